//! Fields that are linear on each cell, with fluxes that are linear along the sides: those of Brezzi, Douglas and
//! Marini of lowest order (Numer. Math. 47, 1985).

use crate::mesh::{Sides, difference, dot};

/// Fluxes through a side, one for each of its nodes by increasing numbers: what would leave if the density were that at
/// the node everywhere. Between the nodes the density is linear, and the mean of the fluxes is the flux.
pub(super) type SideFlux<const D: usize> = [f64; D];

/// Outflows of a cell with these nodes, by the vertex opposite to the side and the vertex at which the density is
/// taken; the flux through a side has one number if the density is constant along it.
#[inline(always)]
pub(super) fn outflows<const V: usize, const N: usize>(
    sides: &Sides<V>,
    cell: u32,
    nodes: &[u32; V],
    flux: &[[f64; N]],
) -> [[f64; V]; V] {
    let mut outflows = [[0.0; V]; V];
    for (opposite, side) in sides.numbers(cell).into_iter().enumerate() {
        let sign = if sides.leaves(cell, side) { 1.0 } else { -1.0 };
        for vertex in (0..V).filter(|vertex| *vertex != opposite) {
            let is_second = N > 1 && nodes[vertex] > nodes[3 - opposite - vertex];
            outflows[opposite][vertex] = sign * flux[side as usize][usize::from(is_second)];
        }
    }
    outflows
}

/// Values at the vertices of the linear field on a cell with these outflows, as [`outflows`] has them.
#[inline(always)]
pub(super) fn at_vertices<const D: usize, const V: usize>(
    vertices: &[[f64; D]; V],
    volume: f64,
    outflows: &[[f64; V]; V],
) -> [[f64; D]; V] {
    // A field along the edge between two vertices flows through no other side at its end.
    let mut values = [[0.0; D]; V];
    let inverse = 1.0 / (D as f64 * volume);
    for (vertex, value) in values.iter_mut().enumerate() {
        for opposite in (0..V).filter(|opposite| *opposite != vertex) {
            let along = inverse * outflows[opposite][vertex];
            for d in 0..D {
                value[d] += along * (vertices[vertex][d] - vertices[opposite][d]);
            }
        }
    }
    values
}

/// Integral over a cell of the product of two linear fields with these values at the vertices.
#[inline(always)]
pub(super) fn product<const D: usize, const V: usize>(
    volume: f64,
    one: &[[f64; D]; V],
    two: &[[f64; D]; V],
) -> f64 {
    let products: f64 = one.iter().zip(two).map(|(a, b)| dot(*a, *b)).sum();
    volume * (products + dot(total(one), total(two))) / (V * (V + 1)) as f64
}

/// Sum of the values at the vertices.
#[inline(always)]
pub(super) fn total<const D: usize, const V: usize>(values: &[[f64; D]; V]) -> [f64; D] {
    let mut sum = [0.0; D];
    for value in values {
        sum.iter_mut().zip(value).for_each(|(sum, x)| *sum += x);
    }
    sum
}

/// Upper bound of the square of the norm of a field for any signs of the outflows, the size of its rounding errors.
#[inline(always)]
pub(super) fn largest_square<const D: usize, const V: usize>(
    vertices: &[[f64; D]; V],
    volume: f64,
    outflows: &[[f64; V]; V],
) -> f64 {
    // By the density, since the square of an outflow times a length may exceed the range of numbers.
    let inverse = 1.0 / (D as f64 * volume);
    let mut squares = 0.0;
    for one in 0..V {
        for two in 0..one {
            let edge = difference(vertices[one], vertices[two]);
            let most = inverse * outflows[one][two].abs().max(outflows[two][one].abs());
            squares += 2.0 * edge.iter().map(|x| (most * x) * (most * x)).sum::<f64>();
        }
    }
    // The square of a sum is at most the sum of the squares times their number: D fields at each vertex, V vertices.
    volume * squares * (D * (V + 1)) as f64 / (V * (V + 1)) as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bounds::triangulation::cells::gradient;
    use crate::mesh::Element;

    const TETRAHEDRON: [[f64; 3]; 4] =
        [[0.0, 0.1, 0.0], [1.0, 0.0, 0.2], [0.1, 1.0, 0.0], [0.0, 0.3, 1.0]];

    #[test]
    fn constant_fields_have_their_norm() {
        let element = Element::<3, 4>::new(TETRAHEDRON);
        let slope = gradient(&element, [1.0, 3.0, -2.0, 0.5]);
        let outflows = element.gradients.map(|g| [-3.0 * element.volume * dot(g, slope); 4]);
        let values = at_vertices(&TETRAHEDRON, element.volume, &outflows);
        for value in values {
            assert!((0..3).all(|d| (value[d] - slope[d]).abs() < 1e-13));
        }
        let expected = element.volume * dot(slope, slope);
        let square = product(element.volume, &values, &values);
        assert!((square - expected).abs() < 1e-14 * expected);
        assert!(largest_square(&TETRAHEDRON, element.volume, &outflows) >= expected);
    }

    #[test]
    fn the_field_that_grows_from_a_corner_has_its_norm() {
        // x on the triangle with corners 0, (1, 0), (0, 1): no flux through the sides at 0, 1 through the third one.
        let triangle = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
        let values = at_vertices(&triangle, 0.5, &[[1.0; 3], [0.0; 3], [0.0; 3]]);
        assert_eq!(values, triangle);
        // The integral of x^2 + y^2.
        assert!((product(0.5, &values, &values) - 1.0 / 6.0).abs() < 1e-15);
    }
}
