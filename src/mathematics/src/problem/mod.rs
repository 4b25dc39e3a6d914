//! Problems: right-hand sides on the square and the cube, the law on the boundary, and problems with known solutions.

pub(crate) mod balance;
pub(crate) mod complex;
pub mod cube;
pub mod disc;
pub mod exact;
pub mod field;
pub mod formula;
pub mod law;
pub mod region;
pub mod shape;
pub mod side;
pub mod source;
pub mod text;
