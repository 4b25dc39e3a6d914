//! Solving one problem by any solver, each brought to the same shape of answer.

use super::{Solver, goal};
use crate::discrete::grid::{Grid, nested};
use crate::discrete::kkt::{Kkt, kkt};
use crate::discrete::load::{LoadRule, load};
use crate::discrete::norms::{Errors, errors};
use crate::discrete::stiffness::{energy, residual};
use crate::discrete::transfer::Prolongation;
use crate::multigrid::MultigridParams;
use crate::multigrid::active_set::{ActiveSetParams, active_set};
use crate::multigrid::square::multigrid;
use crate::multigrid::{self, InputError};
use crate::pipeline::error::{Error, Result};
use crate::problem::source::Source;
use crate::saddle::{
    self, Outcome, Pair, Params, ProximalParams, UzawaOutcome, UzawaParams, on_nested,
    solve_nested, tolerance, uzawa, uzawa_proximal,
};
use std::time::Instant;

/// What is to be solved.
pub(super) struct Problem<'a> {
    pub name: &'a str,
    pub f: &'a Source,
    pub rule: LoadRule,
    /// Cells per side.
    pub finest: usize,
}

/// What came out.
pub(super) struct Solved {
    /// The finest grid.
    pub grid: Grid,
    pub pair: Pair,
    /// One entry per grid on which the solver stopped, coarsest first.
    pub levels: Vec<Level>,
    /// Cost in sweeps of the finest grid, if the solver counts it.
    pub work_units: Option<f64>,
    /// Errors, if the solution is known.
    pub errors: Option<Errors>,
    /// Seconds for grids and load vectors.
    pub setup: f64,
    /// Seconds for the solver.
    pub seconds: f64,
}

/// How a solver stopped on one grid.
pub(super) struct Level {
    pub cells: usize,
    pub iterations: usize,
    /// Gauss-Seidel sweeps, if they are what the solver does.
    pub sweeps: Option<usize>,
    pub stop: String,
    pub energy: f64,
    pub sum_load: f64,
    pub kkt: Kkt,
}

impl Problem<'_> {
    fn load(&self, grid: Grid) -> Vec<f64> {
        load(grid, self.f, self.rule)
    }

    pub fn saddle(&self, solver: Solver, params: &Params) -> Result<Solved> {
        let start = Instant::now();
        let grids = hierarchy(self.finest)?;
        let loads: Vec<_> = grids.iter().map(|&grid| self.load(grid)).collect();
        let setup = start.elapsed().as_secs_f64();
        let start = Instant::now();
        let (outcomes, pair) = on_saddle(solver, &grids, &loads, params);
        let seconds = start.elapsed().as_secs_f64();
        if let Some(o) =
            outcomes.last().map(|o| o.end).filter(|o| o.stop == saddle::StopReason::Diverged)
        {
            return Err(Error::Stage(vec![format!(
                "{} diverged on grid 1/{} after {} iterations; choose a smaller r or scale f down",
                self.name, o.cells, o.iterations
            )]));
        }
        let levels = outcomes
            .iter()
            .map(|&UzawaOutcome { end: o, sweeps }| Level {
                cells: o.cells,
                iterations: o.iterations,
                sweeps: Some(sweeps),
                stop: o.stop.to_string(),
                energy: o.energy,
                sum_load: o.sum_load,
                kkt: o.kkt,
            })
            .collect();
        let (grid, load) = (grids[grids.len() - 1], &loads[loads.len() - 1]);
        let errors = self.errors(grid, &pair.y, load);
        Ok(Solved { grid, pair, levels, work_units: None, errors, setup, seconds })
    }

    pub fn multigrid(&self, tolerance: Option<f64>) -> Result<Solved> {
        self.fast(|grid, load| {
            let params = MultigridParams { goal: goal(tolerance, load), ..Default::default() };
            let (y, outcome) = multigrid(grid.cells(), load, None, &params, |_| ())?;
            Ok((y, outcome.cycles, outcome.stop, Some(outcome.work_units)))
        })
    }

    pub fn active_set(&self) -> Result<Solved> {
        if self.finest > MAX_DIRECT {
            return Err(Error::input(format!(
                "active-set factorises a matrix, which at h = 1/{} takes too much memory; use --solver multigrid, or h = 1/{MAX_DIRECT}",
                self.finest
            )));
        }
        self.fast(|grid, load| {
            let params = ActiveSetParams::default();
            let (y, outcome) = active_set(grid.cells(), load, None, &params, |_| ())?;
            Ok((y, outcome.steps, outcome.stop, None))
        })
    }

    /// Runs a solver that works on the finest grid alone; it returns y, steps, why it stopped, and work units.
    fn fast(&self, solver: impl Fn(Grid, &[f64]) -> FastResult) -> Result<Solved> {
        let start = Instant::now();
        let grid = Grid::new(self.finest).map_err(|e| Error::input(e.to_string()))?;
        let load = self.load(grid);
        let setup = start.elapsed().as_secs_f64();
        let start = Instant::now();
        let (y, iterations, stop, work_units) = solver(grid, &load).map_err(|e| {
            let remedy = match e {
                InputError::NotCoercive(_) => {
                    "average f on its jumps with --load lumped-average, or lower it"
                }
                InputError::GridSize(..) => "choose another --h",
                _ => "check f",
            };
            Error::input(format!("{}: {e}; {remedy}", self.name))
        })?;
        let seconds = start.elapsed().as_secs_f64();
        if stop == multigrid::StopReason::Diverged {
            return Err(Error::Stage(vec![format!("{} diverged; scale f down", self.name)]));
        }
        let mut flux = vec![0.0; grid.nodes()];
        residual(grid, &y, &load, &mut flux);
        // In contact y is exactly zero; elsewhere the flux is rounding error.
        let multiplier =
            |node: usize| if y[node] > 0.0 { 0.0 } else { flux[node].max(0.0) / grid.h() };
        let a = grid.boundary().map(multiplier).collect();
        let level = Level {
            cells: grid.cells(),
            iterations,
            sweeps: None,
            stop: stop.name().into(),
            energy: energy(grid, &y, &load),
            sum_load: load.iter().sum(),
            kkt: kkt(grid, &y, &load),
        };
        let errors = self.errors(grid, &y, &load);
        let pair = Pair { y, a };
        Ok(Solved { grid, pair, levels: vec![level], work_units, errors, setup, seconds })
    }

    fn errors(&self, grid: Grid, y: &[f64], load: &[f64]) -> Option<Errors> {
        self.f.exact().map(|exact| errors(grid, exact, y, load))
    }
}

