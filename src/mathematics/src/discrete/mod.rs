//! The discrete problem: grid, stiffness matrix, load vector, transfer between grids, optimality conditions, norms.

pub(crate) mod adaptive;
pub mod cells;
pub mod contact;
pub mod domain;
pub mod end;
pub mod grid;
pub mod kkt;
pub mod load;
pub(crate) mod load_stats;
pub mod nested;
pub mod network;
pub mod norms;
pub(crate) mod quadrature;
pub mod stiffness;
pub mod transfer;
