//! From the sections of a file to a mesh.

use super::elements::{FileElement, FileElements};
use super::error::GmshError;
use super::groups::GroupNames;
use super::labels::Groups;
use super::nodes::FileNodes;
use super::plane::plane_of;
use crate::mesh::{AnyMesh, Condition, Facet, Mesh, MeshData, Names, Origin, Part, Tags};

/// Difference of two diagonals, over the longer one, that is a rounding error.
const SAME_LENGTH: f64 = 1e-9;

/// Sections that make a mesh.
pub(super) struct Sections {
    pub(super) names: GroupNames,
    pub(super) nodes: FileNodes,
    pub(super) elements: FileElements,
}

impl Sections {
    /// Mesh in space if there are tetrahedra, else in the plane.
    pub(super) fn mesh(self) -> Result<AnyMesh, GmshError> {
        let Self { names, mut nodes, elements } = self;
        let FileElements {
            lines,
            mut triangles,
            quadrangles,
            tetrahedra,
            sets,
            of_higher_order,
            ..
        } = elements;
        let mut groups = Groups { names, sets };
        let has_cells = !(tetrahedra.is_empty() && triangles.is_empty() && quadrangles.is_empty());
        if !has_cells && groups.is_any(&lines) {
            return Err(GmshError::NoCellsInGroups);
        }
        let mut origin = Origin { of_higher_order: of_higher_order[2], ..Origin::default() };
        if tetrahedra.is_empty() {
            let quadrangles = groups.cells_once(quadrangles)?;
            let mut has_cell = has_cell(&nodes, &triangles);
            mark(&mut has_cell, &quadrangles);
            origin.plane = plane_of(&nodes, &has_cell)?;
            origin.quadrangles = quadrangles.len();
            for point in &mut nodes.points {
                let [x, y] = origin.plane.coordinates(*point);
                *point = [x, y, 0.0];
            }
            triangles.extend(quadrangles.iter().flat_map(|quadrangle| halves(&nodes, quadrangle)));
            // Without triangles there is a better message.
            if has_cells {
                check_dimension(&lines, &has_cell, ["line", "triangle"])?;
            }
            let mut mesh = mesh(&mut groups, nodes, triangles, &lines)?;
            mesh.origin = origin;
            Ok(AnyMesh::Plane(mesh))
        } else {
            origin.of_higher_order = of_higher_order[3];
            let has_cell = has_cell(&nodes, &tetrahedra);
            check_dimension(&lines, &has_cell, ["line", "tetrahedron"])?;
            check_dimension(&triangles, &has_cell, ["triangle", "tetrahedron"])?;
            // No side of a tetrahedron is a quadrangle.
            check_dimension(&quadrangles, &[], ["quadrangle", "tetrahedron"])?;
            let mut mesh = mesh(&mut groups, nodes, tetrahedra, &triangles)?;
            mesh.origin = origin;
            Ok(AnyMesh::Space(mesh))
        }
    }
}

/// Returns the triangles into which the shorter diagonal cuts a quadrangle in the plane, or the one that lies inside;
/// of two as long, the one through the first corner.
fn halves(nodes: &FileNodes, quadrangle: &FileElement<4>) -> [FileElement<3>; 2] {
    let &FileElement { tag, nodes: [a, b, c, d], groups } = quadrangle;
    let step = |from: u32, to: u32| {
        let [from, to] = [from, to].map(|node| nodes.points[node as usize]);
        [to[0] - from[0], to[1] - from[1]]
    };
    let length = |from, to| {
        let [x, y] = step(from, to);
        libm::hypot(x, y)
    };
    let is_left = |a, b, c| {
        let ([px, py], [qx, qy]) = (step(a, b), step(a, c));
        px * qy - py * qx > 0.0
    };
    let [first_inside, second_inside] =
        [is_left(a, b, c) == is_left(a, c, d), is_left(a, b, d) == is_left(b, c, d)];
    let second_shorter = length(b, d) < (1.0 - SAME_LENGTH) * length(a, c);
    let halves = match second_inside && (second_shorter || !first_inside) {
        true => [[a, b, d], [b, c, d]],
        false => [[a, b, c], [a, c, d]],
    };
    halves.map(|nodes| FileElement { tag, nodes, groups })
}

