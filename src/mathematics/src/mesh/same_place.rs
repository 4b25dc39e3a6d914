//! Nodes of the boundary with the same place: surfaces or volumes that touch without being joined, and slits.

use super::facets::{BoundaryFacets, sorted};
use super::geometry::{bounds, difference, dot, longest_side};
use super::{MeshData, Tags};
use std::collections::HashMap;
use std::fmt;

/// Distance of two nodes over the size of the domain, up to which they have the same place.
const SAME: f64 = 1e-8;
/// Distance of two nodes over the shortest edge at one of them, above which they have not.
const APART: f64 = 1e-3;

/// Boundary on which the domain touches itself, with nodes of both sides at the same places.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Touching {
    /// Numbers of two nodes with the same place.
    nodes: [u64; 2],
    /// Number of connected components of the domain if two of them touch; one if a component touches itself.
    components: usize,
    /// Number of pairs of facets, or of pairs of nodes if no facets touch.
    count: usize,
    /// Name of what is counted, in the singular.
    what: &'static str,
}

impl fmt::Display for Touching {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { nodes: [one, two], components, count, what } = self;
        let plural = if *count == 1 { "" } else { "s" };
        let touches = format!("{count} {what}{plural}");
        let is_pinched = one == two;
        match is_pinched {
            true => write!(
                f,
                "node {one} is read as a node of each side that meets there: the domain "
            )?,
            false => write!(f, "nodes {one} and {two} have the same place: the domain ")?,
        }
        let join = match (components, *what) {
            (1, "node") => {
                write!(f, "touches itself in {touches}, where v has a value for each side")?;
                "join the sides"
            }
            (1, _) => {
                write!(f, "has a slit along {touches}, whose sides are boundary")?;
                "close it"
            }
            _ => {
                let number = if *components == 2 { "two" } else { &components.to_string() };
                let verb = if *what == "node" { "which touch in" } else { "in contact along" };
                write!(f, "is in {number} parts, {verb} {touches}")?;
                "join them"
            }
        };
        if is_pinched {
            return Ok(());
        }
        write!(f, "; in Gmsh, `Coherence`, fragments or `removeDuplicateNodes` {join}")
    }
}

/// Nodes by their places.
struct Places {
    /// First node with the place of each node; the node itself if there is none before it.
    first: Vec<u32>,
    /// Nodes that come after another one with the same place.
    doubled: Vec<u32>,
}

impl<const D: usize, const V: usize> MeshData<D, V> {
    /// Returns where the domain touches itself, if it does.
    pub(super) fn touching(&self, boundary: &BoundaryFacets<D>) -> Option<Touching> {
        let places = self.places(boundary);
        let first_pair = places.doubled.first().map(|&node| [places.first[node as usize], node])?;
        let components = components(self.points.len(), &self.cells);
        let are_apart = |nodes: &[u32; 2]| {
            let [one, two] = nodes.map(|node| components[node as usize]);
            one != two
        };
        let pairs = places.doubled.iter().map(|&node| [places.first[node as usize], node]);
        let apart: Vec<_> = pairs.filter(are_apart).collect();
        let mut facets_at: HashMap<[u32; D], u32> = HashMap::new();
        let mut count = 0;
        for facet in &boundary.facets {
            let node = facet.nodes[0];
            let at = sorted(facet.nodes.map(|node| places.first[node as usize]));
            match facets_at.get(&at) {
                Some(&other) => count += usize::from(apart.is_empty() || are_apart(&[node, other])),
                None => _ = facets_at.insert(at, node),
            }
        }
        let what = match (count, D) {
            (0, _) => "node",
            (_, 2) => "edge",
            _ => "triangle",
        };
        let pairs = if apart.is_empty() { places.doubled.len() } else { apart.len() };
        Some(Touching {
            nodes: self.tags.pair(apart.first().copied().unwrap_or(first_pair)),
            components: if apart.is_empty() { 1 } else { count_components(&components) },
            count: if count == 0 { pairs } else { count },
            what,
        })
    }

    /// Places of the nodes of the boundary.
    fn places(&self, boundary: &BoundaryFacets<D>) -> Places {
        let reach = self.reach(boundary);
        let low = bounds(&self.points).map(|[least, _]| least);
        // Of boxes of twice the greatest reach, a node meets two in each direction.
        let width = 2.0 * reach.iter().fold(f64::MIN_POSITIVE, |most, reach| reach.max(most));
        let mut places =
            Places { first: (0..).take(self.points.len()).collect(), doubled: Vec::new() };
        let mut nodes_in: HashMap<[i64; D], Vec<u32>> = HashMap::new();
        for node in (0..self.points.len()).filter(|&node| reach[node] > 0.0) {
            let from_low = difference(self.points[node], low);
            let boxes = (0..1usize << D).map(|corner| -> [i64; D] {
                std::array::from_fn(|d| {
                    let shift = if corner >> d & 1 == 1 { 0.5 } else { -0.5 };
                    libm::floor(from_low[d] / width + shift) as i64
                })
            });
            let mut near = boxes.filter_map(|at| nodes_in.get(&at)).flatten().copied();
            let same = near.find(|&other| {
                let apart =
                    difference(self.points[other as usize], self.points[node]).map(|x| x / width);
                let reach = reach[node].min(reach[other as usize]) / width;
                dot(apart, apart) <= reach * reach
            });
            if let Some(other) = same {
                places.first[node] = other;
                places.doubled.push(node as u32);
            } else {
                let at = from_low.map(|x| libm::floor(x / width) as i64);
                nodes_in.entry(at).or_default().push(node as u32);
            }
        }
        places
    }

