//! Errors of a discrete solution against a known one.

use crate::discrete::grid::Grid;
use crate::discrete::stiffness::residual;
use crate::problem::exact::Exact;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// Errors of values and multiplier.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
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

/// Corners of a cell, counter-clockwise from the lower left one.
const CORNERS: [(usize, usize); 4] = [(0, 0), (1, 0), (1, 1), (0, 1)];

/// A point of the rule in the unit cell, and the shares of the corners in a value there.
#[derive(Clone, Copy, Default)]
struct Place {
    at: [f64; 2],
    share: [f64; 4],
    /// Of the area of the cell.
    weight: f64,
}

/// The points of the rule in both triangles of a cell, first those below the rising diagonal.
fn places() -> [[Place; 6]; 2] {
    [[0, 1, 2], [0, 2, 3]].map(|vertices| {
        let mut places = [Place::default(); 6];
        for (k, place) in places.iter_mut().enumerate() {
            let (large, small, weight) = QUADRATURE[k / 3];
            place.weight = 0.5 * weight;
            for (m, &vertex) in vertices.iter().enumerate() {
                let share = if m == k % 3 { large } else { small };
                place.share[vertex] = share;
                place.at[0] += share * CORNERS[vertex].0 as f64;
                place.at[1] += share * CORNERS[vertex].1 as f64;
            }
        }
        places
    })
}

/// The largest absolute value of some numbers; those that are NaN are passed over.
pub fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |largest, value| value.abs().max(largest))
}

/// Errors of the nodal vector `y` on triangles cut by rising diagonals; `load` gives the multiplier.
///
/// The sums are taken row by row, in the same order on any number of threads.
///
/// # Panics
/// If a slice is not of length `grid.nodes()`.
pub fn errors(grid: Grid, problem: Exact, y: &[f64], load: &[f64]) -> Errors {
    let (n, h) = (grid.cells(), grid.h());
    let at = |i: f64| i * h - 0.5;
    let places = places();
    let of_row = |j: usize| {
        let (mut l2, mut h1) = (0.0, 0.0);
        for i in 0..n {
            let value = CORNERS.map(|(di, dj)| y[grid.index(i + di, j + dj)]);
            let lower = [value[1] - value[0], value[2] - value[1]];
            let upper = [value[2] - value[3], value[3] - value[0]];
            for (triangle, slopes) in places.iter().zip([lower, upper]) {
                for place in triangle {
                    let (x, y) = (at(i as f64 + place.at[0]), at(j as f64 + place.at[1]));
                    let exact = problem.at(x, y);
                    let ours: f64 = place.share.iter().zip(value).map(|(s, v)| s * v).sum();
                    let wrong = |axis: usize| exact.gradient[axis] - slopes[axis] / h;
                    l2 += place.weight * (exact.value - ours).powi(2);
                    h1 += place.weight * (wrong(0).powi(2) + wrong(1).powi(2));
                }
            }
        }
        (l2, h1)
    };
    let rows: Vec<(f64, f64)> = (0..n).into_par_iter().map(of_row).collect();
    let (l2, h1) = rows.iter().fold((0.0, 0.0), |sum, row| (sum.0 + row.0, sum.1 + row.1));
    let max = max_error(grid, y, |x, y| problem.at(x, y).value);
    let multiplier_l2 =
        multiplier_error(grid, y, load, |[x, y], normal| problem.multiplier(x, y, normal));
    Errors { l2: h * l2.sqrt(), h1: h * h1.sqrt(), max, multiplier_l2 }
}

/// The error of `(A y - F) / h` as in [`Errors::multiplier_l2`]; `exact` gives `dv/dn` at a point of the
/// side with an outer normal.
///
/// # Panics
/// If a slice is not of length `grid.nodes()`.
pub fn multiplier_error(
    grid: Grid,
    y: &[f64],
    load: &[f64],
    exact: impl Fn([f64; 2], [f64; 2]) -> f64,
) -> f64 {
    let (n, h) = (grid.cells(), grid.h());
    let mut flux = vec![0.0; grid.nodes()];
    residual(grid, y, load, &mut flux);
    let at = |i: usize| i as f64 * h - 0.5;
    let mut square = 0.0;
    for k in 1..n {
        let sides =
            [(k, 0, [0.0, -1.0]), (n, k, [1.0, 0.0]), (k, n, [0.0, 1.0]), (0, k, [-1.0, 0.0])];
        for (i, j, normal) in sides {
            let exact = exact([at(i), at(j)], normal);
            square += h * (exact - flux[grid.index(i, j)] / h).powi(2);
        }
    }
    square.sqrt()
}

/// L2 norm of the nodal vector `y` with lumped mass: at least that of the piecewise linear function.
///
/// # Panics
/// If `y.len() != grid.nodes()`.
pub fn lumped(grid: Grid, y: &[f64]) -> f64 {
    assert_eq!(y.len(), grid.nodes());
    let n = grid.cells();
    let share = |i: usize| if i == 0 || i == n { 0.5 } else { 1.0 };
    let of_row = |(j, row): (usize, &[f64])| -> f64 {
        share(j) * row.iter().enumerate().map(|(i, value)| share(i) * value * value).sum::<f64>()
    };
    grid.h() * y.chunks_exact(n + 1).enumerate().map(of_row).sum::<f64>().sqrt()
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
