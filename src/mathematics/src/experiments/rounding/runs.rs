//! Runs of a table with errors: at each update of a value, or once in the load.

use super::Nearest;
use super::disturbances::{Fused, Noise, Noisy, Reversed, perturbed};
use crate::discrete::grid::Grid;
use crate::experiments::numbers::RandomNumbers;
use crate::experiments::problems::{Discrete, Problem};
use crate::problem::law::Law;
use crate::saddle::batch::{Arithmetic, AsDefined, LANES, Nested, NestedGrids, run_nested};
use crate::saddle::{Iteration, Monitor, Params, StopRule, solve_nested, tolerance};
use rayon::prelude::*;

/// Random relative errors with which the runs of a table are repeated.
pub(super) struct RandomErrors {
    /// Largest size.
    pub(super) size: f64,
    /// Number of repetitions for each r.
    pub(super) repetitions: usize,
    pub(super) seed: u64,
}

/// Least distance of the residual from the tolerance over all iterations, relative to the tolerance, grid by grid.
#[derive(Default)]
struct Margins(Vec<f64>);

impl Monitor for Margins {
    fn wants_iterations(&self) -> bool {
        true
    }

    fn iteration(&mut self, level: usize, iteration: &Iteration) {
        self.0.resize(level, f64::INFINITY);
        let excess = iteration.gradient_signed / tolerance(level) - 1.0;
        self.0[level - 1] = self.0[level - 1].min(excess.abs());
    }
}

/// Run for one r, with these loads.
struct Repeated<'a> {
    /// Index of r in the table.
    row: usize,
    loads: &'a [Vec<f64>],
}

/// Repetition of the run for one r.
#[derive(Clone, Copy)]
struct Repetition {
    /// Index of r in the table.
    row: usize,
    /// True if the load is disturbed, once; false if each value is, whenever it is updated.
    in_load: bool,
    noise: Noise,
}

/// One repetition of so many disturbs the load and not the iteration.
const LOAD_EVERY: usize = 4;
/// Repetitions in a batch: enough that few lanes are idle when only the longest are left.
const BATCH: usize = 4 * LANES;

/// Undisturbed runs of a table.
pub(super) struct Undisturbed<'a> {
    problem: &'a Problem,
    grids: Vec<Grid>,
    loads: Vec<Vec<f64>>,
    /// Counts, per r and grid.
    counts: Vec<Vec<usize>>,
    /// Margins of the counts, per r.
    margins: Vec<Margins>,
}

impl<'a> Undisturbed<'a> {
    pub(super) fn new(problem: &'a Problem) -> Result<Self, String> {
        let Discrete { grids, loads, .. } = problem.discrete()?;
        let on_grids = problem.law()?.with_loads(&loads);
        let runs: Vec<(Vec<usize>, Margins)> = problem
            .r
            .par_iter()
            .map(|&r| {
                let params = Params { r, rule: StopRule::Signed, ..Params::default() };
                let mut margins = Margins::default();
                let (outcomes, _) =
                    solve_nested(&grids, on_grids, &params, problem.prolongation, &mut margins);
                (outcomes.iter().map(|outcome| outcome.iterations).collect(), margins)
            })
            .collect();
        let (counts, margins) = runs.into_iter().unzip();
        Ok(Self { problem, grids, loads, counts, margins })
    }

    /// Margin of each count.
    pub(super) fn margins(&self) -> Vec<Nearest> {
        let mut all = Vec::new();
        for (&r, margins) in self.problem.r.iter().zip(&self.margins) {
            for (&cells, &margin) in self.problem.grids.iter().zip(&margins.0) {
                all.push(Nearest { table: self.problem.number, r, cells, margin });
            }
        }
        all
    }

    /// Number of counts that another order of operations changes.
    pub(super) fn reordered(&self) -> Result<usize, String> {
        if self.all_changed(&mut AsDefined).contains(&true) {
            return Err(format!("table {}: the lanes do not give the counts", self.problem.number));
        }
        let orders = self.all_changed(&mut Reversed).into_iter().zip(self.all_changed(&mut Fused));
        Ok(orders.filter(|(reversed, fused)| *reversed || *fused).count())
    }

