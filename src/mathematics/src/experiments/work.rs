//! Problems with known solutions on one grid, and errors against them.

use super::known::KnownSolution;
use crate::discrete::grid::Grid;
use crate::discrete::norms::lumped;
use crate::discrete::stiffness::energy;
use crate::multigrid::{self, MultigridParams};
use crate::problem::exact::Exact;
use crate::problem::law::Law;

/// Duality parameter: above about 10 it makes no difference to these counts.
pub(super) const R: f64 = 10.0;
/// Factor by which the error may exceed the discretisation error that it is said to reach.
pub(super) const REACHED: f64 = 1.1;

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
