//! Hanging nodes: nodes of the boundary inside a facet, or in space inside an edge of a facet.

use super::Facet;
use super::facet_boxes::{FacetBoxes, NEAR};
use super::geometry::{difference, dot, size};

/// Node that lies on a facet, and in no corner of the facet.
pub(super) struct HangingNode {
    pub(super) node: u32,
    /// Position of the facet.
    pub(super) facet: u32,
}

/// Returns the first hanging node, if there is one.
///
/// A node with the coordinates of a corner does not hang: domains may touch, and have slits.
pub(super) fn hanging_node<const D: usize>(
    points: &[[f64; D]],
    facets: &[Facet<D>],
    boxes: &FacetBoxes<D>,
) -> Option<HangingNode> {
    let mut is_node = vec![false; points.len()];
    facets.iter().flat_map(|facet| facet.nodes).for_each(|node| is_node[node as usize] = true);
    let nodes = is_node.iter().enumerate().filter(|(_, is_node)| **is_node);
    for (node, _) in nodes {
        for facet in boxes.near_point(points[node]) {
            let nodes = facets[facet as usize].nodes;
            let corners = nodes.map(|node| points[node as usize]);
            if !nodes.contains(&(node as u32)) && hangs_on(corners, points[node]) {
                return Some(HangingNode { node: node as u32, facet });
            }
        }
    }
    None
}

/// True if a point lies on a facet, and in none of its corners.
fn hangs_on<const D: usize>(corners: [[f64; D]; D], point: [f64; D]) -> bool {
    // In units of the size, from the point on.
    let size = size(corners);
    let corners = corners
        .map(|corner| -> [f64; D] { std::array::from_fn(|d| (corner[d] - point[d]) / size) });
    if corners.iter().any(|&corner| dot(corner, corner) <= NEAR * NEAR) {
        return false;
    }
    (0..D).any(|k| (0..k).any(|i| edge_meets_origin(corners[i], corners[k])))
        || (D == 3 && triangle_meets_origin(corners))
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

    /// Hanging node, with the nodes of its facet.
    fn found<const D: usize>(points: &[[f64; D]], facets: &[Facet<D>]) -> Option<(u32, [u32; D])> {
        let corners = facets.iter().map(|facet| facet.nodes.map(|node| points[node as usize]));
        let HangingNode { node, facet } = hanging_node(points, facets, &FacetBoxes::new(corners))?;
        Some((node, facets[facet as usize].nodes))
    }

    /// True if a point hangs on a facet, whatever the scale and place of both.
    fn hangs<const D: usize>(corners: [[f64; D]; D], point: [f64; D]) -> bool {
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
    fn nodes_hang_inside_edges_and_triangles_up_to_rounding_errors() {
        let edge = [[0.0, 0.0], [3.0, 1.0]];
        assert!(hangs(edge, [1.5, 0.5]) && hangs(edge, [0.03, 0.01 + 1e-10]));
        assert!(!hangs(edge, [1.5, 0.5 + 1e-7]) && !hangs(edge, [-0.3, -0.1]));
        let triangle = [[0.0, 0.0, 0.0], [2.0, 0.0, 1.0], [0.0, 2.0, 1.0]];
        assert!(hangs(triangle, [0.5, 0.5, 0.5]) && hangs(triangle, [1.0, 1.0, 1.0]));
        assert!(hangs(triangle, [0.5, 0.0, 0.25]));
        assert!(!hangs(triangle, [0.5, 0.5, 0.5 + 1e-7]) && !hangs(triangle, [1.1, 1.1, 1.1]));
        // The corners themselves are allowed.
        assert!(!hangs(edge, [3.0, 1.0]) && !hangs(triangle, [2.0, 0.0, 1.0]));
    }

    #[test]
    fn a_short_edge_finds_the_long_one_on_which_it_ends() {
        let points = [[0.0, 0.0], [1000.0, 0.0], [700.001, 0.0], [700.0015, 0.001]];
        assert_eq!(found(&points, &facets(&[[0, 1], [2, 3]])), Some((2, [0, 1])));
        assert_eq!(found(&points, &facets(&[[1, 3], [0, 3]])), None);
    }
}
