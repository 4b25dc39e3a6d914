//! The section `$Elements`.

use super::error::{Fault, GmshError};
use super::groups::{Entities, GroupSets};
use super::nodes::{FileNodes, blocks, entity};
use super::scanner::{Scanner, Version};

/// Line, triangle, quadrangle or tetrahedron, by its corners.
pub(super) struct FileElement<const K: usize> {
    /// Number of the element.
    pub(super) tag: u64,
    /// Positions of the corners.
    pub(super) nodes: [u32; K],
    /// Position of the set of its physical groups.
    pub(super) groups: u32,
}

impl<const K: usize> FileElement<K> {
    /// True if all corners are among the nodes with cells.
    pub(super) fn is_on(&self, has_cell: &[bool]) -> bool {
        self.nodes.iter().all(|&node| has_cell.get(node as usize) == Some(&true))
    }
}

impl FileElement<4> {
    /// Triangle that a quadrangle with the same node at both ends of a side is.
    fn collapsed(&self) -> Option<FileElement<3>> {
        let &Self { tag, nodes: [a, b, c, d], groups } = self;
        let nodes = if a == b || b == c {
            [a, c, d]
        } else if c == d || d == a {
            [a, b, c]
        } else {
            return None;
        };
        Some(FileElement { tag, nodes, groups })
    }
}

/// Elements by kind, in the order of the file.
#[derive(Default)]
pub(super) struct FileElements {
    pub(super) lines: Vec<FileElement<2>>,
    pub(super) triangles: Vec<FileElement<3>>,
    pub(super) quadrangles: Vec<FileElement<4>>,
    pub(super) tetrahedra: Vec<FileElement<4>>,
    /// Sets of physical groups.
    pub(super) sets: GroupSets,
    /// Number of elements of higher order, by dimension.
    pub(super) of_higher_order: [usize; 4],
    /// Number of triangles written as quadrangles with a node twice.
    pub(super) collapsed: usize,
}

/// Numbers of types of elements of one shape, each with the number of nodes.
type Numbers = &'static [(i64, usize)];

/// Types of elements that are read, to the third order, by the dimension and the number of corners of their shape: the
/// numbers of the types in the manual of Gmsh, each with the number of nodes, of which the corners come first.
const TYPES: [(usize, usize, Numbers); 5] = [
    // Points mean nothing.
    (0, 1, &[(15, 1)]),
    (1, 2, &[(1, 2), (8, 3), (26, 4)]),
    (2, 3, &[(2, 3), (9, 6), (20, 9), (21, 10)]),
    (2, 4, &[(3, 4), (10, 9), (16, 8), (36, 16), (39, 12)]),
    (3, 4, &[(4, 4), (11, 10), (29, 20), (32, 22), (137, 16)]),
];

/// Type of an element that is read.
#[derive(Clone, Copy)]
struct ElementType {
    dimension: usize,
    corners: usize,
    nodes: usize,
}

/// Number of an element, with its type and the position of the set of its groups.
#[derive(Clone, Copy)]
struct ElementHead {
    tag: u64,
    number_of_type: i64,
    groups: u32,
}

impl FileElements {
    /// Adds the elements of a section.
    pub(super) fn read(
        &mut self,
        scanner: &mut Scanner<'_>,
        nodes: &FileNodes,
        entities: &Entities,
    ) -> Result<(), GmshError> {
        match scanner.version {
            Version::FourZero | Version::FourOne => self.read_blocks(scanner, nodes, entities),
            Version::Two if scanner.is_text() => self.read_list(scanner, nodes),
            Version::Two => self.read_runs(scanner, nodes),
        }
    }

    /// Elements of a text of version 2.2, each with its type.
    fn read_list(&mut self, scanner: &mut Scanner<'_>, nodes: &FileNodes) -> Result<(), GmshError> {
        let said = scanner.count()?;
        for _ in 0..said {
            let (tag, number_of_type) = (scanner.tag()?, scanner.whole()?);
            let head = ElementHead { tag, number_of_type, groups: 0 };
            let numbers = scanner.whole()?;
            self.add_numbered(scanner, nodes, head, numbers)?;
        }
        Ok(())
    }

    /// Elements of a binary file of version 2.2: runs of one type.
    fn read_runs(&mut self, scanner: &mut Scanner<'_>, nodes: &FileNodes) -> Result<(), GmshError> {
        let said: u64 = scanner.number("a whole number from 0 on")?;
        scanner.begin_bytes()?;
        let mut count = 0;
        while count < said {
            let (number_of_type, length, numbers) =
                (scanner.whole()?, scanner.whole()?, scanner.whole()?);
            for _ in 0..length {
                count += 1;
                let head = ElementHead { tag: scanner.tag()?, number_of_type, groups: 0 };
                self.add_numbered(scanner, nodes, head, numbers)?;
            }
        }
        Ok(())
    }

