//! A problem on a domain in the plane, and the contact set with which its solution begins.

use super::{PlaneDomain, PlaneSide, Polynomial, SidePlace};
use crate::problem::law::Law;
use crate::problem::source::Source;

/// Right-hand side of a domain in the plane.
#[derive(Clone, Debug)]
pub(crate) enum PlaneSource {
    /// Constant pieces.
    Pieces(Source),
    /// A polynomial.
    Polynomial(Polynomial),
    /// Constant values on regions.
    Regions(Regions),
}

/// Constant values on regions with straight or circular borders.
#[derive(Clone, Debug)]
pub(crate) struct Regions {
    /// Borders between regions inside of the domain, each once: the condition and part of the side are not used.
    pub borders: Vec<RegionBorder>,
    /// A point inside of the domain, and f there.
    pub known: ([f64; 2], f64),
}

/// Border between two regions.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RegionBorder {
    /// The border: its condition and part are not read.
    pub side: PlaneSide,
    /// f on the left and on the right.
    pub values: [f64; 2],
}

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
