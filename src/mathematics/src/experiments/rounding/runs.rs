//! Runs of a table with errors: at each update of a value, or once in the load.

use super::{RoundingCell, RoundingPlan, RoundingRow, RoundingTable};
use crate::discrete::grid::Grid;
use crate::experiments::numbers::RandomNumbers;
use crate::experiments::problems::{Discrete, Problem};
use crate::saddle::batch::{Arithmetic, AsDefined, Fused, LANES, Nested, Reversed, V, run_nested};
use crate::saddle::{Iteration, Monitor, Params, StopRule, solve_nested, tolerance};
use rayon::prelude::*;

/// Undisturbed runs of a table.
struct Undisturbed<'a> {
    problem: &'a Problem,
    grids: Vec<Grid>,
    loads: Vec<Vec<f64>>,
    /// Counts, per r and grid.
    counts: Vec<Vec<usize>>,
    /// Distances of the residual from the tolerance, per r.
    margins: Vec<Margins>,
}

/// Run for one r, with these loads.
struct Repeated<'a> {
    /// Index of r in the table.
    row: usize,
    loads: &'a [Vec<f64>],
}

/// Repetition of the run for one r, with errors of one size.
#[derive(Clone, Copy)]
struct Repetition {
    /// Index of r in the table.
    row: usize,
    /// Index of the size in the plan.
    size: usize,
    /// Number of the sequence of random numbers.
    stream: u64,
    /// True if the load is disturbed, once; false if each value is, whenever it is updated.
    in_load: bool,
}

impl Repetition {
    /// Largest relative error, and the random numbers.
    fn noise(&self, plan: &RoundingPlan) -> Noise {
        Noise { size: plan.sizes[self.size], random: RandomNumbers::new(plan.seed, self.stream) }
    }
}

/// Repeats the runs of a table with errors of all sizes.
pub(super) fn disturb(plan: &RoundingPlan, problem: &Problem) -> Result<RoundingTable, String> {
    let rows = Undisturbed::new(problem)?.rows(plan)?;
    let cells: Vec<_> = rows.iter().flat_map(|row| &row.cells).collect();
    let mut changed = Vec::new();
    for size in &plan.sizes {
        let flips = cells.iter().filter(|cell| cell.flips_at.is_some_and(|at| at <= *size));
        changed.push(flips.count());
    }
    Ok(RoundingTable { number: problem.number, grids: problem.grids.clone(), rows, changed })
}

/// Distance of the residual from the tolerance, grid by grid.
#[derive(Default)]
struct Margins {
    levels: Vec<Margin>,
}

/// Distance of the residual from the tolerance on one grid, relative to the tolerance.
#[derive(Clone, Copy, Default)]
struct Margin {
    /// Least excess over the tolerance before the stop; none if the first iteration stopped.
    above: Option<f64>,
    /// Part of the tolerance that is left at the stop; none before the stop.
    below: Option<f64>,
}

impl Monitor for Margins {
    fn wants_iterations(&self) -> bool {
        true
    }

    fn iteration(&mut self, level: usize, iteration: &Iteration) {
        self.levels.resize(level, Margin::default());
        let margin = &mut self.levels[level - 1];
        let excess = iteration.gradient_signed / tolerance(level) - 1.0;
        if excess > 0.0 {
            margin.above = Some(margin.above.map_or(excess, |least| least.min(excess)));
        } else {
            margin.below = Some(-excess);
        }
    }
}

/// RandomNumbers relative errors of at most `size`.
#[derive(Clone, Copy)]
struct Noise {
    size: f64,
    random: RandomNumbers,
}

/// Arithmetic in which the value of each node is off by a random relative error, whose largest size belongs to the run.
struct Noisy {
    size: [f64; LANES],
    random: [RandomNumbers; LANES],
    /// Errors of all runs; those of a run in a lane are out of date.
    runs: Vec<Noise>,
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
        let Noise { size, random } = self.runs[run];
        (self.size[lane], self.random[lane]) = (size, random);
    }
    fn leave(&mut self, lane: usize, run: usize) {
        self.runs[run].random = self.random[lane];
    }
}

/// One repetition of so many disturbs the load and not the iteration.
const LOAD_EVERY: usize = 4;

