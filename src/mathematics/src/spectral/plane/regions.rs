//! Borders between regions of a mesh on which f differs: straight, or arcs of circles.

use super::outline::{MeshOutline, OutlineEdge, circle_through};
use super::{PlaneError, RegionBorder, Regions};
use crate::mesh::{PlaneMesh, Round};
use crate::problem::complex::Complex;
use crate::problem::source::Source;
use crate::spectral::complex::arg;
use std::collections::BTreeMap;

/// Returns f with these pieces on the regions of a mesh.
///
/// # Errors
/// [`PlaneError::Domain`] if a border is neither straight nor an arc.
pub(super) fn regions(mesh: &PlaneMesh, pieces: Vec<Source>) -> Result<Regions, PlaneError> {
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
        let edges = on_circles(&points);
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
    let is_through = |node: &u32| beside[node].len() == 2;
    let (through, ends): (Vec<u32>, Vec<u32>) = beside.keys().copied().partition(is_through);
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

/// Least number of edges of a path that are taken for an arc of a circle.
const LEAST: usize = 6;
/// Most that two such edges turn, in radians: polygons of up to thirteen sides remain polygons.
const MOST_TURN: f64 = 0.46;
/// Distance of their nodes from the circle, in radii.
const ON_CIRCLE: f64 = 1e-9;

/// Edges between points, those whose ends lie on a circle with it.
fn on_circles(points: &[Complex]) -> Vec<OutlineEdge> {
    let mut edges = vec![OutlineEdge::default(); points.len() - 1];
    let mut from = 0;
    while from + LEAST < points.len() {
        let mut to = from + 2;
        while to + 1 < points.len() && goes_on(&points[from..], to - from) {
            to += 1;
        }
        if to - from < LEAST {
            from += 1;
            continue;
        }
        // Of all such circles, the one through points far apart has least of their rounding.
        let circle = circle_through([0, 1, 2].map(|k| points[from + k * (to - from) / 3]));
        edges[from..to].fill(OutlineEdge { circle, ..OutlineEdge::default() });
        from = to;
    }
    edges
}

/// True if the edge after the point of this number lies on the circle through the first three points, and turns
/// little.
fn goes_on(points: &[Complex], k: usize) -> bool {
    let (u, v) = (points[k] - points[k - 1], points[k + 1] - points[k]);
    let turn = arg(u.conj() * v).abs();
    let circle: Option<Round<2>> = circle_through([points[0], points[1], points[2]]);
    let off = circle.map(|circle| circle.distance(points[k + 1].coordinates()) / circle.radius);
    turn < MOST_TURN && off.is_some_and(|off| off < ON_CIRCLE)
}
