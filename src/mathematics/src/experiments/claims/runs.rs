//! Runs of the experiment on the claims, spread over threads; every count is the same however they are spread.

use super::problem::{ClaimProblem, measured};
use super::{ClaimMeasure, ClaimsPlan, KktTarget, VARIANTS};
use crate::discrete::end::End;
use crate::discrete::norms::largest;
use crate::discrete::stop::Stop;
use crate::machine::threads::map;
use crate::problem::law::Law;
use crate::saddle::batch::LANES;
use crate::saddle::jobs::{Job, NestedJob, run, run_all_nested};
use crate::saddle::{JobGoal, Method, NestedGrids, StopRule};
use serde::Serialize;

/// Stopping rules under which r is swept; the others take the paper's r only.
const SWEPT: [StopRule; 2] = [StopRule::Signed, StopRule::Printed];

/// Least number of runs for a second batch: many, so that few lanes are idle when only the longest runs are left.
const RUNS: usize = 12 * LANES;

/// Name of the paper's method.
pub(super) const ARROW_HURWICZ: &str = "Arrow-Hurwicz";

/// Run on one grid.
#[derive(Clone, Debug, Serialize)]
pub(super) struct ClaimRun {
    /// Number of the problem.
    pub(super) problem: u8,
    /// [`ARROW_HURWICZ`], or the name of a variant of Uzawa's algorithm.
    pub(super) method: &'static str,
    /// End of the run: a stopping rule, on nested grids with the paper's tolerances and load, or a KKT residual,
    /// from the coarser grid's solution with the bilinear load.
    pub(super) end: String,
    /// This KKT residual over the largest component of F; none under a stopping rule.
    pub(super) target: Option<f64>,
    /// Cells per side.
    pub(super) cells: usize,
    /// Duality parameter.
    pub(super) r: f64,
    /// True if the run belongs to the sweep over r.
    pub(super) is_swept: bool,
    /// Sweeps on this grid.
    pub(super) sweeps: usize,
    /// `converged`, or the reason for another end.
    pub(super) stop: Stop,
    /// KKT residual at the end over the largest component of F.
    pub(super) kkt: f64,
    /// Last change of the multiplier.
    pub(super) delta_a: f64,
}

impl ClaimRun {
    /// Sweeps as a number for ratios.
    pub(super) fn count(&self) -> f64 {
        self.sweeps as f64
    }
}

/// A run to be made.
#[derive(Clone, Copy, PartialEq)]
struct ClaimJob {
    /// Index of the problem in the plan.
    problem: usize,
    /// Measure by which it ends: a stopping rule on all grids in turn, or a KKT residual on one of them.
    measure: ClaimMeasure,
    /// Index of this grid; zero under a stopping rule.
    level: usize,
    /// Index in [`VARIANTS`]; `None` stands for Arrow-Hurwicz.
    variant: Option<usize>,
    r: f64,
}

/// Makes all runs, in parallel. Returns them on each grid that they visit: by problem, end, method and grid, each in
/// the order of r.
pub(super) fn run_all(plan: &ClaimsPlan, problems: &[ClaimProblem]) -> Vec<ClaimRun> {
    let batches = batches(plan, problems);
    let done = map(&batches, 1, |batch| match batch[0].measure {
        ClaimMeasure::Rule(_) => run_nested(problems, batch),
        ClaimMeasure::Kkt(_) => run_on_grid(plan, problems, batch),
    });
    let (swept, mut runs) = (plan.r(), Vec::new());
    for (job, ends) in batches.concat().iter().zip(done.iter().flatten()) {
        runs.extend(job.on_grids(problems, &swept, ends).map(|run| (*job, run)));
    }
    runs.sort_by(|(one, on_one), (two, on_two)| {
        let by_problem = one.problem.cmp(&two.problem);
        let by_end = two.target().total_cmp(&one.target()).then(one.rule().cmp(&two.rule()));
        let by_grid = one.variant.cmp(&two.variant).then(on_one.cells.cmp(&on_two.cells));
        by_problem.then(by_end).then(by_grid).then(one.r.total_cmp(&two.r))
    });
    runs.into_iter().map(|(_, run)| run).collect()
}

