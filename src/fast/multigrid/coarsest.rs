//! Direct solution on the coarsest grid.

use super::level::Level;

/// Active-set steps on the coarsest grid; it has at most a few dozen boundary nodes.
const MAX_STEPS: usize = 60;

/// Solves `(A + springs) y = F` with `y = 0` at the nodes in contact, by banded Cholesky.
pub(super) fn solve_linear(level: &mut Level) {
    let n = level.n;
    let (width, size) = (n + 1, level.nodes());
    // Row k holds the entries (k, k - band ..= k) of the lower triangle.
    let (band, stride) = (width, width + 1);
    let mut lower = vec![0.0; size * stride];
    let mut x = vec![0.0; size];
    for j in 0..=n {
        for i in 0..=n {
            let k = j * width + i;
            x[k] = level.load_at(i, j);
            lower[k * stride + band] = 4.0;
            if i > 0 {
                lower[k * stride + band - 1] = if j == 0 || j == n { -0.5 } else { -1.0 };
            }
            if j > 0 {
                lower[k * stride] = if i == 0 || i == n { -0.5 } else { -1.0 };
            }
        }
    }
    Level::for_each_boundary_node(n, |p, i, j| {
        let k = j * width + i;
        let inverse = level.inverse_diagonal[p];
        if inverse > 0.0 {
            lower[k * stride + band] = 1.0 / inverse;
            return;
        }
        x[k] = 0.0;
        lower[k * stride..(k + 1) * stride].fill(0.0);
        lower[k * stride + band] = 1.0;
        for (other, exists) in [(k + 1, i < n), (k + width, j < n)] {
            if exists {
                lower[other * stride + band - (other - k)] = 0.0;
            }
        }
    });
    for row in 0..size {
        let first = row.saturating_sub(band);
        for column in first..=row {
            let from = first.max(column.saturating_sub(band));
            let known: f64 = (from..column)
                .map(|m| {
                    lower[row * stride + band + m - row]
                        * lower[column * stride + band + m - column]
                })
                .sum();
            let at = row * stride + band + column - row;
            let rest = lower[at] - known;
            lower[at] =
                if column < row { rest / lower[column * stride + band] } else { rest.sqrt() };
        }
        let known: f64 = (first..row).map(|m| lower[row * stride + band + m - row] * x[m]).sum();
        x[row] = (x[row] - known) / lower[row * stride + band];
    }
    for row in (0..size).rev() {
        let known: f64 = (row + 1..size.min(row + band + 1))
            .map(|m| lower[m * stride + band + row - m] * x[m])
            .sum();
        x[row] = (x[row] - known) / lower[row * stride + band];
    }
    for j in 0..=n {
        for i in 0..=n {
            level.set_value(i, j, x[j * width + i]);
        }
    }
}

/// Solves the Signorini problem of the coarsest grid by the primal-dual active set method.
///
/// The matrix is an M-matrix, for which the method converges from any start (Hintermüller, Ito and
/// Kunisch 2002, theorem 3.2); starting from full contact it never meets a singular system, because the
/// node with the largest multiplier is kept when all others leave.
pub(super) fn solve_obstacle(level: &mut Level) {
    let n = level.n;
    level.inverse_diagonal = vec![0.0; 4 * n];
    for _ in 0..MAX_STEPS {
        solve_linear(level);
        let mut next = vec![0.0; 4 * n];
        let mut changed = false;
        let (mut largest, mut keep) = (f64::NEG_INFINITY, 0);
        Level::for_each_boundary_node(n, |p, i, j| {
            let (residual, diagonal) = level.boundary_residual(i, j);
            let was_active = level.inverse_diagonal[p] == 0.0;
            let active = if was_active { residual <= 0.0 } else { level.value(i, j) < 0.0 };
            if was_active && -residual > largest {
                (largest, keep) = (-residual, p);
            }
            changed |= active != was_active;
            next[p] = if active { 0.0 } else { 1.0 / diagonal };
        });
        if !changed {
            break;
        }
        if next.iter().all(|&inverse| inverse > 0.0) {
            next[keep] = 0.0;
        }
        level.inverse_diagonal = next;
    }
    Level::for_each_boundary_node(n, |_, i, j| {
        let value = level.value(i, j).max(0.0);
        level.set_value(i, j, value);
    });
}
