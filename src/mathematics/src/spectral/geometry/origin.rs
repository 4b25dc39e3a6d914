//! Place from which a domain is seen, so that coordinates far from the origin of the plane lose no digit.

use crate::machine::extremes::two_sum;
use crate::mesh::PlaneMesh;
use crate::problem::shape::Shape;
use crate::problem::source::Source;
use crate::spectral::geometry::domain::PlaneError;

/// Place from which the domain of a mesh is seen: its coordinates lose no digit when it is subtracted.
#[derive(Clone, Copy, Debug)]
pub(in crate::spectral) struct Origin(pub [f64; 2]);

impl Origin {
    /// Origin of the plane where the mesh is not far from it, else the middle of the box round the mesh, rounded to
    /// multiples of about half of the diameter.
    pub(in crate::spectral) fn of(mesh: &PlaneMesh) -> Self {
        let extent = [0, 1].map(|axis| {
            let along = || mesh.points().iter().map(move |point| point[axis]);
            [along().fold(f64::INFINITY, f64::min), along().fold(f64::NEG_INFINITY, f64::max)]
        });
        let [width, height] = extent.map(|[low, high]| high - low);
        let unit = libm::exp2(libm::log2(0.5 * libm::hypot(width, height)).round());
        let [x, y] = extent.map(|[low, high]| 0.5 * (low + high));
        let is_near = libm::hypot(x, y) < 2.0 * unit;
        Self(if is_near { [0.0; 2] } else { [x, y].map(|x| unit * (x / unit).round()) })
    }

    /// A point, seen from here.
    pub(in crate::spectral) fn seen(self, [x, y]: [f64; 2]) -> [f64; 2] {
        [x - self.0[0], y - self.0[1]]
    }

    /// A point that is seen from here, in the plane.
    pub(in crate::spectral) fn outside(self, [x, y]: [f64; 2]) -> [f64; 2] {
        [x + self.0[0], y + self.0[1]]
    }

    /// A mesh, seen from here.
    pub(in crate::spectral) fn mesh(self, mesh: &PlaneMesh) -> PlaneMesh {
        let mut seen = mesh.clone();
        seen.points.iter_mut().for_each(|point| *point = self.seen(*point));
        for circle in seen.parts.iter_mut().filter_map(|part| part.curve.as_mut()) {
            circle.centre = self.seen(circle.centre);
        }
        seen
    }

    /// Constant pieces, seen from here.
    pub(in crate::spectral) fn pieces(self, f: &Source) -> Source {
        pieces_seen(f, self.0, 1.0)
    }

    /// Checks that the centre of no disc, seen from here, loses digits that count in a domain of this diameter: beside
    /// the domain no centre does. Half-planes lose none, and rectangles only of sides that do not meet the domain.
    ///
    /// # Errors
    /// [`PlaneError::Source`].
    pub(in crate::spectral) fn check(self, f: &Source, diameter: f64) -> Result<(), PlaneError> {
        let Source::Pieces { pieces, .. } = f else { return Ok(()) };
        for (shape, _) in pieces {
            let Shape::Ball { centre, radius } = *shape else { continue };
            let lost = [0, 1].map(|axis| two_sum(centre[axis], -self.0[axis])[1].abs());
            if lost.into_iter().any(|lost| lost > f64::EPSILON * diameter) {
                let [x, y] = centre;
                return Err(PlaneError::Source(format!(
                    "the centre of the disc of radius {radius} round ({x}, {y}) has more digits than count beside the \
                     domain, seen from there; write it with fewer digits"
                )));
            }
        }
        Ok(())
    }
}

/// Constant pieces in the coordinates with an origin and a unit, a power of two.
pub(in crate::spectral) fn pieces_seen(f: &Source, origin: [f64; 2], unit: f64) -> Source {
    let Source::Pieces { background, pieces } = f else { return f.clone() };
    let seen = pieces.iter().map(|(shape, f)| (shape.exactly_seen_from(origin, unit), *f));
    Source::Pieces { background: *background, pieces: seen.collect() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn centres_that_lose_digits_are_refused() {
        let origin = Origin([500.0, 500.0]);
        for (f, diameter, is_refused) in [
            ("disc(500.0001,500.0003,0.0001)=2; else=-1", 1e-3, false),
            ("disc(0.1,500,499.9)=2; else=-1", 1e-3, true),
            ("disc(0.1,500,499.9)=2; else=-1", 1e3, false),
            ("disc(0.125,500,499.9)=2; else=-1", 1e-3, false),
            ("halfplane(0.1,0.3,200)=2; else=-1", 1e-3, false),
        ] {
            assert_eq!(origin.check(&f.parse().unwrap(), diameter).is_err(), is_refused, "{f}");
        }
    }
}
