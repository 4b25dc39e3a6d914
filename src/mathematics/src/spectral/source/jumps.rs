//! f with psi, its jumps, and the points at which psi is singular.

use super::changes::Changes;
use super::groups::{JumpGroup, groups};
use super::psi::Psi;
use crate::problem::complex::Complex;
use crate::problem::shape::Shape;
use crate::problem::source::Source;
use crate::spectral::error::PlaneError;
use crate::spectral::geometry::boundary::PlaneCrossing;
use crate::spectral::geometry::domain::PlaneDomain;
use crate::spectral::source::curves::{JumpEdge, Jumps};
use crate::spectral::source::{PlaneSource, Regions};
use std::f64::consts::{PI, TAU};

/// f with psi, its jumps inside of the domain, and where these meet the boundary.
pub(crate) struct PlaneJumps {
    pub psi: Psi,
    /// Jumps, none of a smooth f.
    pub groups: Vec<JumpGroup>,
    /// Points of the boundary at which jumps end, one for each of their ends.
    pub crossings: Vec<PlaneCrossing>,
    /// Bounds of the difference of f from that of the statement.
    pub changes: Changes,
    /// Bound of |v| inside of the domain less that on its boundary.
    pub inner: f64,
    /// Points at which psi, continued beyond the boundary, may be singular: vertices, and centres of circles.
    pub singular: Vec<Complex>,
}

impl PlaneJumps {
    /// # Errors
    /// [`PlaneError`] if f has parts that are too small, or jumps that do not fit.
    pub(crate) fn new(domain: &PlaneDomain, source: &PlaneSource) -> Result<Self, PlaneError> {
        match source {
            PlaneSource::Smooth(f) => Ok(Self {
                psi: Psi::Smooth(f.clone()),
                groups: Vec::new(),
                crossings: Vec::new(),
                changes: Changes::of_disc(f.error, f.radius),
                // v less psi has its bounds on the boundary.
                inner: 2.0 * f.psi.size(f.radius),
                singular: Vec::new(),
            }),
            PlaneSource::Pieces(regions) => Self::of_regions(domain, regions),
        }
    }

    fn of_regions(domain: &PlaneDomain, regions: &Regions) -> Result<Self, PlaneError> {
        let Jumps { edges, psi: potential, changes, .. } = Jumps::new(domain, regions)?;
        // All parts of the domain between jumps are beside one.
        let values: Vec<f64> = edges.iter().flat_map(|edge| edge.values).map(f64::abs).collect();
        let centres = potential.jumps.iter().filter_map(|jump| jump.arc.curve.centre());
        let singular = potential.vertices.iter().copied().chain(centres).collect();
        let crossings = edges.iter().flat_map(|edge| crossings(domain, edge)).collect();
        let groups = groups(domain, potential, edges, |z| regions.at(z));
        let background = groups[0].psi.parts()[0].potential.background.abs();
        let alone = if values.is_empty() { background } else { 0.0 };
        let largest = values.into_iter().fold(alone, f64::max);
        let size = SourceSize::of(&regions.pieces, largest, domain.diameter(), changes.mass);
        if changes.mass > LOST * (size.integral - changes.mass) {
            return Err(PlaneError::Source(
                "f has a part that is too narrow, or too near to the boundary, for this solver, which tells 1e-12 \
                 of the size of the domain apart; make it wider and its value smaller, with the same integral"
                    .into(),
            ));
        }
        let inner = size.inner();
        Ok(Self { psi: groups[0].psi.clone(), groups, crossings, changes, inner, singular })
    }

    /// Distances of a point from the curves of all jumps.
    pub(crate) fn distances(&self, z: Complex) -> impl Iterator<Item = f64> {
        self.groups.iter().flat_map(move |group| {
            let curves = group.edges.iter().map(|own| own.edge.arc.curve);
            curves.map(move |curve| curve.distance(z - group.middle).abs())
        })
    }
}

/// Share of the integral of |f| that may be lost: the bounds of the energy are apart by no less.
const LOST: f64 = 1e-7;

/// Bounds of |f|, as psi has it, on a domain.
struct SourceSize {
    largest: f64,
    /// That of its integral.
    integral: f64,
    /// Length of the diagonal of the box round the domain.
    diameter: f64,
}

