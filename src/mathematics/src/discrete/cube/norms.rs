//! Errors of a discrete solution on the cube against a known one.

use rayon::prelude::*;

use super::Grid;
use crate::discrete::norms::Errors;
use crate::machine::simd::{Largest, vectorised};
use crate::problem::cube::{Exact, Sample};
use std::array::from_fn;

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
    let (side, mut max) = (grid.cells() + 1, Largest::default());
    let nodes: Vec<_> = (0..side).map(|i| problem.along(grid.coordinate(i))).collect();
    let mut wrong = vec![0.0; side];
    for (row, values) in y.chunks_exact(side).enumerate() {
        let across = [nodes[row % side], nodes[row / side]];
        vectorised(
            #[inline(always)]
            || {
                problem.in_row(
                    &nodes,
                    across,
                    #[inline(always)]
                    |i, exact| wrong[i] = values[i] - exact.value,
                );
                max.see(1.0, &wrong);
            },
        );
    }
    // Layers are summed in order, whatever thread did them.
    let layers: Vec<(f64, f64)> =
        (0..grid.cells()).into_par_iter().map(|k| layer_errors(grid, problem, y, k)).collect();
    let (l2, h1) = layers.iter().fold((0.0, 0.0), |sum, layer| (sum.0 + layer.0, sum.1 + layer.1));
    Errors { l2: l2.sqrt(), h1: h1.sqrt(), max: max.value() }
}

/// A point of the rule in a cell of the unit grid, and what the corners count in the trilinear function there.
struct PlaceInCube {
    inside: [f64; 3],
    /// Of the volume of the cell.
    weight: f64,
    /// The factors of each corner's share in the value, and its shares in the derivatives.
    factors: [[f64; 3]; 8],
    slopes: [[f64; 3]; 8],
}

impl PlaceInCube {
    fn new(at: [f64; 3], weight: f64, h: f64) -> Self {
        let inside = at.map(|t| 0.5 + 0.5 * t);
        let factor = |corner: usize, axis: usize| match ends(corner)[axis] {
            0 => 1.0 - inside[axis],
            _ => inside[axis],
        };
        let slope = |corner: usize, axis: usize| {
            let across = factor(corner, (axis + 1) % 3) * factor(corner, (axis + 2) % 3) / h;
            if ends(corner)[axis] == 0 { -across } else { across }
        };
        let each =
            |of: &dyn Fn(usize, usize) -> f64| from_fn(|corner| from_fn(|axis| of(corner, axis)));
        Self { inside, weight, factors: each(&factor), slopes: each(&slope) }
    }

    /// Squares of the errors of value and derivatives, from the values at the corners of the cell.
    #[inline(always)]
    fn errors(&self, exact: Sample, corners: [f64; 8]) -> [f64; 4] {
        let (mut value, mut slopes) = (0.0, [0.0; 3]);
        for ((v, [a, b, c]), shares) in corners.into_iter().zip(self.factors).zip(self.slopes) {
            value += v * a * b * c;
            for (slope, share) in slopes.iter_mut().zip(shares) {
                *slope += v * share;
            }
        }
        let [x, y, z] = exact.gradient;
        [exact.value - value, x - slopes[0], y - slopes[1], z - slopes[2]].map(|e| e * e)
    }
}

/// Squares of the L2 norms of the errors of value and gradient on the `k`-th layer of cells.
fn layer_errors(grid: Grid, problem: Exact, y: &[f64], k: usize) -> (f64, f64) {
    let (n, h) = (grid.cells(), grid.h());
    let at = |cell: usize, inside: f64| problem.along((cell as f64 + inside) * h - 0.5);
    let rule = quadrature().map(|(point, weight)| {
        let place = PlaceInCube::new(point, weight, h);
        let x: Vec<_> = (0..n).map(|i| at(i, place.inside[0])).collect();
        (place, x)
    });
    let (mut l2, mut h1) = (0.0, 0.0);
    let mut squares = vec![[[0.0; 4]; 14]; n];
    for j in 0..n {
        // Through the corners of the cells of a row, first in the plane below, those in front first.
        let rows: [&[f64]; 4] = from_fn(|row| {
            let first = ((k + row / 2) * (n + 1) + j + row % 2) * (n + 1);
            &y[first..][..n + 1]
        });
        for (p, (place, x)) in rule.iter().enumerate() {
            let across = [at(j, place.inside[1]), at(k, place.inside[2])];
            let (x, squares) = (&x[..n], &mut squares[..n]);
            vectorised(
                #[inline(always)]
                || {
                    problem.in_row(
                        x,
                        across,
                        #[inline(always)]
                        |i, exact| {
                            let [a, b, c, d] = rows;
                            let corners =
                                [a[i], a[i + 1], b[i], b[i + 1], c[i], c[i + 1], d[i], d[i + 1]];
                            squares[i][p] = place.errors(exact, corners);
                        },
                    );
                },
            );
        }
        for (square, (place, _)) in squares.iter().flat_map(|points| points.iter().zip(&rule)) {
            let [value, slopes @ ..] = square;
            l2 += h.powi(3) * place.weight * value;
            slopes.iter().for_each(|slope| h1 += h.powi(3) * place.weight * slope);
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
