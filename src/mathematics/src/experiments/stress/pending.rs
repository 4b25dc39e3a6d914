//! Runs that are yet to be made, in cases.

use super::{Series, StressCase};
use crate::discrete::grid::Grid;
use crate::experiments::trial::{Trial, multigrid_trial, saddle_trials};
use crate::machine::threads::{join, map, map_range};
use crate::multigrid::Goal;
use crate::problem::law::Law;
use crate::saddle::batch::LANES;
use crate::saddle::jobs::Job;
use crate::saddle::{JobGoal, Method, Pair, StopRule};
use std::collections::BTreeMap;

/// Least number of runs of the paper's method for a second batch, so that few lanes are idle when only the longest are
/// left.
const BATCH: usize = 12 * LANES;

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

/// Runs of all series, which are made together: the runs of one alone would leave lanes idle.
#[derive(Default)]
pub(super) struct StressJobs(Vec<StressJob>);

impl StressJobs {
    /// Lists the runs of some cases, in which each is then a number.
    pub(super) fn enlist<X>(
        &mut self,
        pending: Vec<StressCase<X, StressJob>>,
    ) -> Vec<StressCase<X, usize>> {
        let mut cases = Vec::new();
        for StressCase { x, trials } in pending {
            let numbered = trials.into_iter().map(|(name, run)| {
                self.0.push(run);
                (name, self.0.len() - 1)
            });
            cases.push(StressCase { x, trials: numbered.collect() });
        }
        cases
    }

    /// Makes all runs: those of the paper's method on the grid `coarse` in vector lanes, the others side by side.
    pub(super) fn make(&self, coarse: Grid) -> StressTrials {
        let mut saddle: Vec<_> =
            (0..self.0.len()).filter(|&k| self.saddle_job(k).is_some()).collect();
        // A rule with a dual bound takes longer. Dealt out like cards: each batch begins with long runs.
        let is_short = |k: &usize| {
            let goal = self.saddle_job(*k).map(|job| job.goal);
            matches!(goal, Some(JobGoal::Rule(StopRule::Signed, _)))
        };
        saddle.sort_by_key(is_short);
        let count = (saddle.len() / BATCH).max(1);
        let batches: Vec<Vec<usize>> =
            (0..count).map(|k| saddle[k..].iter().step_by(count).copied().collect()).collect();
        let (in_lanes, alone) = join(
            || {
                map(&batches, 1, |batch| {
                    let jobs: Vec<_> = batch.iter().filter_map(|&k| self.saddle_job(k)).collect();
                    batch.iter().copied().zip(saddle_trials(coarse, &jobs)).collect::<Vec<_>>()
                })
            },
            || map_range(0..self.0.len(), 1, |k| self.multigrid_run(k)),
        );
        let all = in_lanes.into_iter().flatten().chain(alone.into_iter().flatten());
        StressTrials(all.collect())
    }

    /// Result of the run with this number, if it is one of multigrid.
    fn multigrid_run(&self, number: usize) -> Option<(usize, Trial)> {
        match &self.0[number] {
            StressJob::Saddle { .. } => None,
            StressJob::Multigrid { grid, load, goal, start } => {
                Some((number, multigrid_trial(*grid, load, *goal, start.as_deref())))
            }
        }
    }

    /// The run with this number, if it is one of the paper's method.
    fn saddle_job(&self, number: usize) -> Option<Job<'_>> {
        let StressJob::Saddle { load, r, goal, limit, start } = &self.0[number] else {
            return None;
        };
        let (law, method) = (Law::SIGNORINI, Method::ArrowHurwicz);
        Some(Job { law, load, start, method, r: *r, goal: *goal, cap: *limit })
    }
}

/// Ends of the runs, by their numbers.
pub(super) struct StressTrials(BTreeMap<usize, Trial>);

impl StressTrials {
    /// Cases with the ends of their runs.
    pub(super) fn series<X>(&self, cases: Vec<StressCase<X, usize>>) -> Series<X> {
        let mut series = Vec::new();
        for StressCase { x, trials } in cases {
            let made = trials.into_iter().map(|(name, number)| (name, self.0[&number].clone()));
            series.push(StressCase { x, trials: made.collect() });
        }
        series
    }
}
