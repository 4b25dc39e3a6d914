//! How a solve on one grid ended, and whether what it ended with is a solution.

use super::Pair;
use super::stopping::StopReason;
use crate::discrete::grid::Grid;
use crate::discrete::kkt::{Kkt, kkt};
use crate::discrete::stiffness::{energy, residual};
use serde::{Deserialize, Serialize};

/// How a solve on one grid ended, and where.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Outcome {
    /// Cells per side of the grid.
    pub cells: usize,
    /// Steps of the multiplier done: the iterations of the paper.
    pub iterations: usize,
    /// Why they ended. What the stopping rule says is not checked here: see [`Outcome::checked`].
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

/// Share of its own terms by which an optimality condition may fail in what counts as a solution.
const ALLOWED: f64 = 0.1;

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

    /// Why the run ended, `converged` only if y passes for a solution by measures of its own.
    ///
    /// The stopping rules see the gradient of M alone. It is small, too, where y drifts through huge values
    /// with no node in contact, and where no solution exists. So this asks for a negative sum of F; for
    /// an energy not above that of v = 0; and for the four optimality conditions: `A y = F` inside,
    /// `A y - F >= 0` and `y >= 0` on the boundary, `<A y - F, y> = 0`. Each may fail by a tenth of its own
    /// terms, the first two and the last also by what components of the size of `tolerance` make.
    ///
    /// # Panics
    /// If a slice has the wrong length for `grid`.
    pub fn checked(&self, grid: Grid, load: &[f64], pair: &Pair, tolerance: f64) -> StopReason {
        if self.stop != StopReason::Converged {
            return self.stop;
        }
        let largest = |v: &[f64]| v.iter().fold(0.0, |worst: f64, x| worst.max(x.abs()));
        let dot = |a: &[f64]| a.iter().zip(&pair.y).map(|(a, y)| a * y).sum::<f64>();
        let mut flux = vec![0.0; grid.nodes()];
        residual(grid, &pair.y, load, &mut flux);
        let of_load = (ALLOWED * largest(load)).max(tolerance);
        let of_work = (ALLOWED * dot(load).abs())
            .max(tolerance * pair.y.iter().map(|y| y.abs()).sum::<f64>());
        let holds = self.sum_load < 0.0
            && self.energy <= 0.0
            && self.kkt.stationarity <= of_load
            && self.kkt.min_lambda * grid.h() >= -of_load
            && self.kkt.min_y >= -ALLOWED * largest(&pair.y)
            && dot(&flux).abs() <= of_work;
        if holds { StopReason::Converged } else { StopReason::NotASolution }
    }
}
