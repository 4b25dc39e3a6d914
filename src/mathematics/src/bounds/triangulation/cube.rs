//! Bounds on the cube: those of Kuhn's triangulation, whose nodes are those of the grid.
//!
//! The matrix of the grid differs from that of the tetrahedra along the edges of the cube. So a solution on the grid
//! leaves a residual there, which the flux balances: the bounds hold, as for every vector.

use super::{BoundsError, bounds_on_mesh};
use crate::bounds::Bounds;
use crate::discrete::cube::Grid;
use crate::mesh::{MeshLoad, assemble, mesh_load, uniform_cube};
use crate::problem::cube::Source;
use crate::problem::law::Law;

/// Bounds on the cube.
#[derive(Clone, Debug, PartialEq)]
pub struct CubeBounds {
    /// Bounds, for v linear on each tetrahedron.
    pub bounds: Bounds,
    /// True if f is not constant on pieces, so that its means and deviations are those of a quadrature.
    pub by_quadrature: bool,
}

/// Returns bounds for the nodal vector `y` of a grid as an approximation of the solution for f under a law on the boundary.
/// Any vector may be given.
///
/// # Errors
/// As [`bounds_on_mesh`].
///
/// # Panics
/// If `y` has not one value for each node.
pub fn bounds_on_cube(
    grid: Grid,
    f: &Source,
    law: Law,
    y: &[f64],
) -> Result<CubeBounds, BoundsError> {
    let mesh = uniform_cube(grid);
    let MeshLoad { cells, unsettled, .. } =
        mesh_load(&mesh, f).map_err(|_| BoundsError::NotFinite)?;
    let bounds = bounds_on_mesh(&mesh, &assemble(&mesh), &cells, law, y)?;
    Ok(CubeBounds { bounds, by_quadrature: unsettled.is_some() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::discrete::cube::{exact_load, judge};
    use crate::multigrid::{MultigridParams, solve_cube};
    use crate::problem::cube::Exact;
    use crate::problem::law::Law;

    fn grid(n: usize) -> Grid {
        Grid::new(n).unwrap()
    }

    /// Solution on a grid.
    fn solved(n: usize, f: &Source) -> Vec<f64> {
        let load = exact_load(grid(n), f);
        let problem = Law::SIGNORINI.with_load(&load);
        solve_cube(n, problem, None, &MultigridParams::default()).unwrap().0
    }

    #[test]
    fn brackets_of_known_solutions_hold_their_energies() {
        for exact in Exact::ALL {
            let f = Source::Exact(exact);
            // Half the integral of f times the solution, by the midpoint rule.
            let points = grid(64);
            let (mut energy, h) = (0.0, points.h());
            for at in points.indices().filter(|at| at.iter().all(|&i| i < 64)) {
                let point = at.map(|i| points.coordinate(i) + 0.5 * h);
                energy -= 0.5 * h.powi(3) * f.at(point) * exact.at(point).value;
            }
            let errors = [8, 16].map(|n| {
                let found = bounds_on_cube(grid(n), &f, Law::SIGNORINI, &solved(n, &f)).unwrap();
                let [low, high] = found.bounds.energy;
                assert!(low < energy && energy < high, "{exact:?} {n}: {low} {energy} {high}");
                assert!(found.by_quadrature);
                found.bounds.error[1]
            });
            let ratio = errors[0] / errors[1];
            assert!((ratio - 2.0).abs() < 0.1, "{exact:?}: {ratio}");
        }
    }

    #[test]
    fn brackets_of_all_grids_hold_one_energy() {
        let mut widths = Vec::new();
        for k in 0..6 {
            let value = |place: f64| libm::sin(17.0 * f64::from(k) + place) - 0.3;
            let (a, b, c) = (value(1.0) * 5.0, value(2.0) * 3.0, value(3.0).abs() + 3.5);
            let text = format!(
                "box(-0.5,0,-0.5,0.25,0,0.5)={a}; box(0,0.25,-0.25,0.5,-0.5,0.5)={b}; else=-{c}"
            );
            let f: Source = text.parse().unwrap();
            let (mut lowest, mut highest) = (f64::NEG_INFINITY, f64::INFINITY);
            for n in [4, 8, 16] {
                let y = solved(n, &f);
                let found = bounds_on_cube(grid(n), &f, Law::SIGNORINI, &y).unwrap();
                assert!(!found.by_quadrature);
                let [low, high] = found.bounds.energy;
                (lowest, highest) = (low.max(lowest), high.min(highest));
                // The energies of grid and tetrahedra differ by what the edges contribute.
                let energy = judge(grid(n), Law::SIGNORINI, &y, &exact_load(grid(n), &f)).energy;
                assert!((energy - high).abs() < 0.2 * (high - low), "{n}: {energy} {low} {high}");
            }
            assert!(lowest <= highest, "{text}: {lowest} {highest}");
            widths.push((highest - lowest) / -highest);
        }
        assert!(widths.iter().all(|width| *width < 0.1), "{widths:?}");
    }
}
