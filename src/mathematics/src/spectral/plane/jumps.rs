//! f with psi, its jumps, and the points at which psi is singular.

use super::domain::{PlaneDomain, SidePlace};
use super::psi::Psi;
use super::{PlaneError, PlaneSource};
use crate::problem::complex::Complex;
use crate::spectral::jumps::{JumpEdge, Jumps};

/// f with psi, its jumps inside of the domain, and where these meet the boundary.
pub(super) struct PlaneJumps {
    pub psi: Psi,
    pub edges: Vec<JumpEdge>,
    /// Points of the boundary at which jumps end, by loop.
    pub crossings: Vec<(usize, SidePlace)>,
    /// Points at which psi, continued beyond the boundary, may be singular: vertices, and centres of circles.
    pub singular: Vec<Complex>,
}

impl PlaneJumps {
    pub(super) fn new(domain: &PlaneDomain, source: &PlaneSource) -> Result<Self, PlaneError> {
        let (jumps, psi) = match source {
            PlaneSource::Polynomial(f) => (Jumps::default(), Psi::Polynomial(f.clone())),
            PlaneSource::Pieces(f) => {
                let jumps = Jumps::of_pieces(domain, f)?;
                let points = inner_points(domain);
                let psi = Psi::of_jumps(jumps.psi.clone(), &points, |z| f.at(z.coordinates()));
                (jumps, psi)
            }
            PlaneSource::Regions(regions) => {
                let jumps = Jumps::of_regions(domain, &regions.borders)?;
                let ([x, y], f) = regions.known;
                let psi = Psi::of_jumps(jumps.psi.clone(), &[Complex::new(x, y)], |_| f);
                (jumps, psi)
            }
        };
        let Jumps { edges, crossings, psi: potential, .. } = jumps;
        let centres = potential.jumps.iter().filter_map(|jump| jump.arc.curve.centre());
        Ok(Self {
            psi,
            edges,
            crossings: crossings.into_iter().map(|z| domain.nearest(z)).collect(),
            singular: potential.vertices.iter().copied().chain(centres).collect(),
        })
    }
}

/// Points of the domain away from its boundary.
fn inner_points(domain: &PlaneDomain) -> Vec<Complex> {
    let [[left, right], [low, high]] = domain.extent();
    let mut points = Vec::new();
    for k in 0..2000 {
        let [x, y] = [0.618_034 * f64::from(k) + 0.31, 0.754_878 * f64::from(k) + 0.17];
        let z = Complex::new(
            left + (right - left) * (x - x.floor()),
            low + (high - low) * (y - y.floor()),
        );
        if domain.holds(z) {
            points.push(z);
        }
        if points.len() == 25 {
            break;
        }
    }
    points
}
