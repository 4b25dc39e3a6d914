//! Known solutions, by a formula or from the spectral solver, and errors against them.

use crate::discrete::grid::{Grid, nested};
use crate::discrete::load::{Diagonal, LoadRule, load};
use crate::discrete::norms;
use crate::discrete::stiffness::energy;
use crate::levels::Problem;
use crate::problem::exact::Exact;
use crate::problem::law::Law;
use crate::problem::source::Source;
use crate::saddle::Pair;
use crate::solvers::true_solution;
use crate::spectral::TrueSolution;

/// A problem whose solution is known.
pub(super) enum KnownSolution {
    /// By a formula.
    Formula(Exact),
    /// From the spectral solver.
    Spectral(Box<Spectral>),
}

/// A problem solved by the spectral solver.
pub(super) struct Spectral {
    /// Name.
    pub(super) name: String,
    /// Right-hand side.
    pub(super) f: Source,
    /// Solution.
    pub(super) solution: TrueSolution,
}

/// Cells per side of the grid at whose nodes solutions of the spectral solver are evaluated: a power of two.
pub(super) const SAMPLED: usize = 32;

impl KnownSolution {
    /// Solves for f in the notation of scenes.
    ///
    /// # Errors
    /// A sentence if f cannot be read, or there is no solution.
    pub(super) fn spectral(name: &str, f: &str) -> Result<Self, String> {
        let f: Source = f.parse().map_err(|e| format!("{name}: {e}"))?;
        let solution =
            true_solution(&on_square(&f, SAMPLED)?).map_err(|e| format!("{name}: {e}"))?;
        Ok(Self::Spectral(Box::new(Spectral { name: name.into(), f, solution })))
    }

    /// Name, as in `exact(name)` if there is a formula.
    pub(super) fn name(&self) -> &str {
        match self {
            Self::Formula(exact) => exact.name(),
            Self::Spectral(known) => &known.name,
        }
    }

    /// Right-hand side.
    pub(super) fn f(&self) -> Source {
        match self {
            Self::Formula(exact) => Source::from(*exact),
            Self::Spectral(known) => known.f.clone(),
        }
    }

    /// What the spectral solver found, if it is from there.
    pub(super) fn found(&self) -> Option<&Spectral> {
        match self {
            Self::Formula(_) => None,
            Self::Spectral(known) => Some(known),
        }
    }

    /// Load vector. If f jumps, f is integrated exactly, so that the discrete energy is that of `v_h`.
    pub(super) fn load(&self, grid: Grid) -> Vec<f64> {
        let rule = match self {
            Self::Formula(_) => LoadRule::default(),
            Self::Spectral(_) => LoadRule::Exact { diagonal: Diagonal::default() },
        };
        load(grid, &self.f(), rule)
    }

    /// L2 norm of `grad (v - v_h)`, with `v_h` linear on triangles with the nodal values `y`.
    ///
    /// # Panics
    /// If a slice is not of length `grid.nodes()`.
    pub(super) fn h1_error(&self, grid: Grid, y: &[f64], load: &[f64]) -> f64 {
        match self {
            Self::Formula(exact) => norms::errors(grid, *exact, y).h1,
            Self::Spectral(known) => known.h1_error(grid, y, load),
        }
    }
}

/// Problem on the grid with so many cells per side.
fn on_square(f: &Source, cells: usize) -> Result<Problem, String> {
    let grids = nested(&[cells]).map_err(|e| e.clone())?;
    Problem::on_square(grids, f.clone(), LoadRule::default(), Law::SIGNORINI)
        .map_err(|e| e.to_string())
}

impl Spectral {
    /// v and the multiplier at the nodes of the grid with so many cells per side.
    ///
    /// # Errors
    /// A sentence if there is no such grid.
    pub(super) fn at_nodes(&self, cells: usize) -> Result<Pair, String> {
        Ok(self.solution.at_nodes(&on_square(&self.f, cells)?))
    }

    /// L2 norm of the error of the gradient: for every w, `|grad (v - w)|^2 = 2 (J(w) - J(v)) - 2 int l w`.
    fn h1_error(&self, grid: Grid, y: &[f64], load: &[f64]) -> f64 {
        let work: f64 = self
            .solution
            .boundary_points()
            .iter()
            .map(|p| p.weight * p.multiplier * on_boundary(grid, y, p.point))
            .sum();
        (2.0 * (energy(grid, y, load) - self.solution.energy - work)).max(0.0).sqrt()
    }
}

/// Value of the nodal vector at a point of the boundary, linear between nodes.
fn on_boundary(grid: Grid, y: &[f64], [x, z]: [f64; 2]) -> f64 {
    let (i, s) = cell_and_fraction(grid.cells(), x);
    let (j, t) = cell_and_fraction(grid.cells(), z);
    let lower = (1.0 - s) * y[grid.index(i, j)] + s * y[grid.index(i + 1, j)];
    let upper = (1.0 - s) * y[grid.index(i, j + 1)] + s * y[grid.index(i + 1, j + 1)];
    (1.0 - t) * lower + t * upper
}

/// Number of the cell in which a coordinate lies, and the fraction of the cell's width below the coordinate.
fn cell_and_fraction(cells: usize, coordinate: f64) -> (usize, f64) {
    let n = cells as f64;
    let place = ((coordinate + 0.5) * n).clamp(0.0, n);
    let cell = (place as usize).min(cells - 1);
    (cell, place - cell as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_on_the_boundary_are_linear_between_nodes() {
        let grid = Grid::new(4).unwrap();
        let y: Vec<f64> = (0..25).map(|k| f64::from(k % 5) + 10.0 * f64::from(k / 5)).collect();
        assert_eq!(on_boundary(grid, &y, [-0.125, -0.5]), 1.5);
        assert_eq!(on_boundary(grid, &y, [0.5, 0.5]), 44.0);
    }

    #[test]
    fn the_error_of_zero_is_the_norm_of_the_solution() {
        let f = "quadrant(ll)=6; else=-4";
        let known = KnownSolution::spectral("k", f).unwrap();
        let solution = &known.found().unwrap().solution;
        // The multiplier does no work on v.
        let size = (-2.0 * solution.energy).sqrt();
        for n in [8, 24, 256] {
            let grid = Grid::new(n).unwrap();
            let zero = vec![0.0; grid.nodes()];
            let h1 = known.h1_error(grid, &zero, &zero);
            assert!((h1 - size).abs() < 1e-12, "{h1} {size}");
        }
    }
}
