//! Full multigrid for the scalar Signorini problem on the unit cube, at optimal cost.
//!
//! # Idea
//! As on the square (see [`multigrid`](crate::multigrid::square)): projected red-black Gauss-Seidel on the
//! finest grid, truncation of the nodes in contact, a linear coarse-grid correction of the others. What is
//! particular here is how coarse grids see the contact set: by the current it draws (see `contact.rs`).
//! The convergence rate is then that of multigrid for the Poisson equation, about 0.1, down to contact in
//! a single node; up to 0.3 for sets scattered over single nodes.
//!
//! # Method
//! Nested iteration from the coarsest grid, one cycle per grid, more only where the contact set of a
//! coarse grid is far off; loads of the coarse grids by full weighting. Trilinear transfers, one sweep
//! before and one after each correction, over-relaxed inside (Yavneh 1996). Coarse grids see two
//! corrections per correction of the grid above, each costing an eighth of the one before. With four cells
//! per side two contact sets may take turns (in 12 of 20 000 random problems); half a correction ends that.
//!
//! # Cost
//! Values and loads of all grids, 18.3 bytes per unknown, plus rounding of rows to cache lines, three planes of
//! residuals for each thread, and what is kept for the boundary. A *work unit* is one projected Gauss-Seidel sweep
//! of the finest grid, counted by visits of unknowns on all grids: a half-sweep 1/2, residual and
//! restriction of one colour 3/4, interpolation to one colour 1/4, restriction of a load 1/2, a check of
//! all optimality conditions 1, boundary loops by their size, direct solutions by their multiplications,
//! of which a visit has as many as its stencil.

mod contact;
mod surface;
mod transfer;

use super::hierarchy::{Geometry, Multigrid};
use super::input::InputError;
use super::layout::Dimension;
use super::level::Level;
use super::{MultigridParams, Outcome};

/// The unit cube.
pub struct Cube;

impl Dimension for Cube {
    const AXES: usize = 3;
}

impl Geometry for Cube {
    const CELLS: &str = "a power of two (at least 2), or three times one";
    const RELAXATION: f64 = 1.25;
    const COARSE_RELAXATION: f64 = 1.25;
    const OVERCORRECTION: f64 = 1.0;
    const TWICE_BELOW: usize = 1;
    const W_CYCLE: bool = true;

    fn coarsest(n: usize) -> Option<usize> {
        let odd = n.checked_shr(n.trailing_zeros())?;
        (n.is_multiple_of(2) && matches!(odd, 1 | 3)).then_some(2 * odd)
    }

    fn set_springs(n: usize, in_contact: &[bool], levels: &mut [Level]) -> f64 {
        contact::set_springs(n, in_contact, levels)
    }

    fn allocated(n: usize) -> Result<Multigrid<Self>, InputError> {
        Multigrid::allocate(n)
    }

    fn solved(
        grids: &mut Multigrid<Self>,
        load: &[f64],
        start: Option<&[f64]>,
        params: &MultigridParams,
    ) -> Result<Outcome, InputError> {
        grids.run(load, start, params)
    }
}
