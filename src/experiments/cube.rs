//! Errors and work units on the unit cube.

use super::accuracy::{GOALS, Spent};
use crate::discrete::cube::{Errors, Grid, errors, load};
use crate::multigrid::MultigridParams;
use crate::multigrid::cube::Multigrid;
use crate::problem::cube::Exact;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// What is computed.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Plan {
    /// Cells per side of the grids, each the halving of the one before.
    pub cells: Vec<usize>,
}

impl Default for Plan {
    fn default() -> Self {
        Self { cells: vec![8, 16, 32, 64] }
    }
}

/// What came out.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Findings {
    /// The problems with known solutions.
    pub problems: Vec<Known>,
    /// Greatest work units on the finest grid, goal by goal.
    pub most: [f64; 3],
    /// Greatest distance of an observed order from 2 in L2 and at the nodes, and from 1 in H1, between
    /// the two finest grids.
    pub off: f64,
    /// Greatest bytes of the workspace per unknown on the finest grid.
    pub bytes: f64,
}

/// A problem with known solution on all grids.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Known {
    /// Name, as in `exact(name)`.
    pub name: String,
    /// Grid by grid.
    pub levels: Vec<Level>,
}

/// A problem with known solution on one grid.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Level {
    /// Cells per side.
    pub cells: usize,
    /// Errors in L2, in the H1 seminorm, and the greatest at a node, solved to the rounding floor.
    pub errors: [f64; 3],
    /// Observed orders against the grid before.
    pub orders: Option<[f64; 3]>,
    /// For the goals of [`super::accuracy`].
    pub goals: [Spent; 3],
    /// Bytes of the workspace per unknown.
    pub bytes: f64,
}

/// Runs the experiment.
///
/// # Errors
/// A sentence if a grid cannot be used, or a problem cannot be solved on it.
pub fn cube(plan: &Plan) -> Result<Findings, String> {
    let known: Result<Vec<_>, _> =
        Exact::ALL.into_par_iter().map(|exact| known(exact, &plan.cells)).collect();
    let problems = known?;
    let finest = || problems.iter().filter_map(|problem| problem.levels.last());
    let greatest = |of: &dyn Fn(&Level) -> f64| finest().map(of).fold(0.0, f64::max);
    let off = |level: &Level| {
        let orders = level.orders.unwrap_or([f64::NAN; 3]);
        orders.iter().zip([2.0, 1.0, 2.0]).map(|(p, best)| (p - best).abs()).fold(0.0, f64::max)
    };
    Ok(Findings {
        most: [0, 1, 2].map(|goal| greatest(&|level| level.goals[goal].work_units)),
        off: greatest(&off),
        bytes: greatest(&|level| level.bytes),
        problems,
    })
}

fn known(exact: Exact, cells: &[usize]) -> Result<Known, String> {
    let mut levels: Vec<Level> = Vec::new();
    for &n in cells {
        let failed = |e: String| format!("{} on the cube, grid 1/{n}: {e}", exact.name());
        let grid = Grid::new(n).map_err(|e| failed(e.to_string()))?;
        let load = load(grid, |point| exact.at(point).f);
        let mut workspace = Multigrid::new(n).map_err(|e| failed(e.to_string()))?;
        let mut solve = |goal| {
            let params = MultigridParams { goal, ..MultigridParams::default() };
            let outcome = workspace.solve(&load, None, &params, |_| ());
            outcome.map(|outcome| Spent::of(&outcome)).map_err(|e| failed(e.to_string()))
        };
        let goals = [solve(GOALS[0])?, solve(GOALS[1])?, solve(GOALS[2])?];
        let mut y = vec![0.0; grid.nodes()];
        workspace.write_solution(&mut y);
        let Errors { l2, h1, max } = errors(grid, exact, &y);
        let errors = [l2, h1, max];
        let order =
            |coarser: &Level| [0, 1, 2].map(|norm| libm::log2(coarser.errors[norm] / errors[norm]));
        levels.push(Level {
            cells: n,
            orders: levels.last().map(order),
            errors,
            goals,
            bytes: workspace.bytes() as f64 / grid.nodes() as f64,
        });
    }
    Ok(Known { name: exact.name().into(), levels })
}