/// Returns for each node if it belongs to a cell.
fn has_cell<const V: usize>(nodes: &FileNodes, cells: &[FileElement<V>]) -> Vec<bool> {
    let mut has_cell = vec![false; nodes.points.len()];
    mark(&mut has_cell, cells);
    has_cell
}

/// Marks the nodes of cells.
fn mark<const V: usize>(has_cell: &mut [bool], cells: &[FileElement<V>]) {
    cells.iter().flat_map(|cell| cell.nodes).for_each(|node| has_cell[node as usize] = true);
}

/// Checks that elements of a lower dimension have no nodes of their own.
fn check_dimension<const K: usize>(
    elements: &[FileElement<K>],
    has_cell: &[bool],
    [kind, cell]: [&'static str; 2],
) -> Result<(), GmshError> {
    let mut elements = elements.iter();
    match elements.find(|element| {
        !element.nodes.iter().all(|&node| has_cell.get(node as usize) == Some(&true))
    }) {
        Some(element) => Err(GmshError::Mixed { element: element.tag, kind, cell }),
        None => Ok(()),
    }
}

/// Mesh of cells and named sides. Nodes of no cell, such as centres of circles, are left out.
fn mesh<const D: usize, const V: usize>(
    groups: &mut Groups,
    nodes: FileNodes,
    cells: Vec<FileElement<V>>,
    sides: &[FileElement<D>],
) -> Result<Mesh<D, V>, GmshError> {
    let cells = groups.cells_once(cells)?;
    let regions = groups.labels(V as i64 - 1, cells.iter().map(|cell| cell.groups))?;
    let sides = groups.sides_once(sides);
    let parts = groups.labels(D as i64 - 1, sides.iter().map(|side| side.groups))?;
    let mut data = MeshData {
        regions: cells.iter().map(|cell| regions.positions[&cell.groups]).collect(),
        region_names: regions.names,
        parts: parts.names.into_iter().map(part).collect(),
        tags: Tags { nodes: Vec::new(), cells: cells.iter().map(|cell| cell.tag).collect() },
        ..MeshData::default()
    };
    let mut numbers = vec![0; nodes.points.len()];
    for (node, has_cell) in has_cell(&nodes, &cells).into_iter().enumerate() {
        if has_cell {
            numbers[node] = data.points.len() as u32;
            data.points.push(std::array::from_fn(|d| nodes.points[node][d]));
            data.tags.nodes.push(nodes.tags[node]);
        }
    }
    data.cells.extend(cells.iter().map(|cell| cell.nodes.map(|node| numbers[node as usize])));
    data.facets.extend(sides.into_iter().map(|side| Facet {
        nodes: side.nodes.map(|node| numbers[node as usize]),
        part: parts.positions[&side.groups],
    }));
    Ok(data.mesh()?)
}

fn part<const D: usize>(names: Names) -> Part<D> {
    Part { names, condition: Condition::default(), curve: None }
}

#[cfg(test)]
mod tests {
    use crate::mesh::gmsh::read;
    use crate::mesh::gmsh::tests::{SQUARE_22, SQUARE_41, after, plane};
    use crate::mesh::{AnyMesh, Condition, PartError};

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
                "$Elements, line 20: element 23 has second order; open the mesh in Gmsh, and save it after `SetOrder \
                 1;`",
            ),
            (
                "23 2 2",
                "23 92 2",
                "$Elements, line 20: element 23 has type 92, which is not read; mesh with simplices only",
            ),
            (
                "13 1 1 0",
                "13 1 1 1",
                "nodes 11 and 13 differ in z, and the file has no tetrahedra: a surface in space is no domain; mesh \
                 the volume, and put it into a Physical Volume if there are physical groups, or mesh in the plane z \
                 = 0",
            ),
            (
                "24 2 2 2 1 11 13 14",
                "24 2 2 2 1 11 12 13",
                "elements 23 and 24 have the same nodes; remove one, e.g. with \
                 `gmsh.model.mesh.removeDuplicateElements()` in Python",
            ),
            (
                "23 2 2 2 1 11 12 13",
                "23 1 2 0 1 11 12",
                "element 22 is a line on no triangle: the file mixes dimensions; save only the domain and its boundary",
            ),
            (
                "22 1 2 1 1 11 12",
                "22 1 2 1 1 12 14",
                "part `south` names the facet [12, 14], which is no side of an element; embed it in the mesh, or \
                 leave its name out",
            ),
        ] {
            assert_eq!(after(SQUARE_22, from, to), message);
        }
    }

    /// Square in version 2.2 with its diagonal; its lower edge and one of its cells are in two groups.
    fn in_many_groups() -> String {
        SQUARE_22
            .replace(
                "$PhysicalNames\n2\n",
                "$PhysicalNames\n5\n1 3 \"loaded\"\n1 4 \"diagonal\"\n2 5 \"steel\"\n",
            )
            .replace("$Elements\n4\n", "$Elements\n8\n")
            .replace(
                "22 1 2 1 1 11 12\n",
                "22 1 2 1 1 11 12\n32 1 2 3 1 12 11\n33 1 2 3 1 12 13\n34 1 2 4 1 11 13\n",
            )
            .replace("23 2 2 2 1 11 12 13\n", "23 2 2 2 1 11 12 13\n43 2 2 5 1 11 12 13\n")
    }

    #[test]
    fn elements_may_be_in_several_groups_and_named_lines_inside() {
        let mesh = plane(in_many_groups().as_bytes());
        let names: Vec<_> = mesh.parts().iter().map(|part| part.names.to_string()).collect();
        assert_eq!(names, ["south, loaded", "loaded", "boundary"]);
        let regions: Vec<_> = mesh.region_names().iter().map(ToString::to_string).collect();
        assert_eq!(
            (&regions[..], mesh.regions()),
            (&["plate".into(), "plate, steel".into()][..], &[1, 0][..])
        );
        let mut mesh = AnyMesh::Plane(mesh);
        assert_eq!(mesh.set_condition("loaded", Condition::Free), Ok(()));
        let AnyMesh::Plane(plane) = &mesh else { unreachable!() };
        let free = plane.facets().iter().filter(|facet| plane.condition(facet) == Condition::Free);
        assert_eq!(free.count(), 2);
        // Two conditions meet on the lower edge.
        let refused = mesh.set_condition("south", Condition::Fixed).unwrap_err();
        assert_eq!(
            refused.to_string(),
            "facets named south, loaded would be free and fixed; choose one of the two"
        );
        assert_eq!(mesh.set_condition("south", Condition::Free), Ok(()));
        let refused = mesh.set_condition("diagonal", Condition::Free).unwrap_err();
        assert_eq!(
            refused.to_string(),
            "`diagonal` lies inside the domain, where no condition holds; the parts of the boundary are south, \
             loaded, boundary"
        );
        assert!(matches!(
            mesh.set_curve("diagonal", &[0.0, 0.0, 1.0]),
            Err(PartError::Inside { .. })
        ));
    }

    #[test]
    fn entities_may_be_in_several_groups() {
        let text = SQUARE_41
            .replace("$PhysicalNames\n2\n", "$PhysicalNames\n3\n1 3 \"loaded\"\n")
            .replace("1 1 0\n6", "2 3 1 0\n6");
        let mesh = plane(text.as_bytes());
        let names: Vec<_> = mesh.parts().iter().map(|part| part.names.to_string()).collect();
        assert_eq!(names, ["south, loaded", "boundary"]);
    }

    #[test]
    fn cells_that_are_in_no_group_are_missed_with_what_saves_them() {
        let cells = "23 2 2 2 1 11 12 13\n24 2 2 2 1 11 13 14\n";
        let text = SQUARE_22.replace("$Elements\n4", "$Elements\n2").replace(cells, "");
        let said = read(text.as_bytes()).unwrap_err().to_string();
        assert_eq!(
            said,
            "the file has no triangles and no tetrahedra: Gmsh saves what is in physical groups; add a Physical \
             Surface, in space a Physical Volume, or set `Mesh.SaveAll = 1`"
        );
        let (before, _) = text.split_once("$PhysicalNames").unwrap();
        let (_, after) = text.split_once("$EndPhysicalNames\n").unwrap();
        let text = format!("{before}{after}").replace("22 1 2 1 1 11 12", "22 1 2 0 1 11 12");
        let said = read(text.as_bytes()).unwrap_err().to_string();
        assert_eq!(said, "the mesh has no triangles; mesh the area itself, not only its boundary");
    }
}
