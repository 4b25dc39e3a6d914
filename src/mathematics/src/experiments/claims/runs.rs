//! Runs of the experiment on the claims, spread over threads; every count is the same however they are spread.

use super::{ClaimMeasure, ClaimsPlan, Count, KktTarget, VARIANTS, WeightRow};
use crate::discrete::end::End;
use crate::discrete::grid::Grid;
use crate::discrete::kkt::kkt;
use crate::discrete::load::{LoadRule, load};
use crate::discrete::norms::{largest, worst};
use crate::discrete::stop::Stop;
use crate::experiments::problems::{ProblemOnGrids, TableProblem};
use crate::problem::law::Law;
use crate::saddle::batch::{Job, LANES, NestedJob, run, run_all_nested};
use crate::saddle::{
    JobGoal, Method, NestedGrids, Pair, Params, StopRule, arrow_hurwicz, run_nested,
};
use rayon::prelude::*;

/// Rule of the load towards a KKT residual: under the published one, problem 1 sums to a positive number on
/// fine grids, and has no solution to converge to.
const SOLVABLE: LoadRule = LoadRule::LumpedAverage {};
/// Tolerance of the coarser grid's solution, from which runs towards a KKT residual start.
const START: f64 = 1e-12;
/// Cells per side of the finest grid on which weights of the proximal term are compared.
const MOST_FOR_WEIGHTS: usize = 32;
/// Duality parameter with which they are compared.
const R_OF_WEIGHTS: f64 = 100.0;
/// Stopping rules under which r is swept; the others take the paper's r only.
pub(super) const SWEPT: [StopRule; 2] = [StopRule::Signed, StopRule::Printed];

/// Runs in a batch: many, so that few lanes are idle when only the longest runs are left.
const RUNS: usize = 12 * LANES;

/// A problem on all its grids.
pub(super) struct ClaimCase<'a> {
    pub(super) problem: &'a TableProblem,
    pub(super) law: Law,
    pub(super) grids: Vec<Grid>,
    /// Load vectors under the published rule.
    pub(super) published: Vec<Vec<f64>>,
    /// Load vectors under [`SOLVABLE`].
    pub(super) solvable: Vec<Vec<f64>>,
    /// Solution on the coarser grid under [`SOLVABLE`], prolonged to each grid; zero on the coarsest grid.
    pub(super) starts: Vec<Pair>,
}

/// A run to be made.
#[derive(Clone, Copy, PartialEq)]
pub(super) struct ClaimJob {
    /// Index of the problem in the plan.
    pub(super) problem: usize,
    /// Measure by which it ends: a stopping rule on all grids in turn, or a KKT residual on one of them.
    pub(super) measure: ClaimMeasure,
    /// Index of this grid; zero under a stopping rule.
    pub(super) level: usize,
    /// Index in [`VARIANTS`]; `None` stands for Arrow-Hurwicz.
    pub(super) variant: Option<usize>,
    pub(super) r: f64,
}

/// Makes all runs, in parallel. Returns, for each, its ends on the grids that it visits, with the KKT residuals over
/// the largest component of F.
pub(super) fn run_all(
    plan: &ClaimsPlan,
    problems: &[ClaimCase],
) -> Vec<(ClaimJob, Vec<(End, f64)>)> {
    let batches = batches(plan, problems);
    let done: Vec<_> = batches
        .par_iter()
        .with_max_len(1)
        .map(|batch| problems[batch[0].problem].run(plan, batch))
        .collect();
    batches.concat().into_iter().zip(done.into_iter().flatten()).collect()
}

/// All runs; those of a batch share the problem, and the stopping rule or the grid.
fn batches(plan: &ClaimsPlan, problems: &[ClaimCase]) -> Vec<Vec<ClaimJob>> {
    let swept = plan.r();
    let mut batches = Vec::new();
    for (index, problem) in problems.iter().enumerate() {
        // The finest grids first: they take longest.
        for (level, grid) in problem.grids.iter().enumerate().rev() {
            let mut runs = Vec::new();
            for &KktTarget { kkt: target, cells: finest } in plan.targets.iter().rev() {
                if grid.cells() > finest {
                    continue;
                }
                let measure = ClaimMeasure::Kkt(target);
                let job = ClaimJob { problem: index, measure, level, variant: None, r: 0.0 };
                runs.extend(job.for_each(&swept));
                if grid.cells() >= plan.compared_from {
                    for variant in (0..VARIANTS.len()).map(Some) {
                        runs.extend(ClaimJob { variant, ..job }.for_each(&plan.compared_r));
                    }
                }
            }
            batches.extend(runs.chunks(RUNS).map(<[ClaimJob]>::to_vec));
        }
        let of_paper = &problem.problem.r;
        for rule in StopRule::ALL {
            let mut r = of_paper.clone();
            if SWEPT.contains(&rule) {
                r.extend(swept.iter().filter(|r| !of_paper.contains(r)));
            }
            r.sort_by(f64::total_cmp);
            let measure = ClaimMeasure::Rule(rule);
            let job = ClaimJob { problem: index, measure, level: 0, variant: None, r: 0.0 };
            let runs: Vec<_> = job.for_each(&r).collect();
            batches.extend(runs.chunks(RUNS).map(<[ClaimJob]>::to_vec));
        }
    }
    batches
}

impl ClaimJob {
    /// This run for each r instead of its own.
    fn for_each(self, r: &[f64]) -> impl Iterator<Item = Self> {
        r.iter().map(move |&r| Self { r, ..self })
    }
}

