//! Many runs of the saddle-point methods on one grid or network at once, one per vector lane, each as if it were alone.
//!
//! A sweep waits at each node for its western neighbour, and all runs wait alike: eight of them
//! side by side cost less than three one after the other, and rows in pairs shorten the wait. A run's
//! stopping rule is first tried at the node that broke it last; all nodes are tried only when that one no
//! longer does. Iterates and counts are those of [`solve`](crate::saddle::solve) to the last bit.

mod arithmetic;
mod lanes;
mod measure;
mod network;

pub(crate) use arithmetic::V;
pub(crate) use lanes::Lanes;
pub use lanes::Order;
pub(super) use network::NetworkLanes;

use crate::problem::law::Law;
use crate::saddle::{Engine, RunStart};

/// Runs side by side.
pub const LANES: usize = 8;

/// Engine that a run enters where a lane is free.
pub(crate) trait LaneEngine: Engine<LANES> {
    /// Puts a run into a lane, under this law.
    ///
    /// # Panics
    /// If a vector has the wrong length for the grid or network, r is not positive, or the method has a proximal term
    /// on a network.
    fn enter(&mut self, lane: usize, law: Law, run: &RunStart<'_>);
}
