//! Runs that are yet to be made, in cases.

use super::{Series, StressCase};
use crate::discrete::grid::Grid;
use crate::experiments::trial::{Trial, multigrid_trial, saddle_trials};
use crate::multigrid::Goal;
use crate::saddle::batch::{Job, LANES};
use crate::saddle::{JobGoal, Method, Pair};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Runs of the paper's method in a batch: enough that few lanes are idle when only the longest are left.
const BATCH: usize = 4 * LANES;

/// A run that is yet to be made.
pub(super) enum StressRun {
    /// Paper's method on the coarse grid.
    Saddle(CoarseRun),
    /// Multigrid, by nested iteration or from a start.
    Multigrid { grid: Grid, load: Vec<f64>, goal: Goal, start: Option<Vec<f64>> },
}

/// A run of the paper's method on the coarse grid.
pub(super) struct CoarseRun {
    pub(super) load: Vec<f64>,
    pub(super) r: f64,
    pub(super) goal: JobGoal,
    pub(super) limit: usize,
    pub(super) start: Pair,
}

impl CoarseRun {
    fn job(&self) -> Job<'_> {
        Job {
            load: &self.load,
            start: &self.start,
            method: Method::ArrowHurwicz,
            r: self.r,
            goal: self.goal,
            cap: self.limit,
        }
    }
}

/// Runs of a [`StressCase`] that are yet to be made, by their names.
pub(super) struct PendingCase<X> {
    pub(super) x: X,
    pub(super) runs: Vec<(&'static str, StressRun)>,
}

/// Makes the runs of all cases: those of the paper's method on the grid `coarse` in vector lanes, the others side by
/// side.
pub(super) fn make_all<X>(coarse: Grid, pending: Vec<PendingCase<X>>) -> Series<X> {
    let runs: Vec<_> = pending.iter().flat_map(|case| &case.runs).map(|(_, run)| run).collect();
    let mut jobs = Vec::new();
    for run in &runs {
        if let StressRun::Saddle(run) = run {
            jobs.push(run.job());
        }
    }
    let in_lanes: Vec<Trial> =
        jobs.par_chunks(BATCH).flat_map(|jobs| saddle_trials(coarse, jobs)).collect();
    let alone: Vec<Option<Trial>> = runs
        .par_iter()
        .map(|run| match run {
            StressRun::Saddle(_) => None,
            StressRun::Multigrid { grid, load, goal, start } => {
                Some(multigrid_trial(*grid, load, *goal, start.as_deref()))
            }
        })
        .collect();
    let (mut in_lanes, mut alone) = (in_lanes.into_iter(), alone.into_iter());
    let mut series = Vec::new();
    for case in pending {
        let mut trials = BTreeMap::new();
        for (name, _) in case.runs {
            let trial = alone.next().flatten().or_else(|| in_lanes.next());
            trials.insert(name.to_owned(), trial.expect("each run was made"));
        }
        series.push(StressCase { x: case.x, trials });
    }
    series
}
