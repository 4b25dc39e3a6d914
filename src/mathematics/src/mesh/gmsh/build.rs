//! From the sections of a file to a mesh.

use super::elements::{FileElements, Simplex};
use super::error::GmshError;
use super::groups::GroupNames;
use super::nodes::FileNodes;
use crate::mesh::{AnyMesh, Condition, Facet, Mesh, MeshData, Part, Tags};
use std::collections::{BTreeMap, HashMap};

/// Difference of z over the size of the domain that is a rounding error.
const SAME_Z: f64 = 1e-10;

/// Sections that make a mesh.
pub(super) struct Sections {
    pub(super) names: GroupNames,
    pub(super) nodes: FileNodes,
    pub(super) elements: FileElements,
}

impl Sections {
    /// Mesh in space if there are tetrahedra, else in the plane.
    pub(super) fn mesh(self) -> Result<AnyMesh, GmshError> {
        let Self { names, nodes, elements } = self;
        let FileElements { lines, triangles, tetrahedra, .. } = elements;
        if tetrahedra.is_empty() {
            let has_cell = has_cell(&nodes, &triangles);
            check_plane(&nodes, &has_cell)?;
            // Without triangles there is a better message.
            if !triangles.is_empty() {
                check_dimension(&lines, &has_cell, ["line", "triangle"])?;
            }
            Ok(AnyMesh::Plane(mesh(&names, nodes, &triangles, &lines)?))
        } else {
            let has_cell = has_cell(&nodes, &tetrahedra);
            check_dimension(&lines, &has_cell, ["line", "tetrahedron"])?;
            check_dimension(&triangles, &has_cell, ["triangle", "tetrahedron"])?;
            Ok(AnyMesh::Space(mesh(&names, nodes, &tetrahedra, &triangles)?))
        }
    }
}

/// Returns for each node if it belongs to a cell.
fn has_cell<const V: usize>(nodes: &FileNodes, cells: &[Simplex<V>]) -> Vec<bool> {
    let mut has_cell = vec![false; nodes.points.len()];
    cells.iter().flat_map(|cell| cell.nodes).for_each(|node| has_cell[node as usize] = true);
    has_cell
}

