//! Outcome of a solve on one grid.

use super::Pair;
use super::gradient::Extrema;
use crate::discrete::grid::Grid;
use crate::discrete::kkt::{Judgement, Kkt, judge};
use crate::discrete::stop::Stop;
use crate::discrete::verdict::Verdict;
use crate::problem::law::Law;
use serde::{Deserialize, Serialize};

/// Outcome of a solve on one grid: the end of the iteration and the quality of the last pair.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Outcome {
    /// Cells per side of the grid; of a mesh, the number of nodes.
    pub cells: usize,
    /// Steps of the multiplier done: the iterations of the paper.
    pub iterations: usize,
    /// Reason for the end. The stopping rules see the gradient of M alone; [`Outcome::kkt`] measures the solution.
    pub stop: Stop,
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
    /// Residual of the Karush-Kuhn-Tucker conditions, the measure common to all solvers.
    pub kkt: Kkt,
    /// Sum over the boundary nodes of y times the gradient of the energy: zero at the solution.
    pub work: f64,
    /// True if the discrete problem has a solution: a part of the boundary is fixed, or the flux can balance the load.
    /// None under the paper's law without fixed parts, where it has one if the sum of the load is negative.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub has_solution: Option<bool>,
}

/// State of an iteration after its last step.
pub(super) struct LastStep {
    /// Steps of the multiplier done.
    pub(super) iterations: usize,
    /// Last change of the multiplier.
    pub(super) delta_a: f64,
    /// Extrema of the gradient (8) at the last pair.
    pub(super) gradient: Extrema,
    /// Reason for the end.
    pub(super) stop: Stop,
}

impl Outcome {
    /// Judges `pair` after the last step of an iteration.
    pub(super) fn judge(grid: Grid, law: Law, load: &[f64], pair: &Pair, last: &LastStep) -> Self {
        let Judgement { kkt, energy, work, .. } = judge(grid, law, &pair.y, load);
        let sum_load = load.iter().sum();
        let reported = [energy, last.gradient.absolute, kkt.natural, kkt.min_lambda];
        let finite = reported.iter().all(|value| value.is_finite());
        Self {
            cells: grid.cells(),
            iterations: last.iterations,
            stop: if finite { last.stop } else { Stop::Diverged },
            gradient_signed: last.gradient.signed,
            gradient_abs: last.gradient.absolute,
            delta_a: last.delta_a,
            energy,
            sum_load,
            kkt,
            work,
            has_solution: (!law.is_signorini())
                .then(|| law.check_solvable(sum_load, Grid::PERIMETER).is_ok()),
        }
    }

    /// Verdict on the vector where the iteration ended.
    pub fn verdict(&self) -> Verdict {
        // A sum that is NaN is judged by the residual.
        let has_solution =
            self.has_solution.unwrap_or(self.sum_load < 0.0 || self.sum_load.is_nan());
        Verdict::new(has_solution, &self.kkt, self.energy, self.work)
    }

    /// Name of the end of the iteration: `stop`, unless the verdict is that there is no solution.
    pub fn end(&self) -> &'static str {
        self.verdict().end(self.stop)
    }
}
