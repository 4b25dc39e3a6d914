//! Full multigrid for the scalar Signorini problem on the unit square, at optimal cost.
//!
//! # Idea
//! The finest grid is smoothed by projected red-black Gauss-Seidel; then the boundary nodes in contact
//! are *truncated* and the others get a linear coarse-grid correction (Kornhuber 1994; Gräser and
//! Kornhuber 2009; Gräser, Sack and Sander 2009; the projected scheme goes back to Brandt and Cryer
//! 1983). What is particular here is how coarse grids see the contact set: not as a set of nodes but
//! as intervals whose ends lie between nodes, through springs (see `contact.rs`). The convergence
//! rate is then that of multigrid for the Poisson equation, down to contact in a single node.
//!
//! # Method
//! Nested iteration from the coarsest grid, one cycle per grid, more only where the contact set of a
//! coarse grid is far off; loads of the coarse grids by full weighting. Cycles V(1,1), bilinear
//! transfers, over-relaxation inside on the colour that the transfers do not rely on (Yavneh 1996 for
//! over-relaxed red-black smoothing). From the third coarser grid on, F-cycles: near-constant modes of
//! semicoercive problems need accurate coarse solves, and there they cost almost nothing; from the second
//! on where only the discretisation error is asked for, since that cycle is often the only one. What a V-cycle
//! returns is too small, and enlarged where it reaches the finest grid (Brandt and Yavneh 1993 enlarge
//! the residual); that halves the rate, to 0.04 per cycle, at no cost.
//!
//! # Cost
//! Values and loads of all grids, 21.3 bytes per unknown, plus rounding of rows to cache lines: 21.5 in
//! all at h = 1/4096, 22.4 at 1/512. A *work unit* is one projected Gauss-Seidel sweep of the finest
//! grid, counted by visits of unknowns on all grids: a half-sweep 1/2, residual and restriction of one
//! colour 3/4, interpolation to one colour 1/4, restriction of a load 1/2, a check of all optimality
//! conditions 1, boundary loops by their size, direct solutions by their multiplications, of which a
//! visit has as many as its stencil. Reordering the input is not counted.
//!
//! # References
//! - A. Brandt, C. W. Cryer, Multigrid algorithms for the solution of linear complementarity problems
//!   arising from free boundary problems, SIAM J. Sci. Stat. Comput. 4 (1983).
//! - A. Brandt, I. Yavneh, Accelerated multigrid convergence and high-Reynolds recirculating flows, SIAM
//!   J. Sci. Comput. 14 (1993).
//! - R. Kornhuber, Monotone multigrid methods for elliptic variational inequalities I, Numer. Math. 69
//!   (1994).
//! - C. Gräser, R. Kornhuber, Multigrid methods for obstacle problems, J. Comput. Math. 27 (2009).
//! - C. Gräser, U. Sack, O. Sander, Truncated nonsmooth Newton multigrid methods for convex minimization
//!   problems, Domain Decomposition Methods XVIII (2009).
//! - I. Yavneh, On red-black SOR smoothing in multigrid, SIAM J. Sci. Comput. 17 (1996).

mod contact;
mod transfer;

use super::hierarchy::{Geometry, Multigrid};
use super::input::InputError;
use super::layout::Dimension;
use super::level::Level;
use super::{MultigridParams, Outcome};

/// The unit square.
pub struct Square;

impl Dimension for Square {
    const AXES: usize = 2;
}

impl Geometry for Square {
    const CELLS: &str = "a power of two (at least 2) times 1, 3, 5 or 7";
    const RELAXATION: f64 = 1.15;
    const COARSE_RELAXATION: f64 = 1.45;
    /// Corrections from a V-cycle fall short by up to a tenth where the wavelength is a few cells of the
    /// coarser grid; enlarged by this factor they err to both sides alike.
    const OVERCORRECTION: f64 = 1.08;
    const TWICE_BELOW: usize = 3;
    const W_CYCLE: bool = false;

    fn coarsest(n: usize) -> Option<usize> {
        let odd = n.checked_shr(n.trailing_zeros())?;
        // Four cells per side are solved directly, which is cheaper than going down to two.
        let coarsest = if odd == 1 { n.min(4) } else { 2 * odd };
        (n.is_multiple_of(2) && matches!(odd, 1 | 3 | 5 | 7)).then_some(coarsest)
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
