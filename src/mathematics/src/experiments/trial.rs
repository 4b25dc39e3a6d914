//! One run of a solver under stress, judged by [`judge`], which no solver uses for its own stop.

use crate::discrete::end::End;
use crate::discrete::grid::Grid;
use crate::discrete::kkt::judge;
use crate::discrete::stop::Stop;
use crate::machine::simd::Largest;
use crate::multigrid::{self, Goal, MultigridParams};
use crate::problem::law::Law;
use crate::saddle::jobs::{Job, run};
use crate::saddle::{JobGoal, Pair, StopRule};
use serde::Serialize;

/// End of a run, and the judgement of [`judge`] on the vector that it returned.
#[derive(Clone, Debug, Default, Serialize)]
pub(super) struct Trial {
    /// Reason that the solver gives for its end; none if it refused to begin.
    pub(super) stop: Option<Stop>,
    /// Iterations, or cycles on the finest grid.
    pub(super) steps: usize,
    /// Work in units of one sweep of the finest grid.
    pub(super) work: f64,
    /// Natural residual over `|F|_inf`; none if it is not finite.
    pub(super) kkt: Option<f64>,
    /// Natural residual over `EPSILON * max |y|`: about 1 to 10 if only rounding errors are left.
    pub(super) floor: Option<f64>,
    /// True if the natural residual is within the bound that the solver claims; none if it claims no bound.
    pub(super) holds: Option<bool>,
}

/// Bound of the natural residual that a solver claims.
enum Claim {
    /// This number.
    AtMost(f64),
    /// Rounding floor of multigrid, [`multigrid::ROUNDING_FLOOR`] times `EPSILON * max |y|`.
    RoundingFloor,
}

impl Trial {
    /// Adds the judgement on the vector `y` that the solver returned, and on its claim, if there is one.
    fn judged(self, grid: Grid, load: &[f64], y: &[f64], claim: Option<Claim>) -> Self {
        let judgement = judge(grid, Law::SIGNORINI, y, load);
        let kkt = judgement.kkt;
        let mut largest = Largest::default();
        largest.see(1.0, y);
        let size = largest.value();
        let slack = SLACK * f64::EPSILON * size;
        let bound = claim.map(|claim| match claim {
            Claim::AtMost(bound) => bound,
            Claim::RoundingFloor => multigrid::ROUNDING_FLOOR * f64::EPSILON * size,
        });
        Self {
            kkt: finite(kkt.relative),
            floor: finite(kkt.natural / (f64::EPSILON * size)),
            holds: bound.map(|bound| kkt.natural.is_finite() && kkt.natural <= bound + slack),
            ..self
        }
    }
}

fn finite(x: f64) -> Option<f64> {
    Some(x).filter(|x| x.is_finite())
}

/// Runs the paper's iteration on one grid, for all `jobs`.
///
/// The printed rule and the dual one together bound the natural residual by their tolerance, over r if
/// that is less than 1. For at a boundary node either the multiplier is zero after its step, and `A y - F`
/// is the component of the gradient; or it is positive, and the step was `-r y`. The other rules
/// bound nothing.
pub(super) fn saddle_trials(grid: Grid, jobs: &[Job]) -> Vec<Trial> {
    let ends = run(grid, jobs);
    jobs.iter().zip(ends).map(|(job, (end, pair))| saddle_trial(grid, job, end, &pair)).collect()
}

fn saddle_trial(grid: Grid, job: &Job, end: End, pair: &Pair) -> Trial {
    let stop = job.outcome(grid, end, pair).end.stop;
    let claim = match job.goal {
        JobGoal::Rule(StopRule::PrintedDual, tolerance) if stop == Stop::Converged => {
            Some(Claim::AtMost(tolerance * (1.0 / job.r).max(1.0)))
        }
        _ => None,
    };
    let trial =
        Trial { stop: Some(stop), steps: end.sweeps(), work: end.work_units, ..Trial::default() };
    trial.judged(grid, job.load, &pair.y, claim)
}

/// Runs multigrid.
pub(super) fn multigrid_trial(grid: Grid, load: &[f64], goal: Goal) -> Trial {
    let params = MultigridParams { goal, ..MultigridParams::default() };
    let problem = Law::SIGNORINI.with_load(load);
    let Ok((y, outcome)) = multigrid::solve_square(grid.cells(), problem, &params) else {
        return Trial::default();
    };
    let claim = match (outcome.stop, goal) {
        (Stop::Converged, Goal::Kkt(tolerance)) => Some(Claim::AtMost(tolerance)),
        (Stop::RoundingFloor, _) => Some(Claim::RoundingFloor),
        _ => None,
    };
    let trial = Trial {
        stop: Some(outcome.stop),
        steps: outcome.iterations,
        work: outcome.work_units,
        ..Trial::default()
    };
    trial.judged(grid, load, &y, claim)
}

/// Largest difference, in units of `EPSILON * max |y|`, between two ways to compute a residual that add in another
/// order.
const SLACK: f64 = 8.0;
