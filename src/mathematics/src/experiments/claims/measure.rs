//! The runs behind the claims, spread over threads; every count is the same however they are spread.

use super::{
    BestParameter, ClaimLine, ClaimMeasure, ClaimTable, ClaimsPlan, Count, CountRow, Measured,
    UzawaCell, VARIANTS,
};
use crate::discrete::grid::Grid;
use crate::discrete::kkt::kkt;
use crate::discrete::load::{LoadRule, load};
use crate::discrete::norms::largest;
use crate::experiments::problems::{Discrete, Problem};
use crate::saddle::batch::{AsDefined, End, Job, JobGoal, LANES, Nested, run, run_nested};
use crate::saddle::{Method, Pair, Params, StopReason, StopRule, arrow_hurwicz, tolerance};
use rayon::prelude::*;
use std::ops::RangeInclusive;

/// The load towards a KKT residual: under the published one, problem 1 sums to a positive number on
/// fine grids, and has no solution to converge to.
const SOLVABLE: LoadRule = LoadRule::LumpedAverage {};
/// Tolerance of the coarser grid's solution, from which runs towards a KKT residual start.
const START: f64 = 1e-12;
/// Stopping rules under which r is swept; the others take the paper's r only.
const SWEPT: [StopRule; 2] = [StopRule::Signed, StopRule::Printed];

/// Runs in a batch: many, so that few lanes are idle when only the longest runs are left.
const RUNS: usize = 12 * LANES;

/// A problem on all its grids.
struct ClaimCase<'a> {
    problem: &'a Problem,
    grids: Vec<Grid>,
    /// Load vectors under the published rule, and under [`SOLVABLE`].
    published: Vec<Vec<f64>>,
    solvable: Vec<Vec<f64>>,
    /// The coarser grid's solution under [`SOLVABLE`], prolonged.
    starts: Vec<Pair>,
}

/// A run for one r.
#[derive(Clone, Copy, PartialEq)]
struct ClaimRun {
    /// Place of the problem in the plan.
    problem: usize,
    end: Until,
    r: f64,
}

/// Grids of a run, and its goal.
#[derive(Clone, Copy, PartialEq)]
enum Until {
    /// All grids in turn, under a stopping rule.
    Rule(StopRule),
    /// One grid, to a KKT residual; a `variant` is a place in [`VARIANTS`], `None` stands for Arrow-Hurwicz.
    Kkt { level: usize, target: f64, variant: Option<usize> },
}

/// Result of a run on a grid.
#[derive(Clone, Copy)]
struct RunResult {
    count: Count,
    delta_a: f64,
    kkt: f64,
}

pub(super) fn measure(plan: &ClaimsPlan) -> Result<Vec<Measured>, String> {
    let cases = plan.problems.par_iter().map(ClaimCase::new).collect::<Result<Vec<_>, _>>()?;
    let batches = batches(plan, &cases);
    let done = batches.par_iter().with_max_len(1);
    let done: Vec<_> = done.map(|batch| cases[batch[0].problem].run(plan, batch)).collect();
    let found: Vec<_> = batches.concat().into_iter().zip(done.into_iter().flatten()).collect();
    let measured = |(place, case)| Gathered { place, case, plan, found: &found }.measured();
    Ok(cases.iter().enumerate().map(measured).collect())
}

/// All runs; those of a batch share the problem, and the stopping rule or the grid.
fn batches(plan: &ClaimsPlan, cases: &[ClaimCase]) -> Vec<Vec<ClaimRun>> {
    let swept = plan.r();
    let mut batches = Vec::new();
    for (problem, case) in cases.iter().enumerate() {
        let with = |end, r: &[f64]| {
            r.iter().map(move |&r| ClaimRun { problem, end, r }).collect::<Vec<_>>()
        };
        // The finest grids first: they take longest.
        for (level, grid) in case.grids.iter().enumerate().rev() {
            let mut runs = Vec::new();
            let asked = |(_, finest): &&(f64, usize)| grid.cells() <= *finest;
            for &(target, _) in plan.targets.iter().filter(asked).rev() {
                let of = |variant| Until::Kkt { level, target, variant };
                runs.extend(with(of(None), &swept));
                if grid.cells() >= plan.compared_from {
                    let variants = (0..VARIANTS.len()).map(Some);
                    runs.extend(variants.flat_map(|variant| with(of(variant), &plan.compared_r)));
                }
            }
            batches.extend(runs.chunks(RUNS).map(<[ClaimRun]>::to_vec));
        }
        for rule in StopRule::ALL {
            let mut r = case.problem.r.clone();
            if SWEPT.contains(&rule) {
                r.extend(swept.iter().filter(|r| !case.problem.r.contains(r)));
            }
            r.sort_by(f64::total_cmp);
            batches.extend(with(Until::Rule(rule), &r).chunks(RUNS).map(<[ClaimRun]>::to_vec));
        }
    }
    batches
}

