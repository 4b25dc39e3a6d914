//! Cells with a linear function w and an f that is constant on each: what the flux must carry, and the field that has
//! given fluxes through the sides.

use crate::machine::threads::{for_runs, items_per_task};
use crate::mesh::{Element, Mesh, centroid, dot, volume};
use crate::problem::law::Law;

/// Numbers whose work takes as long as that on a cell.
pub(super) const COST: usize = 8;

/// Cell as far as the outflows wanted from it are concerned.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cell<const V: usize> {
    /// Area or volume.
    pub volume: f64,
    /// True if the vertices are numbered in the negative sense.
    pub is_mirrored: bool,
    /// Integral of f over the number of vertices.
    pub load: f64,
    /// Integrals of `grad w . grad phi` for the hat functions phi of the vertices. The flux of `grad w` out of the cell
    /// through the side opposite to a vertex is minus D times the integral of the vertex.
    pub work: [f64; V],
}

/// Cells of a mesh, computed where they are asked for: stored, they would take more memory than the mesh.
#[derive(Clone, Copy)]
pub(super) struct Cells<'a, const D: usize, const V: usize> {
    pub mesh: &'a Mesh<D, V>,
    /// Nodal vector of the linear function.
    pub w: &'a [f64],
    /// Means of f.
    pub f: &'a [f64],
    /// Law on the boundary in contact.
    pub law: Law,
}

impl<const D: usize, const V: usize> Cells<'_, D, V> {
    /// Cell of this number.
    pub(super) fn cell(&self, number: u32) -> Cell<V> {
        let nodes = &self.mesh.cells()[number as usize];
        let element = Element::new(self.mesh.vertices(nodes));
        let gradient = gradient(&element, nodes.map(|node| self.w[node as usize]));
        Cell {
            volume: element.volume,
            is_mirrored: element.is_mirrored,
            load: self.load_on(number, element.volume),
            work: element.gradients.map(|slopes| element.volume * dot(gradient, slopes)),
        }
    }

    /// Integrals of f over all cells.
    pub(super) fn masses(&self) -> Vec<f64> {
        let (nodes, mut masses) = (self.mesh.cells(), self.f.to_vec());
        let run = items_per_task(masses.len(), COST);
        for_runs(&mut masses, run, &|number, masses| {
            for (nodes, mass) in nodes[number * run..].iter().zip(masses) {
                *mass *= volume(self.mesh.vertices(nodes));
            }
        });
        masses
    }

    fn load_on(&self, number: u32, volume: f64) -> f64 {
        self.f[number as usize] * volume / V as f64
    }
}

/// Gradient of the linear function with these values at the vertices. Differences come first: a constant has no
/// gradient, not even by rounding.
pub(super) fn gradient<const D: usize, const V: usize>(
    element: &Element<D, V>,
    values: [f64; V],
) -> [f64; D] {
    element.gradient(values.map(|value| value - values[0]))
}

/// Fields of Raviart and Thomas of lowest order on a cell. The field with an outflow of 1 through
/// the side opposite to vertex a, and 0 through the others, is `(x - a) / (D volume)`.
#[derive(Clone, Copy, Debug)]
pub(super) struct RaviartThomas<const D: usize, const V: usize> {
    /// Centroid less each vertex.
    to_centre: [[f64; D]; V],
    /// Volume.
    volume: f64,
    /// One over D times the volume.
    inverse: f64,
}

impl<const D: usize, const V: usize> RaviartThomas<D, V> {
    /// Fields on the cell with these vertices and this volume.
    pub(super) fn new(vertices: [[f64; D]; V], volume: f64) -> Self {
        let centre = centroid(vertices);
        let to_centre = vertices.map(|vertex| difference(centre, vertex));
        Self { to_centre, volume, inverse: 1.0 / (D as f64 * volume) }
    }

    /// Mean of the field with these outflows through the sides.
    pub(super) fn mean(&self, outflows: [f64; V]) -> [f64; D] {
        let mut mean = [0.0; D];
        for (outflow, to_centre) in outflows.into_iter().zip(self.to_centre) {
            mean.iter_mut().zip(to_centre).for_each(|(sum, x)| *sum += outflow * x);
        }
        mean.map(|sum| sum * self.inverse)
    }

    /// Square of the L2 norm of the field with these outflows through the sides.
    pub(super) fn square(&self, outflows: [f64; V]) -> f64 {
        let mean = self.mean(outflows);
        let density = outflows.iter().sum::<f64>() * self.inverse;
        self.volume * (dot(mean, mean) + density * density * self.spread())
    }

    /// Upper bound of [`RaviartThomas::square`] for any signs of the outflows, the size of its rounding errors.
    pub(super) fn largest_square(&self, outflows: [f64; V]) -> f64 {
        // The square of a sum is at most the sum of the squares times their number.
        let squares = outflows.iter().zip(self.to_centre).map(|(q, x)| {
            let density = q * self.inverse;
            density * density * (dot(x, x) + self.spread())
        });
        V as f64 * self.volume * squares.sum::<f64>()
    }

    /// Mean square of the distance from the centroid.
    fn spread(&self) -> f64 {
        let squares: f64 = self.to_centre.iter().map(|&x| dot(x, x)).sum();
        squares / (V * (V + 1)) as f64
    }
}

/// Difference of two points.
pub(super) fn difference<const D: usize>(to: [f64; D], from: [f64; D]) -> [f64; D] {
    std::array::from_fn(|d| to[d] - from[d])
}

#[cfg(test)]
mod tests {
    use super::*;

    const TETRAHEDRON: [[f64; 3]; 4] =
        [[0.0, 0.1, 0.0], [1.0, 0.0, 0.2], [0.1, 1.0, 0.0], [0.0, 0.3, 1.0]];

    #[test]
    fn fields_of_constant_gradients_have_their_norm() {
        let element = Element::<3, 4>::new(TETRAHEDRON);
        let fields = RaviartThomas::new(TETRAHEDRON, element.volume);
        let slope = gradient(&element, [1.0, 3.0, -2.0, 0.5]);
        let outflows = element.gradients.map(|g| -3.0 * element.volume * dot(g, slope));
        let expected = element.volume * dot(slope, slope);
        assert!((fields.square(outflows) - expected).abs() < 1e-14 * expected);
        assert!(difference(fields.mean(outflows), slope).iter().all(|d| d.abs() < 1e-13));
        assert!(fields.largest_square(outflows) >= expected);
    }

    #[test]
    fn the_field_that_grows_from_the_centre_has_its_norm() {
        // x on the triangle with corners 0, (1, 0), (0, 1): no flux through the sides at 0, 1 through the third one.
        let fields = RaviartThomas::<2, 3>::new([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]], 0.5);
        // The integral of x^2 + y^2.
        assert!((fields.square([1.0, 0.0, 0.0]) - 1.0 / 6.0).abs() < 1e-15);
    }
}
