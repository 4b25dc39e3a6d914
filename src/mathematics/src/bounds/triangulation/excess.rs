//! Difference of a value of a law by a formula from its linear interpolation on a facet, as a function on the cell.
//!
//! Let e be the value less its linear interpolation through the nodes of a facet, and P the vertex of the cell opposite
//! to it. On the cell E is `t e(q)`, t one less the hat function of P, q where the ray from P through the point meets
//! the facet: E is e on the facet and 0 on the other sides. So for a linear w with the values of the law at the nodes w
//! + E has them on the whole facet, and `w + E - at` is linear there: what a law makes of it is exact.
//!
//! E is homogeneous of degree one in the distance from P, so that its gradient depends on q alone. With the vertices
//! F_k of the facet, `grad E . (F_k - P) = e + grad e . (F_k - q)`, and the points of the cell above dq have the weight
//! `D t^(D-1) dt`.

use super::cells::{Cells, at_nodes, gradient};
use super::linear::{at_vertices, outflows};
use crate::discrete::quadrature::{QuadraturePoint, facet_points};
use crate::mesh::{BoundarySide, Element, Facet, Sides, dot, sorted};
use crate::problem::formula::Formula;

/// Integrals that E adds in the cell of a facet.
#[derive(Default)]
pub(super) struct Excess {
    /// Square of the energy norm of E: the integral of `k |grad E|^2 + c E^2`.
    pub square: f64,
    /// Integral of `(k grad w - sigma) . grad E + c (w - q) E`; see `sums.rs` for q.
    pub with_distance: f64,
    /// Integral of `k grad w . grad E + c w E`.
    pub with_gradient: f64,
    /// Integral of E.
    pub integral: f64,
    /// Integral over the facet of the value times sigma.n.
    pub of_value: f64,
}

/// Half the difference of two points for a derivative along a facet, over the distance of a vertex.
const STEP: f64 = 1e-5;

/// Facet of the boundary with its cell and the formula of its value.
struct FormulaFacet<'a, const D: usize> {
    corners: [[f64; D]; D],
    /// Values at the corners.
    ends: [f64; D],
    value: &'a Formula,
}

impl<const D: usize> FormulaFacet<'_, D> {
    /// Linear interpolation of the value at a point, and e.
    fn at(&self, point: &QuadraturePoint<D>) -> [f64; 2] {
        let linear = point.barycentric.iter().zip(self.ends).map(|(b, end)| b * end).sum();
        [linear, self.value.at(&point.within(self.corners)) - linear]
    }

    /// Derivative of e at a point towards a corner.
    fn slope(&self, point: &QuadraturePoint<D>, corner: usize) -> f64 {
        let [less, more] = [-STEP, STEP].map(|step| {
            let mut moved = *point;
            moved.barycentric.iter_mut().for_each(|b| *b *= 1.0 - step);
            moved.barycentric[corner] += step;
            self.at(&moved)[1]
        });
        (more - less) / (2.0 * STEP)
    }
}

/// Integrals of E for a facet whose value is this formula.
pub(super) fn excess<const D: usize, const V: usize, const N: usize>(
    &Cells { mesh, w, f }: &Cells<'_, D, V>,
    sides: &Sides<V>,
    flux: &[[f64; N]],
    (facet, at, value): (&Facet<D>, &BoundarySide, &Formula),
) -> Excess {
    let nodes = &mesh.cells()[at.cell as usize];
    let vertices = mesh.vertices(nodes);
    let element = Element::new(vertices);
    let opposite = sides.slot(at.cell, at.side);
    let on_facet = sorted(facet.nodes);
    let corners = on_facet.map(|node| mesh.points()[node as usize]);
    let of_facet = FormulaFacet { corners, ends: corners.map(|corner| value.at(&corner)), value };
    let places = on_facet.map(|node| nodes.iter().position(|own| *own == node).unwrap_or(opposite));
    let outflows = outflows(sides, at.cell, nodes, flux);
    let sigma = at_vertices(&vertices, element.volume, &outflows);
    let k = mesh.k(at.cell as usize);
    let slope = gradient(&element, at_nodes(nodes, w)).map(|slope| k * slope);
    let (c, values) = (mesh.reaction, at_nodes(nodes, w));
    let outflow = outflows.as_flattened().iter().sum::<f64>() / D as f64;
    let of_q = f.mean[at.cell as usize] + outflow / element.volume;
    let d = D as f64;
    let mut found = Excess::default();
    for point in facet_points::<D>() {
        let QuadraturePoint { barycentric, weight } = point;
        let [linear, e] = of_facet.at(&point);
        let (mut of_e, mut apart) = ([0.0; D], slope);
        for (corner, place) in places.into_iter().enumerate() {
            let along = e + of_facet.slope(&point, corner);
            of_e.iter_mut().zip(element.gradients[place]).for_each(|(sum, of)| *sum += along * of);
        }
        for (j, apart) in apart.iter_mut().enumerate() {
            let on_facet: f64 = barycentric.iter().zip(places).map(|(b, k)| b * sigma[k][j]).sum();
            *apart -= (sigma[opposite][j] + d * on_facet) / (d + 1.0);
        }
        let volume = weight * element.volume;
        found.square += k * volume * dot(of_e, of_e);
        found.with_distance += volume * dot(apart, of_e);
        found.with_gradient += volume * dot(slope, of_e);
        found.integral += volume * e * d / (d + 1.0);
        if c > 0.0 {
            let on_facet: f64 = barycentric.iter().zip(places).map(|(b, k)| b * values[k]).sum();
            let with_w = volume * e * d / (d + 2.0) * (on_facet + values[opposite] / (d + 1.0));
            found.square += c * volume * e * e * d / (d + 2.0);
            found.with_gradient += c * with_w;
            found.with_distance += c * with_w - of_q * volume * e * d / (d + 1.0);
        }
        let density = std::array::from_fn::<_, D, _>(|k| flux[at.side as usize][k.min(N - 1)]);
        let density: f64 = barycentric.iter().zip(density).map(|(b, q)| b * q).sum();
        found.of_value += weight * density * (linear + e);
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{CellData, MeshData};

    #[test]
    fn integrals_with_a_reaction_are_those_of_the_function_of_the_ray() {
        // e = x^2 - x on the edge from (0, 0) to (1, 0); w is 3 there and 5 at the opposite vertex, and c q is 2.
        let points = vec![[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
        let data = MeshData { points, cells: vec![[0, 1, 2]], ..MeshData::default() };
        let mut mesh = data.mesh().unwrap();
        (mesh.k, mesh.reaction) = (vec![1e-30], 7.0);
        let f = CellData { mean: vec![2.0], deviation: None, shares: None };
        let cells = Cells { mesh: &mesh, w: &[3.0, 3.0, 5.0], f: &f };
        let sides = Sides::new(&mesh);
        let bottom = mesh.facets().iter().zip(sides.of_facets());
        let (facet, at) = bottom.into_iter().find(|(of, _)| sorted(of.nodes) == [0, 1]).unwrap();
        let value = Formula::read("x^2", 2).unwrap();
        let found = excess(&cells, &sides, &[[0.0; 2]; 3], (facet, at, &value));
        let with_w = 3.0 * (-1.0 / 18.0) + 2.0 * (-1.0 / 72.0);
        for (found, expected) in [
            (found.integral, -1.0 / 18.0),
            (found.square, 7.0 / 120.0),
            (found.with_gradient, 7.0 * with_w),
            (found.with_distance, 7.0 * with_w + 2.0 / 18.0),
        ] {
            assert!((found - expected).abs() < 1e-12, "{found} {expected}");
        }
    }
}
