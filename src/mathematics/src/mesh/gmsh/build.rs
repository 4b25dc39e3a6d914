//! From the sections of a file to a mesh.

use super::elements::{FileElement, FileElements};
use super::error::GmshError;
use super::groups::GroupNames;
use super::labels::Groups;
use super::nodes::FileNodes;
use super::plane::plane_of;
use crate::mesh::{AnyMesh, Condition, Facet, Mesh, MeshData, MeshOrigin, Names, Part, Tags};

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
        let mut origin =
            MeshOrigin { of_higher_order: of_higher_order[2], ..MeshOrigin::default() };
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
    use crate::mesh::{AnyMesh, Condition, MeshOrigin, PartError};

    #[test]
    fn elements_that_make_no_mesh_are_named() {
        for (from, to, message) in [
            (
                "23 2 2",
                "23 17 2",
                "$Elements, line 20: element 23 is a hexahedron; mesh with tetrahedra only",
            ),
            (
                "23 2 2",
                "23 34 2",
                "$Elements, line 20: element 23 has type 34, which is not read; mesh with simplices only",
            ),
            (
                "23 2 2 2 1 11 12 13\n24 2 2 2 1 11 13 14",
                "23 3 2 2 1 11 12 13 14\n24 4 2 2 1 11 12 13 14",
                "element 23 is a quadrangle on no tetrahedron: the file mixes dimensions; save only the domain and its \
                 boundary",
            ),
            (
                "13 1 1 0",
                "13 1 1 1",
                "node 14 is off the plane of nodes 11, 13 and 12, and the file has no tetrahedra: a surface in space \
                 is no domain; mesh the volume, and put it into a Physical Volume if there are physical groups, or \
                 mesh in one plane",
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

    /// Square of one quadrangle, whose last two corners are here.
    fn quadrangle(corners: [&str; 2]) -> String {
        let cells = "23 2 2 2 1 11 12 13\n24 2 2 2 1 11 13 14";
        let nodes = ["13 1 1 0", "14 0 1 0"];
        let text = SQUARE_22.replace("$Elements\n4", "$Elements\n3");
        let text = text.replace(cells, "23 3 2 2 1 11 12 13 14");
        nodes.iter().zip(corners).fold(text, |text, (node, corner)| text.replace(node, corner))
    }

    #[test]
    fn quadrangles_are_cut_by_the_shorter_diagonal_inside() {
        let square = plane(SQUARE_22.as_bytes());
        for (corners, cells) in [
            // As long: through the first corner.
            (["13 1 1 0", "14 0 1 0"], [[0, 1, 2], [0, 2, 3]]),
            (["13 3 3 0", "14 0 1 0"], [[0, 1, 3], [1, 2, 3]]),
            // The diagonal between the second corner and the fourth is shorter, and outside.
            (["13 0.9 0.3 0", "14 1 0.6 0"], [[0, 1, 2], [0, 2, 3]]),
        ] {
            let mut mesh = plane(quadrangle(corners).as_bytes());
            assert_eq!((mesh.cells(), mesh.origin().quadrangles), (&cells[..], 1), "{corners:?}");
            let notes = mesh.notes();
            assert!(notes[0].contains("1 quadrangle is cut into triangles"), "{notes:?}");
            if corners[0] == "13 1 1 0" {
                mesh.origin = MeshOrigin::default();
                assert_eq!(mesh, square);
            }
        }
        // Version 2 writes a cell of two groups twice.
        let cell = "23 3 2 2 1 11 12 13 14";
        let both = quadrangle(["13 1 1 0", "14 0 1 0"])
            .replace("$Elements\n3", "$Elements\n4")
            .replace(cell, &format!("{cell}\n25 3 2 5 1 11 12 13 14"));
        let names = plane(both.as_bytes()).region_names()[0].to_string();
        assert_eq!(names, "plate, 5");
    }

    #[test]
    fn elements_of_higher_order_are_read_by_their_corners() {
        let square = plane(SQUARE_22.as_bytes());
        let text = SQUARE_22
            .replace(
                "$Nodes\n4\n",
                "$Nodes\n9\n15 .5 -.1 0\n16 1 .5 0\n17 .5 1 0\n18 0 .5 0\n19 .5 .5 0\n",
            )
            .replace("22 1 2 1 1 11 12", "22 8 2 1 1 11 12 15")
            .replace("23 2 2 2 1 11 12 13", "23 9 2 2 1 11 12 13 15 16 19")
            .replace("24 2 2 2 1 11 13 14", "24 9 2 2 1 11 13 14 19 17 18");
        let mut mesh = plane(text.as_bytes());
        let notes = mesh.notes();
        assert!(notes[0].starts_with("2 elements of higher order are read by their corners"));
        mesh.origin = MeshOrigin::default();
        assert_eq!(mesh, square);
    }

    #[test]
    fn meshes_lie_in_any_plane() {
        let square = plane(SQUARE_22.as_bytes());
        let corners = ["11 0 0 0", "12 1 0 0", "13 1 1 0", "14 0 1 0"];
        let moved = |to: [&str; 4]| {
            let text = SQUARE_22.to_owned();
            let text = corners.iter().zip(to).fold(text, |text, (from, to)| text.replace(from, to));
            plane(text.as_bytes())
        };
        for (to, note) in [
            (["11 0 0 5", "12 1 0 5", "13 1 1 5", "14 0 1 5"], None),
            (["11 0 0 0", "12 1 0 0", "13 1 1 1e-9", "14 0 1 0"], None),
            (
                ["11 0 7 0", "12 1 7 0", "13 1 7 1", "14 0 7 1"],
                Some("x stands for x of the file and y for z"),
            ),
            (
                ["11 2 0 0", "12 2 1 0", "13 2 1 1", "14 2 0 1"],
                Some("x stands for y of the file and y for z"),
            ),
            (
                ["11 0 0 0", "12 .6 -.8 0", "13 .6 -.8 1", "14 0 0 1"],
                Some("x stands for 0.6 x - 0.8 y of the file and y for z"),
            ),
            (
                ["11 0 0 1", "12 1 0 1", "13 1 .6 1.8", "14 0 .6 1.8"],
                Some("x stands for x of the file and y for 0.6 y + 0.8 z"),
            ),
        ] {
            let mesh = moved(to);
            let notes = mesh.notes();
            assert_eq!(notes.len(), usize::from(note.is_some()), "{notes:?}");
            assert!(note.is_none_or(|note| notes[0].ends_with(note)), "{notes:?}");
            assert_eq!(mesh.cells(), square.cells());
            let shift = if to[0] == "11 0 0 1" { 0.8 } else { 0.0 };
            for ((point, flat), line) in mesh.points().iter().zip(square.points()).zip(to) {
                let near = |a: f64, b: f64| (a - b).abs() <= 1.001e-9;
                assert!(near(point[0], flat[0]) && near(point[1], flat[1] + shift), "{mesh:?}");
                let place = line.split(' ').skip(1).map(|word| word.parse::<f64>().unwrap());
                let same = mesh.in_space(point).into_iter().zip(place).all(|(a, b)| near(a, b));
                assert!(same, "{line}: {mesh:?}");
            }
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
