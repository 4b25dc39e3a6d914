//! Reason for which a solver ended, one for all solvers.

use serde::{Deserialize, Serialize};
use std::fmt;

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
