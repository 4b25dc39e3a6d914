//! Runs that are yet to be made, in cases.

use super::{Series, StressCase};
use crate::discrete::grid::Grid;
use crate::experiments::trial::{Trial, multigrid_trial, saddle_trials};
use crate::multigrid::Goal;
use crate::saddle::batch::{Job, LANES};
use crate::saddle::{JobGoal, Method, Pair};
use rayon::prelude::*;

/// Runs of the paper's method in a batch: enough that few lanes are idle when only the longest are left.
const BATCH: usize = 4 * LANES;

/// A run that is yet to be made.
pub(super) enum StressJob {
    /// Paper's method on the coarse grid.
    Saddle { load: Vec<f64>, r: f64, goal: JobGoal, limit: usize, start: Pair },
    /// Multigrid, by nested iteration or from a start.
    Multigrid { grid: Grid, load: Vec<f64>, goal: Goal, start: Option<Vec<f64>> },
}

impl<X> StressCase<X, StressJob> {
    /// Runs that are yet to be made, by their names.
    pub(super) fn pending<const N: usize>(x: X, runs: [(&str, StressJob); N]) -> Self {
        Self { x, trials: runs.map(|(name, run)| (name.to_owned(), run)).into() }
    }
}

/// Makes the runs of all cases: those of the paper's method on the grid `coarse` in vector lanes, the others side by
/// side.
pub(super) fn make_all<X>(coarse: Grid, pending: Vec<StressCase<X, StressJob>>) -> Series<X> {
    let runs: Vec<_> = pending.iter().flat_map(|case| case.trials.values()).collect();
    let mut jobs = Vec::new();
    for run in &runs {
        if let &StressJob::Saddle { load, r, goal, limit: cap, start } = run {
            jobs.push(Job {
                load,
                start,
                method: Method::ArrowHurwicz,
                r: *r,
                goal: *goal,
                cap: *cap,
            });
        }
    }
    let in_lanes: Vec<Trial> =
        jobs.par_chunks(BATCH).flat_map(|jobs| saddle_trials(coarse, jobs)).collect();
    let alone: Vec<Option<Trial>> = runs
        .par_iter()
        .map(|run| match run {
            StressJob::Saddle { .. } => None,
            StressJob::Multigrid { grid, load, goal, start } => {
                Some(multigrid_trial(*grid, load, *goal, start.as_deref()))
            }
        })
        .collect();
    let (mut in_lanes, mut alone) = (in_lanes.into_iter(), alone.into_iter());
    let mut series = Vec::new();
    for StressCase { x, trials } in pending {
        let made = trials.into_keys().map(|name| {
            let trial = alone.next().flatten().or_else(|| in_lanes.next());
            (name, trial.expect("each run was made"))
        });
        series.push(StressCase { x, trials: made.collect() });
    }
    series
}
