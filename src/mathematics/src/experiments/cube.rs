//! Errors and work units on the unit cube.

use super::accuracy::{Cost, Costed, KnownLevels, cost};
use crate::discrete::cube::{Grid, errors, load};
use crate::discrete::norms::{Errors, worst};
use crate::multigrid::Multigrid;
use crate::problem::cube::Exact;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// Input of the experiment.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct CubePlan {
    /// Cells per side of the grids, each the halving of the one before.
    pub cells: Vec<usize>,
}

impl Default for CubePlan {
    fn default() -> Self {
        Self { cells: vec![8, 16, 32, 64] }
    }
}

/// Result of the experiment.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct CubeFindings {
    /// Problems with known solutions.
    pub problems: Vec<KnownLevels<CubeLevel>>,
    /// Greatest work units on the finest grid, goal by goal.
    pub most: [f64; 3],
}

/// A problem with known solution on one grid.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct CubeLevel {
    /// Errors in L2, in the H1 seminorm, and the greatest at a node, solved to the rounding floor.
    pub errors: [f64; 3],
    /// Observed orders against the grid before.
    pub orders: Option<[f64; 3]>,
    /// Cost of the solution.
    pub cost: Cost,
}

/// Runs the experiment.
///
/// # Errors
/// A sentence if a grid cannot be used, or a problem cannot be solved on it.
pub fn cube(plan: &CubePlan) -> Result<CubeFindings, String> {
    let known: Result<Vec<_>, String> = Exact::ALL
        .into_par_iter()
        .map(|exact| known(exact, &plan.cells).map_err(|e| format!("on the cube, {e}")))
        .collect();
    let problems = known?;
    let finest: Vec<_> = problems.iter().filter_map(|problem| problem.levels.last()).collect();
    Ok(CubeFindings {
        most: [0, 1, 2]
            .map(|goal| worst(finest.iter().map(|level| level.cost.goals[goal].work_units))),
        problems,
    })
}

/// Measures errors and cost of a problem with known solution, grid by grid.
fn known(exact: Exact, cells: &[usize]) -> Result<KnownLevels<CubeLevel>, String> {
    let mut levels: Vec<CubeLevel> = Vec::new();
    for &n in cells {
        let grid = Grid::new(n).map_err(|e| e.to_string())?;
        let load = load(grid, |point| exact.at(point).f);
        let Costed { cost, solutions: [.., y] } = cost(exact.name(), Multigrid::cube, n, &load)?;
        let Errors { l2, h1, max } = errors(grid, exact, &y);
        let errors = [l2, h1, max];
        let orders = levels
            .last()
            .map(|coarser| [0, 1, 2].map(|norm| libm::log2(coarser.errors[norm] / errors[norm])));
        levels.push(CubeLevel { errors, orders, cost });
    }
    Ok(KnownLevels { name: exact.name().into(), levels })
}
