//! Nodes of the boundary inside a facet, or in space inside an edge of a facet: they hang there, or two sides of the
//! domain are in contact that are meshed apart.

use super::check::domains;
use super::error::MeshError;
use super::facet_boxes::{FacetBoxes, NEAR};
use super::facets::{BoundaryFacets, sorted};
use super::geometry::{difference, dot, size};
use super::{Facet, MeshData};
use std::collections::{HashMap, HashSet};

/// Node that lies on a facet, and in no corner of the facet.
#[derive(Clone, Debug)]
struct NodeOnFacet {
    node: u32,
    /// Position of the facet.
    facet: u32,
    /// Corners of the facet, or of the edge of it on which the node lies.
    corners: Vec<u32>,
}

impl<const D: usize, const V: usize> MeshData<D, V> {
    /// Checks that no node hangs; returns what is to be told of sides in contact that are meshed apart.
    pub(super) fn check_hanging(
        &self,
        boundary: &BoundaryFacets<D>,
    ) -> Result<Option<String>, MeshError> {
        let BoundaryFacets { facets, cells, boxes, .. } = boundary;
        let found = nodes_on_facets(&self.points, facets, boxes);
        let tags = |on: &NodeOnFacet| {
            let cell = cells[on.facet as usize];
            [self.tags.node(on.node as usize), self.tags.cell(cell as usize)]
        };
        let domains = domains::<D>();
        if let Some([node, cell]) = hanging_node(facets, &found).map(tags) {
            return Err(MeshError::Hanging { cell, node, domains });
        }
        Ok(found.first().map(tags).map(|[node, cell]| {
            format!(
                "node {node} lies on a side of element {cell} that does not have it: sides in contact are meshed \
                 apart, and v has a value for each; to join them, fragment the {domains} in Gmsh, and mesh again"
            )
        }))
    }
}

/// Returns the nodes of the boundary that lie on facets of others.
///
/// A node with the coordinates of a corner does not: domains may touch, and have slits.
fn nodes_on_facets<const D: usize>(
    points: &[[f64; D]],
    facets: &[Facet<D>],
    boxes: &FacetBoxes<D>,
) -> Vec<NodeOnFacet> {
    let mut is_node = vec![false; points.len()];
    facets.iter().flat_map(|facet| facet.nodes).for_each(|node| is_node[node as usize] = true);
    let mut found = Vec::new();
    for (&point, node) in points.iter().zip(0..).filter(|(_, node)| is_node[*node as usize]) {
        for facet in boxes.near_point(point) {
            let nodes = facets[facet as usize].nodes;
            if nodes.contains(&node) {
                continue;
            }
            let places = nodes.map(|node| points[node as usize]);
            if let Some(corners) = corners_around(places, point) {
                let corners = corners.into_iter().map(|k| nodes[k]).collect();
                found.push(NodeOnFacet { node, facet, corners });
            }
        }
    }
    found
}

/// Returns the first of the nodes on facets that hangs, if there is one.
///
/// Cells of both sides that do not overlap lie on either side of the facet. The node hangs if the other side has all
/// corners of the facet, or of the edge on which the node lies, too: then both are one domain, of which the other side
/// is divided. Else both have nodes of their own, as the lips of a slit have, which may be refined apart.
fn hanging_node<'a, const D: usize>(
    facets: &[Facet<D>],
    found: &'a [NodeOnFacet],
) -> Option<&'a NodeOnFacet> {
    let nodes: HashSet<u32> = found.iter().map(|on| on.node).collect();
    let mut edges: HashSet<[u32; 2]> = HashSet::new();
    for facet in facets.iter().filter(|facet| facet.nodes.iter().any(|node| nodes.contains(node))) {
        edges.extend(pairs::<D>().map(|pair| sorted(pair.map(|k| facet.nodes[k]))));
    }
    let mut on_facet: HashMap<u32, Vec<&NodeOnFacet>> = HashMap::new();
    found.iter().for_each(|on| on_facet.entry(on.facet).or_default().push(on));
    found.iter().find(|hanging| {
        hanging.corners.iter().all(|&corner| {
            on_facet[&hanging.facet].iter().any(|other| {
                other.corners.iter().all(|corner| hanging.corners.contains(corner))
                    && edges.contains(&sorted([corner, other.node]))
            })
        })
    })
}

/// Positions of the corners of a facet, or of the edge of it, on which a point lies; none if it does not, or lies in
/// one of the corners.
fn corners_around<const D: usize>(corners: [[f64; D]; D], point: [f64; D]) -> Option<Vec<usize>> {
    // In units of the size, from the point on.
    let size = size(corners);
    let corners = corners
        .map(|corner| -> [f64; D] { std::array::from_fn(|d| (corner[d] - point[d]) / size) });
    if corners.iter().any(|&corner| dot(corner, corner) <= NEAR * NEAR) {
        return None;
    }
    let edge = pairs::<D>().find(|&[i, k]| edge_meets_origin(corners[i], corners[k]));
    match edge {
        Some(edge) => Some(edge.to_vec()),
        None if D == 3 && triangle_meets_origin(corners) => Some((0..D).collect()),
        None => None,
    }
}

