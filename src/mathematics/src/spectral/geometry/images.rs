//! Points behind the boundary: mirror images, at which the continued solution is singular, and the medial axis of what
//! lies outside of a domain, centres of the discs outside that touch the boundary in two points or more, as in the
//! middle of a slot. Poles there are as far from the boundary as they can be.

use crate::problem::complex::Complex;
use crate::spectral::geometry::domain::PlaneDomain;
use crate::spectral::geometry::ring::PlaneRing;
use crate::spectral::geometry::side::PlaneSide;
use crate::spectral::geometry::way_out::middle;

/// Point behind the boundary at which the continued solution is singular.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Image {
    pub point: Complex,
    pub inwards: Complex,
    /// Distance from the boundary.
    pub distance: f64,
}

/// Mirror images of the singular points of psi behind the sides, and those of them that lie outside themselves, nearer
/// to the boundary than a share of the size of the domain.
pub(crate) fn images(domain: &PlaneDomain, singular: &[Complex], size: f64) -> Vec<Image> {
    const NEAR: f64 = 0.35;
    let mut points = Vec::new();
    for &z in singular {
        let away = domain.distance(z);
        if away < 1e-9 {
            continue;
        }
        if !domain.holds(z) {
            points.push(z);
            continue;
        }
        points.extend(domain.sides().filter_map(|side| mirrored(side, z)));
    }
    for side in domain.sides() {
        // The polynomial part of psi is singular in the centre of a side that is hollow.
        if side.curvature() < 0.0 && side.length() < 6.0 / side.curvature().abs() {
            points.extend(side.arc.curve.centre());
        }
    }
    let mut images: Vec<Image> = Vec::new();
    for point in points {
        let Some(image) = outside(domain, point) else { continue };
        let known = images.iter().any(|other| (other.point - point).norm() < 0.01 * image.distance);
        if image.distance < NEAR * size && !known {
            images.push(image);
        }
    }
    images
}

/// Images of a point of the boundary behind the sides that it sees across the domain, nearer than a distance.
pub(crate) fn images_across(domain: &PlaneDomain, z: Complex, near: f64) -> Vec<Image> {
    let mut images = Vec::new();
    for side in domain.sides() {
        let Some(s) = side.place(z, 0.0) else { continue };
        let to = side.point(s) - z;
        if to.norm() < near && to.norm() > 1e-9 && domain.holds(z + to.scaled(0.5)) {
            images.extend(mirrored(side, z).and_then(|point| outside(domain, point)));
        }
    }
    images
}

/// Image of a point behind a side, if its foot lies on the side.
fn mirrored(side: &PlaneSide, z: Complex) -> Option<Complex> {
    let curve = side.arc.curve;
    let place = side.place(z, 0.2 * side.length())?;
    match curve.centre() {
        None => {
            let local = curve.local(z);
            Some(curve.origin + curve.tangent * local.conj())
        }
        Some(centre) => {
            let from = z - centre;
            let square = 1.0 / (curve.curvature * curve.curvature);
            let far = from.norm2() > 1e-6 * square;
            (far && place >= 0.0).then(|| centre + from.scaled(square / from.norm2()))
        }
    }
}

/// A point outside of the domain with its distance, and the direction from there into the domain.
fn outside(domain: &PlaneDomain, point: Complex) -> Option<Image> {
    if domain.holds(point) {
        return None;
    }
    let distance = domain.distance(point);
    let side = domain.sides().min_by(|a, b| a.distance(point).total_cmp(&b.distance(point)))?;
    let foot = side.point(side.place(point, side.length())?);
    let way = foot - point;
    (distance > 1e-9).then(|| Image { point, inwards: way.scaled(1.0 / way.norm()), distance })
}

/// Largest disc outside of the domain that touches the boundary in a point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MedialDisc {
    /// Point in which it touches.
    pub foot: Complex,
    /// Unit vector from there to the centre.
    pub outwards: Complex,
    pub radius: f64,
}

/// Distance of neighbouring centres, in radii.
const STEP: f64 = 0.05;

impl MedialDisc {
    pub(crate) fn centre(&self) -> Complex {
        self.foot + self.outwards.scaled(self.radius)
    }

    /// Largest disc with a radius up to `most`, by halving: discs that touch in one point lie in each other. Infinite
    /// if that one holds nothing of the boundary.
    fn at(domain: &PlaneDomain, foot: Complex, outwards: Complex, most: f64) -> Self {
        /// Halvings, after which the radius has five digits.
        const HALVINGS: usize = 24;
        let fits =
            |radius: f64| domain.distance(foot + outwards.scaled(radius)) > radius * (1.0 - 1e-6);
        if fits(most) {
            return Self { foot, outwards, radius: f64::INFINITY };
        }
        let [mut low, mut high] = [0.0, most];
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            *(if fits(middle) { &mut low } else { &mut high }) = middle;
        }
        Self { foot, outwards, radius: low }
    }
}

