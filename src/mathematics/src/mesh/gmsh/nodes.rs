//! The section `$Nodes`.

use super::error::{Fault, GmshError};
use super::scanner::{Scanner, Version};
use std::collections::HashMap;

/// Nodes in the order of the file.
#[derive(Default)]
pub(super) struct FileNodes {
    /// Number of each node.
    pub(super) tags: Vec<u64>,
    /// Coordinates of each node.
    pub(super) points: Vec<[f64; 3]>,
    positions: Positions,
}

/// Position of each number of a node.
#[derive(Default)]
struct Positions {
    /// Position of each number that is not much larger than the number of nodes before it, or [`NOWHERE`].
    near: Vec<u32>,
    /// Position of each other number.
    far: HashMap<u64, u32>,
}

/// Position of a number that no node has.
const NOWHERE: u32 = u32::MAX;
/// Largest multiple of the number of nodes up to which numbers have a place of their own.
const NEAR: u64 = 8;

impl Positions {
    fn get(&self, tag: u64) -> Option<u32> {
        let near = self.near.get(usize::try_from(tag).unwrap_or(usize::MAX));
        let near = near.copied().filter(|&position| position != NOWHERE);
        near.or_else(|| self.far.get(&tag).copied())
    }

    /// Adds a number; false if it is there.
    fn insert(&mut self, tag: u64, position: u32) -> bool {
        if self.get(tag).is_some() {
            return false;
        }
        if tag > NEAR * (u64::from(position) + 1000) {
            self.far.insert(tag, position);
            return true;
        }
        let place = tag as usize;
        if place >= self.near.len() {
            self.near.resize(place + 1, NOWHERE);
        }
        self.near[place] = position;
        true
    }
}

impl FileNodes {
    /// Adds the nodes of a section `$Nodes`.
    pub(super) fn read(&mut self, scanner: &mut Scanner<'_>) -> Result<(), GmshError> {
        match scanner.version {
            Version::Two => self.read_list(scanner),
            Version::FourZero | Version::FourOne => self.read_blocks(scanner),
        }
    }

    /// Position of the node of this number.
    pub(super) fn position(&self, tag: u64) -> Option<u32> {
        self.positions.get(tag)
    }

    /// Nodes of version 2.
    fn read_list(&mut self, scanner: &mut Scanner<'_>) -> Result<(), GmshError> {
        let said: u64 = scanner.number("a whole number from 0 on")?;
        scanner.begin_bytes()?;
        for _ in 0..said {
            self.add_tag(scanner)?;
            self.add_point(scanner)?;
        }
        Ok(())
    }

    /// Nodes of version 4. The blocks say how many there are: some files have more in their heads.
    fn read_blocks(&mut self, scanner: &mut Scanner<'_>) -> Result<(), GmshError> {
        let blocks = blocks(scanner)?;
        for _ in 0..blocks {
            let (dimension, _entity) = entity(scanner)?;
            // Nodes with parameters have one on a curve, two on a surface, three in a volume.
            let parameters = if scanner.whole()? == 0 { 0 } else { dimension.clamp(0, 3) };
            let count = scanner.count()?;
            // Version 4.1 has the numbers of a block before its points.
            let tags_first = scanner.version == Version::FourOne;
            if tags_first {
                for _ in 0..count {
                    self.add_tag(scanner)?;
                }
            }
            for _ in 0..count {
                if !tags_first {
                    self.add_tag(scanner)?;
                }
                self.add_point(scanner)?;
                for _ in 0..parameters {
                    scanner.real()?;
                }
            }
        }
        Ok(())
    }

    fn add_tag(&mut self, scanner: &mut Scanner<'_>) -> Result<(), GmshError> {
        let tag = scanner.tag()?;
        let Ok(position) = u32::try_from(self.tags.len()) else {
            return Err(scanner.fault(Fault::Nodes));
        };
        if !self.positions.insert(tag, position) {
            return Err(scanner.fault(Fault::NodeTwice(tag)));
        }
        self.tags.push(tag);
        Ok(())
    }

    fn add_point(&mut self, scanner: &mut Scanner<'_>) -> Result<(), GmshError> {
        self.points.push([scanner.real()?, scanner.real()?, scanner.real()?]);
        Ok(())
    }
}

/// Reads the head of a section with blocks: the number of blocks, then that of nodes or elements and, in version 4.1,
/// the least and the largest number. Returns the number of blocks.
pub(super) fn blocks(scanner: &mut Scanner<'_>) -> Result<u64, GmshError> {
    scanner.begin_bytes()?;
    let blocks = scanner.count()?;
    let others = if scanner.version == Version::FourOne { 3 } else { 1 };
    for _ in 0..others {
        scanner.count()?;
    }
    Ok(blocks)
}

/// Reads the dimension and the number of the entity of a block, which version 4.0 has the other way round.
pub(super) fn entity(scanner: &mut Scanner<'_>) -> Result<(i64, i64), GmshError> {
    let (one, two) = (scanner.whole()?, scanner.whole()?);
    Ok(if scanner.version == Version::FourOne { (one, two) } else { (two, one) })
}
