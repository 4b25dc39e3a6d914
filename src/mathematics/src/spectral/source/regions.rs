//! Borders between regions of a mesh on which f differs: the polygons that the edges of the mesh are. No part of a mesh
//! lies inside of it, so that no circle can be named for a border.

use crate::mesh::PlaneMesh;
use crate::problem::complex::Complex;
use crate::problem::source::Source;
use crate::spectral::geometry::domain::PlaneError;
use crate::spectral::geometry::outline::{MeshOutline, OutlineEdge};
use crate::spectral::source::{RegionBorder, Regions};
use std::collections::BTreeMap;

/// Returns f with these pieces on the regions of a mesh.
///
/// # Errors
/// [`PlaneError::Domain`] if a border bends by too little for a corner.
pub(in crate::spectral) fn regions(
    mesh: &PlaneMesh,
    pieces: Vec<Source>,
) -> Result<Regions, PlaneError> {
    // Regions with the same f are one.
    let first = pieces.iter().map(|f| pieces.iter().position(|other| other == f));
    let first: Vec<usize> = first.map(|first| first.expect("f is itself")).collect();
    let mut left: BTreeMap<[u32; 2], usize> = BTreeMap::new();
    for (&[a, b, c], &region) in mesh.cells().iter().zip(mesh.regions()) {
        left.extend([[a, b], [b, c], [c, a]].map(|edge| (edge, first[usize::from(region)])));
    }
    let beside = |[a, b]: [u32; 2]| [[a, b], [b, a]].map(|edge| left.get(&edge).copied());
    let is_border = |&&[a, b]: &&[u32; 2]| {
        let [one, other] = beside([a, b]);
        one != other && (a < b || other.is_none())
    };
    let edges: Vec<[u32; 2]> = left.keys().filter(is_border).copied().collect();
    let mut borders = Vec::new();
    for nodes in paths(&edges) {
        let regions = beside([nodes[0], nodes[1]]);
        let points = nodes.iter().map(|&node| mesh.points()[node as usize]);
        let points: Vec<_> = points.map(|[x, y]| Complex::new(x, y)).collect();
        let edges = vec![OutlineEdge::default(); points.len() - 1];
        let sides = MeshOutline::new(points, edges).sides()?;
        borders.extend(sides.into_iter().map(|side| RegionBorder { side, regions }));
    }
    Ok(Regions { borders, pieces })
}

/// Paths of edges, each edge once, between nodes in which other than two edges meet; closed paths begin and end in one
/// node.
fn paths(edges: &[[u32; 2]]) -> Vec<Vec<u32>> {
    let mut beside: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
    for &[a, b] in edges {
        beside.entry(a).or_default().push(b);
        beside.entry(b).or_default().push(a);
    }
    let (through, ends): (Vec<u32>, Vec<u32>) =
        beside.keys().copied().partition(|node| beside[node].len() == 2);
    let mut paths = Vec::new();
    for &start in ends.iter().chain(&through) {
        while let Some(mut node) = step(&mut beside, start) {
            let mut path = vec![start, node];
            while node != start
                && through.binary_search(&node).is_ok()
                && let Some(next) = step(&mut beside, node)
            {
                path.push(next);
                node = next;
            }
            paths.push(path);
        }
    }
    paths
}

/// Goes from a node along an edge, which it takes away from both ends.
fn step(beside: &mut BTreeMap<u32, Vec<u32>>, node: u32) -> Option<u32> {
    let next = beside.get_mut(&node)?.pop()?;
    beside.entry(next).or_default().retain(|&other| other != node);
    Some(next)
}
