//! Runs of the saddle-point methods on one grid, one per vector lane, each as if it were alone: one run, or several.
//!
//! A sweep waits at each node for its western neighbour, and all runs wait alike: eight of them side by side cost as
//! much as three one after the other, and bands of rows shorten the wait. A run's stopping rule is first tried at the
//! node that broke it last; all nodes are tried only when that one no longer does. Iterates and counts are those of the
//! definition, [`Plain`](crate::saddle::Plain), to the last bit.

mod arithmetic;
mod lanes;
mod measure;

pub(crate) use arithmetic::V;
pub(crate) use lanes::Lanes;
pub use lanes::Order;

/// Runs side by side.
pub const LANES: usize = 8;

#[cfg(test)]
mod tests;