/// Discs whose centres are next to each other by a part of their radii, where the boundary faces itself: along the
/// outer loop of slots, and along slender holes. None where the cuts of a re-entrant corner are.
pub(crate) fn medial_discs(domain: &PlaneDomain) -> Vec<MedialDisc> {
    /// Largest radius, in diameters.
    const LARGEST: f64 = 0.5;
    /// Distance from a corner, over that from it to the boundary outside, within which cuts are.
    const CUTS: f64 = 0.1;
    let most = LARGEST * domain.diameter();
    let mut found = Vec::new();
    for (number, ring) in domain.rings.iter().enumerate() {
        let faces_itself = if number == 0 { has_slot(domain, ring) } else { is_slender(ring) };
        if faces_itself {
            add_along(domain, ring, most, &mut found);
        }
    }
    if found.is_empty() {
        return found;
    }
    for [corner, outwards] in domain.rings.iter().flat_map(re_entrant) {
        let cuts = CUTS * domain.exit(corner, outwards).min(most);
        found.retain(|disc| (disc.centre() - corner).norm() > cuts);
    }
    found
}

/// True if a way from a side straight outwards ends at the boundary.
fn has_slot(domain: &PlaneDomain, ring: &PlaneRing) -> bool {
    ring.sides.iter().any(|side| {
        [0.2, 0.5, 0.8].into_iter().any(|part| {
            let s = part * side.length();
            domain.exit(side.point(s), -side.tangent(s).turned()).is_finite()
        })
    })
}

/// True of a hole for which functions that are singular in its middle alone are too few.
fn is_slender(ring: &PlaneRing) -> bool {
    /// Distance of the corner farthest from the middle, over that of the nearest side.
    const LONG: f64 = 1.8;
    let (middle, sides) = (middle(ring), &ring.sides);
    let nearest = sides.iter().map(|side| side.distance(middle)).fold(f64::INFINITY, f64::min);
    sides.iter().any(|side| (side.point(0.0) - middle).norm() > LONG * nearest)
}

/// Re-entrant corners, with the unit vector straight outwards.
fn re_entrant(ring: &PlaneRing) -> Vec<[Complex; 2]> {
    let mut corners = Vec::new();
    for (k, side) in ring.sides.iter().enumerate() {
        let [prior, after] = ring.tangents(k);
        if prior.cross(after) < -1e-9 {
            let along = prior + after;
            let outwards = -along.turned().scaled(1.0 / along.norm());
            corners.push([side.point(0.0), outwards]);
        }
    }
    corners
}

/// Adds the discs along a loop.
fn add_along(domain: &PlaneDomain, ring: &PlaneRing, most: f64, found: &mut Vec<MedialDisc>) {
    for (k, side) in ring.sides.iter().enumerate() {
        let (corner, [prior, after]) = (side.point(0.0), ring.tangents(k));
        let turn = libm::atan2(prior.cross(after), prior.dot(after));
        // At a convex corner directions turn from one normal to the next.
        if turn > 1e-3 {
            let turned = |part: f64| {
                let outwards = -(prior * Complex::unit(part * turn)).turned();
                MedialDisc::at(domain, corner, outwards, most)
            };
            add(&turned, found);
        }
        let along = |part: f64| {
            let s = part * side.length();
            MedialDisc::at(domain, side.point(s), -side.tangent(s).turned(), most)
        };
        add(&along, found);
    }
}

/// Adds discs by the part of a side, or of the turn at a corner.
fn add(at: &dyn Fn(f64) -> MedialDisc, found: &mut Vec<MedialDisc>) {
    /// Parts with which it begins.
    const FIRST: usize = 16;
    /// Shortest part.
    const SHORTEST: f64 = 2e-4;
    let first = |k: usize| {
        let part = (k as f64 / FIRST as f64).clamp(1e-9, 1.0 - 1e-9);
        (part, at(part))
    };
    let mut last = first(0);
    for k in 1..=FIRST {
        let mut ahead = vec![first(k)];
        while let Some(next) = ahead.pop() {
            let [one, other] = [&last.1, &next.1];
            let is_near =
                (one.centre() - other.centre()).norm() < STEP * one.radius.min(other.radius);
            let are_none = one.radius.is_infinite() && other.radius.is_infinite();
            if !is_near && !are_none && next.0 - last.0 > SHORTEST {
                let middle = 0.5 * (last.0 + next.0);
                ahead.push(next);
                ahead.push((middle, at(middle)));
                continue;
            }
            if next.1.radius.is_finite() {
                found.push(next.1);
            }
            last = next;
        }
    }
}
