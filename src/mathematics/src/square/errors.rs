//! Errors of a nodal vector of a grid against a known solution.

use crate::discrete::grid::Grid;
use crate::discrete::kkt::judge;
use crate::discrete::norms::Errors;
use crate::machine::simd::{Largest, vectorised};
use crate::machine::threads::map_range;
use crate::problem::exact::{Exact, Sample};
use crate::problem::law::Law;

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
struct PlaceInCell {
    at: [f64; 2],
    share: [f64; 4],
    /// Of the area of the cell.
    weight: f64,
}

impl PlaceInCell {
    /// Squares of the errors of value and gradient, from the values at the corners of the cell.
    #[inline(always)]
    fn errors(&self, exact: Sample, value: [f64; 4], upper: bool, h: f64) -> [f64; 2] {
        let slopes = match upper {
            false => [value[1] - value[0], value[2] - value[1]],
            true => [value[2] - value[3], value[3] - value[0]],
        };
        let [a, b, c, d] = self.share;
        let ours = a * value[0] + b * value[1] + c * value[2] + d * value[3];
        let wrong = exact.value - ours;
        let [x, y] = [0, 1].map(|axis: usize| exact.gradient[axis] - slopes[axis] / h);
        [wrong * wrong, x * x + y * y]
    }
}

/// The points of the rule in both triangles of a cell, first those below the rising diagonal.
fn places() -> [[PlaceInCell; 6]; 2] {
    [[0, 1, 2], [0, 2, 3]].map(|vertices| {
        let mut places = [PlaceInCell::default(); 6];
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

/// Errors of the nodal vector `y` on triangles cut by rising diagonals.
///
/// The sums are taken row by row, in the same order on any number of threads.
///
/// # Panics
/// If `y.len() != grid.nodes()`.
pub fn errors(grid: Grid, problem: Exact, y: &[f64]) -> Errors {
    let (n, h) = (grid.cells(), grid.h());
    let at = |i: f64| i * h - 0.5;
    // The points of the rule in a row of cells, place by place.
    let points = places().map(|triangle| {
        triangle.map(|place| {
            let of_cell = |i: usize| problem.along(at(i as f64 + place.at[0]));
            (place, (0..n).map(of_cell).collect::<Vec<_>>())
        })
    });
    let of_row = |j: usize| {
        let [low, high] = [j, j + 1].map(|j| &y[j * grid.side()..][..n + 1]);
        let (mut l2, mut h1) = (vec![0.0; n], vec![0.0; n]);
        for (upper, triangle) in points.iter().enumerate() {
            for (place, x) in triangle {
                let y = problem.along(at(j as f64 + place.at[1]));
                let (x, l2, h1) = (&x[..n], &mut l2[..n], &mut h1[..n]);
                vectorised(
                    #[inline(always)]
                    || {
                        problem.in_row(
                            x,
                            y,
                            #[inline(always)]
                            |i, exact| {
                                let value = [low[i], low[i + 1], high[i + 1], high[i]];
                                let [value_error, slope_error] =
                                    place.errors(exact, value, upper == 1, h);
                                l2[i] += place.weight * value_error;
                                h1[i] += place.weight * slope_error;
                            },
                        );
                    },
                );
            }
        }
        (l2.iter().sum::<f64>(), h1.iter().sum::<f64>())
    };
    let rows: Vec<(f64, f64)> = map_range(0..n, 1, of_row);
    let (l2, h1) = rows.iter().fold((0.0, 0.0), |sum, row| (sum.0 + row.0, sum.1 + row.1));
    let nodes: Vec<_> = (0..=n).map(|i| problem.along(grid.coordinate(i))).collect();
    let (mut max, mut wrong) = (Largest::default(), vec![0.0; n + 1]);
    for (row, &at) in y.chunks_exact(n + 1).zip(&nodes) {
        let (row, wrong) = (&row[..n + 1], &mut wrong[..n + 1]);
        vectorised(
            #[inline(always)]
            || {
                problem.in_row(
                    &nodes[..n + 1],
                    at,
                    #[inline(always)]
                    |i, exact| wrong[i] = row[i] - exact.value,
                );
                max.see(1.0, wrong);
            },
        );
    }
    Errors { l2: h * l2.sqrt(), h1: h * h1.sqrt(), max: max.value(), multiplier_l2: None }
}

/// L2 norm on the boundary of `dv/dn - (A y - F) / h`, by the trapezoidal rule without the corners, where
/// the normal derivative is not defined; `exact` gives `dv/dn` at a point of the side with an outer normal.
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
    let flux = judge((grid, Law::SIGNORINI), y, load).flux;
    let at = |i: usize| i as f64 * h - 0.5;
    let mut square = 0.0;
    for k in 1..n {
        let sides = [
            ([k, 0], [0.0, -1.0]),
            ([n, k], [1.0, 0.0]),
            ([k, n], [0.0, 1.0]),
            ([0, k], [-1.0, 0.0]),
        ];
        for ([i, j], normal) in sides {
            let exact = exact([at(i), at(j)], normal);
            square += h * (exact - flux[grid.boundary_index(i, j)] / h).powi(2);
        }
    }
    square.sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{PI, SQRT_2};

    #[test]
    fn the_error_of_zero_is_the_norm_of_the_solution() {
        let zero = vec![0.0; 17 * 17];
        let Errors { l2, h1, max, .. } = errors(Grid::new(16).unwrap(), Exact::FullContact, &zero);
        // Integrals of cos^2 cos^2 and 2 pi^2 sin^2 cos^2 over the square.
        assert!((l2 - 0.5).abs() < 1e-5, "{l2}");
        assert!((h1 - PI / SQRT_2).abs() < 1e-4, "{h1}");
        assert_eq!(max, 1.0);
    }
}
