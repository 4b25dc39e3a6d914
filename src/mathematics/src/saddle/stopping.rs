//! Stopping rules: criterion (13) as printed, without its absolute value as in the tables, and each with a dual bound.

use serde::{Deserialize, Serialize};
use std::fmt;

/// Measure of the gradient (8), evaluated at (y^(n), a^(n)), that must fall below the tolerance.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum StopRule {
    /// `max_i dM/dy_i`, without absolute value: the rule that reproduces the published counts.
    #[default]
    Signed,
    /// `max_i |dM/dy_i|`: (13) as printed.
    Printed,
    /// The signed rule, and `max_i |a_i^(n) - a_i^(n-1)|` below the tolerance as well.
    SignedDual,
    /// The printed rule, and the change of the multiplier below the tolerance as well.
    PrintedDual,
}

impl StopRule {
    /// All rules.
    pub const ALL: [Self; 4] = [Self::Signed, Self::Printed, Self::SignedDual, Self::PrintedDual];

    /// Name in scenes and artifacts.
    pub fn name(self) -> &'static str {
        match self {
            Self::Signed => "signed",
            Self::Printed => "printed",
            Self::SignedDual => "signed-dual",
            Self::PrintedDual => "printed-dual",
        }
    }

    pub(super) fn is_printed(self) -> bool {
        matches!(self, Self::Printed | Self::PrintedDual)
    }

    pub(super) fn asks_dual(self) -> bool {
        matches!(self, Self::SignedDual | Self::PrintedDual)
    }
}

impl fmt::Display for StopRule {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(self.name())
    }
}

/// Reason for the end of an iteration; none is an error.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum StopReason {
    /// The stopping rule was met.
    Converged,
    /// The cap on iterations was hit first.
    IterationLimit,
    /// A component of y or a, or a measure of the pair, is infinite or NaN.
    Diverged,
}

impl StopReason {
    /// The name used in artifacts and answers.
    pub fn name(self) -> &'static str {
        match self {
            Self::Converged => "converged",
            Self::IterationLimit => "iteration-limit",
            Self::Diverged => "diverged",
        }
    }
}

impl fmt::Display for StopReason {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(self.name())
    }
}
