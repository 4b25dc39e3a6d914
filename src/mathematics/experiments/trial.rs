//! One run of a solver under stress, judged by a measure that no solver computes for itself.

use crate::discrete::grid::Grid;
use crate::discrete::kkt::{Judgement, judge};
use crate::discrete::simd::Largest;
use crate::multigrid::{self, Goal, MultigridParams, MultigridStop};
use crate::saddle::batch::{self, AsDefined, End, Job, run};
use crate::saddle::{StopReason, StopRule};
use serde::{Deserialize, Serialize};

/// How a run ended, and what [`judge`] says of the vector it returned.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Trial {
    /// How the solver says that it ended; `refused` if it did not begin.
    pub stop: String,
    /// Iterations, or cycles on the finest grid.
    pub steps: usize,
    /// Work in units of one sweep of the finest grid.
    pub work: f64,
    /// Natural residual over `|F|_inf`; none if it is not finite.
    pub kkt: Option<f64>,
    /// Natural residual over `EPSILON * max |y|`, EPSILON that of the run's precision: about 1 to 10 where only
    /// rounding is left.
    pub floor: Option<f64>,
    /// `max |y|`; none if it is not finite.
    pub size: Option<f64>,
    /// Boundary nodes in contact: there the flux exceeds y.
    pub contact: usize,
    /// Whether what the solver claims of the natural residual is so; none if it claims nothing of it.
    pub holds: Option<bool>,
}

impl Trial {
    /// Judges `y`; `claim` is what the solver claims to be a bound of the natural residual, given `max |y|`.
    fn of(
        grid: Grid,
        load: &[f64],
        y: &[f64],
        stop: &str,
        (steps, work): (usize, f64),
        epsilon: f64,
        claim: impl FnOnce(f64) -> Option<f64>,
    ) -> Self {
        let Judgement { kkt, flux, .. } = judge(grid, y, load);
        let mut largest = Largest::default();
        largest.see(1.0, y);
        let size = largest.value();
        let finite = |x: f64| Some(x).filter(|x| x.is_finite());
        let slack = SLACK * epsilon * size;
        Self {
            stop: stop.into(),
            steps,
            work,
            kkt: finite(kkt.relative),
            floor: finite(kkt.natural / (epsilon * size)),
            size: finite(size),
            contact: grid.boundary().zip(&flux).filter(|&(node, flux)| *flux > y[node]).count(),
            holds: claim(size).map(|bound| kkt.natural.is_finite() && kkt.natural <= bound + slack),
        }
    }

    /// Whether the solver says that it reached its goal.
    pub fn converged(&self) -> bool {
        self.stop == "converged"
    }

    /// Whether the solver says that there is no result.
    pub fn says_that_it_failed(&self) -> bool {
        ["diverged", "refused"].contains(&self.stop.as_str())
    }

    fn of_saddle(grid: Grid, job: &Job, end: &End) -> Self {
        let stop = end.outcome(grid, job).stop;
        let claim = |_| match job.goal {
            batch::Goal::Rule(StopRule::PrintedDual, tolerance)
                if stop == StopReason::Converged =>
            {
                Some(tolerance * (1.0 / job.r).max(1.0))
            }
            _ => None,
        };
        let cost = (end.sweeps, end.sweeps as f64);
        Self::of(grid, job.load, &end.pair.y, &stop.to_string(), cost, f64::EPSILON, claim)
    }
}

/// Runs of the paper's iteration on one grid.
///
/// The printed rule and the dual one together bound the natural residual by their tolerance, over r if
/// that is less than 1. For at a boundary node either the multiplier is zero after its step, and `A y - F`
/// is the component of the gradient; or it is positive, and the step was `-r y`. The other rules
/// bound nothing.
pub fn saddle(grid: Grid, jobs: &[Job]) -> Vec<Trial> {
    let ends = run(grid, jobs, &mut AsDefined);
    jobs.iter().zip(ends).map(|(job, end)| Trial::of_saddle(grid, job, &end)).collect()
}

/// A run of the paper's iteration in single precision, judged in double with the unrounded `load`.
pub fn single(grid: Grid, load: &[f64], job: Job<f32>) -> Trial {
    let end = run(grid, &[job], &mut AsDefined).remove(0);
    let cost = (end.sweeps, end.sweeps as f64);
    let stop = end.stop.to_string();
    Trial::of(grid, load, &end.pair.y, &stop, cost, f32::EPSILON.into(), |_| None)
}

/// Multigrid, by nested iteration or from `start`.
pub fn multi(grid: Grid, load: &[f64], goal: Goal, start: Option<&[f64]>) -> Trial {
    let params = MultigridParams { goal, ..MultigridParams::default() };
    let Ok((y, outcome)) = multigrid::solve_square(grid.cells(), load, start, &params) else {
        return Trial { stop: "refused".into(), ..Trial::default() };
    };
    let claim = |size: f64| match (outcome.stop, goal) {
        (MultigridStop::Converged, Goal::Kkt(tolerance)) => Some(tolerance),
        (MultigridStop::RoundingFloor, _) => Some(multigrid::ROUNDING_FLOOR * f64::EPSILON * size),
        _ => None,
    };
    let cost = (outcome.cycles, outcome.work_units);
    Trial::of(grid, load, &y, outcome.stop.name(), cost, f64::EPSILON, claim)
}

/// By how much two ways to compute a residual may differ, adding in another order, in units of
/// `EPSILON * max |y|`.
const SLACK: f64 = 8.0;
