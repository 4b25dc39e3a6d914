//! End of an iteration, one for all solvers, and its judgement.

use super::kkt::{Judgement, Kkt};
use super::norms::sum;
use super::stop::Stop;
use super::verdict::Verdict;
use serde::{Deserialize, Serialize};

/// End of an iteration on one grid or mesh, as the solver knows it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct End {
    /// Steps of the multiplier, the iterations of the paper; cycles on the finest level; or linear systems, one for
    /// each contact set.
    pub iterations: usize,
    /// Work in Gauss-Seidel sweeps of this level: their number, where a method consists of them, else all visits of
    /// unknowns over the number of unknowns. Multiplications count as visits of as many unknowns as a sweep takes them
    /// for.
    pub work_units: f64,
    /// Reason for the end. A solver need not measure the solution; [`Outcome::kkt`] does.
    pub stop: Stop,
    /// Last change of the multiplier, the paper's Delta a, NaN if a value was no longer finite; none without steps of
    /// the multiplier.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub delta_a: Option<f64>,
}

impl End {
    /// End of a solver without levels that has reached its goal after so many iterations.
    pub(crate) fn converged(iterations: usize) -> Self {
        Self { iterations, work_units: 0.0, stop: Stop::Converged, delta_a: None }
    }

    /// True if the goal was reached.
    pub fn has_converged(&self) -> bool {
        self.stop == Stop::Converged
    }

    /// True if values are no longer finite.
    pub fn has_diverged(&self) -> bool {
        self.stop == Stop::Diverged
    }

    /// Number of Gauss-Seidel sweeps of a method that consists of them.
    pub fn sweeps(&self) -> usize {
        self.work_units as usize
    }

    /// The sweeps, if the goal was reached.
    pub fn count(&self) -> Option<usize> {
        (self.stop == Stop::Converged).then_some(self.sweeps())
    }

    /// Last change of the multiplier, NaN if there is none.
    pub fn change(&self) -> f64 {
        self.delta_a.unwrap_or(f64::NAN)
    }
}

/// End on one grid or mesh, and the judgement of the vector there.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Outcome {
    /// Cells per side of a uniform grid; none on a mesh.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cells: Option<usize>,
    /// Number of nodes.
    pub nodes: usize,
    /// End of the iteration.
    #[serde(flatten)]
    pub end: End,
    /// `max_i dM/dy_i` at the end, M the functional (7); none without steps of the multiplier.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gradient_signed: Option<f64>,
    /// `max_i |dM/dy_i|` at the end; none without steps of the multiplier.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gradient_abs: Option<f64>,
    /// `1/2 <A y, y> - <F, y>`, with the law's term.
    pub energy: f64,
    /// Least and greatest nodal value.
    pub range: [f64; 2],
    /// Sum of the load vector.
    pub sum_load: f64,
    /// Residual of the Karush-Kuhn-Tucker conditions, the measure common to all solvers.
    pub kkt: Kkt,
    /// Sum over the boundary nodes of y times the gradient of the energy, with the law's term: zero at the solution.
    pub work: f64,
    /// True if the discrete problem has a solution, see [`has_solution`](super::kkt::has_solution); under the paper's
    /// law without fixed parts, if the sum of the load is negative.
    pub has_solution: bool,
}

impl Outcome {
    /// End with this judgement, on a uniform grid with so many `cells` per side or on a mesh, where the discrete
    /// problem with this load vector has a solution or none.
    pub(crate) fn new(
        end: End,
        judgement: &Judgement,
        cells: Option<usize>,
        load: &[f64],
        has_solution: bool,
    ) -> Self {
        let &Judgement { kkt, energy, work, range, .. } = judgement;
        Self {
            cells,
            nodes: load.len(),
            end,
            gradient_signed: None,
            gradient_abs: None,
            energy,
            range,
            sum_load: sum(load),
            kkt,
            work,
            has_solution,
        }
    }

    /// Verdict on the vector where the iteration ended.
    pub fn verdict(&self) -> Verdict {
        Verdict::new(self.has_solution, &self.kkt, self.energy, self.work)
    }

    /// Verdict on whether this is what was asked for: the one judge of all solvers and commands. Where a bound is asked
    /// for, so that it `is_bounded`, it holds for any vector: residuals of single nodes do not contradict it, and a
    /// limit leaves a rough one.
    pub fn judged(&self, is_bounded: bool) -> Verdict {
        match (self.verdict(), self.end.stop) {
            (Verdict::NoSolution, _) => Verdict::NoSolution,
            (_, Stop::IterationLimit) if is_bounded => Verdict::Rough,
            (_, stop @ (Stop::IterationLimit | Stop::Diverged)) => Verdict::CutOff(stop),
            _ if is_bounded => Verdict::Solved,
            (verdict, Stop::Converged | Stop::RoundingFloor) => verdict,
        }
    }

    /// Name of the end: the verdict if the vector is no solution, else the reason of the solver.
    pub fn name(&self) -> &'static str {
        self.verdict().end(self.end.stop)
    }

    /// Name of the end of an answer for which a bound is asked, so that it `is_bounded`, as [`Outcome::judged`].
    pub fn name_of(&self, is_bounded: bool) -> &'static str {
        self.judged(is_bounded).end(self.end.stop)
    }

    /// Name of the level in a table: `1/64`, or on a mesh `833 nodes`.
    pub fn label(&self) -> String {
        self.cells.map_or_else(|| format!("{} nodes", self.nodes), |cells| format!("1/{cells}"))
    }
}
