//! Verdict on a nodal vector that a solver returned: a solution, a rough one, or none.
//!
//! One rule for all solvers and commands. It reads the conditions of the solution, not the stopping rule, which may
//! hold far from the solution.

use super::kkt::Kkt;
use super::stop::Stop;
use crate::problem::text::plain;
use std::fmt;

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
    /// Judges a nodal vector of a problem that has a solution or none by its `kkt`, its `energy`, and its `work`, which
    /// is the sum of v r over the boundary, r the gradient of the energy, with the law's term.
    pub fn new(has_solution: bool, kkt: &Kkt, energy: f64, work: f64) -> Self {
        if !has_solution {
            Self::NoSolution
        } else if kkt.relative.is_nan() || kkt.relative > SOLVED {
            Self::NotSolved(Violation::Residual(kkt.relative))
        } else if energy > 0.0 {
            Self::NotSolved(Violation::Energy(energy))
        } else if work.abs() > SOLVED * energy.abs() {
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
            Verdict::new(sum < 0.0, &kkt(relative), energy, work)
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
