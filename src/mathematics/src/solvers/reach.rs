//! The loop to an accuracy: on one grid or mesh after the other, each finer than the one before, until the guaranteed
//! bound is small enough.

use super::Refusal;
use super::solved::{ReachEnd, Reached, Solved};
use crate::bounds::{Accuracy, Bounds, NoBound};
use crate::saddle::Monitor;
use std::ops::ControlFlow;

/// Grid or mesh on which a solution was sought, for those who watch.
#[derive(Clone, Copy, Debug)]
pub struct Tried<'a> {
    /// Number of nodes.
    pub nodes: usize,
    /// Guaranteed bounds there, or the reason for which there are none.
    pub bounds: &'a Result<Bounds, NoBound>,
}

/// Observer of a solve; every method has a default that does nothing.
pub trait Watcher: Monitor {
    /// Called on the way to an accuracy after each grid or mesh; the way ends there, with the solution so far if it has
    /// a bound, if it breaks off.
    fn tried(&mut self, _tried: Tried<'_>) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}

/// The observer that does nothing.
impl Watcher for () {}

/// Grid or mesh that becomes finer.
pub(crate) trait Refining {
    /// Number of nodes.
    fn nodes(&self) -> usize;

    /// Solves, and bounds the error.
    fn solve(&mut self, monitor: &mut dyn Monitor) -> Result<Result<Bounds, NoBound>, Refusal>;

    /// True if the solver found no solution, so that no finer grid or mesh is to be tried.
    fn has_failed(&self) -> bool;

    /// True if a finer grid or mesh has no bound either, for a reason why this one has none.
    fn is_hopeless(&self, reason: &NoBound) -> bool;

    /// Becomes finer, as fine as the bounds so far say; returns the reason if that is not of use, or not allowed.
    fn refine(&mut self) -> Result<Option<ReachEnd>, Refusal>;

    /// Solution on the last grid or mesh.
    fn finished(self, reached: Reached) -> Result<Solved, Refusal>;
}

/// Solves on one grid or mesh after the other until the accuracy is reached.
///
/// # Errors
/// [`Refusal`] if there is no solution, or no bound; [`Refusal::Interrupted`] if the watcher breaks off before there is
/// one.
pub(crate) fn reach<R: Refining>(
    mut finest: R,
    accuracy: Accuracy,
    watcher: &mut dyn Watcher,
) -> Result<Solved, Refusal> {
    for tried in 1.. {
        let bounds = finest.solve(watcher)?;
        let is_broken_off =
            watcher.tried(Tried { nodes: finest.nodes(), bounds: &bounds }).is_break();
        let end = match &bounds {
            _ if finest.has_failed() => Some(ReachEnd::NoSolution),
            Ok(bounds) if accuracy.reached(bounds) <= accuracy.wanted() => Some(ReachEnd::Goal),
            Ok(bounds) if is_broken_off => {
                Some(ReachEnd::Interrupted { best: accuracy.reached(bounds) })
            }
            Err(_) if is_broken_off => return Err(Refusal::Interrupted),
            Err(reason) if finest.is_hopeless(reason) => {
                return Err(Refusal::NoBound(*reason));
            }
            _ => finest.refine()?,
        };
        if let Some(end) = end {
            return finest.finished(Reached { accuracy, end, tried, marks: None });
        }
    }
    unreachable!("grids and meshes end");
}
