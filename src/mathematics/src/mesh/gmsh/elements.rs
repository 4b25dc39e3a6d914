//! The section `$Elements`.

use super::error::{Fault, GmshError};
use super::groups::{Entities, GroupSets};
use super::nodes::{FileNodes, four_counts};
use super::scanner::{Scanner, Version};

/// Line, triangle or tetrahedron.
pub(super) struct Simplex<const K: usize> {
    /// Number of the element.
    pub(super) tag: u64,
    /// Positions of the nodes.
    pub(super) nodes: [u32; K],
    /// Position of the set of its physical groups.
    pub(super) groups: u32,
}

/// Elements by kind, in the order of the file.
#[derive(Default)]
pub(super) struct FileElements {
    pub(super) lines: Vec<Simplex<2>>,
    pub(super) triangles: Vec<Simplex<3>>,
    pub(super) tetrahedra: Vec<Simplex<4>>,
    /// Sets of physical groups.
    pub(super) sets: GroupSets,
    /// Number of points, which mean nothing.
    points: usize,
}

/// Kind of an element that is read.
#[derive(Clone, Copy)]
enum Kind {
    Point,
    Line,
    Triangle,
    Tetrahedron,
}

/// Number of an element, with its type and the position of the set of its groups.
#[derive(Clone, Copy)]
struct ElementHead {
    tag: u64,
    number_of_type: i64,
    groups: u32,
}

impl FileElements {
    /// Reads the section.
    pub(super) fn read(
        scanner: &mut Scanner<'_>,
        nodes: &FileNodes,
        entities: &Entities,
    ) -> Result<Self, GmshError> {
        let mut elements = Self::default();
        match scanner.version {
            Version::Four => elements.read_blocks(scanner, nodes, entities)?,
            Version::Two if scanner.is_text() => elements.read_list(scanner, nodes)?,
            Version::Two => elements.read_runs(scanner, nodes)?,
        }
        Ok(elements)
    }

    fn count(&self) -> u64 {
        let cells = self.triangles.len() + self.tetrahedra.len();
        (self.points + self.lines.len() + cells) as u64
    }

    /// Elements of a text of version 2.2, each with its type.
    fn read_list(&mut self, scanner: &mut Scanner<'_>, nodes: &FileNodes) -> Result<(), GmshError> {
        let said = scanner.count()?;
        for _ in 0..said {
            let (tag, number_of_type, numbers) =
                (scanner.tag()?, scanner.whole()?, scanner.whole()?);
            let groups = self.sets.position(&[first_of(scanner, numbers)?]);
            self.add(scanner, nodes, ElementHead { tag, number_of_type, groups })?;
        }
        Ok(())
    }

    /// Elements of a binary file of version 2.2: runs of one type.
    fn read_runs(&mut self, scanner: &mut Scanner<'_>, nodes: &FileNodes) -> Result<(), GmshError> {
        let said: u64 = scanner.number("a whole number from 0 on")?;
        scanner.begin_bytes()?;
        while self.count() < said {
            let (number_of_type, length, numbers) =
                (scanner.whole()?, scanner.whole()?, scanner.whole()?);
            for _ in 0..length {
                let tag = scanner.tag()?;
                let groups = self.sets.position(&[first_of(scanner, numbers)?]);
                self.add(scanner, nodes, ElementHead { tag, number_of_type, groups })?;
            }
        }
        Ok(())
    }

    /// Elements of version 4.1: blocks of one type in one entity. The blocks say how many there are, not the head.
    fn read_blocks(
        &mut self,
        scanner: &mut Scanner<'_>,
        nodes: &FileNodes,
        entities: &Entities,
    ) -> Result<(), GmshError> {
        scanner.begin_bytes()?;
        let [blocks, ..] = four_counts(scanner)?;
        for _ in 0..blocks {
            let (dimension, entity) = (scanner.whole()?, scanner.whole()?);
            let (number_of_type, count) = (scanner.whole()?, scanner.count()?);
            let groups = self.sets.position(entities.groups(dimension, entity));
            for _ in 0..count {
                let head = ElementHead { tag: scanner.tag()?, number_of_type, groups };
                let kind = self.add(scanner, nodes, head)?;
                if kind as i64 != dimension {
                    let fault = Fault::Dimension { element: head.tag, dimension };
                    return Err(scanner.fault(fault));
                }
            }
        }
        Ok(())
    }

