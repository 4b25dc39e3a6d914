//! Known solutions, by a formula or from the spectral solver, and errors against them.

use crate::discrete::grid::Grid;
use crate::discrete::load::{Diagonal, LoadRule, load};
use crate::discrete::norms::{self, multiplier_error, worst};
use crate::discrete::stiffness::energy;
use crate::problem::exact::Exact;
use crate::problem::source::Source;
use crate::spectral::{Solution, SpectralParams, spectral};
use serde::{Deserialize, Serialize};
use std::sync::OnceLock;

/// A problem whose solution is known.
pub enum KnownSolution {
    /// By a formula.
    Formula(Exact),
    /// To rounding, from the spectral solver: f is piecewise constant.
    Spectral(Box<Spectral>),
}

/// A problem solved by the spectral solver.
pub struct Spectral {
    /// Name.
    pub name: String,
    /// Right-hand side.
    pub f: Source,
    /// Solution.
    pub solution: Solution,
    /// v at the nodes of the grid with [`SAMPLED`] cells per side.
    samples: OnceLock<Vec<f64>>,
}

/// Errors of a discrete solution.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Errors {
    /// L2 norm of `v - v_h`; only where v has a formula.
    pub l2: Option<f64>,
    /// L2 norm of `grad (v - v_h)`.
    pub h1: f64,
    /// Largest error at a node; of the spectral solver's solutions, at the nodes of the grid with
    /// [`SAMPLED`] cells per side.
    pub max: f64,
    /// L2 norm on the boundary of the error of the multiplier, by [`multiplier_error`].
    pub multiplier_l2: f64,
}

/// Cells per side of the grid at whose nodes solutions of the spectral solver are evaluated: a power of two.
pub const SAMPLED: usize = 32;

impl KnownSolution {
    /// The solution for a piecewise constant f in the notation of scenes.
    ///
    /// # Errors
    /// A sentence if f cannot be read, or there is no solution.
    pub fn spectral(name: &str, f: &str, params: SpectralParams) -> Result<Self, String> {
        let f: Source = f.parse().map_err(|e| format!("{name}: {e}"))?;
        let solution = spectral(&f, params).map_err(|e| format!("{name}: {e}"))?;
        Ok(Self::of(name, f, solution))
    }

    /// The solution that the spectral solver found for f.
    pub fn of(name: &str, f: Source, solution: Solution) -> Self {
        let samples = OnceLock::new();
        Self::Spectral(Box::new(Spectral { name: name.into(), f, solution, samples }))
    }

    /// Name, as in `exact(name)` where it has a formula.
    pub fn name(&self) -> &str {
        match self {
            Self::Formula(exact) => exact.name(),
            Self::Spectral(known) => &known.name,
        }
    }

    /// The right-hand side.
    pub fn f(&self) -> Source {
        match self {
            Self::Formula(exact) => Source::Exact(*exact),
            Self::Spectral(known) => known.f.clone(),
        }
    }

    /// The spectral solver's solution.
    pub fn solution(&self) -> Option<&Solution> {
        match self {
            Self::Formula(_) => None,
            Self::Spectral(known) => Some(&known.solution),
        }
    }

    /// The load vector. Where f jumps it is integrated exactly, so that the discrete energy is that of v_h.
    pub fn load(&self, grid: Grid) -> Vec<f64> {
        let rule = match self {
            Self::Formula(_) => LoadRule::default(),
            Self::Spectral(_) => LoadRule::Exact { diagonal: Diagonal::default() },
        };
        load(grid, &self.f(), rule)
    }

    /// The L2 norm of `grad (v - v_h)`, v_h linear on triangles with the nodal values `y`.
    ///
    /// # Panics
    /// If a slice is not of length `grid.nodes()`.
    pub fn h1_error(&self, grid: Grid, y: &[f64], load: &[f64]) -> f64 {
        match self {
            Self::Formula(exact) => norms::errors(grid, *exact, y).h1,
            Self::Spectral(known) => known.h1_error(grid, y, load),
        }
    }

