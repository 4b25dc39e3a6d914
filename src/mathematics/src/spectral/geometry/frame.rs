//! Coordinates in which a domain lies near the origin and has about unit size, so that lengths can be compared with
//! fixed small numbers and coordinates far from the origin of the plane lose no digit; and a unit of f.

use crate::machine::extremes::two_sum;
use crate::mesh::{PlaneMesh, centroid};
use crate::problem::complex::Complex;
use crate::problem::law::Law;
use crate::problem::shape::Shape;
use crate::problem::source::Source;
use crate::spectral::error::PlaneError;

/// Coordinates `(z - origin) / unit`, with f over `height`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Frame {
    /// Coordinates of a mesh lose no digit when it is subtracted.
    pub origin: [f64; 2],
    /// A power of two, so that no digit changes.
    pub unit: f64,
    /// Another one.
    pub height: f64,
}

impl Default for Frame {
    /// The plane itself.
    fn default() -> Self {
        Self { origin: [0.0; 2], unit: 1.0, height: 1.0 }
    }
}

impl Frame {
    /// Frame of the domain of a mesh: with the origin of the plane where the mesh is not far from it, else the middle
    /// of the box round the domain, rounded to multiples of the unit; and with the largest value of f in the middle of
    /// a cell, or on a piece, next to 1.
    pub(crate) fn of(mesh: &PlaneMesh, f: &[Source]) -> Self {
        let mut extent = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
        let bulges = mesh.facets().iter().filter_map(|facet| {
            let circle = mesh.parts()[usize::from(facet.part)].curve?;
            let [a, b] = facet.nodes.map(|node| mesh.points()[node as usize]);
            Some(circle.nearest([0, 1].map(|axis| 0.5 * (a[axis] + b[axis]))))
        });
        for point in mesh.points().iter().copied().chain(bulges) {
            for (range, x) in extent.iter_mut().zip(point) {
                *range = [range[0].min(x), range[1].max(x)];
            }
        }
        let [width, height] = extent.map(|[low, high]| high - low);
        let unit = power_of_two(0.5 * libm::hypot(width, height));
        let [x, y] = extent.map(|[low, high]| 0.5 * (low + high));
        let is_near = libm::hypot(x, y) < 2.0 * unit;
        let origin = if is_near { [0.0; 2] } else { [x, y].map(|x| unit * (x / unit).round()) };
        let mut largest = 0.0f64;
        for (cell, &region) in mesh.cells().iter().zip(mesh.regions()) {
            let f = &f[usize::from(region)];
            let here = f.largest().unwrap_or_else(|| f.at(centroid(mesh.vertices(cell))).abs());
            largest = largest.max(here);
        }
        Self { origin, unit, height: if largest > 0.0 { power_of_two(largest) } else { 1.0 } }
    }

    /// Unit of dv/dn.
    pub(crate) fn of_flux(&self) -> f64 {
        self.height * self.unit
    }

    /// Unit of v and of integrals of f and of dv/dn; that of the energy is its square.
    pub(crate) fn of_value(&self) -> f64 {
        self.of_flux() * self.unit
    }

    /// A point of the plane in these coordinates.
    pub(crate) fn seen(&self, [x, y]: [f64; 2]) -> Complex {
        Complex::new(x - self.origin[0], y - self.origin[1]).scaled(1.0 / self.unit)
    }

    /// A point in these coordinates in the plane.
    pub(crate) fn outside(&self, z: Complex) -> [f64; 2] {
        let [x, y] = z.scaled(self.unit).coordinates();
        [x + self.origin[0], y + self.origin[1]]
    }

    /// A mesh in these coordinates.
    pub(crate) fn mesh(&self, mesh: &PlaneMesh) -> PlaneMesh {
        let mut seen = mesh.clone();
        seen.points.iter_mut().for_each(|point| *point = self.seen(*point).coordinates());
        for circle in seen.parts.iter_mut().filter_map(|part| part.curve.as_mut()) {
            circle.centre = self.seen(circle.centre).coordinates();
            circle.radius /= self.unit;
        }
        seen
    }

    /// A law in these coordinates.
    pub(crate) fn law(&self, law: Law) -> Law {
        law.in_units(self.of_value(), self.of_flux())
    }

    /// Constant pieces in these coordinates; another f as it is.
    pub(crate) fn pieces(&self, f: &Source) -> Source {
        let Source::Pieces { background, pieces } = f else { return f.clone() };
        let seen = pieces.iter().map(|(shape, value)| {
            (shape.exactly_seen_from(self.origin, self.unit), value / self.height)
        });
        Source::Pieces { background: background / self.height, pieces: seen.collect() }
    }

    /// Checks that the centre of no disc loses digits that count in a domain of this diameter: beside the domain no
    /// centre does. Half-planes lose none, and rectangles only of sides that do not meet the domain.
    ///
    /// # Errors
    /// [`PlaneError::Source`].
    pub(crate) fn check(&self, f: &Source, diameter: f64) -> Result<(), PlaneError> {
        let Source::Pieces { pieces, .. } = f else { return Ok(()) };
        for (shape, _) in pieces {
            let Shape::Ball { centre, radius } = *shape else { continue };
            let lost = [0, 1].map(|axis| two_sum(centre[axis], -self.origin[axis])[1].abs());
            if lost.into_iter().any(|lost| lost > f64::EPSILON * diameter * self.unit) {
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

/// Power of two next to a positive number, the larger one of two that are as near but for rounding.
fn power_of_two(size: f64) -> f64 {
    const OFF: f64 = 1e-9;
    libm::exp2((libm::log2(size) + OFF).round())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_two_powers_of_two_that_are_as_near_the_larger_counts() {
        let between = 2.0_f64.sqrt();
        for (size, unit) in [(1.0, 1.0), (0.7, 0.5), (1.4, 1.0), (1.5, 2.0), (5e-324, 5e-324)] {
            assert_eq!(power_of_two(size), unit, "{size}");
        }
        for places in [-4.0, 0.0, 4.0] {
            assert_eq!(power_of_two(between * (1.0 + places * f64::EPSILON)), 2.0, "{places}");
        }
    }

    #[test]
    fn centres_that_lose_digits_are_refused() {
        let frame = Frame { origin: [500.0, 500.0], unit: 0.5, height: 2.0 };
        for (f, diameter, is_refused) in [
            ("disc(500.0001,500.0003,0.0001)=2; else=-1", 1e-3, false),
            ("disc(0.1,500,499.9)=2; else=-1", 1e-3, true),
            ("disc(0.1,500,499.9)=2; else=-1", 1e3, false),
            ("disc(0.125,500,499.9)=2; else=-1", 1e-3, false),
            ("halfplane(0.1,0.3,200)=2; else=-1", 1e-3, false),
        ] {
            assert_eq!(frame.check(&f.parse().unwrap(), diameter).is_err(), is_refused, "{f}");
        }
    }
}