impl<'a> ClaimCase<'a> {
    pub(super) fn new(problem: &'a TableProblem) -> Result<Self, String> {
        let ProblemOnGrids { f, grids, loads: published } = problem.discrete()?;
        let law = problem.law()?;
        let solvable: Vec<_> = grids.iter().map(|&grid| load(grid, &f, SOLVABLE)).collect();
        let params =
            Params { r: 100.0, tolerance: START, rule: StopRule::PrintedDual, ..Params::default() };
        let levels = NestedGrids { grids: &grids, prolongation: problem.prolongation };
        let mut starts = Vec::new();
        run_nested(&levels, &mut [Pair::zero(grids[0])], |k, [pair]: &mut [Pair; 1]| {
            starts.push(pair.clone());
            if k + 1 == grids.len() {
                return Ok(());
            }
            let outcome = arrow_hurwicz(grids[k], law.with_load(&solvable[k]), &params, pair);
            match outcome.end.stop {
                Stop::Converged => Ok(()),
                stop => Err(format!("no solution on grid 1/{}: {stop}", grids[k].cells())),
            }
        })?;
        Ok(Self { problem, law, grids, published, solvable, starts })
    }

    /// Makes the runs of a batch. Returns, for each run, its ends on the grids that it visits.
    fn run(&self, plan: &ClaimsPlan, batch: &[ClaimJob]) -> Vec<Vec<(End, f64)>> {
        match batch[0].measure {
            ClaimMeasure::Rule(rule) => self.run_nested(rule, batch),
            ClaimMeasure::Kkt(_) => self.run_on_grid(plan, batch),
        }
    }

    /// Makes runs over all grids, as [`crate::saddle::solve_nested`] does for one r.
    fn run_nested(&self, rule: StopRule, batch: &[ClaimJob]) -> Vec<Vec<(End, f64)>> {
        let loads = &self.published[..];
        let runs: Vec<_> = batch.iter().map(|run| NestedJob { loads, r: run.r, rule }).collect();
        let (limit, prolongation) = (self.problem.max_iterations, self.problem.prolongation);
        let grids = NestedGrids { grids: &self.grids, prolongation };
        let ends = run_all_nested(grids, self.law, &runs, |_, _| limit);
        let mut results = Vec::new();
        for ends in &ends {
            let on_grids = self.grids.iter().zip(loads).zip(ends);
            results.push(on_grids.map(|((g, load), end)| self.measured(*g, load, end)).collect());
        }
        results
    }

    /// Makes runs on one grid towards a KKT residual.
    fn run_on_grid(&self, plan: &ClaimsPlan, batch: &[ClaimJob]) -> Vec<Vec<(End, f64)>> {
        let level = batch[0].level;
        let (grid, load, start) = (self.grids[level], &self.solvable[level], &self.starts[level]);
        let scale = largest(load);
        let mut jobs = Vec::new();
        for run in batch {
            let ClaimMeasure::Kkt(target) = run.measure else {
                unreachable!("the runs of a batch are of one kind")
            };
            let method = match run.variant {
                None => Method::ArrowHurwicz,
                Some(k) => VARIANTS[k].method(plan.weight, 0.1 * target * scale),
            };
            let goal = JobGoal::Kkt(target);
            jobs.push(Job { load, start, method, r: run.r, goal, cap: plan.cap });
        }
        let ends = run(grid, self.law, &jobs);
        ends.iter().map(|end| vec![self.measured(grid, load, end)]).collect()
    }

    /// The end of a run on one grid, with the KKT residual of its last pair.
    fn measured(&self, grid: Grid, load: &[f64], (end, pair): &(End, Pair)) -> (End, f64) {
        (*end, kkt(grid, self.law, &pair.y, load).relative)
    }

    /// Sweeps of the proximal method with loose inner minimisations to a KKT residual on the finest of the grids for
    /// which there is time, one count per weight of the proximal term.
    pub(super) fn weights(&self, plan: &ClaimsPlan) -> WeightRow {
        let KktTarget { kkt: target, cells: finest } = plan.targets[0];
        let fits = |grid: &Grid| grid.cells() <= finest.min(MOST_FOR_WEIGHTS);
        let level = self.grids.iter().rposition(fits).unwrap_or(0);
        let (grid, load, start) = (self.grids[level], &self.solvable[level], &self.starts[level]);
        let inner = 0.1 * target * largest(load);
        let of_weight = |&weight: &f64| Method::Uzawa { weight, inner, loose: true };
        let mut jobs = Vec::new();
        for method in plan.weights.iter().map(of_weight).chain([Method::ArrowHurwicz]) {
            let goal = JobGoal::Kkt(target);
            jobs.push(Job { load, start, method, r: R_OF_WEIGHTS, goal, cap: plan.cap });
        }
        let ends = run(grid, self.law, &jobs);
        let mut counts: Vec<_> = ends.iter().map(|(end, _)| Count::of(end)).collect();
        let arrow_hurwicz = counts.pop().expect("one run more than weights");
        let without = counts.first().map_or(1.0, |count| count.iterations as f64);
        let small = plan.weights.iter().zip(&counts).filter(|(weight, _)| **weight <= 1.0);
        WeightRow {
            name: self.problem.name(),
            cells: grid.cells(),
            change: worst(small.map(|(_, count)| count.iterations as f64 / without - 1.0)),
            ahead: counts.iter().any(|count| count.iterations <= arrow_hurwicz.iterations),
            counts,
            arrow_hurwicz,
        }
    }
}
