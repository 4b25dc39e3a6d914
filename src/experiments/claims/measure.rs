//! The runs behind the claims, spread over threads; every count is the same however they are spread.

use super::{Best, Cell, Count, Line, Measure, Measured, Plan, Row, Table, VARIANTS};
use crate::discrete::grid::Grid;
use crate::discrete::kkt::kkt;
use crate::discrete::load::{LoadRule, load};
use crate::discrete::norms::largest;
use crate::experiments::problems::{Discrete, Problem};
use crate::saddle::batch::{AsDefined, End, Goal, Job, LANES, Nested, run, run_nested};
use crate::saddle::{Method, Pair, Params, StopReason, StopRule, arrow_hurwicz, tolerance};
use rayon::prelude::*;
use std::ops::RangeInclusive;

/// The load towards a KKT residual: under the published one, problem 1 sums to a positive number on
/// fine grids, and has no solution to converge to.
const SOLVABLE: LoadRule = LoadRule::LumpedAverage;
/// Tolerance of the coarser grid's solution, from which runs towards a KKT residual start.
const START: f64 = 1e-12;
/// Stopping rules under which r is swept; the others take the paper's r only.
const SWEPT: [StopRule; 2] = [StopRule::Signed, StopRule::Printed];

/// Runs in a batch: many, so that few lanes are idle when only the longest runs are left.
const RUNS: usize = 12 * LANES;

/// A problem on all its grids.
struct Case<'a> {
    problem: &'a Problem,
    grids: Vec<Grid>,
    /// Load vectors under the published rule, and under [`SOLVABLE`].
    published: Vec<Vec<f64>>,
    solvable: Vec<Vec<f64>>,
    /// The coarser grid's solution under [`SOLVABLE`], prolonged.
    starts: Vec<Pair>,
}

/// What is run in one go: lanes that share problem and grids.
enum Batch {
    /// All grids in turn under a stopping rule.
    Nested { problem: usize, rule: StopRule, r: Vec<f64> },
    /// One grid.
    Direct { problem: usize, level: usize, runs: Vec<Direct> },
}

/// A run on one grid to a KKT residual.
#[derive(Clone, Copy)]
struct Direct {
    target: f64,
    /// `None` for Arrow-Hurwicz, else a place in [`VARIANTS`].
    variant: Option<usize>,
    r: f64,
}

/// What was run, with what came out.
type Results<'a> = [(&'a Batch, Done)];

/// What a batch gives: an entry per run, of as many counts as grids were visited.
type Done = Vec<Vec<Reached>>;

#[derive(Clone, Copy)]
struct Reached {
    count: Count,
    delta_a: f64,
    kkt: f64,
}

pub(super) fn measure(plan: &Plan) -> Result<Vec<Measured>, String> {
    let cases = plan.problems.par_iter().map(Case::new).collect::<Result<Vec<_>, _>>()?;
    let batches = batches(plan, &cases);
    let done: Vec<Done> =
        batches.par_iter().with_max_len(1).map(|batch| batch.run(plan, &cases)).collect();
    let all: Vec<_> = batches.iter().zip(done).collect();
    let measured = |(number, case)| Gathered { number, case, plan, all: &all }.measured();
    Ok(cases.iter().enumerate().map(measured).collect())
}

fn batches(plan: &Plan, cases: &[Case]) -> Vec<Batch> {
    let swept = plan.r();
    let mut batches = Vec::new();
    for (problem, case) in cases.iter().enumerate() {
        // The finest grids first: they take longest.
        for level in (0..case.grids.len()).rev() {
            let mut runs = Vec::new();
            let asked = |(_, finest): &&(f64, usize)| case.grids[level].cells() <= *finest;
            for &(target, _) in plan.targets.iter().filter(asked).rev() {
                runs.extend(swept.iter().map(|&r| Direct { target, variant: None, r }));
                if case.grids[level].cells() >= plan.compared_from {
                    for variant in (0..VARIANTS.len()).map(Some) {
                        let of = |&r: &f64| Direct { target, variant, r };
                        runs.extend(plan.compared_r.iter().map(of));
                    }
                }
            }
            let batch = |runs: &[Direct]| Batch::Direct { problem, level, runs: runs.to_vec() };
            batches.extend(runs.chunks(RUNS).map(batch));
        }
        for rule in StopRule::ALL {
            let mut r = case.problem.r.clone();
            if SWEPT.contains(&rule) {
                r.extend(swept.iter().filter(|r| !case.problem.r.contains(r)));
            }
            r.sort_by(f64::total_cmp);
            let batch = |r: &[f64]| Batch::Nested { problem, rule, r: r.to_vec() };
            batches.extend(r.chunks(RUNS).map(batch));
        }
    }
    batches
}

impl Batch {
    fn run(&self, plan: &Plan, cases: &[Case]) -> Done {
        match self {
            Self::Nested { problem, rule, r } => cases[*problem].nested(*rule, r),
            Self::Direct { problem, level, runs } => cases[*problem].direct(plan, *level, runs),
        }
    }
}

