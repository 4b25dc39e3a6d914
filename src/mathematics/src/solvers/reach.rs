//! The loop to an accuracy: on one grid or mesh after the other, each finer than the one before, until the guaranteed
//! bound is small enough.
//!
//! On grids of the square the bound is taken to fall like a power of the width, and the next grid aims at the goal; all
//! coarser grids together cost less than the last one.

use super::run::Run;
use super::size::{MOST_CELLS, Memory};
use super::solved::{ReachEnd, Reached, Solved};
use super::{Refusal, Settings, solve_watched};
use crate::bounds::{Accuracy, Bounds, NoBound};
use crate::levels::{Problem, Step, Watch};
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

/// Cells per side from which on errors fall like a power of the width of the grid.
const SETTLED: usize = 128;
/// Largest ratio of the widths of a grid and the next one.
const STRIDE: usize = 8;

/// Grids so far, with the solution on the finest.
pub(crate) struct Grids<'a> {
    /// Problem on the finest grid.
    problem: Problem,
    settings: Settings,
    accuracy: Accuracy,
    memory: Memory,
    /// Is told each step.
    steps: Watch<'a>,
    /// Run on the finest grid, with the ends and errors on all.
    run: Option<Run>,
    bounds: Vec<Result<Bounds, NoBound>>,
}

impl<'a> Grids<'a> {
    /// The first grid, that of the problem.
    pub(crate) fn new(
        problem: Problem,
        settings: Settings,
        accuracy: Accuracy,
        memory: Memory,
        steps: Watch<'a>,
    ) -> Self {
        Self { problem, settings, accuracy, memory, steps, run: None, bounds: Vec::new() }
    }

    /// Numbers of cells per side and bounds of the grids so far; no bound is an infinite one.
    fn tried(&self) -> Vec<TriedGrid> {
        let ends = self.run.iter().flat_map(|run| &run.ends);
        let mut tried = Vec::new();
        for (end, bounds) in ends.zip(&self.bounds) {
            let reached = bounds.as_ref().map_or(f64::INFINITY, |of| self.accuracy.reached(of));
            tried.push(TriedGrid { cells: end.cells.unwrap_or_default(), reached });
        }
        tried
    }
}

impl Refining for Grids<'_> {
    fn nodes(&self) -> usize {
        self.problem.lengths()[0]
    }

    fn solve(&mut self, monitor: &mut dyn Monitor) -> Result<Result<Bounds, NoBound>, Refusal> {
        // The load vector is made when it is first read.
        self.problem.load();
        (self.steps)(Step::Load);
        let mut run = solve_watched(&self.problem, &self.settings, monitor)?;
        (self.steps)(Step::Solver);
        let bounds = self.problem.bounds(&run.y);
        (self.steps)(Step::Bounds);
        if let Some(before) = self.run.take() {
            run.ends.splice(0..0, before.ends);
        }
        self.run = Some(run);
        self.bounds.push(bounds.clone());
        Ok(bounds)
    }

    fn has_failed(&self) -> bool {
        self.run.as_ref().is_some_and(|run| run.last().judged(true).is_failure())
    }

    /// On a finer grid the points miss less of f.
    fn is_hopeless(&self, reason: &NoBound) -> bool {
        !matches!(reason, NoBound::Missed { .. })
    }

    fn refine(&mut self) -> Result<Option<ReachEnd>, Refusal> {
        let cells = match next(self.accuracy, &self.tried()) {
            Ok(cells) => cells,
            Err(end) => return Ok(Some(end)),
        };
        self.memory.check_grid(self.settings.solver, cells)?;
        let finer = self.problem.on_grid(cells).expect("multigrid takes this grid of the square");
        self.problem = finer?;
        Ok(None)
    }

    fn finished(self, reached: Reached) -> Result<Solved, Refusal> {
        let run = self.run.expect("at least one grid is tried");
        Ok(Solved::with_bounds(self.problem, run, self.bounds, reached))
    }
}

/// Grid that was tried, with the bound that it gave.
#[derive(Clone, Copy, Debug)]
struct TriedGrid {
    cells: usize,
    reached: f64,
}

/// Cells per side of the grid after the last of those `tried`, whose bounds are too large, or the reason why there is
/// none.
fn next(accuracy: Accuracy, tried: &[TriedGrid]) -> Result<usize, ReachEnd> {
    let TriedGrid { cells: finest, reached } = tried[tried.len() - 1];
    // Of two grids of nearly the same width the coarser may be better, if the borders of f are among its lines.
    let before = tried.iter().filter(|grid| 2 * grid.cells <= finest);
    let before = before.map(|grid| grid.reached).fold(f64::INFINITY, f64::min);
    // The relative error is infinite if the error may be as large as the solution.
    let settled = finest >= SETTLED && reached.is_finite();
    if settled && finest > SETTLED && reached >= before {
        return Err(ReachEnd::Rounding { least: before });
    }
    let order = accuracy.order();
    let needed = finest as f64 * libm::pow(reached / accuracy.wanted(), 1.0 / order);
    let last = MOST_CELLS as f64;
    if finest == MOST_CELLS || (settled && needed > 1.02 * last) {
        let best = reached * libm::pow(finest as f64 / last, order);
        return Err(ReachEnd::Finest { needed: Some(needed), best });
    }
    Ok(size(needed.min(finest as f64 * STRIDE as f64)).clamp(finest + 1, MOST_CELLS))
}

/// Least number of cells per side from 1.003 times `needed` on that multigrid takes: four to seven times a power of
/// two.
fn size(needed: f64) -> usize {
    let needed = (1.003 * needed).ceil() as usize;
    let mut unit = 2;
    while 8 * unit < needed {
        unit *= 2;
    }
    unit * needed.div_ceil(unit).max(4)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_suit_multigrid_and_are_hardly_finer_than_needed() {
        for needed in 9..5000 {
            let n = size(f64::from(needed));
            let odd = n >> n.trailing_zeros();
            assert!(odd <= 7 && n as f64 >= f64::from(needed), "{needed} {n}");
            assert!((n as f64) < 1.3 * f64::from(needed) + 2.0, "{needed} {n}");
        }
    }
}
