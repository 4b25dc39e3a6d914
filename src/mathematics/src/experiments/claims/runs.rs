//! Runs of the experiment on the claims, spread over threads; every count is the same however they are spread.

use super::{ClaimMeasure, ClaimsPlan, Count, KktTarget, VARIANTS, WeightRow};
use crate::discrete::end::End;
use crate::discrete::grid::Grid;
use crate::discrete::kkt::kkt;
use crate::discrete::load::{LoadRule, load};
use crate::discrete::norms::{largest, worst};
use crate::discrete::stop::Stop;
use crate::experiments::problems::TableProblem;
use crate::machine::threads::map;
use crate::problem::law::Law;
use crate::saddle::batch::LANES;
use crate::saddle::jobs::{Job, NestedJob, run, run_all_nested};
use crate::saddle::{self, JobGoal, Method, NestedGrids, Pair, Params, StopRule, arrow_hurwicz};

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

/// Least number of runs for a second batch: many, so that few lanes are idle when only the longest runs are left.
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
    let done = map(&batches, 1, |batch| match batch[0].measure {
        ClaimMeasure::Rule(_) => run_nested(problems, batch),
        ClaimMeasure::Kkt(_) => run_on_grid(plan, problems, batch),
    });
    batches.concat().into_iter().zip(done.into_iter().flatten()).collect()
}

/// All runs; those of a batch share the grids, in turn under a stopping rule, or one grid.
fn batches(plan: &ClaimsPlan, problems: &[ClaimCase]) -> Vec<Vec<ClaimJob>> {
    let mut groups: Vec<Vec<ClaimJob>> = Vec::new();
    for job in all_jobs(plan, problems) {
        match groups.iter_mut().find(|group| job.shares_grids(&group[0], problems)) {
            Some(group) => group.push(job),
            None => groups.push(vec![job]),
        }
    }
    let mut batches = Vec::new();
    for group in groups {
        // Dealt out like cards: each batch begins with long runs and ends with short ones.
        let count = (group.len() / RUNS).max(1);
        batches.extend((0..count).map(|k| group[k..].iter().step_by(count).copied().collect()));
    }
    batches
}

/// All runs, those first that are expected to take longest: over all grids, then on each grid from the finest on.
fn all_jobs(plan: &ClaimsPlan, problems: &[ClaimCase]) -> Vec<ClaimJob> {
    let swept = plan.r();
    let (mut nested, mut on_grids) = (Vec::new(), Vec::new());
    for (index, problem) in problems.iter().enumerate() {
        for rule in StopRule::ALL {
            let mut r = problem.problem.r.clone();
            if SWEPT.contains(&rule) {
                r.extend(swept.iter().filter(|r| !problem.problem.r.contains(r)));
            }
            let measure = ClaimMeasure::Rule(rule);
            let job = ClaimJob { problem: index, measure, level: 0, variant: None, r: 0.0 };
            nested.extend(job.for_each(&r));
        }
        for (level, grid) in problem.grids.iter().enumerate() {
            for &KktTarget { kkt: target, cells: finest } in &plan.targets {
                if grid.cells() > finest {
                    continue;
                }
                let measure = ClaimMeasure::Kkt(target);
                let job = ClaimJob { problem: index, measure, level, variant: None, r: 0.0 };
                on_grids.extend(job.for_each(&swept));
                if grid.cells() >= plan.compared_from {
                    for variant in (0..VARIANTS.len()).map(Some) {
                        on_grids.extend(ClaimJob { variant, ..job }.for_each(&plan.compared_r));
                    }
                }
            }
        }
    }
    // The last rules take longest.
    nested.sort_by(|one, two| two.rule().cmp(&one.rule()).then(one.r.total_cmp(&two.r)));
    let cells = |job: &ClaimJob| problems[job.problem].grids[job.level].cells();
    on_grids.sort_by(|one, two| {
        let by_grid = cells(two).cmp(&cells(one)).then(one.target().total_cmp(&two.target()));
        by_grid.then(one.rank().cmp(&two.rank())).then(one.r.total_cmp(&two.r))
    });
    nested.extend(on_grids);
    nested
}

impl ClaimJob {
    /// This run for each r instead of its own.
    fn for_each(self, r: &[f64]) -> impl Iterator<Item = Self> {
        r.iter().map(move |&r| Self { r, ..self })
    }

    /// True if this run and another may be in one batch.
    fn shares_grids(&self, other: &Self, problems: &[ClaimCase]) -> bool {
        let [one, two] = [self, other].map(|job| &problems[job.problem]);
        let prolongation = |case: &ClaimCase| case.problem.saddle().prolongation;
        match (self.measure, other.measure) {
            (ClaimMeasure::Rule(_), ClaimMeasure::Rule(_)) => {
                one.grids == two.grids && prolongation(one) == prolongation(two)
            }
            (ClaimMeasure::Kkt(_), ClaimMeasure::Kkt(_)) => {
                one.grids[self.level] == two.grids[other.level]
            }
            _ => false,
        }
    }

