//! Faults of a file, each in one line.

use crate::mesh::MeshError;
use std::fmt;

/// Why a file is no mesh.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum GmshError {
    /// Another kind of file.
    #[error("the file does not begin with $MeshFormat; save the mesh with Gmsh as .msh")]
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
    /// A surface that is not in one plane z = const.
    #[error(
        "nodes {one} and {two} differ in z: a surface in space is no domain; mesh the volume, or the plane z = 0"
    )]
    NotPlane {
        /// Node.
        one: u64,
        /// Node with another z.
        two: u64,
    },
    /// A line or triangle apart from the domain.
    #[error(
        "element {element} is a {kind} on no {cell}: the file mixes dimensions; save only the domain and its boundary"
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
        "elements {one} and {two} have the same nodes; put each surface or volume into one physical group"
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
    /// Elements that are no triangulation.
    #[error(transparent)]
    Mesh(#[from] MeshError),
}

/// Place of a fault.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FilePlace {
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
pub enum Fault {
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
    /// A section that is there twice.
    #[error("the section is there twice; save one mesh in one file")]
    SectionTwice,
    /// Elements before what they need.
    #[error("${0} has to stand before $Elements; save the mesh again")]
    Order(&'static str),
    /// A mesh in several parts.
    #[error("the mesh is partitioned; save the mesh in one partition")]
    Partitioned,
    /// A name that is not one short line in quotes.
    #[error("the name of group {0} is not one to 127 printed letters in quotes; change the name")]
    Name(u64),
    /// Another number of nodes or elements than the head of the section says.
    #[error("the head of the section says {said}, and there are {found}; save the mesh again")]
    Total {
        /// Number that the head says.
        said: u64,
        /// Number that was found.
        found: u64,
    },
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
    /// An element that is neither a line nor a triangle nor a tetrahedron of first order.
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
    /// An entity in several groups.
    #[error("{kind} {entity} is in {groups} physical groups; put each {kind} into one")]
    Entity {
        /// Curve, surface or volume.
        kind: &'static str,
        /// Number of the entity.
        entity: i64,
        /// Number of its groups.
        groups: u64,
    },
}
