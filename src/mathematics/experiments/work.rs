//! The work of the paper's method: its sweeps against the width of the grid, and its work beside multigrid's.

use super::exponent;
use super::known::KnownSolution;
use super::saddle::{Checks, loose_uzawa, sweeps_until};
use crate::discrete::grid::{self, Grid};
use crate::discrete::kkt::kkt;
use crate::discrete::load::{LoadRule, load};
use crate::discrete::norms::lumped;
use crate::discrete::stiffness::energy;
use crate::discrete::transfer::Prolongation;
use crate::multigrid::{self, Goal, MultigridParams};
use crate::problem::exact::Exact;
use crate::problem::source::Source;
use crate::saddle::{Method, Pair};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// How many sweeps Arrow-Hurwicz takes to a residual, from grid to grid.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct CostLaw {
    /// f in the notation of scenes.
    pub f: String,
    /// Whether each grid starts from the solution on the grid before, or from zero.
    pub nested: bool,
    /// Natural residual over the largest component of the load.
    pub target: f64,
    /// Cells per side, and sweeps on that grid.
    pub sweeps: Vec<(usize, usize)>,
    /// Exponent of 1/h that fits the three finest grids.
    pub exponent: f64,
}

/// Multigrid and the saddle-point methods on one problem.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Comparison {
    /// Name of the problem.
    pub name: String,
    /// Cells per side of the finest grid.
    pub cells: usize,
    /// Error of the discrete solution there, in the discrete L2 norm.
    pub discretisation: f64,
    /// The methods.
    pub runs: Vec<Run>,
}

/// One method in a [`Comparison`].
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Run {
    /// Its name in words.
    pub method: String,
    /// Its iterates on the finest grid.
    pub trace: Vec<Iterate>,
    /// Where it reached the discretisation error, grid by grid.
    pub reached: Vec<Reached>,
}

/// An iterate on the finest grid.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Iterate {
    /// Work so far, that on coarser grids included.
    pub work_units: f64,
    /// Natural residual over the largest component of the load.
    pub residual: f64,
    /// Error in the discrete L2 norm.
    pub error: f64,
}

/// The first iterate on a grid that is as close as the discretisation lets it be.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Reached {
    /// Cells per side.
    pub cells: usize,
    /// Unknowns visited so far, on all grids.
    pub visits: f64,
    /// The same in sweeps of this grid.
    pub work_units: f64,
    /// Error in the discrete L2 norm.
    pub error: f64,
}

/// The duality parameter: above about 10 it makes no difference to these counts.
pub const R: f64 = 10.0;
/// Relative natural residuals.
const TARGETS: [f64; 2] = [1e-3, 1e-6];
/// The discretisation error is reached when the error is at most this many times as large.
pub const REACHED: f64 = 1.1;
/// Two per cent of the sweeps between checks.
const CHECKS: Checks = Checks { share: 50, cap: 1_000_000 };

/// Counts sweeps of Arrow-Hurwicz for each f, in the notation of scenes, on the grids with these cells per side.
///
/// # Errors
/// A sentence if f cannot be read, grids do not nest, or a target is out of reach.
pub fn laws(cases: &[(String, Vec<usize>)]) -> Result<Vec<CostLaw>, String> {
    let runs: Vec<_> = cases.iter().flat_map(|case| [(case, true), (case, false)]).collect();
    let laws = runs.into_par_iter().map(|((f, cells), nested)| law(f, cells, nested));
    Ok(laws.collect::<Result<Vec<_>, _>>()?.concat())
}

/// One law for each of [`TARGETS`].
fn law(f: &str, cells: &[usize], nested: bool) -> Result<Vec<CostLaw>, String> {
    let grids = grid::nested(cells).map_err(|e| e.to_string())?;
    let source: Source = f.parse().map_err(|e| format!("{f}: {e}"))?;
    let mut sweeps = [Vec::new(), Vec::new()];
    let mut pair = Pair::zero(grids[0]);
    for (k, &grid) in grids.iter().enumerate() {
        pair = match nested && k > 0 {
            true => pair.prolonged(grids[k - 1], Prolongation::default()),
            false => Pair::zero(grid),
        };
        let load = load(grid, &source, LoadRule::default());
        let mut total = 0;
        for (target, sweeps) in TARGETS.iter().zip(&mut sweeps) {
            let done = |_, pair: &Pair| kkt(grid, &pair.y, &load).relative <= *target;
            let case = (grid, &load[..]);
            total += sweeps_until(Method::ArrowHurwicz, case, R, CHECKS, &mut pair, done)
                .ok_or_else(|| format!("{f} on grid 1/{}: {target:e} not reached", grid.cells()))?;
            sweeps.push((grid.cells(), total));
        }
    }
    let of_target = |(target, sweeps): (f64, Vec<(usize, usize)>)| {
        let points: Vec<_> = sweeps.iter().map(|&(n, s)| (n as f64, s as f64)).collect();
        let exponent = exponent(&points[points.len().saturating_sub(3)..]);
        CostLaw { f: f.into(), nested, target, sweeps, exponent }
    };
    Ok(TARGETS.into_iter().zip(sweeps).map(of_target).collect())
}

/// Runs multigrid, Arrow-Hurwicz and Uzawa to the discretisation error on each of the nested grids.
///
/// # Errors
/// A sentence if grids do not nest, or a method does not reach the discretisation error.
pub fn compare(cells: &[usize]) -> Result<Comparison, String> {
    let known = KnownSolution::Formula(Exact::FreeCorner);
    let grids = grid::nested(cells).map_err(|e| e.to_string())?;
    let levels =
        grids.iter().map(|&grid| OnGrid::new(&known, grid)).collect::<Result<Vec<_>, _>>()?;
    let finest = &levels[levels.len() - 1];
    let mut runs = vec![with_multigrid(&levels)?];
    for (name, method) in [("Arrow-Hurwicz", Method::ArrowHurwicz), ("Uzawa", loose_uzawa(0.0))] {
        runs.push(with_saddle(name, method, &levels)?);
    }
    let (cells, discretisation) = (finest.grid.cells(), finest.discretisation);
    Ok(Comparison { name: known.name().into(), cells, discretisation, runs })
}

