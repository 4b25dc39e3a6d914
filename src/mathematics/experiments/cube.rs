//! Errors and work units on the unit cube.

use super::accuracy::{Cost, Known, cost};
use crate::discrete::cube::{Grid, errors, load};
use crate::discrete::norms::{Errors, worst};
use crate::multigrid::Multigrid;
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
    pub problems: Vec<Known<Level>>,
    /// Greatest work units on the finest grid, goal by goal.
    pub most: [f64; 3],
    /// Greatest distance of an observed order from 2 in L2 and at the nodes, and from 1 in H1, between
    /// the two finest grids.
    pub off: f64,
    /// Greatest bytes of the workspace per unknown on the finest grid.
    pub bytes: f64,
}

/// A problem with known solution on one grid.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Level {
    /// Errors in L2, in the H1 seminorm, and the greatest at a node, solved to the rounding floor.
    pub errors: [f64; 3],
    /// Observed orders against the grid before.
    pub orders: Option<[f64; 3]>,
    /// What it cost.
    pub cost: Cost,
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
    let greatest = |of: &dyn Fn(&Level) -> f64| worst(finest().map(of));
    let off = |level: &Level| {
        let orders = level.orders.unwrap_or([f64::NAN; 3]);
        worst(orders.iter().zip([2.0, 1.0, 2.0]).map(|(p, best)| p - best))
    };
    Ok(Findings {
        most: [0, 1, 2].map(|goal| greatest(&|level| level.cost.goals[goal].work_units)),
        off: greatest(&off),
        bytes: greatest(&|level| level.cost.bytes),
        problems,
    })
}

fn known(exact: Exact, cells: &[usize]) -> Result<Known<Level>, String> {
    let mut levels: Vec<Level> = Vec::new();
    for &n in cells {
        let failed = |e: String| format!("on the cube, {e}");
        let grid = Grid::new(n).map_err(|e| failed(e.to_string()))?;
        let load = load(grid, |point| exact.at(point).f);
        let (cost, [.., y]) = cost(exact.name(), Multigrid::cube, n, &load).map_err(failed)?;
        let Errors { l2, h1, max } = errors(grid, exact, &y);
        let errors = [l2, h1, max];
        let order =
            |coarser: &Level| [0, 1, 2].map(|norm| libm::log2(coarser.errors[norm] / errors[norm]));
        levels.push(Level { orders: levels.last().map(order), errors, cost });
    }
    Ok(Known { name: exact.name().into(), levels })
}