    /// Adds an element of version 2, after whose head there are so many numbers: of its group, its entity, the number
    /// of its partitions and these, the first its own, the others negative.
    fn add_numbered(
        &mut self,
        scanner: &mut Scanner<'_>,
        nodes: &FileNodes,
        head: ElementHead,
        numbers: i64,
    ) -> Result<(), GmshError> {
        let mut group = 0;
        for k in 0..numbers {
            let number = scanner.whole()?.unsigned_abs();
            match k {
                0 => group = number,
                3.. if number != 0 => return Err(scanner.fault(Fault::Partitioned)),
                _ => (),
            }
        }
        let groups = self.sets.position(&[group]);
        self.add(scanner, nodes, ElementHead { groups, ..head })?;
        Ok(())
    }

    /// Elements of version 4: blocks of one type in one entity. The blocks say how many there are, not the head.
    fn read_blocks(
        &mut self,
        scanner: &mut Scanner<'_>,
        nodes: &FileNodes,
        entities: &Entities,
    ) -> Result<(), GmshError> {
        for _ in 0..blocks(scanner)? {
            let (dimension, entity) = entity(scanner)?;
            let (number_of_type, count) = (scanner.whole()?, scanner.count()?);
            let groups = self.sets.position(entities.groups(dimension, entity));
            for _ in 0..count {
                let head = ElementHead { tag: scanner.tag()?, number_of_type, groups };
                if self.add(scanner, nodes, head)? as i64 != dimension {
                    let fault = Fault::Dimension { element: head.tag, dimension };
                    return Err(scanner.fault(fault));
                }
            }
        }
        Ok(())
    }

    /// Reads the nodes of an element, and adds the element. Returns its dimension.
    fn add(
        &mut self,
        scanner: &mut Scanner<'_>,
        nodes: &FileNodes,
        head: ElementHead,
    ) -> Result<usize, GmshError> {
        let ElementType { dimension, corners, nodes: count } =
            kind(head).map_err(|fault| scanner.fault(fault))?;
        match (dimension, corners) {
            (0, _) => _ = scanner.tag()?,
            (1, _) => self.lines.push(element(scanner, nodes, head)?),
            (2, 3) => self.triangles.push(element(scanner, nodes, head)?),
            (2, _) => {
                let quadrangle = element(scanner, nodes, head)?;
                match quadrangle.collapsed() {
                    Some(triangle) => {
                        self.triangles.push(triangle);
                        self.collapsed += 1;
                    }
                    None => self.quadrangles.push(quadrangle),
                }
            }
            _ => self.tetrahedra.push(element(scanner, nodes, head)?),
        }
        for _ in corners..count {
            position(scanner, nodes, head)?;
        }
        self.of_higher_order[dimension] += usize::from(count > corners);
        Ok(dimension)
    }
}

/// Reads the corners of an element.
fn element<const K: usize>(
    scanner: &mut Scanner<'_>,
    nodes: &FileNodes,
    head: ElementHead,
) -> Result<FileElement<K>, GmshError> {
    let mut corners = [0; K];
    for corner in &mut corners {
        *corner = position(scanner, nodes, head)?;
    }
    Ok(FileElement { tag: head.tag, nodes: corners, groups: head.groups })
}

/// Reads the position of a node of an element.
fn position(
    scanner: &mut Scanner<'_>,
    nodes: &FileNodes,
    head: ElementHead,
) -> Result<u32, GmshError> {
    let node = scanner.tag()?;
    let missing = Fault::NoNode { element: head.tag, node };
    nodes.position(node).ok_or_else(|| scanner.fault(missing))
}

/// Type of an element, by the number of its type in the manual of Gmsh.
fn kind(head: ElementHead) -> Result<ElementType, Fault> {
    for (dimension, corners, types) in TYPES {
        if let Some(&(_, nodes)) = types.iter().find(|(number, _)| *number == head.number_of_type) {
            return Ok(ElementType { dimension, corners, nodes });
        }
    }
    let simplices = "mesh with tetrahedra only";
    let (is, remedy) = match head.number_of_type {
        5 | 12 | 17 => ("is a hexahedron".into(), simplices),
        6 | 13 | 18 => ("is a prism".into(), simplices),
        7 | 14 | 19 => ("is a pyramid".into(), simplices),
        22..=25 | 27 | 28 | 30 | 31 | 33 | 37 | 38 | 40..=66 | 71..=75 => (
            "is of order 4 or higher, and those up to order 3 are read".into(),
            "mesh with `Mesh.ElementOrder = 1`",
        ),
        other => (
            format!("has type {other}, which is not read"),
            "mesh with simplices of order 1, by `Mesh.ElementOrder = 1`",
        ),
    };
    Err(Fault::Kind { element: head.tag, is, remedy })
}
