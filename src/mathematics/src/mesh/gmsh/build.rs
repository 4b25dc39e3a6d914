//! From the sections of a file to a mesh.

use super::elements::{FileElement, FileElements};
use super::error::GmshError;
use super::groups::{Entities, GroupNames};
use super::labels::Groups;
use super::nodes::FileNodes;
use super::plane::plane_of;
use super::quadrangles::halves;
use crate::mesh::{
    AnyMesh, Facet, Mesh, MeshData, MeshError, MeshOrigin, Names, Part, PlaneMesh, SpaceMesh, Tags,
};
use crate::problem::law::Law;

/// Sections that make a mesh.
pub(super) struct Sections {
    pub(super) names: GroupNames,
    pub(super) entities: Entities,
    pub(super) nodes: FileNodes,
    pub(super) elements: FileElements,
}

impl Sections {
    /// Mesh in space if there are tetrahedra, else in the plane, of sections with cells.
    pub(super) fn mesh(self) -> Result<AnyMesh, GmshError> {
        match self.elements.tetrahedra.is_empty() {
            true => Ok(AnyMesh::Plane(self.plane_mesh()?)),
            false => Ok(AnyMesh::Space(self.space_mesh()?)),
        }
    }

    /// Checks that there are cells, and that what is in groups is meshed.
    pub(super) fn check_cells(&self, has_nodes: bool) -> Result<(), GmshError> {
        let FileElements { lines, triangles, quadrangles, tetrahedra, .. } = &self.elements;
        if !(tetrahedra.is_empty() && triangles.is_empty() && quadrangles.is_empty()) {
            return Ok(());
        }
        for (dimension, group, cells, option) in
            [(3, "Physical Volume", "tetrahedra", "-3"), (2, "Physical Surface", "triangles", "-2")]
        {
            if self.has_group(dimension) {
                return Err(GmshError::NotMeshed { group, cells, option });
            }
        }
        if !has_nodes {
            return Err(GmshError::Missing("Nodes"));
        }
        if !self.names.is_empty() || lines.iter().any(|line| self.elements.is_in_group(line)) {
            return Err(GmshError::NoCellsInGroups);
        }
        let (cells, domain) =
            if self.entities.has(3) { ("tetrahedra", "volume") } else { ("triangles", "area") };
        Err(MeshError::NoCells { cells, domain }.into())
    }

    /// True if the file tells of a group of this dimension.
    fn has_group(&self, dimension: i64) -> bool {
        self.names.select(dimension).next().is_some() || self.entities.has_group(dimension)
    }

    fn plane_mesh(self) -> Result<PlaneMesh, GmshError> {
        let without_volume = self.has_group(3) || self.entities.has(3);
        let Self { names, mut nodes, elements, .. } = self;
        let FileElements { lines, mut triangles, quadrangles, sets, .. } = elements;
        let mut has_cell = has_cell(&nodes, &triangles);
        mark(&mut has_cell, &quadrangles);
        let mut groups = Groups { names, sets };
        let mut left_out = 0;
        let lines = groups.on_cells(lines, &has_cell, ["line", "triangle"], &mut left_out)?;
        let plane = plane_of(&nodes, &has_cell)?;
        for point in &mut nodes.points {
            let [x, y] = plane.coordinates(*point);
            *point = [x, y, 0.0];
        }
        let quadrangles = groups.cells_once(quadrangles)?;
        for quadrangle in &quadrangles {
            triangles.extend(halves(&nodes, quadrangle)?);
        }
        let mut mesh = mesh(&mut groups, nodes, triangles, &lines)?;
        mesh.origin = MeshOrigin {
            plane,
            of_higher_order: elements.of_higher_order[2],
            quadrangles: quadrangles.len(),
            collapsed: elements.collapsed,
            left_out,
            without_volume,
        };
        Ok(mesh)
    }

