//! Problems: right-hand sides on the square and the cube, and problems with known solutions.

pub mod cube;
pub mod disc;
pub mod exact;
mod field;
pub mod formula;
pub mod region;
pub mod shape;
pub mod source;
