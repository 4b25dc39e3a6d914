//! Place from which a domain is seen, so that coordinates far from the origin of the plane lose no digit.

use crate::mesh::PlaneMesh;
use crate::problem::source::Source;

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
}

/// Constant pieces in the coordinates with an origin and a unit, a power of two.
pub(in crate::spectral) fn pieces_seen(f: &Source, origin: [f64; 2], unit: f64) -> Source {
    let Source::Pieces { background, pieces } = f else { return f.clone() };
    let seen = pieces.iter().map(|(shape, f)| (shape.exactly_seen_from(origin, unit), *f));
    Source::Pieces { background: *background, pieces: seen.collect() }
}
