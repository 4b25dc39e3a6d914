//! Faults of a file, each in one line.

use crate::mesh::MeshError;
use std::fmt;

/// Why a file is no mesh.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub(super) enum GmshError {
    /// Another kind of file.
    #[error("{0}")]
    NoMeshFormat(String),
    /// A fault in a section.
    #[error("${section}, {place}: {fault}")]
    Section {
        /// Name of the section.
        section: String,
        /// Place of the fault.
        place: FilePlace,
        /// Fault.
        fault: Fault,
    },
    /// A file without nodes or elements.
    #[error("the file has no section ${0}; save the mesh, not only the geometry")]
    Missing(&'static str),
    /// Physical groups, and no cell in one of them.
    #[error(
        "the file has no triangles and no tetrahedra: Gmsh saves what is in physical groups; add a Physical Surface, \
         in space a Physical Volume, or set `Mesh.SaveAll = 1`"
    )]
    NoCellsInGroups,
    /// A physical group of volumes or surfaces, and no element of its dimension or a higher one.
    #[error(
        "the file has a {group} and no {cells}: mesh it with `gmsh {option} FILE -o mesh.msh`, FILE its geometry"
    )]
    NotMeshed {
        /// Kind of the group.
        group: &'static str,
        /// Kind of the cells.
        cells: &'static str,
        /// Option that makes them.
        option: &'static str,
    },
    /// A quadrangle with its corners in an order that is not that around it.
    #[error(
        "element {0} is a quadrangle whose sides cross: name its corners in their order around it"
    )]
    Crosswise(u64),
    /// A surface that is not in one plane.
    #[error(
        "node {off} is off the plane of nodes {}, {} and {}, and the file has no tetrahedra: a surface in space is no \
         domain; mesh the volume, and put it into a Physical Volume if there are physical groups, or mesh in one plane",
        plane[0],
        plane[1],
        plane[2]
    )]
    NotPlane {
        /// Nodes of a plane.
        plane: [u64; 3],
        /// Node that is not in it.
        off: u64,
    },
    /// A line or triangle apart from the domain that a group names.
    #[error(
        "element {element} is a {kind} on no {cell}, and in a group: the file mixes dimensions; take it out of the \
         group"
    )]
    Mixed {
        /// Number of the line or triangle.
        element: u64,
        /// Kind of the element.
        kind: &'static str,
        /// Kind of the cells.
        cell: &'static str,
    },
    /// Two elements on the same nodes.
    #[error(
        "elements {one} and {two} have the same nodes; remove one, e.g. with \
         `gmsh.model.mesh.removeDuplicateElements()` in Python"
    )]
    Twice {
        /// Element.
        one: u64,
        /// Element that follows.
        two: u64,
    },
    /// More groups than 16 bits number.
    #[error("there are {0} physical groups, and at most 65535 are read; unite some")]
    Groups(usize),
    /// A group whose name is the number of a group without a name.
    #[error(
        "group {named} has the name `{number}`, which group {number}, without a name, has too; rename one of them"
    )]
    NameIsNumber {
        /// Number of the group with the name.
        named: u64,
        /// Number of the group without a name.
        number: u64,
    },
    /// A group with the name of what is in no group.
    #[error(
        "a group has the name `{0}`, which elements in no group have too; put these into a group, or rename that one"
    )]
    NameOfNone(&'static str),
    /// Elements that are no triangulation.
    #[error(transparent)]
    Mesh(#[from] MeshError),
}

/// Place of a fault.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum FilePlace {
    /// Line of a text, from 1 on.
    Line(usize),
    /// Byte of a binary file, from 0 on.
    Byte(usize),
}

impl fmt::Display for FilePlace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Line(line) => write!(f, "line {line}"),
            Self::Byte(byte) => write!(f, "byte {byte}"),
        }
    }
}

/// Fault in a section.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub(super) enum Fault {
    /// The end of the file where something has to follow.
    #[error("the file ends too soon; save the mesh again")]
    FileEnd,
    /// A word that begins with $ in the place of a number.
    #[error("`{0}` stands in the place of a number; the section ends too soon")]
    SectionEnd(String),
    /// A word that is not the one that has to follow.
    #[error("`{found}` stands in the place of {expected}")]
    Unexpected {
        /// Word.
        found: String,
        /// Meaning of the word that has to follow.
        expected: String,
    },
    /// A version that is not read.
    #[error("version {0} of the format is not read; save with `Mesh.MshFileVersion = 4.1`")]
    Version(String),
    /// Bytes for the order of bytes that are not those of 1.
    #[error("the number 1 that tells the order of bytes is missing; save the mesh again")]
    ByteOrder,
    /// Sizes of binary numbers that are not read.
    #[error("numbers of {0} bytes are not read, only of 8; save the mesh as text")]
    NumberSize(i64),
    /// Partitions, of which a file may have some alone.
    #[error("a partitioned mesh is not read; unite its partitions in Gmsh, and save it again")]
    Partitioned,
    /// Elements before what they need.
    #[error("${0} has to stand before $Elements; save the mesh again")]
    Order(&'static str),
    /// Names of groups without their dimension.
    #[error(
        "names of groups without a dimension are not read; open the file in Gmsh, and save it again"
    )]
    NoDimension,
    /// Nodes with parameters in version 2.
    #[error(
        "nodes with parameters are not read in version 2; save with `Mesh.MshFileVersion = 4.1`"
    )]
    Parametric,
    /// A name that is not one short line in quotes.
    #[error("the name of group {0} is not one to 127 printed letters in quotes; change the name")]
    Name(u64),
    /// A node that is there twice.
    #[error("node {0} is there twice; renumber the nodes of the mesh")]
    NodeTwice(u64),
    /// More nodes than 32 bits number.
    #[error("there are more nodes than 32 bits number; mesh less finely")]
    Nodes,
    /// An element of a node that does not exist.
    #[error("element {element} names node {node}, which is not in the mesh")]
    NoNode {
        /// Element.
        element: u64,
        /// Number of the node.
        node: u64,
    },
    /// An element that is neither a line nor a triangle nor a quadrangle nor a tetrahedron.
    #[error("element {element} {is}; {remedy}")]
    Kind {
        /// Element.
        element: u64,
        /// Kind of the element, as the end of a sentence.
        is: String,
        /// Remedy.
        remedy: &'static str,
    },
    /// An element in a curve, surface or volume of another dimension.
    #[error("element {element} lies in an entity of dimension {dimension}; save the mesh again")]
    Dimension {
        /// Element.
        element: u64,
        /// Dimension of the entity.
        dimension: i64,
    },
}