/// Checks that elements of a lower dimension have no nodes of their own.
fn check_dimension<const K: usize>(
    elements: &[Simplex<K>],
    has_cell: &[bool],
    [kind, cell]: [&'static str; 2],
) -> Result<(), GmshError> {
    let mut elements = elements.iter();
    match elements.find(|element| !element.nodes.iter().all(|&node| has_cell[node as usize])) {
        Some(element) => Err(GmshError::Mixed { element: element.tag, kind, cell }),
        None => Ok(()),
    }
}

/// Checks that all nodes of cells have the same z.
fn check_plane(nodes: &FileNodes, has_cell: &[bool]) -> Result<(), GmshError> {
    let Some(first) = has_cell.iter().position(|has_cell| *has_cell) else { return Ok(()) };
    let start = nodes.points[first];
    let used = has_cell.iter().enumerate().filter(|(_, has_cell)| **has_cell);
    let (mut size, mut height, mut highest) = (0.0f64, 0.0, first);
    for (node, _) in used {
        let [x, y, z] = nodes.points[node];
        size = size.max((x - start[0]).abs()).max((y - start[1]).abs());
        if (z - start[2]).abs() > height {
            (height, highest) = ((z - start[2]).abs(), node);
        }
    }
    if height > SAME_Z * size {
        return Err(GmshError::NotPlane { one: nodes.tags[first], two: nodes.tags[highest] });
    }
    Ok(())
}

/// Mesh of cells and named sides. Nodes of no cell, such as centres of circles, are left out.
fn mesh<const D: usize, const V: usize>(
    names: &GroupNames,
    nodes: FileNodes,
    cells: &[Simplex<V>],
    sides: &[Simplex<D>],
) -> Result<Mesh<D, V>, GmshError> {
    // Version 2.2 writes an element of two groups twice.
    if let Some([one, two]) =
        cells.array_windows().find(|[one, two]: &&[Simplex<V>; 2]| one.nodes == two.nodes)
    {
        return Err(GmshError::Twice { one: one.tag, two: two.tag });
    }
    let regions = Labels::new(names, V as i64 - 1, cells.iter().map(|cell| cell.group))?;
    let named: Vec<_> = sides.iter().filter(|side| side.group != 0).collect();
    let parts = Labels::new(names, D as i64 - 1, named.iter().map(|side| side.group))?;
    let mut data = MeshData {
        regions: cells.iter().map(|cell| regions.positions[&cell.group]).collect(),
        region_names: regions.names,
        parts: parts.names.into_iter().map(part).collect(),
        tags: Tags { nodes: Vec::new(), cells: cells.iter().map(|cell| cell.tag).collect() },
        ..MeshData::default()
    };
    let mut numbers = vec![0; nodes.points.len()];
    for (node, has_cell) in has_cell(&nodes, cells).into_iter().enumerate() {
        if has_cell {
            numbers[node] = data.points.len() as u32;
            data.points.push(std::array::from_fn(|d| nodes.points[node][d]));
            data.tags.nodes.push(nodes.tags[node]);
        }
    }
    data.cells.extend(cells.iter().map(|cell| cell.nodes.map(|node| numbers[node as usize])));
    data.facets.extend(named.into_iter().map(|side| Facet {
        nodes: side.nodes.map(|node| numbers[node as usize]),
        part: parts.positions[&side.group],
    }));
    Ok(data.mesh()?)
}

fn part<const D: usize>(name: String) -> Part<D> {
    Part { name, condition: Condition::default(), curve: None }
}

/// Names of the groups of one dimension.
struct Labels {
    names: Vec<String>,
    /// Position of the name of each group. Groups with the same name are one.
    positions: HashMap<u64, u16>,
}

impl Labels {
    /// Names of all groups that elements have or the file names, in the order of their numbers.
    fn new(
        names: &GroupNames,
        dimension: i64,
        groups: impl Iterator<Item = u64>,
    ) -> Result<Self, GmshError> {
        let mut by_number: BTreeMap<u64, Option<&str>> =
            groups.map(|group| (group, None)).collect();
        by_number.extend(names.of(dimension).map(|(group, name)| (group, Some(name))));
        if by_number.len() > u16::MAX as usize {
            return Err(GmshError::Groups(by_number.len()));
        }
        let mut labels = Self { names: Vec::new(), positions: HashMap::new() };
        let mut by_name = HashMap::new();
        for (group, name) in by_number {
            let name = match (name, group) {
                (Some(name), _) => name.to_owned(),
                (None, 0) => "domain".to_owned(),
                (None, number) => number.to_string(),
            };
            let position = *by_name.entry(name.clone()).or_insert(labels.names.len() as u16);
            if position as usize == labels.names.len() {
                labels.names.push(name);
            }
            labels.positions.insert(group, position);
        }
        Ok(labels)
    }
}

#[cfg(test)]
mod tests {
    use crate::mesh::gmsh::tests::{SQUARE_22, after};

    #[test]
    fn elements_that_make_no_mesh_are_named() {
        for (from, to, message) in [
            (
                "23 2 2",
                "23 3 2",
                "$Elements, line 20: element 23 is a quadrangle; mesh with triangles only",
            ),
            (
                "23 2 2",
                "23 9 2",
                "$Elements, line 20: element 23 has second order; save the mesh with `Mesh.ElementOrder = 1`",
            ),
            (
                "23 2 2",
                "23 92 2",
                "$Elements, line 20: element 23 has type 92, which is not read; mesh with simplices only",
            ),
            (
                "13 1 1 0",
                "13 1 1 1",
                "nodes 11 and 13 differ in z: a surface in space is no domain; mesh the volume, or the plane z = 0",
            ),
            (
                "24 2 2 2 1 11 13 14",
                "24 2 2 2 1 11 12 13",
                "elements 23 and 24 have the same nodes; put each surface or volume into one physical group",
            ),
            (
                "23 2 2 2 1 11 12 13",
                "23 1 2 0 1 11 12",
                "element 22 is a line on no triangle: the file mixes dimensions; save only the domain and its boundary",
            ),
            (
                "22 1 2 1 1 11 12",
                "22 1 2 1 1 11 13",
                "part `south` names the facet [11, 13], which is not on the boundary",
            ),
            (
                "23 2 2 2 1 11 12 13",
                "23 2 2 2 1 13 12 11",
                "element 23 is inverted: its vertices are numbered in the other sense; mend the mesh",
            ),
        ] {
            assert_eq!(after(SQUARE_22, from, to), message);
        }
    }
}
