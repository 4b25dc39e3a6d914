//! Solvers whose cost is proportional to the number of unknowns, and the direct oracle.

pub mod active_set;
mod banded;
mod blocks;
mod buffers;
mod coarsest;
pub mod cube;
mod cycle;
mod hierarchy;
mod input;
mod layout;
mod level;
mod load;
mod network;
mod pass;
mod rows;
pub mod square;
mod stencil;
mod stopping;
mod transfer;

pub use hierarchy::{Geometry, Multigrid, solve};
pub use input::InputError;
pub(crate) use stopping::FLOOR;

use serde::{Deserialize, Serialize};

/// Why the iteration ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
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

/// When to stop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Goal {
    /// Algebraic error at most a tenth of the discretisation error in the energy norm: one cycle on the finest
    /// grid, seldom two.
    DiscretisationError,
    /// `max(max_interior |A y - F|, max_boundary |min(y, A y - F)|)` at most this number (units of the
    /// load, that is of f h^2; not relative).
    Kkt(f64),
    /// As far as double precision goes.
    RoundingFloor,
}

/// Parameters of multigrid.
#[derive(Clone, Debug)]
pub struct MultigridParams {
    /// When to stop.
    pub goal: Goal,
    /// Limit on the cycles on the finest grid.
    pub max_cycles: usize,
}

impl Default for MultigridParams {
    fn default() -> Self {
        Self { goal: Goal::RoundingFloor, max_cycles: 60 }
    }
}

/// Result without the solution itself.
#[derive(Clone, Copy, Debug)]
pub struct Outcome {
    /// Why it ended.
    pub stop: StopReason,
    /// Cycles on the finest grid.
    pub cycles: usize,
    /// Natural residual of the solution, not relative: in the units of the load.
    pub kkt: f64,
    /// Work in sweeps of the finest grid.
    pub work_units: f64,
}

#[cfg(test)]
mod tests {
    use super::pass::tests::compare;

    #[test]
    fn vector_instructions_do_not_change_a_bit() {
        compare::<super::square::Square>(32);
        compare::<super::square::Square>(36);
        compare::<super::square::Square>(128);
        compare::<super::cube::Cube>(12);
    }
}
