//! Solver of near-optimal cost on nested triangulations, in the plane and in space.
//!
//! # Algorithm
//! The run is that of multigrid on the square (`driver.rs` there), with other steps.
//!
//! 1. Check the load, scale it by a power of two, and restrict it to every coarser network.
//! 2. Solve the problem of the coarsest network by the active set method.
//! 3. On each finer network in turn (`iterate.rs`): interpolate, relax all nodes once, hold the nodes that reach the
//!    contact at zero, and apply one step of conjugate gradients to the others.
//! 4. On the finest network, go on until the goal is reached.
//!
//! The preconditioner is a V-cycle (`cycle.rs`) whose functions leave out what is held. Where a fine node is held
//! between coarse nodes that are not, the coarse functions would be too soft: springs make up for the difference
//! (`springs.rs`). After each step, nodes with negative values are held, those with a negative multiplier are released,
//! and the directions start anew if there are any.
//!
//! # References
//! R. Kornhuber, Numer. Math. 69 (1994) 167-184, for truncated coarse functions; J. J. Moré and G. Toraldo, SIAM J.
//! Optim. 1 (1991) 93-113, for conjugate gradients with changing sets of bounds.

mod aggregates;
mod cycle;
mod interpolation;
mod iterate;
mod levels;
mod smoothed;
mod solve;
mod springs;

pub use solve::{improve_on_nested_networks, solve_nested_networks};