#[cfg(test)]
mod tests {
    use crate::mesh::gmsh::read;
    use crate::mesh::gmsh::tests::{SQUARE_22, SQUARE_41, after};

    /// Changes of the square, each with its refusal.
    const BROKEN: [(&str, &str, &str); 21] = [
        (
            "$Mesh",
            "Mesh",
            "the file does not begin with $MeshFormat; save the mesh with Gmsh as .msh, or convert it with `meshio \
                 convert FILE mesh.msh --output-format gmsh22`",
        ),
        (
            "2.2 0",
            "3.0 0",
            "$MeshFormat, line 2: version 3.0 of the format is not read; save with `Mesh.MshFileVersion = 4.1`",
        ),
        (
            "2.2 0 8",
            "2.2 2 8",
            "$MeshFormat, line 2: `2` stands in the place of 0 for text or 1 for a binary file",
        ),
        (
            "2.2 0 8",
            "2.2 1 4",
            "$MeshFormat, line 2: numbers of 4 bytes are not read, only of 8; save the mesh as text",
        ),
        (
            "2.2 0 8",
            "2.2 1 8",
            "$MeshFormat, line 3: the number 1 that tells the order of bytes is missing; save the mesh again",
        ),
        ("13 1 1 0", "13 1 1,5 0", "$Nodes, line 13: `1,5` stands in the place of a number"),
        (
            "13 1 1 0",
            "13 1 1e999 0",
            "$Nodes, line 13: `inf` stands in the place of a finite number",
        ),
        (
            "13 1 1 0",
            "12 1 1 0",
            "$Nodes, line 13: node 12 is there twice; renumber the nodes of the mesh",
        ),
        (
            "14 0 1 0\n",
            "",
            "$Nodes, line 14: `$EndNodes` stands in the place of a number; the section ends too soon",
        ),
        ("$Nodes\n4", "$Nodes\n3", "$Nodes, line 14: `14` stands in the place of $EndNodes"),
        (
            "$Nodes\n4",
            "$Nodes\n-1",
            "$Nodes, line 10: `-1` stands in the place of a whole number from 0 on",
        ),
        (
            "13 14\n$EndElements\n",
            "13",
            "$Elements, line 21: the file ends too soon; save the mesh again",
        ),
        (
            "23 2 2 2 1 11 12 13",
            "23 2 2 2 1 11 12 15",
            "$Elements, line 20: element 23 names node 15, which is not in the mesh",
        ),
        (
            "$EndElements\n",
            "$EndElements\n$Nodes\n1\n11 0 0 0\n$EndNodes",
            "$Nodes, line 25: node 11 is there twice; renumber the nodes of the mesh",
        ),
        (
            "$Nodes\n4",
            "$Elements\n0\n$EndElements\n$Nodes\n4",
            "$Elements, line 9: $Nodes has to stand before $Elements; save the mesh again",
        ),
        (
            "$Elements\n",
            "more text that is in no section\n$Elements\n",
            "$Nodes, line 16: `more` stands in the place of $ and the name of a section",
        ),
        ("$Elements\n", "$Other\n", "$Other, line 16: the file ends too soon; save the mesh again"),
        (
            "\"south\"",
            "south",
            "$PhysicalNames, line 6: the name of group 1 is not one to 127 printed letters in quotes; change the \
                 name",
        ),
        (
            "1 1 \"south\"",
            "1 \"south\"",
            "$PhysicalNames, line 6: names of groups without a dimension are not read; open the file in Gmsh, and \
                 save it again",
        ),
        (
            "1 1 \"south\"",
            "1\"south\"",
            "$PhysicalNames, line 6: names of groups without a dimension are not read; open the file in Gmsh, and \
                 save it again",
        ),
        (
            "$Nodes\n4",
            "$ParametricNodes\n4",
            "$ParametricNodes, line 9: nodes with parameters are not read in version 2; save with \
                 `Mesh.MshFileVersion = 4.1`",
        ),
    ];

    #[test]
    fn broken_sections_are_named_with_the_line() {
        for (from, to, message) in BROKEN {
            assert_eq!(after(SQUARE_22, from, to), message);
        }
    }

    #[test]
    fn versions_are_numbers_and_sections_must_be_there() {
        for version in ["2.000000", "2", "2.1", "2.20", "2.2000", "2.200000047683716"] {
            assert!(
                read(SQUARE_22.replace("2.2 0 8", &format!("{version} 0 8")).as_bytes()).is_ok()
            );
        }
        assert!(read(SQUARE_41.replace("4.1 0 8", "4.10 0 8").as_bytes()).is_ok());
        let (nodes, _) = SQUARE_22.split_once("$Elements").unwrap();
        assert_eq!(
            read(nodes.as_bytes()).unwrap_err(),
            "the file has no section $Elements; save the mesh, not only the geometry"
        );
    }
}
