//! A problem on a domain in the plane, and the contact set with which its solution begins.

use crate::problem::complex::Complex;
use crate::problem::law::Law;
use crate::problem::source::Source;
use crate::spectral::geometry::domain::{PlaneDomain, PlaneSide, SidePlace, directions, ray_hits};
use crate::spectral::source::polynomial::Polynomial;

/// Right-hand side of a domain in the plane.
#[derive(Clone, Debug)]
pub(crate) enum PlaneSource {
    /// Constant pieces.
    Pieces(Source),
    /// A polynomial, in the coordinates of the domain's frame.
    Polynomial(Polynomial),
    /// Constant pieces on each region.
    Regions(Regions),
}

/// Constant pieces on regions with straight borders, and circular ones along the boundary of the domain.
#[derive(Clone, Debug)]
pub(crate) struct Regions {
    /// Borders of regions on which f differs, with each other and along the boundary of the domain, each once.
    pub borders: Vec<RegionBorder>,
    /// f on the regions.
    pub pieces: Vec<Source>,
}

/// Border of regions.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RegionBorder {
    /// The border: its condition and part are not read.
    pub side: PlaneSide,
    /// Regions on the left and on the right; none outside of the domain.
    pub regions: [Option<usize>; 2],
}

impl RegionBorder {
    /// True if it lies inside of the domain.
    pub(in crate::spectral) fn is_inside(&self) -> bool {
        self.regions.iter().all(Option::is_some)
    }
}

impl Regions {
    /// f at a point of the domain.
    pub(in crate::spectral) fn at(&self, z: Complex) -> f64 {
        self.pieces[self.region(z)].at(z.coordinates())
    }

    /// Region at a point of the domain: that on this side of the first border in a direction.
    fn region(&self, z: Complex) -> usize {
        let mut found = 0;
        for direction in directions() {
            let hits = ray_hits(self.borders.iter().map(|border| &border.side), z, direction);
            let ahead = hits.into_iter().filter(|hit| hit.distance > 0.0);
            let first = ahead.min_by(|one, other| one.distance.total_cmp(&other.distance));
            let Some(hit) = first else { continue };
            let [left, right] = self.borders[hit.side].regions;
            // Between an arc of the boundary and its chord the domain is on the other side.
            let here = if hit.is_left { left.or(right) } else { right.or(left) };
            found = here.unwrap_or(found);
            if !hit.is_unsure {
                break;
            }
        }
        found
    }
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
