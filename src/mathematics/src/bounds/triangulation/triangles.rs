//! Shapes of the cells of a mesh in the plane, found once for all nodes of each.

use super::cells::COST;
use crate::machine::threads::{for_runs, items_per_task};
use crate::mesh::{Mesh, difference, dot};

/// Shape of a triangle.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Triangle {
    /// Minus the product of the gradients of the hat functions at both ends of each side, opposite to the first vertex
    /// and so on, over k: half the cotangent of the angle there. The products of fields are made of them.
    pub couplings: [f64; 3],
    /// Area.
    pub area: f64,
}

impl Triangle {
    fn new<const D: usize>(vertices: [[f64; D]; 3], k: f64) -> Self {
        let [x, y, z] = vertices;
        let edges = [difference(z, y), difference(x, z), difference(y, x)];
        let double = (edges[0][0] * edges[1][1] - edges[0][1] * edges[1][0]).abs();
        let [a, b, c] = edges;
        let couplings =
            [dot(b, c), dot(c, a), dot(a, b)].map(|product| -0.5 * product / (double * k));
        Self { couplings, area: 0.5 * double }
    }

    /// Product, over k, of the field of lowest order that has these outflows through the sides and the one that turns
    /// once around a vertex.
    #[inline(always)]
    pub(super) fn turn(&self, vertex: usize, outflows: [f64; 3]) -> f64 {
        let [next, last] = [(vertex + 1) % 3, (vertex + 2) % 3];
        let [a, b] = [self.couplings[next], self.couplings[last]];
        let of_others = outflows[next] * (a + a + b) - outflows[last] * (a + b + b);
        (outflows[vertex] * (b - a) + of_others) / 3.0
    }
}

/// Triangles of a mesh; none in space.
pub(super) fn triangles<const D: usize, const V: usize>(mesh: &Mesh<D, V>) -> Vec<Triangle> {
    if D != 2 {
        return Vec::new();
    }
    let cells = mesh.cells();
    let mut triangles = vec![Triangle::default(); cells.len()];
    let each = items_per_task(cells.len(), COST);
    for_runs(&mut triangles, each, &|run, triangles| {
        for (number, triangle) in (run * each..).zip(triangles) {
            let vertices = [0, 1, 2].map(|k| mesh.points()[cells[number][k] as usize]);
            *triangle = Triangle::new(vertices, mesh.k(number));
        }
    });
    triangles
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bounds::triangulation::linear::{at_vertices, product};
    use crate::mesh::Element;

    #[test]
    fn products_are_those_of_the_fields() {
        let vertices = [[0.1, 0.2], [1.3, -0.1], [0.4, 0.9]];
        let (triangle, element) = (Triangle::new(vertices, 1.0), Element::new(vertices));
        assert!((triangle.area - element.volume).abs() < 1e-15);
        let outflows = [0.3, -1.7, 0.8];
        let field = at_vertices(&vertices, element.volume, &outflows.map(|outflow| [outflow; 3]));
        for (k, [x, y]) in element.gradients.into_iter().enumerate() {
            let turned = product(element.volume, &field, &[[y, -x]; 3]);
            assert!((triangle.turn(k, outflows) - turned).abs() < 1e-15);
            let [i, j] = [(k + 1) % 3, (k + 2) % 3];
            assert!((triangle.couplings[k] + element.stiffness(i, j)).abs() < 1e-15);
        }
    }
}
