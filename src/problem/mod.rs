//! What is solved: right-hand sides on the square and the cube, and problems with known solutions.

pub mod cube;
pub mod exact;
pub mod region;
pub mod source;