    fn space_mesh(self) -> Result<SpaceMesh, GmshError> {
        let Self { names, nodes, elements, .. } = self;
        let FileElements { lines, triangles, quadrangles, tetrahedra, sets, .. } = elements;
        let has_cell = has_cell(&nodes, &tetrahedra);
        let mut groups = Groups { names, sets };
        let mut left_out = 0;
        groups.on_cells(lines, &has_cell, ["line", "tetrahedron"], &mut left_out)?;
        let triangles =
            groups.on_cells(triangles, &has_cell, ["triangle", "tetrahedron"], &mut left_out)?;
        // No side of a tetrahedron is a quadrangle.
        groups.on_cells(quadrangles, &[], ["quadrangle", "tetrahedron"], &mut left_out)?;
        let mut mesh = mesh(&mut groups, nodes, tetrahedra, &triangles)?;
        mesh.origin = MeshOrigin {
            of_higher_order: elements.of_higher_order[3],
            collapsed: elements.collapsed,
            left_out,
            ..MeshOrigin::default()
        };
        Ok(mesh)
    }
}

impl FileElements {
    /// True if an element is in a group.
    fn is_in_group<const K: usize>(&self, element: &FileElement<K>) -> bool {
        !self.sets.groups(element.groups).is_empty()
    }
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
    Part { names, law: Law::SIGNORINI, curve: None }
}

#[cfg(test)]
mod tests {
    use crate::mesh::gmsh::read;
    use crate::mesh::gmsh::tests::{SQUARE_22, SQUARE_41, TETRAHEDRON, plane};
    use crate::mesh::{AnyMesh, MeshOrigin};
    use crate::problem::law::Law;

    /// The square with more elements, and nodes of no cell.
    fn beside(elements: &str) -> String {
        let count = 4 + elements.lines().count();
        SQUARE_22
            .replace("$Nodes\n4", "$Nodes\n6")
            .replace("14 0 1 0\n", "14 0 1 0\n15 2 2 0\n16 3 2 7\n")
            .replace("$Elements\n4", &format!("$Elements\n{count}"))
            .replace("$EndElements", &format!("{elements}$EndElements"))
    }

    #[test]
    fn what_is_on_no_cell_and_in_no_group_is_left_out() {
        let square = plane(SQUARE_22.as_bytes());
        for strays in ["31 1 2 0 9 15 16\n", "31 1 2 0 9 15 16\n32 1 0 12 15\n"] {
            let mut mesh = plane(beside(strays).as_bytes());
            let notes = mesh.notes();
            assert!(
                notes[0].ends_with("on no cell and in no group is left out")
                    || notes[0].starts_with("2 elem")
            );
            mesh.origin = MeshOrigin::default();
            assert_eq!(mesh, square);
        }
        let named = read(beside("31 1 2 5 9 15 16\n").as_bytes()).unwrap_err();
        assert!(
            named.starts_with("element 31 is a line on no triangle, and in a group: "),
            "{named}"
        );
        let nodes = "$Nodes\n7\n91 0 0 9\n92 1 0 9\n93 0 1 9\n";
        let strays = "31 2 2 0 1 91 92 93\n32 1 2 0 1 91 92\n33 3 2 0 1 1 2 92 91\n$EndElements";
        let AnyMesh::Space(alone) = read(TETRAHEDRON.as_bytes()).unwrap() else {
            panic!("in space")
        };
        let text = TETRAHEDRON
            .replace("$Nodes\n4\n", nodes)
            .replace("$Elements\n3\n", "$Elements\n6\n")
            .replace("$EndElements", strays);
        let AnyMesh::Space(mut mesh) = read(text.as_bytes()).unwrap() else { panic!("in space") };
        assert_eq!(mesh.origin.left_out, 3);
        mesh.origin = MeshOrigin::default();
        assert_eq!(mesh, alone);
    }

