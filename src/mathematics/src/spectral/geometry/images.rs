//! Points behind the boundary at which the continued solution is singular: mirror images.

use crate::problem::complex::Complex;
use crate::spectral::geometry::domain::{PlaneDomain, PlaneSide};

/// Point behind the boundary at which the continued solution is singular.
#[derive(Clone, Copy, Debug)]
pub(in crate::spectral) struct Image {
    pub point: Complex,
    pub inwards: Complex,
    /// Distance from the boundary.
    pub distance: f64,
}

/// Mirror images of the singular points of psi behind the sides, and those of them that lie outside themselves, nearer
/// to the boundary than a share of the size of the domain.
pub(in crate::spectral) fn images(
    domain: &PlaneDomain,
    singular: &[Complex],
    size: f64,
) -> Vec<Image> {
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
pub(in crate::spectral) fn images_across(
    domain: &PlaneDomain,
    z: Complex,
    near: f64,
) -> Vec<Image> {
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
