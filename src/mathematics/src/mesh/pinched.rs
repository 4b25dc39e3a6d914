//! Nodes in which cells meet that no chain of common facets joins there: each group of cells gets a node of its own.
//!
//! A point of the plane, or an edge in space, joins nothing: functions of finite energy may have other values on either
//! side. With one value for both, meshes converge to the solution like one over a logarithm, and bounds do not fall. A
//! slit that ends on the boundary has such a node if only its inner nodes are doubled.

use super::MeshData;
use super::facets::{BoundaryFacets, CellSides};
use super::same_place::root;
use std::collections::HashMap;

impl<const D: usize, const V: usize> MeshData<D, V> {
    /// Gives each group of cells a node of its own, with the number of the old one. What hangs has been refused: that
    /// is told by the nodes that both sides have.
    pub(super) fn part_pinched(&mut self, boundary: &mut BoundaryFacets<D>) {
        let mut new_nodes: HashMap<(u32, u32), u32> = HashMap::new();
        let mut renamed: HashMap<(u32, u32), u32> = HashMap::new();
        for Moved { cell, node, group } in self.moved_corners(&boundary.sides) {
            let next = self.points.len() as u32;
            let new = *new_nodes.entry((node, group)).or_insert(next);
            if new == next {
                self.points.push(self.points[node as usize]);
                if !self.tags.nodes.is_empty() {
                    self.tags.nodes.push(self.tags.node(node as usize));
                }
            }
            renamed.insert((cell, node), new);
            let corners = self.cells[cell as usize].iter_mut();
            corners.filter(|corner| **corner == node).for_each(|corner| *corner = new);
        }
        for (facet, &cell) in boundary.facets.iter_mut().zip(&boundary.cells) {
            facet.nodes =
                facet.nodes.map(|node| renamed.get(&(cell, node)).copied().unwrap_or(node));
        }
    }

    /// Corners of cells at nodes of which another group of cells keeps the number.
    fn moved_corners(&self, sides: &CellSides<D>) -> Vec<Moved> {
        let mut is_outside = vec![false; self.points.len()];
        let single = sides.groups().filter(|group| group.len() == 1).flatten();
        single.flat_map(|side| side.nodes).for_each(|node| is_outside[node as usize] = true);
        let mut corners: Vec<(u32, u32)> = Vec::new();
        for (cell, k) in self.cells.iter().zip(0..) {
            corners.extend(
                cell.iter().filter(|&&node| is_outside[node as usize]).map(|&node| (node, k)),
            );
        }
        corners.sort_unstable();
        let mut above: Vec<u32> = (0..).take(corners.len()).collect();
        for group in sides.groups().filter(|group| group.len() == 2) {
            for node in group[0].nodes.into_iter().filter(|&node| is_outside[node as usize]) {
                let [one, two] = [group[0].cell, group[1].cell].map(|cell| {
                    let corner = corners.binary_search(&(node, cell));
                    root(&mut above, corner.expect("the cell has the node") as u32)
                });
                above[two as usize] = one;
            }
        }
        let (mut moved, mut first) = (Vec::new(), (u32::MAX, 0));
        for (&(node, cell), corner) in corners.iter().zip(0..) {
            let group = root(&mut above, corner);
            if first.0 != node {
                first = (node, group);
            }
            if first.1 != group {
                moved.push(Moved { cell, node, group });
            }
        }
        moved
    }
}

/// Corner of a cell that gets a new node.
struct Moved {
    cell: u32,
    node: u32,
    /// Number of the group of cells there.
    group: u32,
}

#[cfg(test)]
mod tests {
    use crate::mesh::{Facet, MeshData, Part, Tags};
    use crate::problem::law::Law;

    #[test]
    fn triangles_at_one_node_are_two_bodies() {
        let data = MeshData::<2, 3> {
            points: vec![[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]],
            cells: vec![[0, 1, 2], [0, 3, 4]],
            facets: vec![Facet { nodes: [4, 0], part: 0 }],
            parts: vec![Part { names: "left".into(), law: Law::SIGNORINI, curve: None }],
            tags: Tags { nodes: (11..16).collect(), cells: Vec::new() },
            ..MeshData::default()
        };
        let mesh = data.mesh().unwrap();
        assert_eq!((mesh.points().len(), mesh.points()[5]), (6, [0.0; 2]));
        assert_eq!(mesh.cells(), [[0, 1, 2], [5, 3, 4]]);
        let left: Vec<_> = mesh.facets().iter().filter(|facet| facet.part == 0).collect();
        assert_eq!((left.len(), left[0].nodes), (1, [4, 5]));
        let said = "node 11 is read as a node of each side that meets there: the domain is in two parts, which touch \
            in 1 node";
        assert_eq!(mesh.touching(), [said]);
    }

    #[test]
    fn a_slit_may_end_on_the_boundary_in_one_node() {
        // Along y = 0 from the node 0 to the node 2 on the right side; the node between is there twice.
        let data = MeshData::<2, 3> {
            points: vec![
                [0.0, 0.0],
                [0.5, 0.0],
                [1.0, 0.0],
                [0.5, 0.0],
                [0.5, 1.0],
                [-1.0, 0.0],
                [0.5, -1.0],
            ],
            cells: vec![[0, 1, 4], [1, 2, 4], [0, 4, 5], [0, 5, 6], [0, 6, 3], [3, 6, 2]],
            ..MeshData::default()
        };
        let mesh = data.mesh().unwrap();
        assert_eq!(mesh.points().len(), 8);
        assert!(mesh.touching()[0].contains("the domain has a slit along 2 edges"));
    }

    #[test]
    fn tetrahedra_at_one_edge_are_two_bodies() {
        let data = MeshData::<3, 4> {
            points: vec![
                [0.0; 3],
                [0.0, 0.0, 1.0],
                [1.0, 0.0, 0.0],
                [0.0, 1.0, 0.0],
                [-1.0, 0.0, 0.0],
                [0.0, -1.0, 0.0],
            ],
            cells: vec![[0, 1, 2, 3], [0, 1, 4, 5]],
            ..MeshData::default()
        };
        let mesh = data.mesh().unwrap();
        assert_eq!(mesh.points().len(), 8);
        assert!(mesh.touching()[0].contains("in two parts, which touch in 2 nodes"));
    }
}