impl<'a> Undisturbed<'a> {
    fn new(problem: &'a Problem) -> Result<Self, String> {
        let Discrete { grids, loads, .. } = problem.discrete()?;
        let runs: Vec<(Vec<usize>, Margins)> = problem
            .r
            .par_iter()
            .map(|&r| {
                let params = Params { r, rule: StopRule::Signed, ..Params::default() };
                let mut margins = Margins::default();
                let (outcomes, _) =
                    solve_nested(&grids, &loads, &params, problem.prolongation, &mut margins);
                (outcomes.iter().map(|outcome| outcome.iterations).collect(), margins)
            })
            .collect();
        let (counts, margins) = runs.into_iter().unzip();
        Ok(Self { problem, grids, loads, counts, margins })
    }

    /// Makes the runs. Returns, per run and grid, true if the count is another one.
    fn changed(&self, runs: &[Repeated], arithmetic: &mut impl Arithmetic<f64>) -> Vec<Vec<bool>> {
        let mut nested = Vec::new();
        for &Repeated { row, loads } in runs {
            nested.push(Nested { loads, r: self.problem.r[row], rule: StopRule::Signed });
        }
        let ends = run_nested(
            &self.grids,
            &nested,
            self.problem.prolongation,
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

    /// Makes the run of every row, undisturbed but for the arithmetic. Returns, per row and grid, true if the count is
    /// another one.
    fn all_changed(&self, arithmetic: &mut impl Arithmetic<f64>) -> Vec<Vec<bool>> {
        let mut runs = Vec::new();
        for row in 0..self.counts.len() {
            runs.push(Repeated { row, loads: &self.loads });
        }
        self.changed(&runs, arithmetic)
    }

    /// Makes the repetitions of a batch. Returns, per repetition and grid, true if the count is another one.
    fn disturbed(&self, plan: &RoundingPlan, batch: &[Repetition]) -> Vec<Vec<bool>> {
        if batch[0].in_load { self.with_noisy_load(plan, batch) } else { self.noisy(plan, batch) }
    }

    fn noisy(&self, plan: &RoundingPlan, batch: &[Repetition]) -> Vec<Vec<bool>> {
        let runs: Vec<_> =
            batch.iter().map(|of| Repeated { row: of.row, loads: &self.loads }).collect();
        let mut noisy = Noisy {
            size: [0.0; LANES],
            random: [RandomNumbers::new(0, 0); LANES],
            runs: batch.iter().map(|of| of.noise(plan)).collect(),
        };
        self.changed(&runs, &mut noisy)
    }

    fn with_noisy_load(&self, plan: &RoundingPlan, batch: &[Repetition]) -> Vec<Vec<bool>> {
        let mut all_loads = Vec::new();
        for repetition in batch {
            let Noise { size, mut random } = repetition.noise(plan);
            let mut loads = self.loads.clone();
            for value in loads.iter_mut().flatten() {
                *value = perturbed(*value, size, &mut random);
            }
            all_loads.push(loads);
        }
        let pairs = batch.iter().zip(&all_loads);
        let runs: Vec<_> = pairs.map(|(of, loads)| Repeated { row: of.row, loads }).collect();
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

    /// Makes all repetitions, and compares the counts.
    fn rows(&self, plan: &RoundingPlan) -> Result<Vec<RoundingRow>, String> {
        if self.all_changed(&mut AsDefined).iter().flatten().any(|changed| *changed) {
            return Err(format!("table {}: the lanes do not give the counts", self.problem.number));
        }
        let orders = [self.all_changed(&mut Reversed), self.all_changed(&mut Fused)];
        let batches = self.batches(plan);
        let changed: Vec<_> = batches.par_iter().map(|batch| self.disturbed(plan, batch)).collect();
        let runs: Vec<_> = batches.iter().flatten().zip(changed.iter().flatten()).collect();
        let mut rows = Vec::new();
        for (row, &r) in self.problem.r.iter().enumerate() {
            let mut cells = Vec::new();
            for k in 0..self.grids.len() {
                // Sizes with which a repetition gave another count.
                let flips = runs.iter().filter(|(run, changed)| run.row == row && changed[k]);
                let flips: Vec<usize> = flips.map(|(run, _)| run.size).collect();
                let Margin { above, below } = self.margins[row].levels[k];
                let below = below.expect("the lanes have reached the stop");
                cells.push(RoundingCell {
                    count: self.counts[row][k],
                    below,
                    above,
                    margin: above.map_or(below, |above| above.min(below)),
                    flips: flips.iter().filter(|size| **size == 0).count(),
                    flips_at: flips.iter().map(|size| plan.sizes[*size]).min_by(f64::total_cmp),
                    reordered: orders.iter().any(|changed| changed[row][k]),
                });
            }
            rows.push(RoundingRow { r, cells });
        }
        Ok(rows)
    }
}
