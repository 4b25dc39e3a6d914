//! One measure for every solver: how far a nodal vector is from the Karush-Kuhn-Tucker conditions.

use crate::discrete::grid::Grid;
use crate::discrete::stiffness::residual;
use serde::{Deserialize, Serialize};

/// Violations of the conditions `A y = F` inside and `y >= 0`, `A y - F >= 0`, complementary on the boundary.
///
/// Computed from `y` and `F` alone: the multiplier of node i is the discrete flux `(A y - F)_i / h`,
/// whatever multiplier a solver carried along.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Kkt {
    /// Largest `|A y - F|` over interior nodes, in units of F.
    pub stationarity: f64,
    /// Least y on the boundary.
    pub min_y: f64,
    /// Least multiplier on the boundary.
    pub min_lambda: f64,
    /// Largest `|min(y, A y - F)|` over boundary nodes.
    pub complementarity: f64,
    /// `max(stationarity, complementarity)`, the natural residual: zero at the solution only.
    pub natural: f64,
    /// `natural` over `|F|_inf`; invariant under scaling of f.
    pub relative: f64,
}

/// Judges the nodal vector `y` for the load vector `load`.
///
/// # Panics
/// If a slice is not of length `grid.nodes()`.
pub fn kkt(grid: Grid, y: &[f64], load: &[f64]) -> Kkt {
    let mut flux = vec![0.0; grid.nodes()];
    residual(grid, y, load, &mut flux);
    judge(flux, grid.boundary(), y, load, grid.h())
}

/// The same from the gradient `A y - F`, the numbers of the boundary nodes, and the measure of the
/// boundary around one of them.
pub(crate) fn judge(
    mut flux: Vec<f64>,
    boundary: impl Iterator<Item = usize>,
    y: &[f64],
    load: &[f64],
    measure: f64,
) -> Kkt {
    let (mut min_y, mut min_flux, mut complementarity) = (f64::INFINITY, f64::INFINITY, 0.0);
    for node in boundary {
        min_y = min(min_y, y[node]);
        min_flux = min(min_flux, flux[node]);
        complementarity = max(complementarity, y[node].min(flux[node]).abs());
        flux[node] = 0.0;
    }
    let stationarity = flux.iter().fold(0.0, |worst, r| max(worst, r.abs()));
    let natural = max(stationarity, complementarity);
    let scale = load.iter().fold(0.0, |worst, f| max(worst, f.abs()));
    Kkt {
        stationarity,
        min_y,
        min_lambda: min_flux / measure,
        complementarity,
        natural,
        relative: if natural == 0.0 { 0.0 } else { natural / scale },
    }
}

/// The larger of two, or NaN if either is: `f64::max` would hide a NaN.
fn max(a: f64, b: f64) -> f64 {
    if a >= b || a.is_nan() { a } else { b }
}

fn min(a: f64, b: f64) -> f64 {
    if a <= b || a.is_nan() { a } else { b }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_violation_is_seen_where_it_is() {
        let grid = Grid::new(2).unwrap();
        let mut load = vec![0.0; 9];
        load[4] = -1.0;
        let mut y = vec![0.0; 9];
        y[4] = -0.25;
        let solved = kkt(grid, &y, &load);
        assert_eq!((solved.natural, solved.min_y, solved.min_lambda), (0.0, 0.0, 0.0));
        y[4] = 0.0;
        assert_eq!(kkt(grid, &y, &load).stationarity, 1.0);
        y[4] = -0.25;
        y[1] = -0.5;
        let infeasible = kkt(grid, &y, &load);
        assert_eq!(infeasible.min_y, -0.5);
        assert!(infeasible.complementarity >= 0.5);
        load[3] = 7.0;
        assert!(kkt(grid, &y, &load).min_lambda < -6.0);
    }

    #[test]
    fn nan_is_never_hidden() {
        let grid = Grid::new(2).unwrap();
        for node in [0, 4] {
            let mut y = vec![0.0; 9];
            y[node] = f64::NAN;
            assert!(kkt(grid, &y, &[1.0; 9]).natural.is_nan());
        }
    }
}
