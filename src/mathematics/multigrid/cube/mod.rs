//! Full multigrid for the scalar Signorini problem on the unit cube, at optimal cost.
//!
//! # Idea
//! The method is that of the [square](crate::multigrid::square): projected red-black Gauss-Seidel sweeps on the finest
//! grid, truncation of the nodes in contact, a linear coarse-grid correction of the others. New here is the
//! representation of the contact set on coarse grids: by the current that it draws (see `contact.rs`). The rate of
//! convergence is then that of multigrid for the Poisson equation, about 0.1, for contact sets down to a single node,
//! and up to 0.3 for sets of scattered single nodes.
//!
//! # Parameters of the algorithm
//! The steps are numbered in [`multigrid`](crate::multigrid). On the cube:
//! - Transfers are trilinear. A visit to a grid applies one sweep before and one after the coarse-grid correction,
//!   over-relaxed inside (Yavneh, SIAM J. Sci. Comput. 17, 1996).
//! - Nested iteration applies one cycle per grid, and more only where the contact set of a coarse grid is far off.
//! - Each visit to a grid makes two visits to the next coarser one (W-cycle), where a visit costs an eighth.
//! - On a grid with four cells per side two contact sets may alternate (in 12 of 20 000 random problems); half a
//!   correction ends the alternation.
//!
//! # Cost
//! Memory: values and loads of all grids, 18.3 bytes per unknown, plus padding of rows to cache lines, three planes of
//! residuals for each thread, and the arrays of the boundary nodes. The work unit is that of the square.

mod contact;
mod surface;
mod transfer;

use super::geometry::{MultigridGeometry, Visits};
use super::layout::Dimension;
use super::level::Level;

/// The unit cube, as a type.
pub struct Cube;

impl Dimension for Cube {
    const AXES: usize = 3;
}

impl MultigridGeometry for Cube {
    const CELLS: &str = "a power of two (at least 2), or three times one";
    const RELAXATION: f64 = 1.25;
    const COARSE_RELAXATION: f64 = 1.25;
    const OVERCORRECTION: f64 = 1.0;
    const DOUBLE_VISITS_BELOW: usize = 1;
    const IN_SECOND_VISIT: Visits = Visits::Double;

    fn coarsest(n: usize) -> Option<usize> {
        let odd = n.checked_shr(n.trailing_zeros())?;
        (n.is_multiple_of(2) && matches!(odd, 1 | 3)).then_some(2 * odd)
    }

    fn set_springs(n: usize, in_contact: &[bool], levels: &mut [Level]) -> f64 {
        contact::set_springs(n, in_contact, levels)
    }
}