    /// All errors of the nodal values `y`; [`Self::load`] gives the multiplier.
    ///
    /// # Panics
    /// As [`Self::h1_error`].
    pub fn errors(&self, grid: Grid, y: &[f64], load: &[f64]) -> Errors {
        match self {
            Self::Formula(exact) => {
                let norms::Errors { l2, h1, max } = norms::errors(grid, *exact, y);
                let multiplier = |point, normal| exact.multiplier(point, normal);
                let multiplier_l2 = multiplier_error(grid, y, load, multiplier);
                Errors { l2: Some(l2), h1, max, multiplier_l2 }
            }
            Self::Spectral(known) => Errors {
                l2: None,
                h1: known.h1_error(grid, y, load),
                max: known.max_error(grid, y),
                multiplier_l2: multiplier_error(grid, y, load, |point, _| {
                    known.solution.on_border(point)[1]
                }),
            },
        }
    }
}

impl Spectral {
    /// For every w, `|grad (v - w)|^2 = 2 (J(w) - J(v)) - 2 int l w`.
    fn h1_error(&self, grid: Grid, y: &[f64], load: &[f64]) -> f64 {
        let work: f64 = self
            .solution
            .border()
            .map(|p| p.weight * p.multiplier * on_border(grid, y, p.point))
            .sum();
        (2.0 * (energy(grid, y, load) - self.solution.energy - work)).max(0.0).sqrt()
    }

    /// At the nodes that both grids have.
    fn max_error(&self, grid: Grid, y: &[f64]) -> f64 {
        let samples = self.samples.get_or_init(|| self.solution.at_nodes(SAMPLED));
        let common = 1 << grid.cells().trailing_zeros().min(SAMPLED.trailing_zeros());
        let (ours, theirs) = (grid.cells() / common, SAMPLED / common);
        let nodes = (0..=common).flat_map(|j| (0..=common).map(move |i| (i, j)));
        let error = |(i, j): (usize, usize)| {
            y[grid.index(i * ours, j * ours)] - samples[j * theirs * (SAMPLED + 1) + i * theirs]
        };
        worst(nodes.map(error))
    }
}

/// The nodal vector at a point of the boundary, linear between nodes.
fn on_border(grid: Grid, y: &[f64], [x, z]: [f64; 2]) -> f64 {
    let n = grid.cells() as f64;
    let cell = |s: f64| {
        let place = ((s + 0.5) * n).clamp(0.0, n);
        let k = (place as usize).min(grid.cells() - 1);
        (k, place - k as f64)
    };
    let ((i, s), (j, t)) = (cell(x), cell(z));
    let at = |i: usize, j: usize| y[grid.index(i, j)];
    (1.0 - t) * ((1.0 - s) * at(i, j) + s * at(i + 1, j))
        + t * ((1.0 - s) * at(i, j + 1) + s * at(i + 1, j + 1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_on_the_boundary_are_linear_between_nodes() {
        let grid = Grid::new(4).unwrap();
        let y: Vec<f64> = (0..25).map(|k| f64::from(k % 5) + 10.0 * f64::from(k / 5)).collect();
        assert_eq!(on_border(grid, &y, [-0.125, -0.5]), 1.5);
        assert_eq!(on_border(grid, &y, [0.5, 0.5]), 44.0);
    }

    #[test]
    fn the_errors_of_zero_are_the_norms_of_the_solution() {
        let f = "quadrant(ll)=6; else=-4";
        let known = KnownSolution::spectral("k", f, SpectralParams::default()).unwrap();
        let solution = known.solution().unwrap();
        // The multiplier does no work on v.
        let size = (-2.0 * solution.energy).sqrt();
        let multiplier: f64 =
            solution.border().map(|p| p.weight * p.multiplier * p.multiplier).sum();
        for n in [8, 24, 256] {
            let grid = Grid::new(n).unwrap();
            let zero = vec![0.0; grid.nodes()];
            let Errors { l2, h1, max, multiplier_l2 } = known.errors(grid, &zero, &zero);
            assert_eq!(l2, None);
            assert!((h1 - size).abs() < 1e-12, "{h1} {size}");
            // The corner of the quadrant with f > 0.
            assert!((max - solution.corners()[3]).abs() < 1e-12, "{max}");
            let wrong = (multiplier_l2 / multiplier.sqrt() - 1.0).abs();
            assert!(wrong < 8.0 / (n * n) as f64, "{n}: {wrong}");
        }
    }
}