    /// Distance of each node of the boundary up to which another one has the same place; zero for inner nodes.
    fn reach(&self, boundary: &BoundaryFacets<D>) -> Vec<f64> {
        let size = longest_side(bounds(&self.points));
        let mut shortest = vec![f64::INFINITY; self.points.len()];
        for facet in &boundary.facets {
            for (k, &one) in facet.nodes.iter().enumerate() {
                for &two in &facet.nodes[..k] {
                    let [a, b] = [one, two].map(|node| self.points[node as usize]);
                    let edge = super::size([a, b]);
                    for node in [one, two] {
                        let shortest = &mut shortest[node as usize];
                        *shortest = shortest.min(edge);
                    }
                }
            }
        }
        let reach = |edge: f64| (SAME * size).min(APART * edge);
        shortest.into_iter().map(|edge| if edge.is_finite() { reach(edge) } else { 0.0 }).collect()
    }
}

/// Connected component of each of so many nodes by the cells, as one of its nodes.
pub(super) fn components<const V: usize>(nodes: usize, cells: &[[u32; V]]) -> Vec<u32> {
    let mut above: Vec<u32> = (0..).take(nodes).collect();
    for cell in cells {
        let first = root(&mut above, cell[0]);
        for &node in &cell[1..] {
            let other = root(&mut above, node);
            above[other as usize] = first;
        }
    }
    (0..).take(nodes).map(|node| root(&mut above, node)).collect()
}

/// Root of the tree of a node; halves the way to it.
pub(super) fn root(above: &mut [u32], mut node: u32) -> u32 {
    while above[node as usize] != node {
        above[node as usize] = above[above[node as usize] as usize];
        node = above[node as usize];
    }
    node
}

fn count_components(components: &[u32]) -> usize {
    components.iter().zip(0..).filter(|(root, node)| *root == node).count()
}

impl Tags {
    fn pair(&self, nodes: [u32; 2]) -> [u64; 2] {
        nodes.map(|node| self.node(node as usize))
    }
}

#[cfg(test)]
mod tests {
    use crate::mesh::{MeshData, Tags};

    /// Message on two unit squares side by side, of two triangles each, after a change.
    fn after(change: impl FnOnce(&mut MeshData<2, 3>)) -> Option<String> {
        let [one, two] = [0.0, 1.0].map(|x| [[x, 0.0], [x + 1.0, 0.0], [x + 1.0, 1.0], [x, 1.0]]);
        let mut data = MeshData {
            points: [one, two].concat(),
            cells: vec![[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]],
            tags: Tags { nodes: (1..9).collect(), cells: Vec::new() },
            ..MeshData::default()
        };
        change(&mut data);
        data.mesh().unwrap().touching().first().cloned()
    }

    #[test]
    fn parts_that_are_not_joined_are_told_with_their_common_edges() {
        let said = "nodes 2 and 5 have the same place: the domain is in two parts, in contact along 1 edge; in Gmsh, \
            `Coherence`, fragments or `removeDuplicateNodes` join them";
        for unit in [1e-40, 1e-6, 1.0, 1e40] {
            for apart in [0.0, 1e-15, -1e-12, 1e-9] {
                let found = after(|data| {
                    data.points[4][0] += apart;
                    data.points.iter_mut().for_each(|point| *point = point.map(|x| unit * x));
                });
                assert_eq!(found.as_deref(), Some(said), "{unit:e} {apart:e}");
            }
        }
        let point = after(|data| {
            data.points[4..].iter_mut().for_each(|point| point[1] += 1.0);
        });
        assert!(point.unwrap().contains("is in two parts, which touch in 1 node;"));
        assert_eq!(
            after(|data| data.points[4..].iter_mut().for_each(|point| point[0] += 0.1)),
            None
        );
        assert_eq!(
            after(|data| {
                data.cells[2..].iter_mut().flatten().for_each(|node| {
                    *node = [0, 0, 0, 0, 1, 4, 5, 2][*node as usize];
                });
                data.points.drain(4..5);
                data.points.pop();
            }),
            None
        );
    }

    #[test]
    fn a_slit_is_told_as_one() {
        // Four triangles around a node, cut open along one edge.
        let data = MeshData::<2, 3> {
            points: vec![[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0], [1.0, 0.0]],
            cells: vec![[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]],
            ..MeshData::default()
        };
        let said = data.mesh().unwrap().touching().concat();
        assert!(said.starts_with("nodes 1 and 5 have the same place: the domain has a slit along 1 edge, whose sides \
            are boundary; in Gmsh, "), "{said}");
    }

    #[test]
    fn volumes_are_in_contact_along_triangles() {
        let data = MeshData::<3, 4> {
            points: vec![
                [0.0; 3],
                [1.0, 0.0, 0.0],
                [0.0, 1.0, 0.0],
                [0.0, 0.0, 1.0],
                [1.0, 0.0, 0.0],
                [0.0, 1.0, 0.0],
                [0.0, 0.0, 1.0],
                [1.0, 1.0, 1.0],
            ],
            cells: vec![[0, 1, 2, 3], [4, 5, 6, 7]],
            ..MeshData::default()
        };
        let said = data.mesh().unwrap().touching().concat();
        assert!(said.contains("is in two parts, in contact along 1 triangle;"), "{said}");
    }
}
