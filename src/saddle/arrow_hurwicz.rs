//! The paper's method (9)-(12): one Gauss-Seidel sweep for y, one projected gradient step for a, in turn.
//!
//! Idea: Uzawa's algorithm minimises over y before each step of the multiplier; this one sweeps once.
//! Requirements: r > 0; a load vector with negative sum, or no saddle point exists.
//! Reference: N. N. Maksimova, equations (7)-(13); the misprints are mended as the report says.

use super::Pair;
use super::stopping::{StopReason, StopRule};
use super::sweep::sweep;
use crate::grid::Grid;
use crate::kkt::{Kkt, kkt};
use crate::stiffness::{energy, residual_row};
use serde::{Deserialize, Serialize};
use std::ops::ControlFlow;

/// What the iteration needs besides grid and load vector.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Params {
    /// Duality parameter r > 0, the step of the multiplier.
    pub r: f64,
    /// Bound of the stopping rule; the paper takes 10^-N on grid N.
    pub tolerance: f64,
    /// Which stopping rule.
    pub rule: StopRule,
    /// Iterations after which to give up.
    pub max_iterations: usize,
}

impl Default for Params {
    fn default() -> Self {
        Self { r: 1.0, tolerance: 1e-5, rule: StopRule::Signed, max_iterations: 1_000_000 }
    }
}

/// What the monitor sees after each iteration.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Iteration {
    /// Iterations done on this grid.
    pub number: usize,
    /// `max_i dM/dy_i` at (y^(n), a^(n)).
    pub gradient_signed: f64,
    /// `max_i |dM/dy_i|` there.
    pub gradient_abs: f64,
    /// `max_i |a_i^(n) - a_i^(n-1)|`.
    pub delta_a: f64,
}

/// Called after each iteration; a break ends the run.
pub type OnIteration<'a> = &'a mut dyn FnMut(&Iteration) -> ControlFlow<()>;

/// How a solve on one grid ended, and where.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Outcome {
    /// Cells per side of the grid.
    pub cells: usize,
    /// Iterations done.
    pub iterations: usize,
    /// Why they ended.
    pub stop: StopReason,
    /// `max_i dM/dy_i` at the end.
    pub gradient_signed: f64,
    /// `max_i |dM/dy_i|` at the end.
    pub gradient_abs: f64,
    /// Last change of the multiplier, the paper's Delta a.
    pub delta_a: f64,
    /// `1/2 <A y, y> - <F, y>`.
    pub energy: f64,
    /// Sum of the load vector; the discrete problem is solvable only if it is negative.
    pub sum_load: f64,
    /// The measure common to all solvers.
    pub kkt: Kkt,
}

/// Iterates on `pair` in place until the rule is met, the cap is hit, or the monitor breaks.
///
/// Without a monitor the residuals are only compared with the tolerance, row by row until one
/// exceeds it; with one they are computed in full. The iterates are the same.
///
/// # Panics
/// If a slice has the wrong length for `grid`, or `params.r` is not positive.
pub fn arrow_hurwicz(
    grid: Grid,
    load: &[f64],
    params: &Params,
    pair: &mut Pair,
    mut monitor: Option<OnIteration>,
) -> Outcome {
    assert!(params.r > 0.0, "the duality parameter r must be positive");
    assert!(load.len() == grid.nodes() && pair.y.len() == grid.nodes());
    assert!(pair.a.len() == grid.boundary_nodes());
    let boundary: Vec<usize> = grid.boundary().collect();
    let mut gradient = Gradient { grid, load, r: params.r, row: vec![0.0; grid.side()], failed: 0 };
    let (mut iterations, mut delta_a) = (0, 0.0);
    let stop = loop {
        if iterations == params.max_iterations {
            break StopReason::IterationLimit;
        }
        iterations += 1;
        sweep(grid, load, params.r, &mut pair.y, &pair.a);
        delta_a = match dual_step(&boundary, params.r, &pair.y, &mut pair.a) {
            Some(change) => change,
            None => break StopReason::Diverged,
        };
        if let Some(monitor) = monitor.as_mut() {
            let (gradient_signed, gradient_abs) = gradient.extrema(pair);
            let iteration =
                Iteration { number: iterations, gradient_signed, gradient_abs, delta_a };
            if monitor(&iteration).is_break() {
                break StopReason::Interrupted;
            }
        }
        if (!params.rule.asks_dual() || delta_a <= params.tolerance)
            && gradient.within(pair, params.tolerance, params.rule.is_printed())
        {
            break StopReason::Converged;
        }
    };
    let (gradient_signed, gradient_abs) = gradient.extrema(pair);
    let (energy, kkt) = (energy(grid, &pair.y, load), kkt(grid, &pair.y, load));
    let finite = [energy, gradient_abs, kkt.natural, kkt.min_lambda].iter().all(|v| v.is_finite());
    let stop = if finite { stop } else { StopReason::Diverged };
    Outcome {
        cells: grid.cells(),
        iterations,
        stop,
        gradient_signed,
        gradient_abs,
        delta_a,
        energy,
        sum_load: load.iter().sum(),
        kkt,
    }
}