/// A problem with known solution on one grid.
pub struct OnGrid {
    /// The grid.
    pub grid: Grid,
    /// Its load vector.
    pub load: Vec<f64>,
    measure: Measure,
    /// Error of the discrete solution.
    pub discretisation: f64,
}

/// By what errors are measured.
enum Measure {
    /// The true values at the nodes.
    Nodes(Vec<f64>),
    /// The true energy.
    Energy(f64),
}

impl OnGrid {
    /// Errors are measured at the nodes where there is a formula, and in the energy elsewhere.
    pub fn new(known: &KnownSolution, grid: Grid) -> Result<Self, String> {
        let side = grid.side();
        let measure = match known {
            KnownSolution::Formula(exact) => {
                let value =
                    |k: usize| exact.at(grid.coordinate(k % side), grid.coordinate(k / side)).value;
                Measure::Nodes((0..grid.nodes()).map(value).collect())
            }
            KnownSolution::Spectral(known) => Measure::Energy(known.solution.energy),
        };
        let mut level = Self { grid, load: known.load(grid), measure, discretisation: 0.0 };
        let params = MultigridParams::default();
        let solved = multigrid::solve_square(grid.cells(), &level.load, None, &params);
        level.discretisation = level.error(&solved.map_err(|e| e.to_string())?.0);
        Ok(level)
    }

    /// The error of `y` in the discrete L2 norm; or, where there is no formula, what the energy is too
    /// large by, relative to it, with values that are negative on the boundary set to zero.
    pub fn error(&self, y: &[f64]) -> f64 {
        match &self.measure {
            Measure::Nodes(exact) => {
                let wrong: Vec<f64> = y.iter().zip(exact).map(|(a, b)| a - b).collect();
                lumped(self.grid, &wrong)
            }
            Measure::Energy(least) => {
                let mut admissible = y.to_vec();
                self.grid.boundary().for_each(|node| admissible[node] = y[node].max(0.0));
                (energy(self.grid, &admissible, &self.load) - least) / least.abs()
            }
        }
    }

    fn is_reached(&self, error: f64) -> bool {
        error <= REACHED * self.discretisation
    }
}

fn with_multigrid(levels: &[OnGrid]) -> Result<Run, String> {
    let mut run = Run { method: "multigrid".into(), trace: Vec::new(), reached: Vec::new() };
    for (k, level) in levels.iter().enumerate() {
        let OnGrid { grid, load, .. } = level;
        let unknowns = grid.nodes() as f64;
        let solve = |goal, max_cycles| {
            let params = MultigridParams { goal, max_cycles };
            let solved = multigrid::solve_square(grid.cells(), load, None, &params);
            solved.map_err(|e| e.to_string())
        };
        let limit = MultigridParams::default().max_cycles;
        let (y, outcome) = solve(Goal::DiscretisationError, limit)?;
        let work_units = outcome.work_units;
        let (visits, error) = (work_units * unknowns, level.error(&y));
        run.reached.push(Reached { cells: grid.cells(), visits, work_units, error });
        if k + 1 == levels.len() {
            let cycles = solve(Goal::RoundingFloor, limit)?.1.cycles;
            for max_cycles in 0..=cycles {
                let (y, outcome) = solve(Goal::RoundingFloor, max_cycles)?;
                let (residual, error) = (kkt(*grid, &y, load).relative, level.error(&y));
                run.trace.push(Iterate { work_units: outcome.work_units, residual, error });
            }
        }
    }
    Ok(run)
}

/// Each grid is left as soon as its discretisation error is reached, which no real stop could know.
fn with_saddle(name: &str, method: Method, levels: &[OnGrid]) -> Result<Run, String> {
    let mut run = Run { method: name.into(), trace: Vec::new(), reached: Vec::new() };
    let mut visits = 0.0;
    let mut pair = Pair::zero(levels[0].grid);
    for (k, level) in levels.iter().enumerate() {
        if k > 0 {
            pair = pair.prolonged(levels[k - 1].grid, Prolongation::default());
        }
        let (last, unknowns) = (k + 1 == levels.len(), level.grid.nodes() as f64);
        let (cells, before, mut reached) = (level.grid.cells(), visits, None);
        let done = |sweeps: usize, pair: &Pair| {
            let error = level.error(&pair.y);
            let visits = before + sweeps as f64 * unknowns;
            let work_units = visits / unknowns;
            let residual = kkt(level.grid, &pair.y, &level.load).relative;
            if last {
                run.trace.push(Iterate { work_units, residual, error });
            }
            if level.is_reached(error) && reached.is_none() {
                reached = Some(Reached { cells, visits, work_units, error });
            }
            reached.is_some() && (!last || residual <= TARGETS[1])
        };
        let case = (level.grid, &level.load[..]);
        let sweeps = sweeps_until(method, case, R, CHECKS, &mut pair, done);
        let missed = format!("{name} does not reach the discretisation error on grid 1/{cells}");
        visits += sweeps.ok_or(&missed)? as f64 * unknowns;
        run.reached.push(reached.ok_or(&missed)?);
    }
    // The start of the first grid has cost nothing and has no place on a logarithmic axis.
    run.trace.retain(|iterate| iterate.work_units > 0.0);
    Ok(run)
}
