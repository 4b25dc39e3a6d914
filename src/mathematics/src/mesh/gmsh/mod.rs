//! Meshes of [Gmsh](https://gmsh.info), from files of the versions 2.0 to 2.2, 4.0 and 4.1, in text and in bytes.
//!
//! Triangles and tetrahedra are read, those of higher order by their corners, and quadrangles, which a diagonal cuts;
//! physical groups name regions and parts of the boundary. Sections may be repeated. The reader is our own because the
//! crate `mshio` reads version 4.1 only, and has had no release for years.

mod build;
mod elements;
mod error;
mod groups;
mod labels;
mod nodes;
mod plane;
mod quadrangles;
mod scanner;

use super::AnyMesh;
use build::Sections;
use elements::FileElements;
use error::{Fault, GmshError};
use groups::{Entities, GroupNames};
use nodes::FileNodes;
use scanner::{Scanner, Version};

/// Reads a mesh: in space if there are tetrahedra, else in the plane, whose place is in
/// `MeshOrigin`.
///
/// Nodes keep the order of the file; nodes of no line, triangle or tetrahedron are left out. A group without a name has
/// its number for a name; cells without a group are the region `domain`. An element may be in several groups: facets of
/// the same groups are a part, cells of the same groups a region. Facets inside the domain are left out, and so is what
/// is on no cell and in no group.
///
/// # Errors
/// A sentence with the section and the line or byte, or with the number of the element.
pub fn read(bytes: &[u8]) -> Result<AnyMesh, String> {
    read_mesh(bytes).map_err(|e| e.to_string())
}