    /// Stopping rule, if it is one that ends the run.
    fn rule(&self) -> Option<StopRule> {
        match self.measure {
            ClaimMeasure::Rule(rule) => Some(rule),
            ClaimMeasure::Kkt(_) => None,
        }
    }

    /// KKT residual at which the run ends; infinite under a rule.
    fn target(&self) -> f64 {
        match self.measure {
            ClaimMeasure::Rule(_) => f64::INFINITY,
            ClaimMeasure::Kkt(target) => target,
        }
    }

    /// Place among the methods by the length of their runs: exact inner minimisations take longest.
    fn rank(&self) -> u8 {
        match self.variant.map(|k| VARIANTS[k].loose) {
            Some(false) => 0,
            Some(true) => 1,
            None => 2,
        }
    }
}

impl<'a> ClaimCase<'a> {
    pub(super) fn new(problem: &'a TableProblem) -> Result<Self, String> {
        let (f, grids) = problem.on_grids()?;
        let published = problem.loads(&f, &grids);
        let law = problem.statement.law().map_err(|e| e.to_string())?;
        let solvable: Vec<_> = grids.iter().map(|&grid| load(grid, &f, SOLVABLE)).collect();
        let params =
            Params { r: 100.0, tolerance: START, rule: StopRule::PrintedDual, ..Params::default() };
        let levels = NestedGrids { grids: &grids, prolongation: problem.saddle().prolongation };
        let mut starts = Vec::new();
        saddle::run_nested(&levels, &mut [Pair::zero(grids[0])], |k, [pair]: &mut [Pair; 1]| {
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
            let (law, r) = (self.law, R_OF_WEIGHTS);
            jobs.push(Job { law, load, start, method, r, goal, cap: plan.cap });
        }
        let ends = run(grid, &jobs);
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

/// Makes runs over all grids, as [`crate::saddle::solve_nested`] does for one r. Returns, for each run, its ends on the
/// grids.
fn run_nested(problems: &[ClaimCase], batch: &[ClaimJob]) -> Vec<Vec<(End, f64)>> {
    let first = &problems[batch[0].problem];
    let levels =
        NestedGrids { grids: &first.grids, prolongation: first.problem.saddle().prolongation };
    let mut runs = Vec::new();
    for job in batch {
        let ClaimCase { law, published: loads, .. } = &problems[job.problem];
        let rule = job.rule().expect("the runs of a batch are of one kind");
        runs.push(NestedJob { law: *law, loads, r: job.r, rule });
    }
    let limit = |run: usize, _| problems[batch[run].problem].problem.saddle().max_iterations;
    let mut results = Vec::new();
    for (job, ends) in batch.iter().zip(run_all_nested(&levels, &runs, limit)) {
        let case = &problems[job.problem];
        let on_grids = case.grids.iter().zip(&case.published).zip(&ends);
        results.push(on_grids.map(|((g, load), end)| case.measured(*g, load, end)).collect());
    }
    results
}

/// Makes runs on one grid towards a KKT residual. Returns the end of each.
fn run_on_grid(
    plan: &ClaimsPlan,
    problems: &[ClaimCase],
    batch: &[ClaimJob],
) -> Vec<Vec<(End, f64)>> {
    let mut jobs = Vec::new();
    for run in batch {
        let ClaimCase { law, solvable, starts, .. } = &problems[run.problem];
        let (law, load, start) = (*law, &solvable[run.level], &starts[run.level]);
        let method = match run.variant {
            None => Method::ArrowHurwicz,
            Some(k) => VARIANTS[k].method(plan.weight, 0.1 * run.target() * largest(load)),
        };
        let goal = JobGoal::Kkt(run.target());
        jobs.push(Job { law, load, start, method, r: run.r, goal, cap: plan.cap });
    }
    let grid = problems[batch[0].problem].grids[batch[0].level];
    let mut results = Vec::new();
    for ((job, run), end) in jobs.iter().zip(batch).zip(run(grid, &jobs)) {
        results.push(vec![problems[run.problem].measured(grid, job.load, &end)]);
    }
    results
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statement::Fineness;

    #[test]
    fn every_run_is_in_one_batch_and_no_batch_leaves_lanes_idle_from_the_start() {
        let plan = ClaimsPlan::friction();
        // The first two have the paper's f.
        let papers = plan.problems[..2].iter().cloned();
        let mut papers = ClaimsPlan::new(papers.collect());
        papers.problems.iter_mut().for_each(|problem| problem.statement.law = None);
        for mut plan in [plan, papers] {
            // The batches are the same without the finest grids.
            plan.problems.iter_mut().for_each(|problem| {
                problem.statement.fineness = Fineness::Grids(vec![4, 8, 16]);
            });
            let problems: Vec<_> =
                plan.problems.iter().map(|problem| ClaimCase::new(problem).unwrap()).collect();
            let (all, batches) = (all_jobs(&plan, &problems), batches(&plan, &problems));
            assert!(batches.iter().all(|batch| batch.len() >= 4 * LANES && batch.len() < 2 * RUNS));
            let batched = batches.concat();
            assert_eq!(batched.len(), all.len());
            assert!(all.iter().all(|job| batched.contains(job)));
        }
    }
}
