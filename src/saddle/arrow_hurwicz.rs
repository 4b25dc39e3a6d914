//! The paper's method (9)-(12): one Gauss-Seidel sweep for y, one projected gradient step for a, in turn.
//!
//! Idea: Uzawa's algorithm minimises over y before each step of the multiplier; this one sweeps once.
//! Requirements: r > 0; a load vector with negative sum, or no saddle point exists.
//! Reference: N. N. Maksimova, equations (7)-(13); the misprints are mended as the report says.

use super::Pair;
use super::gradient::DualStep;
use super::stopping::{StopReason, StopRule};
use super::sweep::sweep;
use crate::discrete::grid::Grid;
use crate::discrete::kkt::{Kkt, kkt};
use crate::discrete::stiffness::energy;
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
    let stopping = (params.rule, params.tolerance);
    let mut dual = DualStep::new(grid, load, params.r, stopping, pair);
    let stop = loop {
        if dual.iterations == params.max_iterations {
            break StopReason::IterationLimit;
        }
        sweep(grid, load, 0.0, params.r, &mut pair.y, &pair.a);
        if let ControlFlow::Break(stop) = dual.step(pair, &mut monitor) {
            break stop;
        }
    };
    Outcome::at(grid, pair, dual, stop)
}

impl Outcome {
    /// What is to be said of `pair` after the last step.
    pub(super) fn at(grid: Grid, pair: &Pair, mut dual: DualStep, stop: StopReason) -> Self {
        let (load, iterations, delta_a) = (dual.load, dual.iterations, dual.delta_a);
        let (gradient_signed, gradient_abs) = dual.gradient.extrema(load, pair);
        let (energy, kkt) = (energy(grid, &pair.y, load), kkt(grid, &pair.y, load));
        let finite =
            [energy, gradient_abs, kkt.natural, kkt.min_lambda].iter().all(|v| v.is_finite());
        let stop = if finite { stop } else { StopReason::Diverged };
        Self {
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
}
