//! The work of the paper's method: its sweeps against the width of the grid, and its work beside multigrid's.

use super::known::KnownSolution;
use super::saddle::{CheckInterval, loose_uzawa, sweeps_until};
use super::{Findings, Rows};
use crate::discrete::grid::{self, Grid};
use crate::discrete::kkt::kkt;
use crate::discrete::load::{LoadRule, load};
use crate::discrete::norms::lumped;
use crate::discrete::stiffness::energy;
use crate::discrete::transfer::Prolongation;
use crate::machine::threads::{join, try_map};
use crate::multigrid::{self, Goal, MultigridParams};
use crate::problem::exact::Exact;
use crate::problem::law::Law;
use crate::problem::source::Source;
use crate::saddle::{Method, NestedGrids, Pair, RunStart, run_nested};
use serde::{Deserialize, Serialize};

/// Table `sweeps`: number of sweeps that Arrow-Hurwicz takes to a residual on one grid.
#[derive(Clone, Serialize)]
struct SweepsRow {
    /// f in the notation of scenes.
    f: String,
    /// True if each grid starts from the solution on the grid before, false if from zero.
    nested: bool,
    /// Natural residual over the largest component of the load.
    target: f64,
    cells: usize,
    sweeps: usize,
}

/// Table `compared`: work of each method to an error of at most [`REACHED`] times the discretisation error: visits of
/// unknowns so far, on all grids, over the number of unknowns of this one.
#[derive(Serialize)]
struct ComparedWork {
    problem: &'static str,
    cells: usize,
    multigrid: f64,
    arrow_hurwicz: f64,
    /// Uzawa's method with loose inner minimisation.
    uzawa: f64,
}

/// Duality parameter: above about 10 it makes no difference to these counts.
pub(super) const R: f64 = 10.0;
/// Relative natural residuals.
const TARGETS: [f64; 2] = [1e-3, 1e-6];
/// Factor by which the error may exceed the discretisation error that it is said to reach.
pub(super) const REACHED: f64 = 1.1;
/// Two per cent of the sweeps between checks.
const CHECKS: CheckInterval = CheckInterval { share: 50, limit: 1_000_000 };

/// Input of the experiment; every grid is given by its cells per side.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct WorkPlan {
    /// Right-hand sides in the notation of scenes, and grids, on which the sweeps of the paper's method are counted.
    laws: Vec<(String, Vec<usize>)>,
    /// Nested grids on which multigrid is compared with the saddle-point methods.
    compared: Vec<usize>,
}

impl WorkPlan {
    /// Plan of the book for the paper's problems, given by name with f in the notation of scenes.
    pub(super) fn new(problems: &[(String, String)]) -> Self {
        let mut laws = vec![("exact(free-corner)".into(), vec![8, 16, 32, 64, 128])];
        // Problem 2: finer grids take too long for an experiment that is part of every run.
        laws.extend(problems.get(1).map(|(_, f)| (f.clone(), vec![4, 8, 16, 32])));
        Self { laws, compared: vec![8, 16, 32, 64] }
    }
}

/// Runs the experiment: tables `sweeps` of the paper's method, and `compared` with multigrid's work.
///
/// # Errors
/// A sentence if a grid cannot be used, or a problem cannot be solved on it.
pub(super) fn work(plan: &WorkPlan) -> Result<Findings, String> {
    let (sweeps, compared) = join(|| laws(&plan.laws), || compare(&plan.compared));
    Ok(Findings::from([
        ("sweeps".into(), Rows::of(sweeps?)),
        ("compared".into(), Rows::of(compared?)),
    ]))
}

/// Counts sweeps of Arrow-Hurwicz for each f, in the notation of scenes, on the grids with these cells per side.
///
/// # Errors
/// A sentence if f cannot be read, grids do not nest, or a target is out of reach.
fn laws(cases: &[(String, Vec<usize>)]) -> Result<Vec<SweepsRow>, String> {
    let runs: Vec<_> = cases.iter().flat_map(|case| [(case, true), (case, false)]).collect();
    Ok(try_map(&runs, |&((f, cells), nested)| law(f, cells, nested))?.concat())
}

/// Counts the sweeps to each of [`TARGETS`] on all grids.
fn law(f: &str, cells: &[usize], nested: bool) -> Result<Vec<SweepsRow>, String> {
    let grids = grid::nested(cells).map_err(|e| e.clone())?;
    let source: Source = f.parse().map_err(|e| format!("{f}: {e}"))?;
    let mut rows = Vec::new();
    let levels = NestedGrids { grids: &grids, prolongation: Prolongation::default() };
    run_nested(&levels, &mut [Pair::zero(grids[0])], |k, [pair]: &mut [Pair; 1]| {
        let grid = grids[k];
        if !nested {
            *pair = Pair::zero(grid);
        }
        let load = load(grid, &source, LoadRule::default());
        let mut total = 0;
        for target in TARGETS {
            let is_reached =
                &mut |pair: &Pair| kkt(grid, Law::SIGNORINI, &pair.y, &load).relative <= target;
            let start = RunStart { load: &load, method: Method::ArrowHurwicz, r: R, pair };
            let reached = sweeps_until(grid, &start, CHECKS, is_reached);
            let (last, sweeps) = reached
                .ok_or_else(|| format!("{f} on grid 1/{}: {target:e} not reached", grid.cells()))?;
            *pair = last;
            total += sweeps;
            rows.push(SweepsRow {
                f: f.into(),
                nested,
                target,
                cells: grid.cells(),
                sweeps: total,
            });
        }
        Ok::<(), String>(())
    })?;
    Ok(rows)
}

