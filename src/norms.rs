//! Norms of the error of a nodal vector against a known function.

use crate::grid::Grid;

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