    #[test]
    fn volumes_and_surfaces_that_are_not_meshed_are_told() {
        let entity = "$Entities\n0 0 0 1\n1 0 0 0 1 1 1 0 0\n$EndEntities\n";
        let text = SQUARE_41.replace("$EndEntities\n", &format!("$EndEntities\n{entity}"));
        let notes = plane(text.as_bytes()).notes();
        assert!(
            notes[0].starts_with("the file tells of a volume and has no tetrahedra: "),
            "{notes:?}"
        );
        assert!(plane(SQUARE_41.as_bytes()).notes().is_empty());
        let (before, _) = SQUARE_22.split_once("$Elements").unwrap();
        let alone = format!("{before}$Elements\n1\n22 1 2 1 1 11 12\n$EndElements\n");
        for (from, to, said) in [
            (
                "2 2 \"",
                "3 2 \"",
                "the file has a Physical Volume and no tetrahedra: mesh it with `gmsh -3 ",
            ),
            (
                "1 1 \"",
                "1 1 \"",
                "the file has a Physical Surface and no triangles: mesh it with `gmsh -2 ",
            ),
        ] {
            assert!(alone.contains(from), "{alone}");
            let fault = read(alone.replace(from, to).as_bytes()).unwrap_err();
            assert!(fault.starts_with(said), "{fault}");
        }
        let nothing = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n0 0 0 0\n$EndNodes\n\
            $Elements\n0 0 0 0\n$EndElements\n";
        let nothing = nothing.replace("$Nodes", &format!("{entity}$Nodes"));
        // With a Physical Volume, and surfaces meshed alone, version 4 has neither nodes nor elements.
        let (geometry, _) = nothing.split_once("$Nodes").unwrap();
        let fault = read(geometry.as_bytes()).unwrap_err();
        assert!(fault.starts_with("the file has no section $Nodes; "), "{fault}");
        let in_group = geometry.replace("1 1 1 0 0", "1 1 1 1 5 0");
        let fault = read(in_group.as_bytes()).unwrap_err();
        assert!(fault.starts_with("the file has a Physical Volume and no tetrahedra: "), "{fault}");
        let fault = read(nothing.as_bytes()).unwrap_err();
        assert_eq!(
            fault,
            "the mesh has no tetrahedra; mesh the volume itself, not only its boundary"
        );
    }

    #[test]
    fn planes_may_be_rounded_to_six_digits() {
        let corners = ["11 0 0 0", "12 1 0 0", "13 1 1 0", "14 0 1 0"];
        // Turned about the diagonal of x and y.
        let turned =
            ["11 0 0 0", "12 0.853553 0.146447 0.5", "13 1 1 0", "14 0.146447 0.853553 -0.500004"];
        let mut text = SQUARE_22.to_owned();
        corners.iter().zip(turned).for_each(|(from, to)| text = text.replace(from, to));
        assert!((plane(text.as_bytes()).volume() - 1.0).abs() < 1e-5);
        let bent = text.replace("-0.500004", "-0.5001");
        assert!(read(bent.as_bytes()).unwrap_err().contains("is off the plane of nodes"));
        // A strip is no line, however narrow.
        for narrow in
            [["12 1 0 0", "13 1 0 1e-6", "14 0 0 1e-6"], ["12 1 0 0", "13 1 1e-6 0", "14 0 1e-6 0"]]
        {
            let mut text = SQUARE_22.to_owned();
            corners[1..].iter().zip(narrow).for_each(|(from, to)| text = text.replace(from, to));
            assert!((plane(text.as_bytes()).volume() - 1e-6).abs() < 1e-15);
        }
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
        assert_eq!(mesh.set_law("loaded", Law::FREE), Ok(()));
        let AnyMesh::Plane(plane) = &mesh else { unreachable!() };
        let free = plane.facets().iter().filter(|facet| plane.law(facet) == Law::FREE);
        assert_eq!(free.count(), 2);
        // Two conditions meet on the lower edge.
        let refused = mesh.set_law("south", Law::FIXED).unwrap_err();
        assert_eq!(
            refused,
            "facets named south, loaded would have two laws, free and fixed; choose one of the two"
        );
        assert_eq!(mesh.set_law("south", Law::FREE), Ok(()));
        let refused = mesh.set_law("diagonal", Law::FREE).unwrap_err();
        assert_eq!(
            refused,
            "`diagonal` lies inside the domain, where no law holds; the parts of the boundary are south, \
             loaded, boundary"
        );
        let inside = "borders of regions are straight edges; write a disc or ball in f in place of a round region";
        let refused = refused.replace("no law holds", inside);
        assert_eq!(mesh.set_curve("diagonal", &[0.0, 0.0, 1.0]), Err(refused));
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
}
