//! Arcs of the boundary that stick, and the flux on the gaps between them.

use super::place::BoundaryPlace;

/// Arcs that stick, with the flux on the gaps between them.
#[derive(Clone, Debug)]
pub(super) struct StickArcs {
    /// Beginnings and ends in turn, anticlockwise; none if all of the boundary sticks.
    pub(super) places: Vec<BoundaryPlace>,
    /// dv/dn on the gap after each arc, which is one end of the law.
    pub(super) flux: Vec<f64>,
}

impl StickArcs {
    /// True if v is positive on some gaps and negative on others.
    pub(super) fn have_both_signs(&self) -> bool {
        self.flux.iter().any(|flux| *flux != self.flux[0])
    }
}
