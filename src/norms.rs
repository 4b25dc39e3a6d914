//! Errors of a discrete solution against a known one.

use crate::exact::Exact;
use crate::grid::Grid;
use crate::stiffness::residual;

/// Errors of values and multiplier.
#[derive(Clone, Copy, Debug)]
pub struct Errors {
    /// L2 norm of `v - v_h`, `v_h` piecewise linear.
    pub l2: f64,
    /// L2 norm of `grad (v - v_h)`.
    pub h1: f64,
    /// Largest error at a node.
    pub max: f64,
    /// L2 norm on the boundary of `dv/dn - (A y - F) / h`, by the trapezoidal rule without the corners,
    /// where the normal derivative is not defined.
    pub multiplier_l2: f64,
}

/// Barycentric coordinates (one number, then twice the other) and weights of a rule on a triangle,
/// exact for polynomials of degree 4 (Dunavant 1985): degree 2 would get the constants of L2 wrong.
const QUADRATURE: [(f64, f64, f64); 2] = [
    (0.108_103_018_168_070, 0.445_948_490_915_965, 0.223_381_589_678_011),
    (0.816_847_572_980_459, 0.091_576_213_509_771, 0.109_951_743_655_322),
];

/// Errors of the nodal vector `y` on triangles cut by rising diagonals; `load` gives the multiplier.
///
/// # Panics
/// If a slice is not of length `grid.nodes()`.
pub fn errors(grid: Grid, problem: Exact, y: &[f64], load: &[f64]) -> Errors {
    let (n, h) = (grid.cells(), grid.h());
    let mut flux = vec![0.0; grid.nodes()];
    residual(grid, y, load, &mut flux);
    let at = |i: f64| i * h - 0.5;
    let node = |i: usize, j: usize| y[j * (n + 1) + i];
    let (mut l2, mut h1) = (0.0, 0.0);
    for (i, j) in (0..n).flat_map(|j| (0..n).map(move |i| (i, j))) {
        let corner = [(0, 0), (1, 0), (1, 1), (0, 1)];
        let value = corner.map(|(di, dj)| node(i + di, j + dj));
        let lower = [value[1] - value[0], value[2] - value[1]];
        let upper = [value[2] - value[3], value[3] - value[0]];
        for (vertices, slopes) in [([0, 1, 2], lower), ([0, 2, 3], upper)] {
            for (large, small, weight) in QUADRATURE {
                for k in 0..3 {
                    let share = |m: usize| if m == k { large } else { small };
                    let mean = |of: &dyn Fn(usize) -> f64| -> f64 {
                        vertices.iter().enumerate().map(|(m, &vertex)| share(m) * of(vertex)).sum()
                    };
                    let x = at(i as f64 + mean(&|vertex| f64::from(corner[vertex].0 as u8)));
                    let y = at(j as f64 + mean(&|vertex| f64::from(corner[vertex].1 as u8)));
                    let exact = problem.at(x, y);
                    let area = 0.5 * h * h;
                    l2 += area * weight * (exact.value - mean(&|vertex| value[vertex])).powi(2);
                    let wrong = |axis: usize| exact.gradient[axis] - slopes[axis] / h;
                    h1 += area * weight * (wrong(0).powi(2) + wrong(1).powi(2));
                }
            }
        }
    }
    let max = max_error(grid, y, |x, y| problem.at(x, y).value);
    let mut multiplier = 0.0;
    for k in 1..n {
        let sides =
            [(k, 0, [0.0, -1.0]), (n, k, [1.0, 0.0]), (k, n, [0.0, 1.0]), (0, k, [-1.0, 0.0])];
        for (i, j, normal) in sides {
            let exact = problem.multiplier(at(i as f64), at(j as f64), normal);
            multiplier += h * (exact - flux[grid.index(i, j)] / h).powi(2);
        }
    }
    Errors { l2: f64::sqrt(l2), h1: f64::sqrt(h1), max, multiplier_l2: f64::sqrt(multiplier) }
}

/// The greatest `|y_i - v(M_i)|` over the nodes; NaN if any value is.
///
/// # Panics
/// If `y.len() != grid.nodes()`.
pub fn max_error(grid: Grid, y: &[f64], v: impl Fn(f64, f64) -> f64) -> f64 {
    assert_eq!(y.len(), grid.nodes());
    let mut worst = 0.0f64;
    for (k, value) in y.iter().enumerate() {
        let (i, j) = (k % grid.side(), k / grid.side());
        let error = (value - v(grid.coordinate(i), grid.coordinate(j))).abs();
        worst = if error <= worst { worst } else { error };
        if worst.is_nan() {
            break;
        }
    }
    worst
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{PI, SQRT_2};

    #[test]
    fn the_error_of_zero_is_the_norm_of_the_solution() {
        let zero = vec![0.0; 17 * 17];
        let Errors { l2, h1, max, .. } =
            errors(Grid::new(16).unwrap(), Exact::FullContact, &zero, &zero);
        // Integrals of cos^2 cos^2 and 2 pi^2 sin^2 cos^2 over the square.
        assert!((l2 - 0.5).abs() < 1e-5, "{l2}");
        assert!((h1 - PI / SQRT_2).abs() < 1e-4, "{h1}");
        assert_eq!(max, 1.0);
    }

    #[test]
    fn worst_node_counts_and_nan_is_not_hidden() {
        let grid = Grid::new(2).unwrap();
        let mut y: Vec<f64> = (0..9).map(|k| grid.coordinate(k % 3)).collect();
        assert_eq!(max_error(grid, &y, |x, _| x), 0.0);
        y[5] += 0.25;
        assert_eq!(max_error(grid, &y, |x, _| x), 0.25);
        y[1] = f64::NAN;
        assert!(max_error(grid, &y, |x, _| x).is_nan());
    }
}