impl<'a> ClaimCase<'a> {
    fn new(problem: &'a Problem) -> Result<Self, String> {
        let Discrete { f, grids, loads: published } = problem.discrete()?;
        let solvable: Vec<_> = grids.iter().map(|&grid| load(grid, &f, SOLVABLE)).collect();
        let mut starts = vec![Pair::zero(grids[0])];
        for (k, &grid) in grids[..grids.len() - 1].iter().enumerate() {
            let params = Params {
                r: 100.0,
                tolerance: START,
                rule: StopRule::PrintedDual,
                ..Params::default()
            };
            let mut pair = starts[k].clone();
            let outcome = arrow_hurwicz(grid, &solvable[k], &params, &mut pair);
            if outcome.stop != StopReason::Converged {
                return Err(format!("no solution on grid 1/{}: {}", grid.cells(), outcome.stop));
            }
            starts.push(pair.prolonged(grid, problem.prolongation));
        }
        Ok(Self { problem, grids, published, solvable, starts })
    }

    /// Results of the runs of a batch, on the grids that it visits.
    fn run(&self, plan: &ClaimsPlan, batch: &[ClaimRun]) -> Vec<Vec<RunResult>> {
        match batch[0].end {
            Until::Rule(rule) => self.nested(rule, batch),
            Until::Kkt { level, .. } => self.direct(plan, level, batch),
        }
    }

    /// As [`crate::saddle::solve_nested`], for several r.
    fn nested(&self, rule: StopRule, batch: &[ClaimRun]) -> Vec<Vec<RunResult>> {
        let loads = &self.published[..];
        let runs: Vec<_> = batch.iter().map(|of| Nested { loads, r: of.r, rule }).collect();
        let cap = |_, _| self.problem.max_iterations;
        let ends = run_nested(&self.grids, &runs, self.problem.prolongation, cap, &mut AsDefined);
        let reached = |(k, end): (usize, &End)| {
            RunResult::of(end, kkt(self.grids[k], &end.pair.y, &loads[k]).relative)
        };
        ends.iter().map(|ends| ends.iter().enumerate().map(reached).collect()).collect()
    }

    fn direct(&self, plan: &ClaimsPlan, level: usize, batch: &[ClaimRun]) -> Vec<Vec<RunResult>> {
        let (grid, load) = (self.grids[level], &self.solvable[level]);
        let scale = largest(load);
        let job = |of: &ClaimRun| {
            let Until::Kkt { target, variant, .. } = of.end else {
                unreachable!("the runs of a batch are of one kind")
            };
            let method = variant.map_or(Method::ArrowHurwicz, |variant| {
                VARIANTS[variant].method(plan.weight, 0.1 * target * scale)
            });
            let (start, goal) = (&self.starts[level], JobGoal::Kkt(target));
            Job { load, start, method, r: of.r, goal, cap: plan.cap }
        };
        let jobs: Vec<_> = batch.iter().map(job).collect();
        let ends = run(grid, &jobs, &mut AsDefined);
        ends.iter().map(|end| vec![RunResult::of(end, f64::NAN)]).collect()
    }
}

/// The counts of a problem, to be gathered from all runs.
struct Gathered<'a> {
    /// Place of the problem in the plan.
    place: usize,
    case: &'a ClaimCase<'a>,
    plan: &'a ClaimsPlan,
    /// Results of the runs, on the grids that it visited.
    found: &'a [(ClaimRun, Vec<RunResult>)],
}