fn read_mesh(bytes: &[u8]) -> Result<AnyMesh, GmshError> {
    let mut scanner = Scanner::new(bytes)?;
    let (mut names, mut entities) = (GroupNames::default(), Entities::default());
    let (mut nodes, mut elements) = (None, None);
    while let Some(section) = scanner.section()? {
        let has_entities = scanner.version != Version::Two;
        match section {
            "PhysicalNames" => names.read(&mut scanner)?,
            "PartitionedEntities" => return Err(scanner.fault(Fault::Partitioned)),
            "Entities" if has_entities => {
                if elements.is_some() && entities.is_empty() {
                    return Err(scanner.fault(Fault::Order("Entities")));
                }
                entities.read(&mut scanner)?;
            }
            "ParametricNodes" if !has_entities => return Err(scanner.fault(Fault::Parametric)),
            "Nodes" => nodes.get_or_insert_with(FileNodes::default).read(&mut scanner)?,
            "Elements" => {
                let Some(nodes) = &nodes else { return Err(scanner.fault(Fault::Order("Nodes"))) };
                let elements = elements.get_or_insert_with(FileElements::default);
                elements.read(&mut scanner, nodes, &entities)?;
            }
            _ => {
                scanner.skip()?;
                continue;
            }
        }
        scanner.end()?;
    }
    let has_nodes = nodes.is_some();
    let (nodes, elements) = match (nodes, elements) {
        (Some(_), None) => return Err(GmshError::Missing("Elements")),
        (nodes, elements) => (nodes.unwrap_or_default(), elements.unwrap_or_default()),
    };
    let sections = Sections { names, entities, nodes, elements };
    sections.check_cells(has_nodes)?;
    sections.mesh()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{Mesh, PlaneMesh};

    const GEAR: [&[u8]; 4] = [
        include_bytes!("../../../../../tests/meshes/gear.msh"),
        include_bytes!("../../../../../tests/meshes/gear-22.msh"),
        include_bytes!("../../../../../tests/meshes/gear-binary.msh"),
        include_bytes!("../../../../../tests/meshes/gear-22-binary.msh"),
    ];
    const NOTCH: &[u8] = include_bytes!("../../../../../tests/meshes/notch.msh");
    /// Unit square as two triangles, with its lower edge named, in version 2.2.
    pub(super) const SQUARE_22: &str = include_str!("../../../../../tests/meshes/square-22.msh");
    /// Square with coordinates of the nodes on the surface too, in version 4.1.
    pub(super) const SQUARE_41: &str = include_str!("../../../../../tests/meshes/square.msh");
    /// One cell with one named side, in version 2.2.
    pub(super) const TETRAHEDRON: &str =
        include_str!("../../../../../tests/meshes/tetrahedron-22.msh");

    /// Piece of a binary file.
    enum Piece {
        Text(&'static str),
        Wholes(&'static [i32]),
        Counts(&'static [u64]),
        Reals(&'static [f64]),
    }

    use Piece::{Counts, Reals, Text, Wholes};

    /// Square in bytes, in version 4.0.
    const SQUARE_40_BINARY: [Piece; 36] = [
        Text("$MeshFormat\n4.0 1 8\n"),
        Wholes(&[1]),
        Text(
            "\n$EndMeshFormat\n$PhysicalNames\n2\n1 1 \"south\"\n2 2 \"plate\"\n$EndPhysicalNames\n",
        ),
        Text("$Entities\n"),
        Counts(&[0, 1, 1, 0]),
        Wholes(&[5]),
        Reals(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0]),
        Counts(&[1]),
        Wholes(&[1]),
        Counts(&[0]),
        Wholes(&[6]),
        Reals(&[0.0, 0.0, 0.0, 1.0, 1.0, 0.0]),
        Counts(&[1]),
        Wholes(&[2]),
        Counts(&[1]),
        Wholes(&[5]),
        Text("\n$EndEntities\n$Nodes\n"),
        Counts(&[1, 4]),
        Wholes(&[6, 2, 0]),
        Counts(&[4]),
        Wholes(&[11]),
        Reals(&[0.0, 0.0, 0.0]),
        Wholes(&[12]),
        Reals(&[1.0, 0.0, 0.0]),
        Wholes(&[13]),
        Reals(&[1.0, 1.0, 0.0]),
        Wholes(&[14]),
        Reals(&[0.0, 1.0, 0.0]),
        Text("\n$EndNodes\n$Unknown\n\u{1}$EndNothing \u{2}\n$EndUnknown\n$Elements\n"),
        Counts(&[2, 3]),
        Wholes(&[5, 1, 1]),
        Counts(&[1]),
        Wholes(&[22, 11, 12, 6, 2, 2]),
        Counts(&[2]),
        Wholes(&[23, 11, 12, 13, 24, 11, 13, 14]),
        Text("\n$EndElements\n"),
    ];

    fn encode(pieces: &[Piece], is_big_endian: bool) -> Vec<u8> {
        let mut bytes = Vec::new();
        for piece in pieces {
            let numbers: Vec<Vec<u8>> = match piece {
                Text(text) => {
                    bytes.extend(text.bytes());
                    continue;
                }
                Wholes(numbers) => numbers.iter().map(|n| n.to_le_bytes().to_vec()).collect(),
                Counts(numbers) => numbers.iter().map(|n| n.to_le_bytes().to_vec()).collect(),
                Reals(numbers) => numbers.iter().map(|n| n.to_le_bytes().to_vec()).collect(),
            };
            for mut number in numbers {
                if is_big_endian {
                    number.reverse();
                }
                bytes.extend(number);
            }
        }
        bytes
    }

    pub(super) fn plane(bytes: &[u8]) -> PlaneMesh {
        match read(bytes) {
            Ok(AnyMesh::Plane(mesh)) => mesh,
            other => panic!("{other:?}"),
        }
    }

    /// Names of the parts, with the number of facets of each.
    fn parts<const D: usize, const V: usize>(mesh: &Mesh<D, V>) -> Vec<(String, usize)> {
        let mut parts: Vec<_> =
            mesh.parts().iter().map(|part| (part.names.to_string(), 0)).collect();
        mesh.facets().iter().for_each(|facet| parts[facet.part as usize].1 += 1);
        parts
    }

    fn named(parts: &[(&str, usize)]) -> Vec<(String, usize)> {
        parts.iter().map(|&(name, facets)| (name.to_owned(), facets)).collect()
    }

    #[test]
    fn a_square_is_the_same_in_every_form() {
        let square = plane(SQUARE_22.as_bytes());
        assert_eq!(square.points(), [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
        assert_eq!(square.cells(), [[0, 1, 2], [0, 2, 3]]);
        assert_eq!(square.region_names(), ["plate".into()]);
        assert_eq!(parts(&square), named(&[("south", 1), ("boundary", 3)]));
        assert_eq!(plane(SQUARE_41.as_bytes()), square);
        for is_big_endian in [false, true] {
            let bytes = encode(&SQUARE_40_BINARY, is_big_endian);
            assert_eq!(plane(&bytes), square);
            let message = read(&bytes[..bytes.len() - 20]).unwrap_err();
            assert_eq!(message, "$Elements, byte 607: the file ends too soon; save the mesh again");
        }
    }

    #[test]
    fn old_versions_and_repeated_sections_change_nothing() {
        let square = plane(SQUARE_22.as_bytes());
        for version in ["2", "2.0", "2.1"] {
            let text = SQUARE_22.replace("2.2 0 8", &format!("{version} 0 8"));
            assert_eq!(plane(text.as_bytes()), square, "{version}");
        }
        let (before, _) = SQUARE_41.split_once("$Nodes").unwrap();
        // Points have boxes, too.
        let before =
            before.replace("4.1 0 8", "4.0 0 8").replace("1 0 0 0 0\n", "1 0 0 0 0 0 0 0\n");
        let text = format!(
            "{before}$Nodes\n1 4\n6 2 1 4\n11 0 0 0 0 0\n12 1 0 0 1 0\n13 1 1 0 1 1\n14 0 1 0 0 1\n$EndNodes\n\
             $Elements\n3 4\n1 0 15 1\n21 11\n5 1 1 1\n22 11 12\n6 2 2 2\n23 11 12 13\n24 11 13 14\n$EndElements\n"
        );
        assert_eq!(plane(text.as_bytes()), square);

        let refused =
            "a partitioned mesh is not read; unite its partitions in Gmsh, and save it again";
        let partitioned = SQUARE_22.replace("24 2 2 2 1 11", "24 2 4 2 1 1 2 11");
        assert_eq!(
            read(partitioned.as_bytes()).unwrap_err(),
            format!("$Elements, line 21: {refused}")
        );
        let partitioned = SQUARE_41.replace(
            "$EndEntities\n",
            "$EndEntities\n$PartitionedEntities\n2\n0\n0 0 0 0\n$EndPartitionedEntities\n",
        );
        assert!(read(partitioned.as_bytes()).unwrap_err().ends_with(refused));

        let repeated = SQUARE_22
            .replace(
                "2\n1 1 \"south\"\n",
                "1\n1 1 \"south\"\n$EndPhysicalNames\n$PhysicalNames\n1\n",
            )
            .replace("$Nodes\n4\n", "$Nodes\n3\n")
            .replace("14 0 1 0\n", "$EndNodes\n$Nodes\n1\n14 0 1 0\n")
            .replace("$Elements\n4\n", "$Elements\n3\n")
            .replace("24 2 2", "$EndElements\n$Elements\n1\n24 2 2");
        assert_eq!(plane(repeated.as_bytes()), square);
    }

    #[test]
    fn a_gear_is_the_same_in_every_form() {
        let [text, bytes] = [plane(GEAR[0]), plane(GEAR[2])];
        assert_eq!(parts(&text), named(&[("teeth", 84), ("hole", 12)]));
        assert_eq!((text.region_names(), text.cells().len()), (&["gear".into()][..], 448));
        assert_eq!((plane(GEAR[1]), plane(GEAR[3])), (text.clone(), bytes.clone()));
        // Text has 16 digits.
        let pairs = text.points().iter().flatten().zip(bytes.points().iter().flatten());
        assert!(pairs.into_iter().all(|(text, bytes)| (text - bytes).abs() < 1e-15));
        assert_eq!((text.cells(), text.facets()), (bytes.cells(), bytes.facets()));
    }

    #[test]
    fn a_notched_box_is_in_space() {
        let Ok(AnyMesh::Space(notch)) = read(NOTCH) else { panic!("a mesh in space") };
        assert_eq!(parts(&notch), named(&[("walls", 150), ("notch", 12)]));
        assert!((notch.volume() - 1.85).abs() < 1e-13);
    }

    #[test]
    fn groups_without_names_have_numbers_and_elements_without_groups_have_defaults() {
        let Ok(AnyMesh::Space(mesh)) = read(TETRAHEDRON.as_bytes()) else {
            panic!("a mesh in space")
        };
        assert_eq!(mesh.region_names(), ["9".into()]);
        assert_eq!(parts(&mesh), named(&[("7", 1), ("boundary", 3)]));
        let text = TETRAHEDRON.replace("2 7 1 ", "2 0 1 ").replace("2 9 1 ", "0 ");
        let Ok(AnyMesh::Space(mesh)) = read(text.as_bytes()) else { panic!("a mesh in space") };
        assert_eq!(mesh.region_names(), ["domain".into()]);
        assert_eq!(parts(&mesh), named(&[("boundary", 4)]));
    }

    #[test]
    fn blanks_comments_other_sections_and_unused_nodes_change_nothing() {
        let square = plane(SQUARE_41.as_bytes());
        for text in [SQUARE_22, SQUARE_41] {
            assert_eq!(plane(text.replace('\n', "\r\n").as_bytes()), square);
            assert_eq!(plane(text.replace(' ', " \t ").replace('\n', " \n\n").as_bytes()), square);
            let comments =
                format!("$Comments\n$EndNodes\n$EndComments\n{text}$Periodic\n0\n$EndPeriodic");
            assert_eq!(plane(comments.as_bytes()), square);
        }
        let text = SQUARE_22
            .replace("$Nodes\n4\n", "$Nodes\n5\n1 0.5 0 7\n")
            .replace("2 0 1 11", "2 0 1 1");
        assert_eq!(plane(text.as_bytes()), square);
    }

    #[test]
    fn wrong_heads_and_the_mark_of_an_editor_change_nothing() {
        let square = plane(SQUARE_41.as_bytes());
        let marked = [b"\xef\xbb\xbf", SQUARE_22.as_bytes()].concat();
        assert_eq!(plane(&marked), square);
        for (from, to) in
            [("1 4 11 14", "1 5 11 14"), ("3 4 21 24", "3 9 21 24"), ("1 4 11 14", "1 2 11 14")]
        {
            assert!(SQUARE_41.contains(from), "{from}");
            assert_eq!(plane(SQUARE_41.replace(from, to).as_bytes()), square);
        }
    }
}
