//! End of an iteration, its judgement, and the verdict on the vector: a solution, a rough one, or none.
//!
//! One rule for all solvers and commands. The verdict reads the conditions of the solution, not the stopping rule,
//! which may hold far from the solution.

use super::kkt::{Judgement, Kkt};
use super::norms::sum;
use crate::problem::text::plain;
use serde::{Deserialize, Serialize};
use std::fmt;

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
    /// Sum over the boundary nodes of the flux times the values of the laws: the energy of a solution less this is
    /// minus half of `<A y, y>`. None where all of these values are zero.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub of_values: Option<f64>,
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
        let &Judgement { kkt, energy, of_values, work, range, .. } = judgement;
        Self {
            cells,
            nodes: load.len(),
            end,
            gradient_signed: None,
            gradient_abs: None,
            energy,
            of_values,
            range,
            sum_load: sum(load),
            kkt,
            work,
            has_solution,
        }
    }

    /// Verdict on the vector where the iteration ended.
    pub fn verdict(&self) -> Verdict {
        Verdict::new(self.has_solution, &self.kkt, (self.energy, self.of_values), self.work)
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

/// Reason for which a solver ended; none is an error.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Stop {
    /// The stopping rule was met, or the goal was reached.
    Converged,
    /// Rounding errors prevent further progress.
    RoundingFloor,
    /// The limit on iterations, sweeps, cycles or steps was reached first.
    IterationLimit,
    /// Values became infinite or NaN, or residuals grew by a factor of 1e12.
    Diverged,
}

impl Stop {
    /// Name in artifacts and answers.
    pub fn name(self) -> &'static str {
        match self {
            Self::Converged => "converged",
            Self::RoundingFloor => "rounding-floor",
            Self::IterationLimit => "iteration-limit",
            Self::Diverged => "diverged",
        }
    }
}

impl fmt::Display for Stop {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(self.name())
    }
}

/// Largest relative KKT residual, and largest sum of v r over the size of the energy, of what may be called a
/// solution: above, half of the load is out of balance.
const SOLVED: f64 = 0.5;
/// Largest relative KKT residual of a solution that is not [`Verdict::Rough`].
const ROUGH: f64 = 0.1;

/// Verdict on a nodal vector.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Verdict {
    /// The flux through the boundary cannot balance the load vector, so that the discrete problem has no solution;
    /// under the paper's law, since it sums to a non-negative number.
    NoSolution,
    /// The conditions of the solution are violated.
    NotSolved(Violation),
    /// The solver was cut off by its limit, or its values are not finite.
    CutOff(Stop),
    /// A solution with a relative KKT residual of more than a tenth.
    Rough,
    /// A solution.
    Solved,
}

/// Condition that a nodal vector violates by too much to be a solution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Violation {
    /// The relative KKT residual is this large, or not a number.
    Residual(f64),
    /// The energy, this one, is above that of v = 0.
    Energy(f64),
    /// The sum over the boundary of v r, r the gradient of the energy, and of the law's term is not small beside the
    /// energy.
    Work {
        /// This sum, zero at the solution.
        work: f64,
        /// Energy.
        energy: f64,
    },
}

impl Verdict {
    /// Judges a nodal vector of a problem that has a solution or none by its `kkt`, its energy, with the part of it
    /// that the values of the laws make, and its `work`, which is the sum of v r over the boundary, r the gradient of
    /// the energy, with the law's term.
    pub fn new(
        has_solution: bool,
        kkt: &Kkt,
        (energy, of_values): (f64, Option<f64>),
        work: f64,
    ) -> Self {
        if !has_solution {
            Self::NoSolution
        } else if kkt.relative.is_nan() || kkt.relative > SOLVED {
            Self::NotSolved(Violation::Residual(kkt.relative))
        } else if energy > 0.0 && of_values.is_none() {
            Self::NotSolved(Violation::Energy(energy))
        } else if work.abs() > SOLVED * (energy - of_values.unwrap_or(0.0)).abs() {
            Self::NotSolved(Violation::Work { work, energy })
        } else if kkt.relative > ROUGH {
            Self::Rough
        } else {
            Self::Solved
        }
    }

    /// True if the vector is no solution.
    pub fn is_failure(self) -> bool {
        matches!(self, Self::NoSolution | Self::NotSolved(_) | Self::CutOff(_))
    }

    /// Name of the end of a solve whose solver reports the reason `stop`: `no-solution` or `not-solved` takes its
    /// place, but a limit that cut an iteration off stays a limit if the problem has a solution.
    pub fn end(self, stop: Stop) -> &'static str {
        match self {
            Self::NoSolution => "no-solution",
            Self::NotSolved(_) if stop != Stop::IterationLimit => "not-solved",
            _ => stop.name(),
        }
    }
}

impl fmt::Display for Violation {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Residual(relative) => {
                write!(out, "the KKT residual is {relative:.2} of the load")
            }
            Self::Energy(energy) => {
                write!(out, "the energy {} is above that of v = 0", plain(*energy, 4))
            }
            Self::Work { work, energy } => {
                let [work, energy] = [work, energy].map(|number| plain(*number, 4));
                write!(out, "the sum of v r is {work}, beside an energy of {energy}")
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kkt(relative: f64) -> Kkt {
        let none = 0.0;
        Kkt {
            stationarity: none,
            min_y: None,
            min_lambda: None,
            complementarity: none,
            natural: relative,
            relative,
        }
    }

    #[test]
    fn each_condition_has_its_verdict() {
        let verdict = |sum: f64, relative, energy, work| {
            Verdict::new(sum < 0.0, &kkt(relative), (energy, None), work)
        };
        assert_eq!(verdict(-1.0, 1e-12, -1.0, 0.0), Verdict::Solved);
        assert_eq!(verdict(-1.0, 0.2, -1.0, 0.0), Verdict::Rough);
        assert_eq!(verdict(0.0, 1e-12, -1.0, 0.0), Verdict::NoSolution);
        for (relative, energy, work) in
            [(0.6, -1.0, 0.0), (f64::NAN, -1.0, 0.0), (0.0, 1.0, 0.0), (0.0, -1.0, -0.6)]
        {
            let verdict = verdict(-1.0, relative, energy, work);
            assert!(matches!(verdict, Verdict::NotSolved(_)), "{verdict:?}");
            assert_eq!(verdict.end(Stop::Converged), "not-solved");
            assert_eq!(verdict.end(Stop::IterationLimit), "iteration-limit");
        }
        assert_eq!(Verdict::NoSolution.end(Stop::IterationLimit), "no-solution");
        assert_eq!(Verdict::Rough.end(Stop::Converged), "converged");
    }
}