    /// Reads the nodes of an element, and adds the element.
    fn add(
        &mut self,
        scanner: &mut Scanner<'_>,
        nodes: &FileNodes,
        head: ElementHead,
    ) -> Result<Kind, GmshError> {
        let kind = kind(head).map_err(|fault| scanner.fault(fault))?;
        match kind {
            Kind::Point => {
                scanner.tag()?;
                self.points += 1;
            }
            Kind::Line => self.lines.push(simplex(scanner, nodes, head)?),
            Kind::Triangle => self.triangles.push(simplex(scanner, nodes, head)?),
            Kind::Tetrahedron => self.tetrahedra.push(simplex(scanner, nodes, head)?),
        }
        Ok(kind)
    }
}

/// Reads so many numbers of version 2.2; returns the first, that of the group.
fn first_of(scanner: &mut Scanner<'_>, numbers: i64) -> Result<u64, GmshError> {
    let mut group = 0;
    for k in 0..numbers {
        let number = scanner.whole()?.unsigned_abs();
        if k == 0 {
            group = number;
        }
    }
    Ok(group)
}

fn simplex<const K: usize>(
    scanner: &mut Scanner<'_>,
    nodes: &FileNodes,
    head: ElementHead,
) -> Result<Simplex<K>, GmshError> {
    let mut positions = [0; K];
    for position in &mut positions {
        let node = scanner.tag()?;
        let Some(found) = nodes.position(node) else {
            return Err(scanner.fault(Fault::NoNode { element: head.tag, node }));
        };
        *position = found;
    }
    Ok(Simplex { tag: head.tag, nodes: positions, groups: head.groups })
}

/// Kind of an element, by the number of its type in the manual of Gmsh.
fn kind(head: ElementHead) -> Result<Kind, Fault> {
    let first_order = "open the mesh in Gmsh, and save it after `SetOrder 1;`";
    let (is, remedy) = match head.number_of_type {
        1 => return Ok(Kind::Line),
        2 => return Ok(Kind::Triangle),
        4 => return Ok(Kind::Tetrahedron),
        15 => return Ok(Kind::Point),
        3 => ("is a quadrangle".into(), "mesh with triangles only"),
        5 => ("is a hexahedron".into(), "mesh with tetrahedra only"),
        6 => ("is a prism".into(), "mesh with tetrahedra only"),
        7 => ("is a pyramid".into(), "mesh with tetrahedra only"),
        8..=14 | 16..=19 => ("has second order".into(), first_order),
        20 | 21 | 26 | 29 => ("has third order".into(), first_order),
        22 | 23 | 27 | 30 => ("has fourth order".into(), first_order),
        24 | 25 | 28 | 31 => ("has fifth order".into(), first_order),
        other => (format!("has type {other}, which is not read"), "mesh with simplices only"),
    };
    Err(Fault::Kind { element: head.tag, is, remedy })
}

#[cfg(test)]
mod tests {
    use crate::mesh::gmsh::tests::{SQUARE_41, after};

    #[test]
    fn broken_blocks_are_named_with_the_line() {
        for (from, to, message) in [
            (
                "2 6 1 4",
                "2 6 1 18446744073709551615",
                "$Nodes, line 22: node 0 is there twice; renumber the nodes of the mesh",
            ),
            (
                "1 5 1 1",
                "2 6 1 1",
                "$Elements, line 32: element 22 lies in an entity of dimension 2; save the mesh again",
            ),
            (
                "$Entities\n",
                "$PartitionedEntities\n",
                "$PartitionedEntities, line 9: the mesh is partitioned; save the mesh in one partition",
            ),
        ] {
            assert_eq!(after(SQUARE_41, from, to), message);
        }
    }
}
