//! A problem on a domain in the plane, and the contact set with which its solution begins; and coordinates
//! in which a domain lies near the origin and has about unit size, so that lengths can be compared with fixed small
//! numbers.

use crate::problem::complex::Complex;
use crate::problem::law::Law;
use crate::problem::source::Source;
use crate::spectral::geometry::curve::{Arc, Curve};
use crate::spectral::geometry::domain::{PlaneDomain, PlaneSide, SidePlace};
use crate::spectral::geometry::origin::pieces_seen;
use crate::spectral::source::{PlaneSource, RegionBorder, Regions};

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

/// Coordinates `z / unit`. There v is smaller by the square of the unit, dv/dn by the unit, the energy by its fourth
/// power.
#[derive(Clone, Copy, Debug)]
pub(in crate::spectral) struct Frame {
    /// A power of two, so that no digit changes.
    pub unit: f64,
}

impl Frame {
    /// Frame in which a domain has about unit size.
    pub(in crate::spectral) fn of(domain: &PlaneDomain) -> Self {
        Self { unit: domain.unit() }
    }

    pub(in crate::spectral) fn seen(self, [x, y]: [f64; 2]) -> Complex {
        Complex::new(x, y).scaled(1.0 / self.unit)
    }

    fn side(self, side: &PlaneSide) -> PlaneSide {
        let Arc { curve, span, ends } = side.arc;
        let curve = Curve {
            origin: self.seen(curve.origin.coordinates()),
            curvature: curve.curvature * self.unit,
            ..curve
        };
        PlaneSide { arc: Arc { curve, span: span.map(|s| s / self.unit), ends }, ..*side }
    }

    /// Constant pieces in these coordinates.
    fn pieces(self, f: &Source) -> Source {
        pieces_seen(f, [0.0; 2], self.unit)
    }

    /// The problem in these coordinates.
    pub(in crate::spectral) fn problem(self, problem: &PlaneProblem) -> PlaneProblem {
        let loops = problem.domain.loops.iter();
        let domain = PlaneDomain {
            loops: loops.map(|sides| sides.iter().map(|side| self.side(side)).collect()).collect(),
        };
        let [lo, hi] = [problem.law.lo(), problem.law.hi()].map(|end| end / self.unit);
        let law = Law::new(lo, hi).expect("the ends keep their order");
        let source = match &problem.source {
            PlaneSource::Pieces(f) => PlaneSource::Pieces(self.pieces(f)),
            PlaneSource::Polynomial(f) => PlaneSource::Polynomial(f.clone()),
            PlaneSource::Regions(Regions { borders, pieces }) => {
                let borders = borders.iter();
                let borders = borders.map(|b| RegionBorder { side: self.side(&b.side), ..*b });
                PlaneSource::Regions(Regions {
                    borders: borders.collect(),
                    pieces: pieces.iter().map(|f| self.pieces(f)).collect(),
                })
            }
        };
        PlaneProblem { domain, law, source }
    }

    /// Place on a side in these coordinates.
    pub(in crate::spectral) fn place(self, SidePlace { side, s }: SidePlace) -> SidePlace {
        SidePlace { side, s: s / self.unit }
    }

    /// The start in these coordinates.
    pub(in crate::spectral) fn start(self, start: &PlaneStart) -> PlaneStart {
        let loops = start.loops.iter().map(|own| LoopStart {
            arcs: own.arcs.iter().map(|ends| ends.map(|place| self.place(place))).collect(),
            gaps: own.gaps.iter().map(|flux| flux / self.unit).collect(),
        });
        PlaneStart { loops: loops.collect(), spacing: start.spacing / self.unit }
    }
}