impl SourceSize {
    /// By the largest |f|, and a bound of the integral of its changes.
    fn of(all_pieces: &[Source], largest: f64, diameter: f64, changed: f64) -> Self {
        let around = PI * diameter * diameter;
        let mut integral = changed;
        for f in all_pieces {
            let Source::Pieces { background, pieces } = f else { continue };
            integral += background.abs().min(largest) * around;
            for (shape, value) in pieces {
                let area = match *shape {
                    Shape::Ball { radius, .. } => PI * radius * radius,
                    Shape::Box(sides) => {
                        sides.map(|[low, high]| (high - low).min(diameter)).iter().product()
                    }
                    Shape::HalfSpace { .. } => around,
                };
                integral += value.abs().min(largest) * area.clamp(0.0, around);
            }
        }
        Self { largest, integral, diameter }
    }

    /// Bound of the integral of `|f| 1 / 2 pi log(2 diameter / |x - y|)`, which is positive with |f| for its Laplacian:
    /// largest in the middle of a disc.
    fn inner(&self) -> f64 {
        if self.largest == 0.0 {
            return 0.0;
        }
        let radius = (self.integral / (PI * self.largest)).sqrt();
        self.integral / TAU * (0.5 + libm::log((2.0 * self.diameter / radius).max(1.0)))
    }
}

/// Points of the boundary at which a jump ends. Seen from the start of a jump, which leads into the domain, its left is
/// before it in walking order; seen from the end, after it.
fn crossings(domain: &PlaneDomain, edge: &JumpEdge) -> Vec<PlaneCrossing> {
    let (arc, [left, right]) = (edge.arc, edge.values);
    let mut found = Vec::new();
    for (k, change) in [right - left, left - right].into_iter().enumerate() {
        if arc.ends[k].is_some() || edge.is_circle() {
            continue;
        }
        let z = arc.curve.at(arc.span[k]);
        let (ring, place) = domain.nearest(z);
        let own = &domain.rings[ring];
        let gap = (own.sides[place.side].point(place.s) - z).norm();
        found.push(PlaneCrossing { ring, t: own.along(place), change, gap });
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spectral::geometry::polygons::polygon;

    #[test]
    fn psi_belongs_to_f_where_jumps_end_in_bays() {
        let u = [
            [-1.0, -1.0],
            [1.0, -1.0],
            [1.0, 1.0],
            [0.5, 1.0],
            [0.5, -0.5],
            [-0.5, -0.5],
            [-0.5, 1.0],
            [-1.0, 1.0],
        ];
        // A bay behind a way with two bends.
        let hook = [
            [-1.0, -1.0],
            [1.0, -1.0],
            [1.0, 1.0],
            [-0.7, 1.0],
            [-0.7, 0.6],
            [0.2, 0.6],
            [0.2, -0.2],
            [-0.2, -0.2],
            [-0.2, 0.2],
            [0.1, 0.2],
            [0.1, 0.5],
            [-0.8, 0.5],
            [-0.8, 1.0],
            [-1.0, 1.0],
        ];
        for points in [&u[..], &hook[..]] {
            let domain = polygon(points);
            for text in [
                "rect(-2,0,-2,0.1)=3; else=-1",
                "halfplane(1,0.3,0.02)=4; rect(-0.3,0.8,-0.7,0.3)=2; disc(-0.4,0,0.5)=1; else=-2",
                "disc(0,-0.9,0.75)=1; rect(-2,-0.1,-2,2)=-3; else=2",
            ] {
                let pieces: Source = text.parse().unwrap();
                let f = PlaneSource::Pieces(Regions::all(pieces.clone()));
                let psi = PlaneJumps::new(&domain, &f).unwrap().psi;
                for z in domain.inner_points(25) {
                    let value = pieces.at(z.coordinates());
                    assert!((psi.source(z) - value).abs() < 1e-10, "{text}: {z:?} {value}");
                    let (step, slope) = (1e-5, psi.gradients(&[z])[0]);
                    for way in [Complex::new(step, 0.0), Complex::new(0.0, step)] {
                        let change = psi.value(z + way) - psi.value(z - way);
                        let off = 0.5 * change / step - slope.dot(way.scaled(1.0 / step));
                        assert!(off.abs() < 1e-4, "{text}: {z:?} {off}");
                    }
                }
            }
        }
    }
}