/// Runs multigrid, Arrow-Hurwicz and Uzawa to the discretisation error on each of the nested grids.
///
/// # Errors
/// A sentence if grids do not nest, or a method does not reach the discretisation error.
fn compare(cells: &[usize]) -> Result<Vec<ComparedWork>, String> {
    let exact = Exact::FreeCorner;
    let known = KnownSolution::Formula(exact);
    let grids = grid::nested(cells).map_err(|e| e.clone())?;
    let mut levels = Vec::new();
    for grid in grids {
        levels.push(OnGrid::new(&known, grid)?);
    }
    let multigrid = with_multigrid(&levels)?;
    let arrow_hurwicz = with_saddle("Arrow-Hurwicz", Method::ArrowHurwicz, &levels)?;
    let uzawa = with_saddle("Uzawa", loose_uzawa(0.0), &levels)?;
    let mut rows = Vec::new();
    for (k, level) in levels.iter().enumerate() {
        rows.push(ComparedWork {
            problem: exact.name(),
            cells: level.grid.cells(),
            multigrid: multigrid[k],
            arrow_hurwicz: arrow_hurwicz[k],
            uzawa: uzawa[k],
        });
    }
    Ok(rows)
}

/// A problem with known solution on one grid.
pub(super) struct OnGrid {
    /// The grid.
    pub(super) grid: Grid,
    /// Load vector.
    pub(super) load: Vec<f64>,
    measure: WorkMeasure,
    /// Error of the discrete solution.
    pub(super) discretisation: f64,
}

/// True values that errors are measured against.
enum WorkMeasure {
    /// Values at the nodes.
    Nodes(Vec<f64>),
    /// Energy.
    Energy(f64),
}

impl OnGrid {
    /// Takes the values at the nodes as the measure of errors if there is a formula, else the energy.
    ///
    /// # Errors
    /// A sentence if the grid cannot be used.
    pub(super) fn new(known: &KnownSolution, grid: Grid) -> Result<Self, String> {
        let measure = match known {
            KnownSolution::Formula(exact) => WorkMeasure::Nodes(nodal_values(*exact, grid)),
            KnownSolution::Spectral(known) => WorkMeasure::Energy(known.solution.energy),
        };
        let mut level = Self { grid, load: known.load(grid), measure, discretisation: 0.0 };
        let params = MultigridParams::default();
        let solved =
            multigrid::solve_square(grid.cells(), Law::SIGNORINI.with_load(&level.load), &params);
        level.discretisation = level.error(&solved.map_err(|e| e.to_string())?.0);
        Ok(level)
    }

    /// Error of `y` in the discrete L2 norm. Without a formula: the energy of `y`, with negative values on the
    /// boundary set to zero, less the least energy, over the absolute value of the latter.
    pub(super) fn error(&self, y: &[f64]) -> f64 {
        match &self.measure {
            WorkMeasure::Nodes(exact) => {
                let wrong: Vec<f64> = y.iter().zip(exact).map(|(a, b)| a - b).collect();
                lumped(self.grid, &wrong)
            }
            WorkMeasure::Energy(least) => {
                let mut admissible = y.to_vec();
                for node in self.grid.boundary() {
                    admissible[node] = y[node].max(0.0);
                }
                (energy(self.grid, &admissible, &self.load) - least) / least.abs()
            }
        }
    }

    fn is_reached(&self, error: f64) -> bool {
        error <= REACHED * self.discretisation
    }
}

/// Values of the true solution at the nodes, row by row.
fn nodal_values(exact: Exact, grid: Grid) -> Vec<f64> {
    let mut values = Vec::with_capacity(grid.nodes());
    for j in 0..grid.side() {
        for i in 0..grid.side() {
            values.push(exact.at(grid.coordinate(i), grid.coordinate(j)).value);
        }
    }
    values
}

/// Work units of multigrid to the discretisation error, grid by grid.
fn with_multigrid(levels: &[OnGrid]) -> Result<Vec<f64>, String> {
    let mut work = Vec::new();
    for OnGrid { grid, load, .. } in levels {
        let params =
            MultigridParams { goal: Goal::DiscretisationError, ..MultigridParams::default() };
        let (_, outcome) =
            multigrid::solve_square(grid.cells(), Law::SIGNORINI.with_load(load), &params)
                .map_err(|e| e.to_string())?;
        work.push(outcome.work_units);
    }
    Ok(work)
}

/// Work units of a saddle-point method over nested grids, each of which is left as soon as its discretisation error is
/// reached: no stopping rule could know that.
fn with_saddle(name: &str, method: Method, levels: &[OnGrid]) -> Result<Vec<f64>, String> {
    let (mut work, mut visits) = (Vec::new(), 0.0);
    let grids: Vec<_> = levels.iter().map(|level| level.grid).collect();
    let nested = NestedGrids { grids: &grids, prolongation: Prolongation::default() };
    run_nested(&nested, &mut [Pair::zero(grids[0])], |k, [pair]: &mut [Pair; 1]| {
        let level = &levels[k];
        let (grid, load) = (level.grid, &level.load[..]);
        let (cells, unknowns) = (grid.cells(), grid.nodes() as f64);
        let start = RunStart { load, method, r: R, pair };
        let is_reached = &mut |pair: &Pair| level.is_reached(level.error(&pair.y));
        let (last, sweeps) = sweeps_until(grid, &start, CHECKS, is_reached).ok_or_else(|| {
            format!("{name} does not reach the discretisation error on grid 1/{cells}")
        })?;
        *pair = last;
        visits += sweeps as f64 * unknowns;
        work.push(visits / unknowns);
        Ok::<(), String>(())
    })?;
    Ok(work)
}