/// Pairs of corners of a facet.
fn pairs<const D: usize>() -> impl Iterator<Item = [usize; 2]> {
    (0..D).flat_map(|k| (0..k).map(move |i| [i, k]))
}

/// True if the origin is next to the line between two points.
fn edge_meets_origin<const D: usize>(one: [f64; D], two: [f64; D]) -> bool {
    let edge = difference(two, one);
    let along = (-dot(one, edge) / dot(edge, edge)).clamp(0.0, 1.0);
    let nearest: [f64; D] = std::array::from_fn(|d| one[d] + along * edge[d]);
    dot(nearest, nearest) <= NEAR * NEAR
}

/// True if the origin is next to the inside of a triangle in space.
fn triangle_meets_origin<const D: usize>(corners: [[f64; D]; D]) -> bool {
    let origin = corners[0];
    let (one, two) = (difference(corners[1], origin), difference(corners[2], origin));
    let [a, b, c] = [dot(one, one), dot(one, two), dot(two, two)];
    let [p, q] = [-dot(origin, one), -dot(origin, two)];
    let determinant = a * c - b * b;
    let (s, t) = ((c * p - b * q) / determinant, (a * q - b * p) / determinant);
    let nearest: [f64; D] = std::array::from_fn(|d| origin[d] + s * one[d] + t * two[d]);
    // Written so that NaN is outside.
    s >= 0.0 && t >= 0.0 && s + t <= 1.0 && dot(nearest, nearest) <= NEAR * NEAR
}

#[cfg(test)]
mod tests {
    use super::*;

    fn facets<const D: usize>(nodes: &[[u32; D]]) -> Vec<Facet<D>> {
        nodes.iter().map(|&nodes| Facet { nodes, part: 0 }).collect()
    }

    /// First node on a facet, with the nodes of the facet.
    fn found<const D: usize>(points: &[[f64; D]], facets: &[Facet<D>]) -> Option<(u32, [u32; D])> {
        let corners = facets.iter().map(|facet| facet.nodes.map(|node| points[node as usize]));
        let on = nodes_on_facets(points, facets, &FacetBoxes::new(corners)).into_iter().next()?;
        Some((on.node, facets[on.facet as usize].nodes))
    }

    /// True if a point lies on a facet, whatever the scale and place of both.
    fn lies_on<const D: usize>(corners: [[f64; D]; D], point: [f64; D]) -> bool {
        let (mut answers, nodes) = (Vec::new(), std::array::from_fn(|k| k as u32));
        for (scale, shift) in [(1.0, 0.0), (1e-6, 0.0), (1e8, 3e7), (1.0, -7.0)] {
            let points = corners.into_iter().chain([point]);
            let points: Vec<_> = points.map(|point| point.map(|x| scale * x + shift)).collect();
            // A second facet makes a boundary node of the point.
            let all = facets(&[nodes, std::array::from_fn(|k| (D - k) as u32)]);
            answers.push(found(&points, &all) == Some((D as u32, nodes)));
        }
        assert!(answers.iter().all(|answer| *answer == answers[0]), "{answers:?}");
        answers[0]
    }

    #[test]
    fn nodes_lie_on_edges_and_triangles_up_to_rounding_errors() {
        let edge = [[0.0, 0.0], [3.0, 1.0]];
        assert!(lies_on(edge, [1.5, 0.5]) && lies_on(edge, [0.03, 0.01 + 1e-10]));
        assert!(!lies_on(edge, [1.5, 0.5 + 1e-7]) && !lies_on(edge, [-0.3, -0.1]));
        let triangle = [[0.0, 0.0, 0.0], [2.0, 0.0, 1.0], [0.0, 2.0, 1.0]];
        assert!(lies_on(triangle, [0.5, 0.5, 0.5]) && lies_on(triangle, [1.0, 1.0, 1.0]));
        assert!(lies_on(triangle, [0.5, 0.0, 0.25]));
        assert!(!lies_on(triangle, [0.5, 0.5, 0.5 + 1e-7]) && !lies_on(triangle, [1.1, 1.1, 1.1]));
        // The corners themselves are allowed.
        assert!(!lies_on(edge, [3.0, 1.0]) && !lies_on(triangle, [2.0, 0.0, 1.0]));
    }

    #[test]
    fn a_short_edge_finds_the_long_one_on_which_it_ends() {
        let points = [[0.0, 0.0], [1000.0, 0.0], [700.001, 0.0], [700.0015, 0.001]];
        assert_eq!(found(&points, &facets(&[[0, 1], [2, 3]])), Some((2, [0, 1])));
        assert_eq!(found(&points, &facets(&[[1, 3], [0, 3]])), None);
    }
}
