//! The boundary of a domain in the plane as closed curves.

use super::PlaneMesh;

/// No node.
pub(super) const NONE: usize = usize::MAX;

/// Neighbours of each node on the boundary, in the direction that has the domain on the left; [`NONE`] of other nodes.
pub(super) struct BoundaryLinks {
    pub(super) before: Vec<usize>,
    pub(super) after: Vec<usize>,
}

/// Closed curve of the boundary.
#[derive(Clone, Debug, PartialEq)]
pub struct BoundaryCurve {
    /// Nodes in the direction that has the domain on the left, from the lowest one, of several the leftmost.
    pub nodes: Vec<usize>,
    /// Positions of the parts on the curve in the parts of the mesh.
    pub parts: Vec<usize>,
}

impl BoundaryLinks {
    pub(super) fn new(mesh: &PlaneMesh) -> Self {
        let nodes = mesh.points.len();
        let mut links = Self { before: vec![NONE; nodes], after: vec![NONE; nodes] };
        for facet in &mesh.facets {
            let [from, to] = facet.nodes.map(|node| node as usize);
            (links.after[from], links.before[to]) = (to, from);
        }
        links
    }
}

/// Returns the closed curves of the boundary, from the one with the lowest node on.
pub fn boundary_curves(mesh: &PlaneMesh) -> Vec<BoundaryCurve> {
    let BoundaryLinks { mut after, .. } = BoundaryLinks::new(mesh);
    let mut starts: Vec<usize> =
        (0..mesh.points.len()).filter(|&node| after[node] != NONE).collect();
    starts.sort_by(|&a, &b| {
        let [[ax, ay], [bx, by]] = [mesh.points[a], mesh.points[b]];
        ay.total_cmp(&by).then(ax.total_cmp(&bx))
    });
    let mut curve_of = vec![NONE; mesh.points.len()];
    let mut curves: Vec<BoundaryCurve> = Vec::new();
    for start in starts {
        let (mut node, mut nodes) = (start, Vec::new());
        while after[node] != NONE {
            curve_of[node] = curves.len();
            nodes.push(node);
            node = std::mem::replace(&mut after[node], NONE);
        }
        if !nodes.is_empty() {
            curves.push(BoundaryCurve { nodes, parts: Vec::new() });
        }
    }
    for facet in &mesh.facets {
        let parts = &mut curves[curve_of[facet.nodes[0] as usize]].parts;
        if !parts.contains(&(facet.part as usize)) {
            parts.push(facet.part as usize);
        }
    }
    curves.iter_mut().for_each(|curve| curve.parts.sort_unstable());
    curves
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{BuiltIn, refine};

    #[test]
    fn the_annulus_has_two_curves_that_run_with_the_domain_on_their_left() {
        let mesh = refine(&BuiltIn::Annulus.plane().unwrap()).unwrap().mesh;
        let curves = boundary_curves(&mesh);
        assert_eq!(curves.len(), 2);
        assert_eq!(curves.iter().map(|curve| curve.nodes.len()).sum::<usize>(), mesh.facets.len());
        for (curve, turns) in curves.iter().zip([1.0, -1.0]) {
            assert_eq!(curve.parts.len(), 1);
            let place = |k: usize| mesh.points[curve.nodes[k % curve.nodes.len()]];
            let area: f64 = (0..curve.nodes.len())
                .map(|k| {
                    let ([ax, ay], [bx, by]) = (place(k), place(k + 1));
                    0.5 * (ax * by - ay * bx)
                })
                .sum();
            assert!(area * turns > 0.0, "{area}");
            assert!((0..curve.nodes.len()).all(|k| place(0)[1] <= place(k)[1]));
        }
    }
}
