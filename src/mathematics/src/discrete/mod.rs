//! The discrete problem: grid, stiffness matrix, load vector, transfer between grids, optimality conditions, norms.

pub mod cells;
pub mod contact;
pub mod cube;
pub mod grid;
pub mod kkt;
pub mod load;
pub mod memory;
pub mod norms;
pub(crate) mod simd;
pub mod stiffness;
pub mod streams;
pub(crate) mod threads;
pub mod transfer;
pub mod verdict;
