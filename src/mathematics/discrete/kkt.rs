//! One measure for every solver: how far a nodal vector is from the Karush-Kuhn-Tucker conditions.

use crate::discrete::grid::Grid;
use crate::discrete::simd::Largest;
use crate::discrete::stiffness::{add_energy, residual_row};
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

/// What a nodal vector is worth, from it and the load vector alone.
#[derive(Clone, Debug, PartialEq)]
pub struct Judgement {
    /// How far it is from the conditions.
    pub kkt: Kkt,
    /// `1/2 <A y, y> - <F, y>`.
    pub energy: f64,
    /// `A y - F` at the boundary nodes: a boundary vector, on the cube in the order of a nodal vector.
    pub flux: Vec<f64>,
}

impl Judgement {
    /// The multiplier at the boundary nodes: the flux over the `measure` of a node's part of the boundary in contact,
    /// where the flux is more than `y`. It is zero elsewhere, where the flux of a solution is rounding error.
    pub fn multiplier(
        &self,
        boundary: impl IntoIterator<Item = usize>,
        y: &[f64],
        measure: f64,
    ) -> Vec<f64> {
        let of_node = |(node, flux): (usize, &f64)| {
            if y[node] < *flux { flux.max(0.0) / measure } else { 0.0 }
        };
        boundary.into_iter().zip(&self.flux).map(of_node).collect()
    }
}

/// Judges the nodal vector `y` for the load vector `load`.
///
/// # Panics
/// If a slice is not of length `grid.nodes()`.
pub fn judge(grid: Grid, y: &[f64], load: &[f64]) -> Judgement {
    assert!(y.len() == grid.nodes() && load.len() == y.len());
    let (n, side) = (grid.cells(), grid.side());
    let mut judge = Judge::default();
    let (mut gradient, mut flux) = (vec![0.0; side], vec![0.0; grid.boundary_nodes()]);
    for (j, (y_row, load_row)) in y.chunks_exact(side).zip(load.chunks_exact(side)).enumerate() {
        residual_row(grid, j, y, load, &mut gradient);
        judge.see(y_row, &gradient, load_row, j % n > 0);
        let step = if j % n > 0 { n } else { 1 };
        for i in (0..side).step_by(step) {
            flux[grid.boundary_index(i, j)] = gradient[i];
        }
    }
    Judgement { kkt: judge.kkt(grid.h()), energy: judge.energy, flux }
}

/// How far `y` is from the conditions, as [`judge`] finds it.
///
/// # Panics
/// If a slice is not of length `grid.nodes()`.
pub fn kkt(grid: Grid, y: &[f64], load: &[f64]) -> Kkt {
    judge(grid, y, load).kkt
}

/// A judgement that takes one row of nodes after the other into account.
pub(crate) struct Judge {
    pub(crate) energy: f64,
    stationarity: Largest,
    load: Largest,
    complementarity: Largest,
    min_y: f64,
    min_flux: f64,
}

impl Default for Judge {
    fn default() -> Self {
        let (largest, least) = (Largest::default(), f64::INFINITY);
        Self {
            energy: 0.0,
            stationarity: largest,
            load: largest,
            complementarity: largest,
            min_y: least,
            min_flux: least,
        }
    }
}

impl Judge {
    /// Takes into account a row with the gradient `A y - F`; its ends lie on the boundary, the others if the row is
    /// not `inner`.
    pub(crate) fn see(&mut self, y: &[f64], gradient: &[f64], load: &[f64], inner: bool) {
        self.energy = add_energy(self.energy, y, gradient, load);
        self.load.see(1.0, load);
        let last = y.len() - 1;
        let inside = if inner { 1..last } else { 0..0 };
        self.stationarity.see(1.0, &gradient[inside.clone()]);
        for node in (0..inside.start).chain(inside.end..=last) {
            self.min_y = min(self.min_y, y[node]);
            self.min_flux = min(self.min_flux, gradient[node]);
            self.complementarity.put(min(y[node], gradient[node]));
        }
    }

    /// The violations, where `measure` is that of the boundary around one of its nodes.
    pub(crate) fn kkt(&self, measure: f64) -> Kkt {
        let [stationarity, complementarity, scale] =
            [self.stationarity, self.complementarity, self.load].map(Largest::value);
        let natural = max(stationarity, complementarity);
        Kkt {
            stationarity,
            min_y: self.min_y,
            min_lambda: self.min_flux / measure,
            complementarity,
            natural,
            relative: if natural == 0.0 { 0.0 } else { natural / scale },
        }
    }
}

/// The larger of two, or NaN if either is: `f64::max` would hide a NaN, as `f64::min` would.
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
            let mut load = [1.0; 9];
            load[node] = f64::NAN;
            assert!(kkt(grid, &[0.0; 9], &load).natural.is_nan());
        }
    }
}
