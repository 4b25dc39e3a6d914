//! Solver of near-optimal cost on nested triangulations, in the plane and in space.
//!
//! # Algorithm
//! The run is that of multigrid on the square (`driver.rs` there), with other steps.
//!
//! 1. If the coarsest network is too large for factors, make coarser levels of aggregates of its nodes: smoothed
//!    aggregation (`aggregates.rs`, `smoothed.rs`). A level of aggregates is a network with contact nodes as well, so
//!    that all that follows is the same on all levels (`levels.rs`).
//! 2. Check the load, scale it by a power of two, and restrict it to every coarser level.
//! 3. Solve the problem of the coarsest level: of a mesh by the active set method, of aggregates by some steps.
//! 4. On each finer level in turn (`iterate.rs`): interpolate, relax all nodes once, hold the nodes that reach the
//!    contact at zero, and apply one step of conjugate gradients to the others.
//! 5. On the finest network, go on until the goal is reached. If the steps are slow, as where cells are stretched,
//!    begin again from the vector so far with levels of aggregates alone, which the matrix tells how to coarsen: along
//!    very strong couplings, of at least a quarter of the diagonal.
//!
//! The preconditioner is a cycle (`cycle.rs`), V over meshes and W over aggregates, whose functions leave out what is
//! held. Where a fine node is held between coarse nodes that are not, the coarse functions would be too soft: springs
//! make up for the difference (`springs.rs`). After each step, nodes with negative values are held, those with a
//! negative multiplier are released if that pays, and the directions start anew if there are any.
//!
//! # Cost
//! 15 to 21 steps to rounding errors on meshes of Gmsh with 10^4 to 10^6 nodes, in the plane and in space, graded and
//! with layers of aspect 1000: some 2 microseconds a node. Unstructured meshes that are stretched everywhere take more
//! steps.
//!
//! # References
//! R. Kornhuber, Numer. Math. 69 (1994) 167-184, for truncated coarse functions; J. J. Moré and G. Toraldo, SIAM J.
//! Optim. 1 (1991) 93-113, for conjugate gradients with changing sets of bounds; P. Vanek, J. Mandel and M. Brezina,
//! Computing 56 (1996) 179-196, for smoothed aggregation.

mod aggregates;
mod cycle;
mod interpolation;
mod iterate;
mod levels;
mod run;
mod smoothed;
mod solve;

pub use solve::{Improved, Start, improve_on_nested_networks, solve_nested_networks};