impl<'a> Case<'a> {
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
            let outcome = arrow_hurwicz(grid, &solvable[k], &params, &mut pair, None);
            if outcome.stop != StopReason::Converged {
                return Err(format!("no solution on grid 1/{}: {}", grid.cells(), outcome.stop));
            }
            starts.push(pair.prolonged(grid, problem.prolongation));
        }
        Ok(Self { problem, grids, published, solvable, starts })
    }

    /// As [`crate::saddle::solve_nested`], for several r.
    fn nested(&self, rule: StopRule, r: &[f64]) -> Done {
        let loads = &self.published[..];
        let runs: Vec<_> = r.iter().map(|&r| Nested { loads, r, rule }).collect();
        let cap = |_, _| self.problem.max_iterations;
        let ends = run_nested(&self.grids, &runs, self.problem.prolongation, cap, &mut AsDefined);
        let reached = |(k, end): (usize, &End)| {
            Reached::of(end, kkt(self.grids[k], &end.pair.y, &loads[k]).relative)
        };
        ends.iter().map(|ends| ends.iter().enumerate().map(reached).collect()).collect()
    }

    fn direct(&self, plan: &Plan, level: usize, runs: &[Direct]) -> Done {
        let (grid, load) = (self.grids[level], &self.solvable[level]);
        let scale = largest(load);
        let job = |of: &Direct| Job {
            load,
            start: &self.starts[level],
            method: of.variant.map_or(Method::ArrowHurwicz, |variant| {
                VARIANTS[variant].method(plan.weight, 0.1 * of.target * scale)
            }),
            r: of.r,
            goal: Goal::Kkt(of.target),
            cap: plan.cap,
        };
        let ends = run(grid, &runs.iter().map(job).collect::<Vec<_>>(), &mut AsDefined);
        ends.iter().map(|end| vec![Reached::of(end, f64::NAN)]).collect()
    }
}

/// The counts of a problem, to be gathered from the batches.
struct Gathered<'a> {
    /// Place of the problem in the plan.
    number: usize,
    case: &'a Case<'a>,
    plan: &'a Plan,
    all: &'a Results<'a>,
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

    /// What came out under a stopping rule, grid by grid.
    fn nested(&self, wanted: StopRule, wanted_r: f64) -> &[Reached] {
        let of = self.all.iter().find_map(|(batch, done)| match batch {
            Batch::Nested { problem, rule, r } if *problem == self.number && *rule == wanted => {
                r.iter().position(|r| *r == wanted_r).map(|k| &done[k][..])
            }
            _ => None,
        });
        of.expect("every r was run")
    }

    fn direct(&self, wanted: usize, target: f64, variant: Option<usize>, r: f64) -> Count {
        let wanted_run =
            |run: &Direct| run.target == target && run.variant == variant && run.r == r;
        let of = self.all.iter().find_map(|(batch, done)| match batch {
            Batch::Direct { problem, level, runs }
                if *problem == self.number && *level == wanted =>
            {
                runs.iter().position(wanted_run).map(|k| done[k][0].count)
            }
            _ => None,
        });
        of.expect("every r was run")
    }

    /// The grids with so many cells, each with its place.
    fn grids(&self, cells: RangeInclusive<usize>) -> impl Iterator<Item = (usize, usize)> {
        let all = self.case.grids.iter().map(|grid| grid.cells()).enumerate();
        all.filter(move |(_, n)| cells.contains(n))
    }

    fn rows(&self) -> Vec<Row> {
        let swept = self.plan.r();
        let mut rows = Vec::new();
        for rule in SWEPT {
            for (level, cells) in self.grids(0..=usize::MAX) {
                let counts = swept.iter().map(|&r| self.nested(rule, r)[level].count).collect();
                rows.push(Row::new(Measure::Rule(rule), cells, &swept, counts));
            }
        }
        for &(target, finest) in &self.plan.targets {
            for (level, cells) in self.grids(0..=finest) {
                let counts = swept.iter().map(|&r| self.direct(level, target, None, r)).collect();
                rows.push(Row::new(Measure::Kkt(target), cells, &swept, counts));
            }
        }
        rows
    }

    fn table(&self, rule: StopRule) -> Table {
        let without = match rule {
            StopRule::Signed | StopRule::SignedDual => StopRule::Signed,
            StopRule::Printed | StopRule::PrintedDual => StopRule::Printed,
        };
        let line = |&r: &f64| {
            let reached = self.nested(rule, r);
            let last = reached[reached.len() - 1];
            let fewer = self.nested(without, r)[reached.len() - 1].count.iterations;
            Line {
                r,
                counts: reached.iter().map(|reached| reached.count).collect(),
                factor: last.count.iterations as f64 / fewer as f64,
                delta_a: last.delta_a,
                excess: last.delta_a / tolerance(reached.len()),
                kkt: last.kkt,
            }
        };
        Table { rule, lines: self.case.problem.r.iter().map(line).collect() }
    }

    fn cells(&self) -> Vec<Cell> {
        let mut all = Vec::new();
        for &(target, finest) in &self.plan.targets {
            for (level, cells) in self.grids(self.plan.compared_from..=finest) {
                all.extend(self.plan.compared_r.iter().map(|&r| Cell {
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

impl Reached {
    fn of(end: &End, kkt: f64) -> Self {
        Self { count: Count { iterations: end.sweeps, stop: end.stop }, delta_a: end.delta_a, kkt }
    }
}

impl Row {
    fn new(measure: Measure, cells: usize, r: &[f64], counts: Vec<Count>) -> Self {
        let reached = |k: usize| counts[k].reached();
        let least = (0..r.len()).filter_map(|k| Some((reached(k)?, k))).min();
        let best = least.map(|(iterations, at)| {
            let flat = |k: &usize| reached(*k).is_some_and(|count| 10 * count <= 11 * iterations);
            let from = (0..=at).rev().take_while(flat).last().unwrap_or(at);
            let to = (at..r.len()).take_while(flat).last().unwrap_or(at);
            Best { r: r[at], iterations, flat: (r[from], r[to]) }
        });
        Self { measure, cells, counts, best }
    }
}
