//! Surfaces on which parts of the boundary may lie: new nodes of a refinement are put there.

use super::check::flat;
use super::error::MeshError;
use super::{Element, Facet, Mesh, Names};

/// Circle, sphere or cylinder: all points at one distance from a centre or from a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Round<const D: usize> {
    /// Centre, or a point on the axis of a cylinder.
    pub centre: [f64; D],
    /// Unit vector along the axis of a cylinder; zero for a circle or sphere.
    pub axis: [f64; D],
    /// Distance.
    pub radius: f64,
}

impl<const D: usize> Round<D> {
    /// Circle or sphere.
    pub fn sphere(centre: [f64; D], radius: f64) -> Self {
        Self { centre, axis: [0.0; D], radius }
    }

    /// Returns the vector to a point from the centre or, at a right angle, from the axis, and its length.
    pub(super) fn outward(&self, point: [f64; D]) -> ([f64; D], f64) {
        let mut outward: [f64; D] = std::array::from_fn(|d| point[d] - self.centre[d]);
        let along: f64 = outward.iter().zip(self.axis).map(|(x, a)| x * a).sum();
        outward.iter_mut().zip(self.axis).for_each(|(x, a)| *x -= along * a);
        (outward, outward.iter().map(|x| x * x).sum::<f64>().sqrt())
    }

    /// Distance of a point from the surface.
    pub fn distance(&self, point: [f64; D]) -> f64 {
        (self.outward(point).1 - self.radius).abs()
    }

    /// Nearest point of the surface; a point of the centre or axis stays where it is.
    pub fn nearest(&self, point: [f64; D]) -> [f64; D] {
        let (outward, length) = self.outward(point);
        if length == 0.0 {
            return point;
        }
        std::array::from_fn(|d| point[d] - outward[d] + outward[d] * self.radius / length)
    }
}

impl<const D: usize, const V: usize> Mesh<D, V> {
    /// Checks that a piece of the cell of this number has the orientation that it would have without curves, and a
    /// volume.
    pub(super) fn check_piece(
        &self,
        cell: usize,
        vertices: [[f64; D]; V],
        is_mirrored: bool,
    ) -> Result<(), MeshError> {
        let element = Element::new(vertices);
        match element.is_mirrored != is_mirrored || flat(&element, vertices) {
            true => Err(self.folded(cell)),
            false => Ok(()),
        }
    }

    /// Fault of a cell that a curve turns inside out, with the part of an edge of it that lies on one.
    fn folded(&self, cell: usize) -> MeshError {
        let nodes = self.cells[cell];
        let at_cell = self.facets.iter().filter(|facet| facet.shares_edge(nodes));
        let parts = at_cell.map(|facet| &self.parts[facet.part as usize]);
        let curved = parts.filter(|part| part.curve.is_some()).map(|part| &part.names);
        let element = self.elements.get(cell).copied().unwrap_or(cell as u64);
        MeshError::Folded { element, part: Names::all(curved) }
    }

    /// True if a part of the boundary lies on a curve.
    pub(crate) fn is_curved(&self) -> bool {
        self.parts.iter().any(|part| part.curve.is_some())
    }
}

impl<const D: usize> Facet<D> {
    /// True if two of the nodes, or more, are those of a cell.
    fn shares_edge<const V: usize>(&self, cell: [u32; V]) -> bool {
        self.nodes.iter().filter(|node| cell.contains(node)).count() >= 2
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nearest_points_are_on_the_surface() {
        let sphere = Round::sphere([1.0, 0.0, 0.0], 2.0);
        assert_eq!(sphere.nearest([1.0, 3.0, 0.0]), [1.0, 2.0, 0.0]);
        let cylinder = Round { centre: [0.0; 3], axis: [0.0, 0.0, 1.0], radius: 1.0 };
        assert_eq!(cylinder.nearest([3.0, 4.0, 5.0]), [0.6, 0.8, 5.0]);
        assert_eq!(cylinder.distance([0.0, 3.0, 9.0]), 2.0);
    }
}
