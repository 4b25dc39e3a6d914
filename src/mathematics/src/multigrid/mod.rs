//! Multigrid for the scalar Signorini problem on the square and on the cube, and the direct method that checks it.
//!
//! # Algorithm
//! 1. Check the load, scale it by a power of two, and restrict it to every coarser grid by full weighting (`load.rs`).
//! 2. Solve the problem of the coarsest grid directly (`coarsest.rs`).
//! 3. Nested iteration (`cycle.rs`): interpolate the solution to the next finer grid and apply one cycle there, or
//!    more if the residual is still large; repeat up to the finest grid.
//! 4. Apply cycles on the finest grid until the goal is reached (`stopping.rs`). One cycle on a problem under the law:
//!    1. Find the boundary nodes in contact, and the springs by which coarser grids represent them
//!       (`square/contact.rs`, `cube/contact.rs`).
//!    2. Restrict the residual of the nodes that are not in contact (`transfer.rs`).
//!    3. Solve the linear correction problem recursively, by an F- or W-cycle.
//!    4. Add the interpolated correction, put the boundary nodes whose values changed sign at zero, and smooth
//!       by red-black Gauss-Seidel sweeps (`stencil.rs`).
//!
//! All half-sweeps and transfers between two visits to the coarser grid are one *pass* over the memory (`pass.rs`).
//! The central function is `find_correction` in `cycle.rs`. [`square`] and [`cube`] give the theory, the cost and the
//! references.
//!
//! # Easily broken
//! - Results are compared by hash between machines and numbers of threads: neither the order of additions nor the
//!   order of half-sweeps may change.
//! - Loops gain from vector instructions only if each function between `vectorised` and the loop is inlined: keep
//!   `#[inline(always)]`.
//! - Each pass must begin with a half-sweep or a transfer that does not read the red values, and a restriction must
//!   follow an exact half-sweep over the black nodes.

pub mod active_set;
mod banded;
mod blocks;
mod buffers;
mod coarsest;
pub mod cube;
mod cycle;
pub(crate) mod direct;
mod geometry;
mod hierarchy;
pub(crate) mod input;
mod layout;
mod level;
mod load;
mod pass;
mod rows;
pub mod square;
mod stencil;
mod stopping;
mod transfer;
mod workspace;

pub use input::InputError;
pub(crate) use stopping::ROUNDING_FLOOR;
pub use workspace::{Multigrid, solve_cube, solve_square};

use crate::discrete::stop::Stop;
use serde::{Deserialize, Serialize};

/// Goal at which multigrid stops.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Goal {
    /// Algebraic error at most a tenth of the discretisation error in the energy norm. One cycle on the finest grid
    /// is nearly always enough.
    DiscretisationError,
    /// Upper limit of `max(max_interior |A y - F|, max_boundary |min(y, A y - F)|)`, not relative: in the units of
    /// the load, those of f h^2.
    Kkt(f64),
    /// Smallest residual that double precision allows.
    RoundingFloor,
}

/// Parameters of multigrid.
#[derive(Clone, Debug)]
pub struct MultigridParams {
    /// Goal at which the iteration stops.
    pub goal: Goal,
    /// Limit on the number of cycles on the finest grid.
    pub max_cycles: usize,
}

impl Default for MultigridParams {
    fn default() -> Self {
        Self { goal: Goal::RoundingFloor, max_cycles: 60 }
    }
}

/// Result of multigrid without the solution itself.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct MultigridOutcome {
    /// Reason for which the iteration ended.
    pub stop: Stop,
    /// Number of cycles on the finest grid.
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
