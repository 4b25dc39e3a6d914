//! The runs of a table with errors: at each update of a value, or once in the load.

use super::{RoundingCell, RoundingPlan, RoundingRow, RoundingTable};
use crate::discrete::grid::Grid;
use crate::experiments::numbers::RandomNumbers;
use crate::experiments::problems::{Discrete, Problem};
use crate::saddle::batch::{
    Arithmetic, AsDefined, End, Fused, LANES, Nested, Reversed, V, run_nested,
};
use crate::saddle::{Iteration, Monitor, Params, StopRule, solve_nested, tolerance};
use rayon::prelude::*;

/// The undisturbed runs of a table.
struct Undisturbed<'a> {
    problem: &'a Problem,
    grids: Vec<Grid>,
    loads: Vec<Vec<f64>>,
    /// Per r, the counts.
    counts: Vec<Vec<usize>>,
}

/// A repetition of the run for one r, with errors of this size.
#[derive(Clone, Copy)]
struct Repetition {
    /// Place of r in the table.
    row: usize,
    /// Place in the sizes of the plan.
    size: usize,
    /// Number of the sequence of random numbers.
    stream: u64,
    /// True if the load is disturbed, once; else each value whenever it is updated.
    in_load: bool,
}

/// Repeats the runs of a table with errors of all sizes.
pub(super) fn disturb(plan: &RoundingPlan, problem: &Problem) -> Result<RoundingTable, String> {
    let Discrete { grids, loads, .. } = problem.discrete()?;
    let count = |&r: &f64| {
        let mut near = Margins::default();
        let params = Params { r, rule: StopRule::Signed, ..Params::default() };
        let (outcomes, _) = solve_nested(&grids, &loads, &params, problem.prolongation, &mut near);
        (outcomes.iter().map(|outcome| outcome.iterations).collect(), near)
    };
    let (counts, near): (Vec<_>, Vec<_>) =
        problem.r.par_iter().map(count).collect::<Vec<_>>().into_iter().unzip();
    let table = Undisturbed { problem, grids, loads, counts };
    let rows = table.rows(plan, &near)?;
    let cells = || rows.iter().flat_map(|row: &RoundingRow| &row.cells);
    let changed = plan
        .sizes
        .iter()
        .map(|size| cells().filter(|cell| cell.flips_at.is_some_and(|at| at <= *size)).count())
        .collect();
    Ok(RoundingTable { number: problem.number, grids: problem.grids.clone(), rows, changed })
}

/// Distance of the residual from the tolerance on each grid.
#[derive(Default)]
struct Margins {
    /// Per grid: least excess over the tolerance before the stop, and what is left of it at the stop.
    levels: Vec<(Option<f64>, f64)>,
}

impl Monitor for Margins {
    fn wants_iterations(&self) -> bool {
        true
    }

    fn iteration(&mut self, level: usize, iteration: &Iteration) {
        self.levels.resize(level, (None, f64::NAN));
        let (above, below) = &mut self.levels[level - 1];
        let excess = iteration.gradient_signed / tolerance(level) - 1.0;
        if excess > 0.0 {
            *above = Some(above.map_or(excess, |least| least.min(excess)));
        } else {
            *below = -excess;
        }
    }
}

/// The value of each node off by a random relative error, whose largest size is a run's own.
struct Noisy {
    size: [f64; LANES],
    random: [RandomNumbers; LANES],
    /// Size and random numbers of the runs that are in no lane.
    runs: Vec<(f64, RandomNumbers)>,
}

/// `value`, off by a random relative error of at most `size`.
#[inline(always)]
fn perturbed(value: f64, size: f64, random: &mut RandomNumbers) -> f64 {
    value + value * (size * (2.0 * random.unit() - 1.0))
}

impl Arithmetic<f64> for Noisy {
    #[inline(always)]
    fn node(&mut self, y: V<f64>) -> V<f64> {
        V(std::array::from_fn(
            #[inline(always)]
            |l| perturbed(y.0[l], self.size[l], &mut self.random[l]),
        ))
    }
    fn enter(&mut self, lane: usize, run: usize) {
        (self.size[lane], self.random[lane]) = self.runs[run];
    }
    fn leave(&mut self, lane: usize, run: usize) {
        self.runs[run].1 = self.random[lane];
    }
}

/// One repetition of so many disturbs the load and not the iteration.
const LOAD_EVERY: usize = 4;

