//! The discrete problem: grid, stiffness matrix, load vector, transfer between grids, optimality conditions, norms.

pub(crate) mod adaptive;
pub mod cells;
pub(crate) mod components;
pub mod contact;
pub mod domain;
pub mod end;
pub mod grid;
pub mod kkt;
pub mod law_and_load;
pub mod load;
pub(crate) mod load_stats;
pub mod nested;
pub mod network;
pub mod norms;
pub(crate) mod quadrature;
pub(crate) mod sampled;
pub(crate) mod stencils;
pub mod stiffness;
pub mod stop;
pub mod transfer;
pub mod verdict;
