//! The work of the paper's method: its sweeps against the width of the grid, and its work beside multigrid's.

use super::exponent;
use super::known::KnownSolution;
use super::saddle::{CheckInterval, loose_uzawa, sweeps_until};
use crate::discrete::grid::{self, Grid};
use crate::discrete::kkt::kkt;
use crate::discrete::load::{LoadRule, load};
use crate::discrete::norms::lumped;
use crate::discrete::stiffness::energy;
use crate::discrete::transfer::Prolongation;
use crate::machine::threads::map;
use crate::multigrid::{self, Goal, MultigridParams};
use crate::problem::exact::Exact;
use crate::problem::law::Law;
use crate::problem::source::Source;
use crate::saddle::{Method, NestedGrids, Pair, RunStart, run_nested};
use serde::{Deserialize, Serialize};

/// Number of sweeps that Arrow-Hurwicz takes to a residual, grid by grid.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct CostLaw {
    /// f in the notation of scenes.
    pub f: String,
    /// True if each grid starts from the solution on the grid before, false if from zero.
    pub nested: bool,
    /// Natural residual over the largest component of the load.
    pub target: f64,
    /// Cells per side, and sweeps on that grid.
    pub sweeps: Vec<(usize, usize)>,
    /// Exponent of 1/h that fits the three finest grids; none with fewer than two.
    pub exponent: Option<f64>,
}

/// Multigrid and the saddle-point methods on one problem.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Comparison {
    /// Name of the problem.
    pub name: String,
    /// Grid by grid.
    pub rows: Vec<ComparedWork>,
    /// Number of grids on which Uzawa's method with loose inner minimisation takes less work than Arrow-Hurwicz.
    pub uzawa_ahead: usize,
}

/// Work of each method to an error of at most [`REACHED`] times the discretisation error: visits of unknowns so far, on
/// all grids, over the number of unknowns of this one.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct ComparedWork {
    /// Cells per side.
    pub cells: usize,
    /// Work units of multigrid.
    pub multigrid: f64,
    /// Work units of Arrow-Hurwicz.
    pub arrow_hurwicz: f64,
    /// Work units of Uzawa's method with loose inner minimisation.
    pub uzawa: f64,
}

/// Duality parameter: above about 10 it makes no difference to these counts.
pub const R: f64 = 10.0;
/// Relative natural residuals.
const TARGETS: [f64; 2] = [1e-3, 1e-6];
/// Factor by which the error may exceed the discretisation error that it is said to reach.
pub const REACHED: f64 = 1.1;
/// Two per cent of the sweeps between checks.
const CHECKS: CheckInterval = CheckInterval { share: 50, limit: 1_000_000 };

/// Counts sweeps of Arrow-Hurwicz for each f, in the notation of scenes, on the grids with these cells per side.
///
/// # Errors
/// A sentence if f cannot be read, grids do not nest, or a target is out of reach.
pub fn laws(cases: &[(String, Vec<usize>)]) -> Result<Vec<CostLaw>, String> {
    let runs: Vec<_> = cases.iter().flat_map(|case| [(case, true), (case, false)]).collect();
    let laws: Result<Vec<_>, String> =
        map(&runs, 1, |&((f, cells), nested)| law(f, cells, nested)).into_iter().collect();
    Ok(laws?.concat())
}

/// Measures one law for each of [`TARGETS`].
fn law(f: &str, cells: &[usize], nested: bool) -> Result<Vec<CostLaw>, String> {
    let grids = grid::nested(cells).map_err(|e| e.to_string())?;
    let source: Source = f.parse().map_err(|e| format!("{f}: {e}"))?;
    let mut laws = TARGETS.map(|target| CostLaw {
        f: f.into(),
        nested,
        target,
        sweeps: Vec::new(),
        exponent: None,
    });
    let levels = NestedGrids { grids: &grids, prolongation: Prolongation::default() };
    run_nested(&levels, &mut [Pair::zero(grids[0])], |k, [pair]: &mut [Pair; 1]| {
        let grid = grids[k];
        if !nested {
            *pair = Pair::zero(grid);
        }
        let load = load(grid, &source, LoadRule::default());
        let mut total = 0;
        for law in &mut laws {
            let target = law.target;
            let is_reached =
                &mut |pair: &Pair| kkt(grid, Law::SIGNORINI, &pair.y, &load).relative <= target;
            let start = RunStart { load: &load, method: Method::ArrowHurwicz, r: R, pair };
            let reached = sweeps_until(grid, &start, CHECKS, is_reached);
            let (last, sweeps) = reached
                .ok_or_else(|| format!("{f} on grid 1/{}: {target:e} not reached", grid.cells()))?;
            *pair = last;
            total += sweeps;
            law.sweeps.push((grid.cells(), total));
        }
        Ok::<(), String>(())
    })?;
    for law in &mut laws {
        let finest = &law.sweeps[law.sweeps.len().saturating_sub(3)..];
        let points: Vec<_> = finest.iter().map(|&(n, sweeps)| (n as f64, sweeps as f64)).collect();
        law.exponent = exponent(&points);
    }
    Ok(laws.into())
}

/// Runs multigrid, Arrow-Hurwicz and Uzawa to the discretisation error on each of the nested grids.
///
/// # Errors
/// A sentence if grids do not nest, or a method does not reach the discretisation error.
pub fn compare(cells: &[usize]) -> Result<Comparison, String> {
    let known = KnownSolution::Formula(Exact::FreeCorner);
    let grids = grid::nested(cells).map_err(|e| e.to_string())?;
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
            cells: level.grid.cells(),
            multigrid: multigrid[k],
            arrow_hurwicz: arrow_hurwicz[k],
            uzawa: uzawa[k],
        });
    }
    let uzawa_ahead = rows.iter().filter(|row| row.uzawa < row.arrow_hurwicz).count();
    Ok(Comparison { name: known.name().into(), rows, uzawa_ahead })
}

/// A problem with known solution on one grid.
pub struct OnGrid {
    /// The grid.
    pub grid: Grid,
    /// Load vector.
    pub load: Vec<f64>,
    measure: WorkMeasure,
    /// Error of the discrete solution.
    pub discretisation: f64,
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
    pub fn new(known: &KnownSolution, grid: Grid) -> Result<Self, String> {
        let measure = match known {
            KnownSolution::Formula(exact) => WorkMeasure::Nodes(nodal_values(*exact, grid)),
            KnownSolution::Spectral(known) => WorkMeasure::Energy(known.solution.energy),
        };
        let mut level = Self { grid, load: known.load(grid), measure, discretisation: 0.0 };
        let params = MultigridParams::default();
        let solved = multigrid::solve_square(
            grid.cells(),
            Law::SIGNORINI.with_load(&level.load),
            None,
            &params,
        );
        level.discretisation = level.error(&solved.map_err(|e| e.to_string())?.0);
        Ok(level)
    }

    /// Error of `y` in the discrete L2 norm. Without a formula: the energy of `y`, with negative values on the
    /// boundary set to zero, less the least energy, over the absolute value of the latter.
    pub fn error(&self, y: &[f64]) -> f64 {
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
pub(super) fn nodal_values(exact: Exact, grid: Grid) -> Vec<f64> {
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
            multigrid::solve_square(grid.cells(), Law::SIGNORINI.with_load(load), None, &params)
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
