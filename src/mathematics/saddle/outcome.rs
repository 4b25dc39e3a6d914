//! How a solve on one grid ended.

use super::Pair;
use super::stopping::StopReason;
use crate::discrete::grid::Grid;
use crate::discrete::kkt::{Judgement, Kkt, judge};
use serde::{Deserialize, Serialize};

/// How a solve on one grid ended, and where.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Outcome {
    /// Cells per side of the grid.
    pub cells: usize,
    /// Steps of the multiplier done: the iterations of the paper.
    pub iterations: usize,
    /// Why they ended. The stopping rules see the gradient of M alone; see [`Outcome::kkt`].
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

impl Outcome {
    /// What is to be said of `pair` after the last step, with the extrema of the gradient (8) there.
    pub(super) fn at(
        grid: Grid,
        load: &[f64],
        pair: &Pair,
        (iterations, delta_a): (usize, f64),
        (gradient_signed, gradient_abs): (f64, f64),
        stop: StopReason,
    ) -> Self {
        let Judgement { kkt, energy, .. } = judge(grid, &pair.y, load);
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
