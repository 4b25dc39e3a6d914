//! A problem on a domain in the plane, and the contact set with which its solution begins.

pub(super) mod frame;

use crate::problem::law::Law;
use crate::spectral::geometry::domain::{PlaneDomain, SidePlace};
use crate::spectral::source::PlaneSource;

/// Problem on a domain of the plane.
#[derive(Clone, Debug)]
pub(crate) struct PlaneProblem {
    /// The domain.
    pub domain: PlaneDomain,
    /// The law on sides in contact.
    pub law: Law,
    /// f.
    pub source: PlaneSource,
}

/// Contact set with which Newton's method begins, loop by loop.
#[derive(Clone, Debug, Default)]
pub(crate) struct PlaneStart {
    /// Arcs that stick, loop by loop.
    pub loops: Vec<LoopStart>,
    /// Length of the edges of the mesh that it is from: arcs and gaps of one or two are left out.
    pub spacing: f64,
}

/// Arcs of a loop that stick. What it says of fixed and free sides is not read.
#[derive(Clone, Debug, Default)]
pub(crate) struct LoopStart {
    /// Beginning and end of each arc in walking order.
    pub arcs: Vec<[SidePlace; 2]>,
    /// Flux dv/dn on the gap after each arc, an end of the law. Without arcs: none if all of the loop sticks, one if
    /// nothing does.
    pub gaps: Vec<f64>,
}