/// `a <- (a - r y)^+` (12); the largest change, or `None` if a value is no longer finite.
fn dual_step(boundary: &[usize], r: f64, y: &[f64], a: &mut [f64]) -> Option<f64> {
    let (mut change, mut finite) = (0.0f64, true);
    for (a, &node) in a.iter_mut().zip(boundary) {
        let next = *a - r * y[node];
        finite &= next.is_finite();
        let next = if next > 0.0 { next } else { 0.0 };
        change = change.max((next - *a).abs());
        *a = next;
    }
    finite.then_some(change)
}

/// The gradient (8) of the modified functional with respect to y, evaluated row by row.
struct Gradient<'a> {
    grid: Grid,
    load: &'a [f64],
    r: f64,
    row: Vec<f64>,
    /// Row that failed the last comparison: the likeliest to fail the next.
    failed: usize,
}

impl Gradient<'_> {
    fn evaluate(&mut self, j: usize, pair: &Pair) {
        let (grid, n) = (self.grid, self.grid.cells());
        residual_row(grid, j, &pair.y, self.load, &mut self.row);
        let y = &pair.y[j * grid.side()..];
        let pull = |b: usize, i: usize| grid.h() * (pair.a[b] - self.r * y[i]).max(0.0);
        if j == 0 {
            (0..=n).for_each(|i| self.row[i] -= pull(i, i));
        } else if j == n {
            (0..=n).for_each(|i| self.row[i] -= pull(3 * n - i, i));
        } else {
            self.row[0] -= pull(4 * n - j, 0);
            self.row[n] -= pull(n + j, n);
        }
    }

    /// Whether every component, or its absolute value, is at most `tolerance`; NaN never is.
    fn within(&mut self, pair: &Pair, tolerance: f64, absolute: bool) -> bool {
        let side = self.grid.side();
        let first = self.failed;
        for k in 0..side {
            let j = (first + k) % side;
            self.evaluate(j, pair);
            // No early exit inside a row, so that the comparison vectorises.
            let ok = if absolute {
                self.row.iter().fold(true, |ok, g| ok & (g.abs() <= tolerance))
            } else {
                self.row.iter().fold(true, |ok, g| ok & (*g <= tolerance))
            };
            if !ok {
                self.failed = j;
                return false;
            }
        }
        true
    }

    /// Largest component and largest absolute value; NaN if any component is.
    fn extrema(&mut self, pair: &Pair) -> (f64, f64) {
        let (mut signed, mut absolute) = (f64::NEG_INFINITY, 0.0);
        for j in 0..self.grid.side() {
            self.evaluate(j, pair);
            for &g in &self.row {
                if g.is_nan() {
                    return (f64::NAN, f64::NAN);
                }
                signed = signed.max(g);
                absolute = g.abs().max(absolute);
            }
        }
        (signed, absolute)
    }
}
