//! Full multigrid for the scalar Signorini problem on the unit square, at optimal cost.
//!
//! # Idea
//! The finest grid is smoothed by projected red-black Gauss-Seidel sweeps. Boundary nodes in contact are then
//! *truncated*, that is excluded from the correction, and the other nodes get a linear coarse-grid correction
//! (Kornhuber 1994; Gräser and Kornhuber 2009; Gräser, Sack and Sander 2009; the projected scheme is due to Brandt and
//! Cryer 1983). New here is the representation of the contact set on coarse grids: not as a set of nodes but as
//! intervals whose ends lie between nodes, through springs (see `contact.rs`). The rate of convergence is then that of
//! multigrid for the Poisson equation, for any contact set down to a single node.
//!
//! # Parameters of the algorithm
//! The steps are numbered in [`multigrid`](crate::multigrid). On the square:
//! - Transfers are bilinear. A visit to a grid applies one sweep before and one after the coarse-grid correction,
//!   over-relaxed inside on the colour that the transfers do not read or write (Yavneh 1996).
//! - Nested iteration applies one cycle per grid, and more only where the contact set of a coarse grid is far off.
//! - From the third coarser grid on, cycles are F-cycles: near-constant modes of semicoercive problems need accurate
//!   coarse solutions, and on coarse grids these cost almost nothing. If only the discretisation error is requested,
//!   F-cycles begin on the second coarser grid, since that cycle is often the only one.
//! - Corrections by a V-cycle are too small; they are enlarged where they reach the finest grid (Brandt and Yavneh
//!   1993 enlarge the residual). That halves the rate, to 0.04 per cycle, at no cost.
//!
//! # Cost
//! Memory: values and loads of all grids, 21.3 bytes per unknown, plus padding of rows to cache lines: 21.5 in all at
//! h = 1/4096, 22.4 at 1/512.
//!
//! A *work unit* is one projected Gauss-Seidel sweep of the finest grid, counted by visits of unknowns on all grids: a
//! half-sweep 1/2, residual and restriction of one colour 3/4, interpolation to one colour 1/4, restriction of a load
//! 1/2, a check of all optimality conditions 1, boundary loops by the number of their nodes, direct solutions by their
//! multiplications, of which a visit has one per stencil entry. Reordering the input is not counted.
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

use super::geometry::{MultigridGeometry, Visits};
use super::layout::Dimension;
use super::level::Level;

/// The unit square, as a type.
pub struct Square;

impl Dimension for Square {
    const AXES: usize = 2;
}

impl MultigridGeometry for Square {
    const CELLS: &str = "a power of two (at least 2) times 1, 3, 5 or 7";
    const RELAXATION: f64 = 1.15;
    const COARSE_RELAXATION: f64 = 1.45;
    /// Corrections by a V-cycle are too small by up to a tenth where the wavelength is a few cells of the coarser
    /// grid; enlarged by this factor they are too large as often as too small.
    const OVERCORRECTION: f64 = 1.08;
    const DOUBLE_VISITS_BELOW: usize = 3;
    const IN_SECOND_VISIT: Visits = Visits::Single;

    fn coarsest(n: usize) -> Option<usize> {
        let odd = n.checked_shr(n.trailing_zeros())?;
        // Four cells per side are solved directly, which is cheaper than a further coarsening to two.
        let coarsest = if odd == 1 { n.min(4) } else { 2 * odd };
        (n.is_multiple_of(2) && matches!(odd, 1 | 3 | 5 | 7)).then_some(coarsest)
    }

    fn set_springs(n: usize, in_contact: &[bool], levels: &mut [Level]) -> f64 {
        contact::set_springs(n, in_contact, levels)
    }
}