impl Gathered<'_> {
    fn measured(&self) -> Measured {
        let sum = |loads: &[Vec<f64>]| loads.last().map_or(0.0, |load| load.iter().sum());
        Measured {
            number: self.case.problem.number,
            sums: [sum(&self.case.published), sum(&self.case.solvable)],
            rows: self.rows(),
            tables: StopRule::ALL.map(|rule| self.table(rule)).into(),
            cells: self.cells(),
        }
    }

    /// Results on each grid visited.
    fn found(&self, end: Until, r: f64) -> &[RunResult] {
        let wanted = ClaimRun { problem: self.place, end, r };
        let found = self.found.iter().find(|(run, _)| *run == wanted);
        &found.expect("every r was run").1
    }

    /// Results under a stopping rule, grid by grid.
    fn nested(&self, rule: StopRule, r: f64) -> &[RunResult] {
        self.found(Until::Rule(rule), r)
    }

    fn direct(&self, level: usize, target: f64, variant: Option<usize>, r: f64) -> Count {
        self.found(Until::Kkt { level, target, variant }, r)[0].count
    }

    /// The grids with so many cells, each with its place.
    fn grids(&self, cells: RangeInclusive<usize>) -> impl Iterator<Item = (usize, usize)> {
        let all = self.case.grids.iter().map(|grid| grid.cells()).enumerate();
        all.filter(move |(_, n)| cells.contains(n))
    }

    fn rows(&self) -> Vec<CountRow> {
        let swept = self.plan.r();
        let mut rows = Vec::new();
        for rule in SWEPT {
            for (level, cells) in self.grids(0..=usize::MAX) {
                let counts = swept.iter().map(|&r| self.nested(rule, r)[level].count).collect();
                rows.push(CountRow::new(ClaimMeasure::Rule(rule), cells, &swept, counts));
            }
        }
        for &(target, finest) in &self.plan.targets {
            for (level, cells) in self.grids(0..=finest) {
                let counts = swept.iter().map(|&r| self.direct(level, target, None, r)).collect();
                rows.push(CountRow::new(ClaimMeasure::Kkt(target), cells, &swept, counts));
            }
        }
        rows
    }

    fn table(&self, rule: StopRule) -> ClaimTable {
        let without = match rule {
            StopRule::Signed | StopRule::SignedDual => StopRule::Signed,
            StopRule::Printed | StopRule::PrintedDual => StopRule::Printed,
        };
        let line = |&r: &f64| {
            let reached = self.nested(rule, r);
            let last = reached[reached.len() - 1];
            let fewer = self.nested(without, r)[reached.len() - 1].count.iterations;
            ClaimLine {
                r,
                counts: reached.iter().map(|reached| reached.count).collect(),
                factor: last.count.iterations as f64 / fewer as f64,
                delta_a: last.delta_a,
                excess: last.delta_a / tolerance(reached.len()),
                kkt: last.kkt,
            }
        };
        ClaimTable { rule, lines: self.case.problem.r.iter().map(line).collect() }
    }

    fn cells(&self) -> Vec<UzawaCell> {
        let mut all = Vec::new();
        for &(target, finest) in &self.plan.targets {
            for (level, cells) in self.grids(self.plan.compared_from..=finest) {
                all.extend(self.plan.compared_r.iter().map(|&r| UzawaCell {
                    cells,
                    target,
                    r,
                    arrow_hurwicz: self.direct(level, target, None, r),
                    uzawa: [0, 1, 2, 3].map(|variant| self.direct(level, target, Some(variant), r)),
                }));
            }
        }
        all
    }
}

impl RunResult {
    fn of(end: &End, kkt: f64) -> Self {
        Self { count: Count { iterations: end.sweeps, stop: end.stop }, delta_a: end.delta_a, kkt }
    }
}

impl CountRow {
    fn new(measure: ClaimMeasure, cells: usize, r: &[f64], counts: Vec<Count>) -> Self {
        let reached = |k: usize| counts[k].reached();
        let least = (0..r.len()).filter_map(|k| Some((reached(k)?, k))).min();
        let best = least.map(|(iterations, at)| {
            let flat = |k: &usize| reached(*k).is_some_and(|count| 10 * count <= 11 * iterations);
            let from = (0..=at).rev().take_while(flat).last().unwrap_or(at);
            let to = (at..r.len()).take_while(flat).last().unwrap_or(at);
            BestParameter { r: r[at], iterations, flat: (r[from], r[to]) }
        });
        Self { measure, cells, counts, best }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The best of some counts for r = 1, 10, 100, ..; those that are none hit a cap of 10.
    fn best<const N: usize>(counts: [Option<usize>; N]) -> Option<(f64, usize, (f64, f64))> {
        let r: Vec<f64> = (0..N).map(|k| 10f64.powi(k as i32)).collect();
        let count = |count: Option<usize>| match count {
            Some(iterations) => Count { iterations, stop: StopReason::Converged },
            None => Count { iterations: 10, stop: StopReason::IterationLimit },
        };
        let row = CountRow::new(ClaimMeasure::Kkt(1e-3), 16, &r, counts.map(count).into());
        row.best.map(|BestParameter { r, iterations, flat }| (r, iterations, flat))
    }

    #[test]
    fn the_best_r_is_the_least_with_the_fewest_iterations_and_its_interval_has_no_gap() {
        let counts = [None, Some(11), Some(10), Some(10), Some(12), Some(10)];
        assert_eq!(best(counts), Some((100.0, 10, (10.0, 1000.0))));
        assert_eq!(best([Some(10), None, Some(10)]), Some((1.0, 10, (1.0, 1.0))));
        assert_eq!(best([None, Some(20)]), Some((10.0, 20, (10.0, 10.0))));
        assert_eq!(best([None, None]), None);
    }
}
