//! Faults of a file, each in one line.

use crate::mesh::MeshError;
use std::fmt;

/// Why a file is no mesh.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub(super) enum GmshError {
    /// Another kind of file.
    #[error(
        "the file does not begin with $MeshFormat; save the mesh with Gmsh as .msh, or convert it with \
         `meshio convert FILE mesh.msh --output-format gmsh22`"
    )]
    NoMeshFormat,
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

/// Bytes that some editors put before a text.
pub(super) const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";