    /// Number of counts that these errors change in any repetition.
    pub(super) fn changed_by(&self, errors: &RandomErrors) -> usize {
        let all = self.repetitions(errors);
        let alike = all.chunk_by(|a, b| a.in_load == b.in_load);
        let batches: Vec<_> = alike.flat_map(|alike| alike.chunks(BATCH)).collect();
        let changed: Vec<_> = batches.par_iter().flat_map(|batch| self.disturbed(batch)).collect();
        let mut any = vec![vec![false; self.grids.len()]; self.counts.len()];
        for (repetition, changed) in all.iter().zip(changed) {
            for (any, changed) in any[repetition.row].iter_mut().zip(changed) {
                *any |= changed;
            }
        }
        any.iter().flatten().filter(|changed| **changed).count()
    }

    /// All repetitions, those that disturb the load last.
    fn repetitions(&self, errors: &RandomErrors) -> Vec<Repetition> {
        let size = errors.size;
        let mut all = Vec::new();
        for (row, r) in self.problem.r.iter().enumerate() {
            for repetition in 0..errors.repetitions {
                let of_r = r.to_bits().rotate_left(17);
                let stream = size.to_bits() ^ of_r ^ repetition as u64;
                let noise = Noise { size, random: RandomNumbers::new(errors.seed, stream) };
                all.push(Repetition { row, in_load: repetition.is_multiple_of(LOAD_EVERY), noise });
            }
        }
        all.sort_by_key(|repetition| repetition.in_load);
        all
    }

    /// Makes the repetitions of a batch, which are alike in what they disturb. Returns, per repetition and grid, true
    /// if the count is another one.
    fn disturbed(&self, batch: &[Repetition]) -> Vec<Vec<bool>> {
        if batch[0].in_load { self.with_noisy_load(batch) } else { self.noisy(batch) }
    }

    fn noisy(&self, batch: &[Repetition]) -> Vec<Vec<bool>> {
        let (mut runs, mut noise) = (Vec::new(), Vec::new());
        for repetition in batch {
            runs.push(Repeated { row: repetition.row, loads: &self.loads });
            noise.push(repetition.noise);
        }
        self.changed(&runs, &mut Noisy::new(noise))
    }

    fn with_noisy_load(&self, batch: &[Repetition]) -> Vec<Vec<bool>> {
        let mut all_loads = Vec::new();
        for repetition in batch {
            let Noise { size, mut random } = repetition.noise;
            let mut loads = self.loads.clone();
            for value in loads.iter_mut().flatten() {
                *value = perturbed(*value, size, &mut random);
            }
            all_loads.push(loads);
        }
        let mut runs = Vec::new();
        for (repetition, loads) in batch.iter().zip(&all_loads) {
            runs.push(Repeated { row: repetition.row, loads });
        }
        self.changed(&runs, &mut AsDefined)
    }

    /// Makes the run of every row, undisturbed but for the arithmetic. Returns true for each count that is another one.
    fn all_changed(&self, arithmetic: &mut impl Arithmetic) -> Vec<bool> {
        let mut runs = Vec::new();
        for row in 0..self.counts.len() {
            runs.push(Repeated { row, loads: &self.loads });
        }
        self.changed(&runs, arithmetic).concat()
    }

    /// Makes the runs. Returns, per run and grid, true if the count is another one.
    fn changed(&self, runs: &[Repeated], arithmetic: &mut impl Arithmetic) -> Vec<Vec<bool>> {
        let mut nested = Vec::new();
        for &Repeated { row, loads } in runs {
            nested.push(Nested { loads, r: self.problem.r[row], rule: StopRule::Signed });
        }
        let prolongation = self.problem.prolongation;
        let ends = run_nested(
            NestedGrids { grids: &self.grids, prolongation },
            Law::SIGNORINI,
            &nested,
            // One more than the count would show a late stop; with the others a finer grid starts from about
            // where a run without a limit would end.
            |run, k| self.counts[runs[run].row][k] + 10,
            arithmetic,
        );
        let mut changed = Vec::new();
        for (ends, run) in ends.iter().zip(runs) {
            let counts = ends.iter().zip(&self.counts[run.row]);
            changed.push(counts.map(|(end, count)| end.count() != Some(*count)).collect());
        }
        changed
    }
}
