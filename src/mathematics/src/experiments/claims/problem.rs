//! A problem of the claims on its grids, and the weights of the proximal term on one of them.

use super::{ClaimsPlan, KktTarget};
use crate::discrete::end::End;
use crate::discrete::grid::Grid;
use crate::discrete::kkt::kkt;
use crate::discrete::load::{LoadRule, load};
use crate::discrete::norms::{largest, worst};
use crate::discrete::stop::Stop;
use crate::discrete::transfer::Prolongation;
use crate::experiments::problems::TableProblem;
use crate::problem::law::Law;
use crate::saddle::jobs::{Job, run};
use crate::saddle::{self, JobGoal, Method, NestedGrids, Pair, Params, StopRule, arrow_hurwicz};
use serde::Serialize;

/// Rule of the load towards a KKT residual: under the published one, problem 1 sums to a positive number on
/// fine grids, and has no solution to converge to.
const SOLVABLE: LoadRule = LoadRule::Bilinear {};
/// Tolerance of the coarser grid's solution, from which runs towards a KKT residual start.
const START: f64 = 1e-12;
/// Cells per side of the finest grid on which weights of the proximal term are compared.
const MOST_FOR_WEIGHTS: usize = 32;
/// Duality parameter with which they are compared.
const R_OF_WEIGHTS: f64 = 100.0;

/// A problem on all its grids.
pub(super) struct ClaimProblem<'a> {
    pub(super) problem: &'a TableProblem,
    pub(super) grids: Vec<Grid>,
    /// Load vectors under the published rule.
    pub(super) published: Vec<Vec<f64>>,
    /// Load vectors under [`SOLVABLE`].
    pub(super) solvable: Vec<Vec<f64>>,
    /// Solution on the coarser grid under [`SOLVABLE`], prolonged to each grid; zero on the coarsest grid.
    pub(super) starts: Vec<Pair>,
}

/// Sweeps of the proximal method to a KKT residual on one grid.
#[derive(Serialize)]
pub(super) struct WeightRow {
    /// Name of the problem.
    name: String,
    /// Cells per side.
    cells: usize,
    /// Sweeps for each weight of the plan.
    sweeps: Vec<usize>,
    /// Sweeps of Arrow-Hurwicz.
    arrow_hurwicz: usize,
    /// Largest relative change of the sweeps by a weight of at most 1, against the weight 0.
    change: f64,
    /// True if the method takes no more sweeps than Arrow-Hurwicz with some weight.
    ahead: bool,
}

/// The end of a run on one grid, with the KKT residual of its last pair.
pub(super) fn measured(grid: Grid, load: &[f64], (end, pair): &(End, Pair)) -> (End, f64) {
    (*end, kkt(grid, Law::SIGNORINI, &pair.y, load).relative)
}

impl<'a> ClaimProblem<'a> {
    pub(super) fn new(problem: &'a TableProblem) -> Result<Self, String> {
        let (f, grids) = problem.on_grids()?;
        let published = problem.loads(&f, &grids);
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
            let outcome =
                arrow_hurwicz(grids[k], Law::SIGNORINI.with_load(&solvable[k]), &params, pair);
            match outcome.end.stop {
                Stop::Converged => Ok(()),
                stop => Err(format!("no solution on grid 1/{}: {stop}", grids[k].cells())),
            }
        })?;
        Ok(Self { problem, grids, published, solvable, starts })
    }

    /// Interpolation to the next grid.
    pub(super) fn prolongation(&self) -> Prolongation {
        self.problem.saddle().prolongation
    }

    /// Sweeps of the proximal method with loose inner minimisations to a KKT residual on the finest of the grids for
    /// which there is time, one count per weight of the proximal term.
    pub(super) fn weights(&self, plan: &ClaimsPlan) -> WeightRow {
        let KktTarget { kkt: target, cells: finest } = plan.targets[0];
        let finest = finest.min(MOST_FOR_WEIGHTS);
        let level = self.grids.iter().rposition(|grid| grid.cells() <= finest).unwrap_or(0);
        let (grid, load, start) = (self.grids[level], &self.solvable[level], &self.starts[level]);
        let inner = 0.1 * target * largest(load);
        let weights = plan.weights.iter();
        let methods = weights.map(|&weight| Method::Uzawa { weight, inner, loose: true });
        let mut jobs = Vec::new();
        for method in methods.chain([Method::ArrowHurwicz]) {
            let goal = JobGoal::Kkt(target);
            let (law, r) = (Law::SIGNORINI, R_OF_WEIGHTS);
            jobs.push(Job { law, load, start, method, r, goal, cap: plan.cap });
        }
        let mut sweeps: Vec<_> = run(grid, &jobs).iter().map(|(end, _)| end.sweeps()).collect();
        let arrow_hurwicz = sweeps.pop().expect("one run more than weights");
        let without = sweeps.first().map_or(1.0, |&sweeps| sweeps as f64);
        let small = plan.weights.iter().zip(&sweeps).filter(|(weight, _)| **weight <= 1.0);
        WeightRow {
            name: self.problem.name(),
            cells: grid.cells(),
            change: worst(small.map(|(_, &sweeps)| sweeps as f64 / without - 1.0)),
            ahead: sweeps.iter().any(|&sweeps| sweeps <= arrow_hurwicz),
            sweeps,
            arrow_hurwicz,
        }
    }
}
