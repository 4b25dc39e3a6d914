//! Coordinates and units in which domain and f are of size one, about.

use crate::mesh::{MeshSource, PlaneMesh, Round, centroid};
use crate::problem::law::Law;
use crate::problem::source::Source;

/// Coordinates `(x - origin) / unit`, and f in multiples of `height`. Powers of two change no digit.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    origin: [f64; 2],
    unit: f64,
    /// Unit of f.
    height: f64,
}

impl Frame {
    /// Frame in which the built-in domains are as they are.
    pub(super) fn of(mesh: &PlaneMesh, f: &MeshSource<2>) -> Self {
        let (points, extent) = (mesh.points(), mesh.extent());
        let unit = power_of_two(0.5 * extent);
        let middle: [f64; 2] = std::array::from_fn(|axis| {
            points.iter().map(|point| point[axis]).sum::<f64>() / points.len() as f64
        });
        let is_far = middle.iter().any(|x| x.abs() > extent);
        let origin = if is_far { middle } else { [0.0; 2] };
        let values = mesh.cells().iter().zip(mesh.regions());
        let largest = values.fold(0.0f64, |most, (cell, &region)| {
            most.max(f.on(region).at(centroid(mesh.vertices(cell))).abs())
        });
        let all = mesh.regions().iter().filter_map(|&region| f.on(region).largest());
        let largest = if largest > 0.0 { largest } else { all.fold(0.0, f64::max) };
        let height = if largest > 0.0 { power_of_two(largest) } else { 1.0 };
        Self { origin, unit, height }
    }

    /// Point in these coordinates.
    pub(super) fn point(&self, point: [f64; 2]) -> [f64; 2] {
        std::array::from_fn(|axis| (point[axis] - self.origin[axis]) / self.unit)
    }

    /// Point with these coordinates.
    pub(super) fn outside(&self, point: [f64; 2]) -> [f64; 2] {
        std::array::from_fn(|axis| self.origin[axis] + self.unit * point[axis])
    }

    /// Circle in these coordinates.
    pub(super) fn circle(&self, circle: Round<2>) -> Round<2> {
        Round::sphere(self.point(circle.centre), circle.radius / self.unit)
    }

    /// Value of f in these units.
    pub(super) fn f(&self, value: f64) -> f64 {
        value / self.height
    }

    /// Constant pieces in this frame; a formula stays as it is.
    pub(super) fn pieces(&self, f: &Source) -> Source {
        let Source::Pieces { background, pieces } = f else { return f.clone() };
        let seen = pieces
            .iter()
            .map(|(shape, value)| (shape.seen_from(self.origin, self.unit), self.f(*value)));
        Source::Pieces { background: self.f(*background), pieces: seen.collect() }
    }

    /// Law in these units.
    pub(super) fn law(&self, law: Law) -> Law {
        let [lo, hi] = [law.lo(), law.hi()].map(|flux| flux / self.flux());
        Law::new(lo, hi).unwrap_or(law)
    }

    /// Unit of dv/dn.
    pub(super) fn flux(&self) -> f64 {
        self.height * self.unit
    }

    /// Unit of v, and of integrals of dv/dn and f.
    pub(super) fn v(&self) -> f64 {
        self.flux() * self.unit
    }

    /// Unit of the energy.
    pub(super) fn energy(&self) -> f64 {
        self.v() * self.v()
    }
}

/// Power of two next to a positive number.
fn power_of_two(size: f64) -> f64 {
    libm::exp2(libm::round(libm::log2(size)))
}