/// Runs a saddle-point method over the nested grids: the end and the sweeps on each, and the last pair.
fn on_saddle(
    solver: Solver,
    grids: &[Grid],
    loads: &[Vec<f64>],
    params: &Params,
) -> (Vec<UzawaOutcome>, Pair) {
    let prolongation = Prolongation::default();
    if solver == Solver::ArrowHurwicz {
        let (ends, pair) = solve_nested(grids, loads, params, prolongation, &mut ());
        let sweeps = |end: Outcome| UzawaOutcome { end, sweeps: end.iterations };
        return (ends.into_iter().map(sweeps).collect(), pair);
    }
    let Params { r, rule, max_iterations, .. } = *params;
    on_nested(grids, loads, prolongation, |level, grid, load, pair| {
        let params = UzawaParams {
            r,
            rule,
            tolerance: tolerance(level),
            max_sweeps: max_iterations,
            ..UzawaParams::default()
        };
        let outcome = if solver == Solver::Uzawa {
            uzawa(grid, load, &params, pair, None)
        } else {
            let params = ProximalParams { uzawa: params, ..ProximalParams::default() };
            uzawa_proximal(grid, load, &params, pair, None)
        };
        (outcome, outcome.end.stop)
    })
}

type FastResult =
    std::result::Result<(Vec<f64>, usize, multigrid::StopReason, Option<f64>), InputError>;

/// Finest grid whose Cholesky factor fits comfortably in memory.
const MAX_DIRECT: usize = 1024;

/// Grids from the coarsest that halves down to `finest`, with at least four cells if possible.
fn hierarchy(finest: usize) -> Result<Vec<Grid>> {
    let mut sizes = vec![finest];
    while sizes[0].is_multiple_of(2) && sizes[0] >= 8 {
        sizes.insert(0, sizes[0] / 2);
    }
    nested(&sizes).map_err(|e| Error::input(e.to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hierarchies_halve_down_to_an_odd_or_small_grid() {
        let sizes = |n| -> Vec<_> { hierarchy(n).unwrap().iter().map(|g| g.cells()).collect() };
        assert_eq!(sizes(64), [4, 8, 16, 32, 64]);
        assert_eq!(sizes(12), [6, 12]);
        assert_eq!(sizes(7), [7]);
        assert!(hierarchy(1).is_err());
    }
}
