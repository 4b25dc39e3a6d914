//! f and its particular solution psi, with -Lap psi = f, in closed form.
//!
//! Of constant pieces: [`curves`] finds the curves across which f jumps, [`jumps`] has f with psi, whose gradient is a
//! sum over the jumps ([`potential`]) and whose values are in [`psi`]; small closed shapes are seen from their own
//! middles ([`groups`]). Of formulas: [`expansion`] multiplies them out to a [`polynomial`].

pub(super) mod changes;
pub(super) mod closed_edges;
pub(super) mod curves;
pub(super) mod expansion;
pub(super) mod far_field;
pub(super) mod groups;
pub(super) mod jumps;
pub(super) mod polynomial;
pub(super) mod potential;
pub(super) mod psi;
pub(super) mod quadratic;
pub(super) mod real_polynomial;
pub(super) mod regions;

use crate::problem::complex::Complex;
use crate::problem::source::Source;
use crate::spectral::geometry::domain::{PlaneSide, directions, ray_hits};
use polynomial::Polynomial;

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