/// All runs; those of a batch share the grids, in turn under a stopping rule, or one grid.
fn batches(plan: &ClaimsPlan, problems: &[ClaimProblem]) -> Vec<Vec<ClaimJob>> {
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
fn all_jobs(plan: &ClaimsPlan, problems: &[ClaimProblem]) -> Vec<ClaimJob> {
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
    on_grids.sort_by(|one, two| {
        let [own, other] = [one, two].map(|job| problems[job.problem].grids[job.level].cells());
        let by_grid = other.cmp(&own).then(one.target().total_cmp(&two.target()));
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
    fn shares_grids(&self, other: &Self, problems: &[ClaimProblem]) -> bool {
        let [one, two] = [self, other].map(|job| &problems[job.problem]);
        match (self.measure, other.measure) {
            (ClaimMeasure::Rule(_), ClaimMeasure::Rule(_)) => {
                one.grids == two.grids && one.prolongation() == two.prolongation()
            }
            (ClaimMeasure::Kkt(_), ClaimMeasure::Kkt(_)) => {
                one.grids[self.level] == two.grids[other.level]
            }
            _ => false,
        }
    }

    /// The run on each grid that it visits, with these ends and KKT residuals.
    fn on_grids<'a>(
        &'a self,
        problems: &'a [ClaimProblem],
        swept: &'a [f64],
        ends: &'a [(End, f64)],
    ) -> impl Iterator<Item = ClaimRun> + 'a {
        let ClaimProblem { problem, grids, .. } = &problems[self.problem];
        let (end, target, is_swept) = match self.measure {
            ClaimMeasure::Rule(rule) => (rule.to_string(), None, SWEPT.contains(&rule)),
            ClaimMeasure::Kkt(target) => {
                (format!("{target:e}"), Some(target), self.variant.is_none())
            }
        };
        grids[self.level..].iter().zip(ends).map(move |(grid, (ended, kkt))| ClaimRun {
            problem: problem.number,
            method: self.variant.map_or(ARROW_HURWICZ, |k| VARIANTS[k].name),
            end: end.clone(),
            target,
            cells: grid.cells(),
            r: self.r,
            is_swept: is_swept && swept.contains(&self.r),
            sweeps: ended.sweeps(),
            stop: ended.stop,
            kkt: *kkt,
            delta_a: ended.change(),
        })
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

/// Makes runs over all grids, as [`crate::saddle::solve_nested`] does for one r. Returns, for each run, its ends on the
/// grids.
fn run_nested(problems: &[ClaimProblem], batch: &[ClaimJob]) -> Vec<Vec<(End, f64)>> {
    let first = &problems[batch[0].problem];
    let levels = NestedGrids { grids: &first.grids, prolongation: first.prolongation() };
    let mut runs = Vec::new();
    for job in batch {
        let loads = &problems[job.problem].published;
        let rule = job.rule().expect("the runs of a batch are of one kind");
        runs.push(NestedJob { law: Law::SIGNORINI, loads, r: job.r, rule });
    }
    let all_ends = run_all_nested(&levels, &runs, |run, _| {
        problems[batch[run].problem].problem.saddle().max_iterations
    });
    let mut results = Vec::new();
    for (job, ends) in batch.iter().zip(all_ends) {
        let case = &problems[job.problem];
        let on_grids = case.grids.iter().zip(&case.published).zip(&ends);
        results.push(on_grids.map(|((g, load), end)| measured(*g, load, end)).collect());
    }
    results
}

/// Makes runs on one grid towards a KKT residual. Returns the end of each.
fn run_on_grid(
    plan: &ClaimsPlan,
    problems: &[ClaimProblem],
    batch: &[ClaimJob],
) -> Vec<Vec<(End, f64)>> {
    let mut jobs = Vec::new();
    for run in batch {
        let ClaimProblem { solvable, starts, .. } = &problems[run.problem];
        let (load, start) = (&solvable[run.level], &starts[run.level]);
        let method = match run.variant {
            None => Method::ArrowHurwicz,
            Some(k) => VARIANTS[k].method(plan.weight, 0.1 * run.target() * largest(load)),
        };
        let goal = JobGoal::Kkt(run.target());
        jobs.push(Job { law: Law::SIGNORINI, load, start, method, r: run.r, goal, cap: plan.cap });
    }
    let grid = problems[batch[0].problem].grids[batch[0].level];
    let mut results = Vec::new();
    for (job, end) in jobs.iter().zip(run(grid, &jobs)) {
        results.push(vec![measured(grid, job.load, &end)]);
    }
    results
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiments::problems::TableProblem;
    use crate::statement::{Domain, Fineness, Statement};

    #[test]
    fn every_run_is_in_one_batch_and_no_batch_leaves_lanes_idle_from_the_start() {
        let mut papers = Vec::new();
        for (number, f) in [(1, "quadrant(ll)=3; else=-1.002"), (2, "quadrant(ll)=-6; else=1.998")]
        {
            // The batches are the same without the finest grids.
            let fineness = Fineness::Grids(vec![4, 8, 16]);
            let statement = Statement { fineness, ..Statement::usual(Domain::square(), f) };
            let r = vec![1e6, 10.0, 5.0, 1.0, 0.5];
            papers.push(TableProblem { number, r, statement });
        }
        let plan = ClaimsPlan::new(papers);
        let problems: Vec<_> =
            plan.problems.iter().map(|problem| ClaimProblem::new(problem).unwrap()).collect();
        let (all, batches) = (all_jobs(&plan, &problems), batches(&plan, &problems));
        assert!(batches.iter().all(|batch| batch.len() >= 4 * LANES && batch.len() < 2 * RUNS));
        let batched = batches.concat();
        assert_eq!(batched.len(), all.len());
        assert!(all.iter().all(|job| batched.contains(job)));
    }
}
