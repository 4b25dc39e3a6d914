//! Parts of the domain between the chords of the mesh and the curve of the boundary, which the bounds do not see.

use crate::mesh::{Element, Mesh, Sides, dot, measure};

/// Size of the energy in the segment between a facet and its curve. It is no bound: the solution there is taken for
/// that in the cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct CurveShare {
    /// Number of the cell.
    pub cell: u32,
    /// Twice the energy: `(2/3) l s (k (|grad w| + |f| d / k)^2 + 2 |f w|)`, l the length of the chord, s the height of
    /// the arc, d the distance of the chord from the centroid of the cell, where its gradient is that of the solution.
    pub square: f64,
}

/// Returns the shares of all facets on curves, for the means of f over the cells and a nodal vector; none if no part of
/// the boundary is curved, and in space.
pub(crate) fn curve_shares<const D: usize, const V: usize>(
    mesh: &Mesh<D, V>,
    sides: &Sides<V>,
    f: &[f64],
    w: &[f64],
) -> Option<Vec<CurveShare>> {
    if D != 2 || mesh.parts().iter().all(|part| part.curve.is_none()) {
        return None;
    }
    let mut shares = Vec::new();
    for (facet, side) in mesh.facets().iter().zip(sides.of_facets()) {
        let Some(curve) = mesh.parts()[usize::from(facet.part)].curve else { continue };
        let nodes = &mesh.cells()[side.cell as usize];
        let (cell, k) = (Element::new(mesh.vertices(nodes)), mesh.k(side.cell as usize));
        let gradient = cell.gradient(nodes.map(|node| w[node as usize]));
        let mean = facet.nodes.iter().map(|&node| w[node as usize]).sum::<f64>() / D as f64;
        let length = measure(mesh.corners(facet));
        let area = length * length * length / (12.0 * curve.radius);
        let (f, to_chord) = (f[side.cell as usize], 2.0 / 3.0 * cell.volume / length);
        let slope = dot(gradient, gradient).sqrt() + f.abs() * to_chord / k;
        let density = k * slope * slope + 2.0 * (f * mean).abs();
        shares.push(CurveShare { cell: side.cell, square: area * density });
    }
    Some(shares)
}
