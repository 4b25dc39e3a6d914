//! Errors of a discrete solution on the cube against a known one.

use rayon::prelude::*;

use super::Grid;
use crate::problem::cube::Exact;

/// Errors of values and gradients.
#[derive(Clone, Copy, Debug)]
pub struct Errors {
    /// L2 norm of `v - v_h` by the trapezoidal rule, from the nodes alone.
    pub l2: f64,
    /// L2 norm of `grad (v - v_h)`, `v_h` trilinear, by the two-point Gauss rule along each axis.
    pub h1: f64,
    /// Largest error at a node.
    pub max: f64,
}

/// Errors of the nodal vector `y`.
///
/// # Panics
/// If `y.len() != grid.nodes()`.
pub fn errors(grid: Grid, problem: Exact, y: &[f64]) -> Errors {
    assert_eq!(y.len(), grid.nodes());
    let volume = grid.h().powi(3);
    let (mut l2, mut max) = (0.0, 0.0_f64);
    for (value, indices) in y.iter().zip(grid.indices()) {
        let error = value - problem.at(indices.map(|i| grid.coordinate(i))).value;
        l2 += volume * grid.share(indices) * error * error;
        max = if error.abs() > max || error.is_nan() { error.abs() } else { max };
    }
    // Planes are summed in order, whatever thread did them.
    let planes: Vec<f64> =
        (0..grid.cells()).into_par_iter().map(|k| gradient_errors(grid, problem, y, k)).collect();
    Errors { l2: l2.sqrt(), h1: planes.iter().sum::<f64>().sqrt(), max }
}

/// Square of the L2 norm of the error of the gradient on the `k`-th layer of cells.
fn gradient_errors(grid: Grid, problem: Exact, y: &[f64], k: usize) -> f64 {
    let (n, h) = (grid.cells(), grid.h());
    let gauss = [0.5 - 0.5 / 3f64.sqrt(), 0.5 + 0.5 / 3f64.sqrt()];
    let mut sum = 0.0;
    for (j, i) in (0..n).flat_map(|j| (0..n).map(move |i| (j, i))) {
        let corner = |d: [usize; 3]| y[((k + d[2]) * (n + 1) + j + d[1]) * (n + 1) + i + d[0]];
        for number in 0..8 {
            let inside = [number & 1, number >> 1 & 1, number >> 2].map(|digit| gauss[digit]);
            let point = [i, j, k];
            let point = [0, 1, 2].map(|d| (point[d] as f64 + inside[d]) * h - 0.5);
            let exact = problem.at(point).gradient;
            for axis in 0..3 {
                let others = [(axis + 1) % 3, (axis + 2) % 3];
                let mut slope = 0.0;
                for (a, b) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                    let weight = |d: usize, end: usize| {
                        if end == 1 { inside[d] } else { 1.0 - inside[d] }
                    };
                    let (mut from, mut to) = ([0; 3], [0; 3]);
                    (from[others[0]], to[others[0]]) = (a, a);
                    (from[others[1]], to[others[1]]) = (b, b);
                    to[axis] = 1;
                    let difference = corner(to) - corner(from);
                    slope += weight(others[0], a) * weight(others[1], b) * difference / h;
                }
                sum += h * h * h / 8.0 * (exact[axis] - slope) * (exact[axis] - slope);
            }
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn the_error_of_zero_is_the_norm_of_the_solution() {
        let grid = Grid::new(16).unwrap();
        let Errors { l2, h1, max } = errors(grid, Exact::FullContact, &vec![0.0; 17 * 17 * 17]);
        assert!((l2 - 0.125f64.sqrt()).abs() < 1e-12, "{l2}");
        assert!((h1 - PI * (3.0 / 8.0f64).sqrt()).abs() < 1e-4, "{h1}");
        assert_eq!(max, 1.0);
    }
}