impl Undisturbed<'_> {
    /// For runs of these rows with these loads, on which grids the count is another one.
    fn changed(
        &self,
        runs: &[(usize, &[Vec<f64>])],
        arithmetic: &mut impl Arithmetic<f64>,
    ) -> Vec<Vec<bool>> {
        // One more than the count would show a late stop; with the others a finer grid starts from about
        // where a run without a cap would end.
        let cap = |run: usize, k: usize| self.counts[runs[run].0][k] + 10;
        let rule = StopRule::Signed;
        let all: Vec<Nested> = runs
            .iter()
            .map(|&(row, loads)| Nested { loads, r: self.problem.r[row], rule })
            .collect();
        let ends = run_nested(&self.grids, &all, self.problem.prolongation, cap, arithmetic);
        let differs = |(ends, (row, _)): (Vec<End>, &(usize, _))| {
            let pairs = ends.iter().zip(&self.counts[*row]);
            pairs.map(|(end, want)| end.count() != Some(*want)).collect()
        };
        ends.into_iter().zip(runs).map(differs).collect()
    }

    /// Grids with another count for every row, undisturbed but for the arithmetic.
    fn all_changed(&self, arithmetic: &mut impl Arithmetic<f64>) -> Vec<Vec<bool>> {
        let runs: Vec<_> = (0..self.counts.len()).map(|row| (row, &self.loads[..])).collect();
        self.changed(&runs, arithmetic)
    }

    /// Grids with another count for each repetition of a batch.
    fn disturbed(&self, plan: &RoundingPlan, batch: &[Repetition]) -> Vec<Vec<bool>> {
        let source =
            |of: &Repetition| (plan.sizes[of.size], RandomNumbers::new(plan.seed, of.stream));
        if !batch[0].in_load {
            let runs: Vec<_> = batch.iter().map(|of| (of.row, &self.loads[..])).collect();
            let (size, random) = ([0.0; LANES], [RandomNumbers::new(0, 0); LANES]);
            let mut noisy = Noisy { size, random, runs: batch.iter().map(source).collect() };
            return self.changed(&runs, &mut noisy);
        }
        let disturb = |of: &Repetition| -> Vec<Vec<f64>> {
            let (size, mut random) = source(of);
            let mut noisy = |load: &Vec<f64>| {
                load.iter().map(|&value| perturbed(value, size, &mut random)).collect()
            };
            self.loads.iter().map(&mut noisy).collect()
        };
        let loads: Vec<_> = batch.iter().map(disturb).collect();
        let runs: Vec<_> = batch.iter().zip(&loads).map(|(of, load)| (of.row, &load[..])).collect();
        self.changed(&runs, &mut AsDefined)
    }

    /// All repetitions; those of a batch share r, and whether they disturb the load.
    fn batches(&self, plan: &RoundingPlan) -> Vec<Vec<Repetition>> {
        let mut batches = Vec::new();
        for (row, r) in self.problem.r.iter().enumerate() {
            let mut all = Vec::new();
            for (size, bound) in plan.sizes.iter().enumerate() {
                let repetitions = if size == 0 { plan.repetitions } else { plan.further };
                for repetition in 0..repetitions {
                    let stream = bound.to_bits() ^ r.to_bits().rotate_left(17) ^ repetition as u64;
                    let in_load = repetition.is_multiple_of(LOAD_EVERY);
                    all.push(Repetition { row, size, stream, in_load });
                }
            }
            all.sort_by_key(|of| of.in_load);
            for alike in all.chunk_by(|a, b| a.in_load == b.in_load) {
                batches.extend(alike.chunks(2 * LANES).map(<[Repetition]>::to_vec));
            }
        }
        batches
    }

    fn rows(&self, plan: &RoundingPlan, near: &[Margins]) -> Result<Vec<RoundingRow>, String> {
        if self.all_changed(&mut AsDefined).iter().flatten().any(|changed| *changed) {
            return Err(format!("table {}: the lanes do not give the counts", self.problem.number));
        }
        let orders = [self.all_changed(&mut Reversed), self.all_changed(&mut Fused)];
        let batches = self.batches(plan);
        let changed: Vec<_> = batches.par_iter().map(|batch| self.disturbed(plan, batch)).collect();
        let runs: Vec<_> = batches.iter().flatten().zip(changed.iter().flatten()).collect();
        let cell = |row: usize, k: usize| {
            let flipped = || runs.iter().filter(move |(of, changed)| of.row == row && changed[k]);
            let (above, below) = near[row].levels[k];
            RoundingCell {
                count: self.counts[row][k],
                below,
                above,
                margin: above.map_or(below, |above| above.min(below)),
                flips: flipped().filter(|(of, _)| of.size == 0).count(),
                flips_at: flipped().map(|(of, _)| plan.sizes[of.size]).min_by(f64::total_cmp),
                reordered: orders.iter().any(|changed| changed[row][k]),
            }
        };
        let row = |(row, &r)| {
            let cells = (0..self.grids.len()).map(|k| cell(row, k)).collect();
            RoundingRow { r, cells }
        };
        Ok(self.problem.r.iter().enumerate().map(row).collect())
    }
}
