//! Solvers whose cost is proportional to the number of unknowns, and the direct oracle.

pub mod active_set;
mod banded;
pub mod cube;
mod input;
mod network;
mod rows;
pub mod square;
mod stopping;

pub use input::InputError;

/// Why the iteration ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StopReason {
    /// The goal was reached; a tolerance was checked in full.
    Converged,
    /// Rounding errors prevent further progress.
    RoundingFloor,
    /// The limit on cycles or steps was not enough.
    CycleLimit,
    /// Numbers grew beyond all bounds.
    Diverged,
}

impl StopReason {
    /// The name used in answers.
    pub fn name(self) -> &'static str {
        match self {
            Self::Converged => "converged",
            Self::RoundingFloor => "rounding-floor",
            Self::CycleLimit => "cycle-limit",
            Self::Diverged => "diverged",
        }
    }
}
