//! Runs that are yet to be made.

use super::StressRun;
use crate::discrete::grid::Grid;
use crate::experiments::trial::{Trial, multigrid_trial, saddle_trials};
use crate::machine::threads::{join, map};
use crate::multigrid::Goal;
use crate::problem::law::Law;
use crate::saddle::batch::LANES;
use crate::saddle::jobs::Job;
use crate::saddle::{JobGoal, Method, Pair, StopRule};

/// Least number of runs of the paper's method for a second batch, so that few lanes are idle when only the longest are
/// left.
const BATCH: usize = 12 * LANES;

/// Job that makes a run.
pub(super) enum StressJob {
    /// Paper's method on the coarse grid.
    Saddle { load: Vec<f64>, r: f64, goal: JobGoal, limit: usize, start: Pair },
    /// Multigrid.
    Multigrid { grid: Grid, load: Vec<f64>, goal: Goal },
}

/// A run with the job that makes it.
pub(super) struct Pending {
    /// The run without its end.
    pub(super) run: StressRun,
    pub(super) job: StressJob,
}

impl Pending {
    /// The run if it is one of the paper's method.
    fn saddle_job(&self) -> Option<Job<'_>> {
        let StressJob::Saddle { load, r, goal, limit, start } = &self.job else { return None };
        let (law, method) = (Law::SIGNORINI, Method::ArrowHurwicz);
        Some(Job { law, load, start, method, r: *r, goal: *goal, cap: *limit })
    }

    /// End of the run if it is one of multigrid.
    fn multigrid_trial(&self) -> Option<Trial> {
        match &self.job {
            StressJob::Saddle { .. } => None,
            StressJob::Multigrid { grid, load, goal } => Some(multigrid_trial(*grid, load, *goal)),
        }
    }

    /// True if the run ends under the signed rule; a rule with a dual bound takes longer.
    fn is_short(&self) -> bool {
        matches!(self.job, StressJob::Saddle { goal: JobGoal::Rule(StopRule::Signed, _), .. })
    }
}

/// Makes the runs of all series together, since those of one alone would leave lanes idle: those of the paper's method
/// on the grid `coarse` in vector lanes, the others side by side.
pub(super) fn made(coarse: Grid, pending: Vec<Pending>) -> Vec<StressRun> {
    let mut saddle: Vec<usize> = (0..pending.len()).collect();
    saddle.retain(|&k| pending[k].saddle_job().is_some());
    // Dealt out like cards: each batch begins with long runs.
    saddle.sort_by_key(|&k| pending[k].is_short());
    let count = (saddle.len() / BATCH).max(1);
    let batches: Vec<Vec<usize>> =
        (0..count).map(|k| saddle[k..].iter().step_by(count).copied().collect()).collect();
    let (in_lanes, mut trials) = join(
        || {
            map(&batches, 1, |batch| {
                let jobs: Vec<_> = batch.iter().filter_map(|&k| pending[k].saddle_job()).collect();
                saddle_trials(coarse, &jobs)
            })
        },
        || map(&pending, 1, Pending::multigrid_trial),
    );
    for (k, trial) in batches.concat().into_iter().zip(in_lanes.into_iter().flatten()) {
        trials[k] = Some(trial);
    }
    let runs = pending.into_iter().zip(trials);
    runs.map(|(pending, trial)| pending.run.ended(trial.unwrap_or_default())).collect()
}
