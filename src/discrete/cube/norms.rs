//! Errors of a discrete solution on the cube against a known one.

use rayon::prelude::*;

use super::Grid;
use crate::problem::cube::Exact;

/// Errors of values and gradients.
#[derive(Clone, Copy, Debug)]
pub struct Errors {
    /// L2 norm of `v - v_h`, `v_h` trilinear.
    pub l2: f64,
    /// L2 norm of `grad (v - v_h)`.
    pub h1: f64,
    /// Largest error at a node.
    pub max: f64,
}

/// Points in the cell (-1, 1)^3 and weights, of its volume, of a rule exact for polynomials of degree 5
/// (Hammer and Stroud 1958): degree 3 would get the constants of L2 wrong.
fn quadrature() -> [([f64; 3], f64); 14] {
    let (face, corner) = ((19.0 / 30.0_f64).sqrt(), (19.0 / 33.0_f64).sqrt());
    std::array::from_fn(|k| {
        let sign = |bit: usize| if bit == 0 { -1.0 } else { 1.0 };
        match k {
            0..6 => {
                let mut point = [0.0; 3];
                point[k / 2] = sign(k % 2) * face;
                (point, 40.0 / 361.0)
            }
            _ => ([0, 1, 2].map(|axis| sign((k - 6) >> axis & 1) * corner), 121.0 / 2888.0),
        }
    })
}

/// Errors of the nodal vector `y`.
///
/// # Panics
/// If `y.len() != grid.nodes()`.
pub fn errors(grid: Grid, problem: Exact, y: &[f64]) -> Errors {
    assert_eq!(y.len(), grid.nodes());
    let mut max = 0.0_f64;
    for (value, indices) in y.iter().zip(grid.indices()) {
        let error = (value - problem.at(indices.map(|i| grid.coordinate(i))).value).abs();
        max = if error > max || error.is_nan() { error } else { max };
    }
    // Layers are summed in order, whatever thread did them.
    let layers: Vec<(f64, f64)> =
        (0..grid.cells()).into_par_iter().map(|k| layer_errors(grid, problem, y, k)).collect();
    let (l2, h1) = layers.iter().fold((0.0, 0.0), |sum, layer| (sum.0 + layer.0, sum.1 + layer.1));
    Errors { l2: l2.sqrt(), h1: h1.sqrt(), max }
}

/// Squares of the L2 norms of the errors of value and gradient on the `k`-th layer of cells.
fn layer_errors(grid: Grid, problem: Exact, y: &[f64], k: usize) -> (f64, f64) {
    let (n, h) = (grid.cells(), grid.h());
    let rule = quadrature();
    let (mut l2, mut h1) = (0.0, 0.0);
    for (j, i) in (0..n).flat_map(|j| (0..n).map(move |i| (j, i))) {
        let corners: [f64; 8] = std::array::from_fn(|corner| {
            let [di, dj, dk] = ends(corner);
            y[((k + dk) * (n + 1) + j + dj) * (n + 1) + i + di]
        });
        let cell = [i, j, k];
        for (at, weight) in &rule {
            let inside = at.map(|t| 0.5 + 0.5 * t);
            let exact =
                problem.at([0, 1, 2].map(|axis| (cell[axis] as f64 + inside[axis]) * h - 0.5));
            let (mut value, mut slopes) = (0.0, [0.0; 3]);
            for (corner, v) in corners.iter().enumerate() {
                let ends = ends(corner);
                let share = |axis: usize| match ends[axis] {
                    0 => 1.0 - inside[axis],
                    _ => inside[axis],
                };
                value += v * share(0) * share(1) * share(2);
                for axis in 0..3 {
                    let across = share((axis + 1) % 3) * share((axis + 2) % 3) / h;
                    slopes[axis] += if ends[axis] == 0 { -v * across } else { v * across };
                }
            }
            l2 += h.powi(3) * weight * (exact.value - value).powi(2);
            for (gradient, slope) in exact.gradient.iter().zip(slopes) {
                h1 += h.powi(3) * weight * (gradient - slope).powi(2);
            }
        }
    }
    (l2, h1)
}

/// Along each axis, at which end of a cell its corner of this number is.
fn ends(corner: usize) -> [usize; 3] {
    [corner & 1, corner >> 1 & 1, corner >> 2]
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn the_error_of_zero_is_the_norm_of_the_solution() {
        let grid = Grid::new(16).unwrap();
        let Errors { l2, h1, max } = errors(grid, Exact::FullContact, &vec![0.0; 17 * 17 * 17]);
        assert!((l2 - 0.125f64.sqrt()).abs() < 1e-6, "{l2}");
        assert!((h1 - PI * (3.0 / 8.0f64).sqrt()).abs() < 1e-4, "{h1}");
        assert_eq!(max, 1.0);
    }

    #[test]
    fn the_rule_is_exact_for_degree_5_and_l2_is_that_of_the_function() {
        let moment = |powers: [i32; 3]| -> f64 {
            let term = |(p, w): &([f64; 3], f64)| {
                w * (0..3).map(|axis| p[axis].powi(powers[axis])).product::<f64>()
            };
            quadrature().iter().map(term).sum()
        };
        for (powers, want) in [
            ([0, 0, 0], 1.0),
            ([2, 0, 0], 1.0 / 3.0),
            ([0, 4, 0], 1.0 / 5.0),
            ([2, 0, 2], 1.0 / 9.0),
            ([1, 0, 0], 0.0),
            ([0, 3, 1], 0.0),
        ] {
            assert!((moment(powers) - want).abs() < 1e-14, "{powers:?}");
        }
        // The interpolant of a known solution is exact at the nodes, but not between them.
        let grid = Grid::new(8).unwrap();
        let value = |at: [usize; 3]| Exact::FullContact.at(at.map(|i| grid.coordinate(i))).value;
        let y: Vec<f64> = grid.indices().map(value).collect();
        let Errors { l2, max, .. } = errors(grid, Exact::FullContact, &y);
        assert!(max == 0.0 && l2 > 1e-4, "{max} {l2}");
    }
}
