//! Direct solution on the coarsest grid.

use super::level::Level;
use crate::multigrid::banded::Banded;

/// Active-set steps on the coarsest grid; it has at most a few dozen boundary nodes.
const MAX_STEPS: usize = 60;

/// Multiplications per visit of an unknown.
const STENCIL: f64 = 5.0;

/// Solves `(A + springs) y = F` with `y = 0` at the nodes in contact, by banded Cholesky; returns the work
/// in visits of unknowns.
pub(super) fn solve_linear(level: &mut Level) -> f64 {
    let n = level.n;
    let (width, size) = (n + 1, level.nodes());
    let mut matrix = Banded::zeros(size, width);
    let mut x = vec![0.0; size];
    for j in 0..=n {
        for i in 0..=n {
            let k = j * width + i;
            x[k] = level.load_at(i, j);
            *matrix.entry(k, k) = 4.0;
            if i > 0 {
                *matrix.entry(k, k - 1) = if j == 0 || j == n { -0.5 } else { -1.0 };
            }
            if j > 0 {
                *matrix.entry(k, k - width) = if i == 0 || i == n { -0.5 } else { -1.0 };
            }
        }
    }
    Level::for_each_boundary_node(n, |p, i, j| {
        let k = j * width + i;
        let inverse = level.inverse_diagonal[p];
        if inverse > 0.0 {
            *matrix.entry(k, k) = 1.0 / inverse;
        } else {
            x[k] = 0.0;
            matrix.fix(k);
        }
    });
    matrix.factor();
    matrix.solve(&mut x);
    for j in 0..=n {
        for i in 0..=n {
            level.set_value(i, j, x[j * width + i]);
        }
    }
    (matrix.factor_work() + matrix.solve_work()) / STENCIL
}

/// Solves the Signorini problem of the coarsest grid by the primal-dual active set method.
///
/// Starting from full contact it never meets a singular system, because the node with the largest
/// multiplier is kept when all others leave; see [`active_set`](crate::multigrid::active_set) on
/// convergence. Returns the work in visits of unknowns.
pub(super) fn solve_obstacle(level: &mut Level) -> f64 {
    let n = level.n;
    level.inverse_diagonal = vec![0.0; 4 * n];
    let mut work = 0.0;
    for _ in 0..MAX_STEPS {
        work += solve_linear(level);
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
    work
}
