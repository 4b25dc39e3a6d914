//! Problems: right-hand sides in the plane and in space, the law on the boundary, and problems with known solutions.

pub(crate) mod balance;
pub(crate) mod choices;
pub(crate) mod complex;
pub(crate) mod descent;
pub mod error;
pub mod exact;
pub mod field;
pub mod formula;
pub mod law;
pub mod shape;
pub mod side;
pub mod source;
pub mod text;
pub mod unsolvable;
