//! Physical groups: their names, and the curves, surfaces and volumes in them.

use super::error::{Fault, GmshError};
use super::scanner::{Scanner, Version};
use crate::problem::text::is_forbidden;
use std::collections::{BTreeMap, BTreeSet, HashMap};

/// Letters of the longest name.
const LONGEST: usize = 127;

/// Names of physical groups, by dimension and number.
#[derive(Default)]
pub(super) struct GroupNames(BTreeMap<(i64, u64), String>);

impl GroupNames {
    /// Adds the names of a section `$PhysicalNames`, which is text in binary files too.
    pub(super) fn read(&mut self, scanner: &mut Scanner<'_>) -> Result<(), GmshError> {
        let count: u64 = scanner.number("a whole number from 0 on")?;
        for _ in 0..count {
            if scanner.words_before_quote() == Some(1) {
                scanner.word()?;
                return Err(scanner.fault(Fault::NoDimension));
            }
            let dimension: i64 = scanner.number("a dimension")?;
            let group = scanner.number::<i64>("the number of a group")?.unsigned_abs();
            let line = String::from_utf8_lossy(scanner.rest_of_line());
            let Some(name) = name_in_quotes(&line) else {
                return Err(scanner.fault(Fault::Name(group)));
            };
            self.0.insert((dimension, group), name.to_owned());
        }
        Ok(())
    }

    /// True if there are no names.
    pub(super) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Names of the groups of one dimension, in the order of their numbers.
    pub(super) fn select(&self, dimension: i64) -> impl Iterator<Item = (u64, &str)> {
        let groups = self.0.range((dimension, 1)..=(dimension, u64::MAX));
        groups.map(|(&(_, group), name)| (group, name.as_str()))
    }
}

/// Name between quotes, if one can be printed in a line.
fn name_in_quotes(line: &str) -> Option<&str> {
    let name = line.strip_prefix('"')?.strip_suffix('"')?;
    let is_short = (1..=LONGEST).contains(&name.chars().count());
    (is_short && !name.contains(is_forbidden)).then_some(name)
}

/// Sets of groups to which elements belong, each set once.
#[derive(Default)]
pub(super) struct GroupSets {
    sets: Vec<Vec<u64>>,
    positions: HashMap<Vec<u64>, u32>,
}

impl GroupSets {
    /// Position of the set of some groups; 0 stands for none.
    pub(super) fn position(&mut self, groups: &[u64]) -> u32 {
        if let Some(&position) = self.positions.get(groups) {
            return position;
        }
        let set: BTreeSet<u64> = groups.iter().copied().filter(|&group| group != 0).collect();
        let set: Vec<u64> = set.into_iter().collect();
        let new = self.sets.len() as u32;
        let position = *self.positions.entry(set.clone()).or_insert(new);
        if position == new {
            self.sets.push(set);
        }
        // Also for these groups in another order.
        self.positions.insert(groups.to_vec(), position);
        position
    }

    /// Position of the set of all groups of two sets.
    pub(super) fn union(&mut self, one: u32, two: u32) -> u32 {
        self.position(&[self.groups(one), self.groups(two)].concat())
    }

    /// Groups of a set, in increasing order.
    pub(super) fn groups(&self, position: u32) -> &[u64] {
        &self.sets[position as usize]
    }
}

/// Groups of the entities, which are points, curves, surfaces and volumes of the geometry, by dimension and number.
#[derive(Default)]
pub(super) struct Entities(HashMap<(i64, i64), Vec<u64>>);

impl Entities {
    /// Adds the entities of a section `$Entities`.
    pub(super) fn read(&mut self, scanner: &mut Scanner<'_>) -> Result<(), GmshError> {
        scanner.begin_bytes()?;
        let mut counts = [0; 4];
        for count in &mut counts {
            *count = scanner.count()?;
        }
        for (dimension, count) in (0..).zip(counts) {
            for _ in 0..count {
                let entity = scanner.whole()?;
                // A point, or the corners of a box, which version 4.0 has for points too.
                let is_point = dimension == 0 && scanner.version == Version::FourOne;
                let reals = if is_point { 3 } else { 6 };
                for _ in 0..reals {
                    scanner.real()?;
                }
                let mut groups = Vec::new();
                for _ in 0..scanner.count()? {
                    groups.push(scanner.whole()?.unsigned_abs());
                }
                self.0.insert((dimension, entity), groups);
                let boundary = if dimension == 0 { 0 } else { scanner.count()? };
                for _ in 0..boundary {
                    scanner.whole()?;
                }
            }
        }
        Ok(())
    }

    /// True if there are no entities.
    pub(super) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Groups of an entity.
    pub(super) fn groups(&self, dimension: i64, entity: i64) -> &[u64] {
        self.0.get(&(dimension, entity)).map_or(&[], |groups| groups)
    }

    /// True if there is an entity of this dimension.
    pub(super) fn has(&self, dimension: i64) -> bool {
        self.of(dimension).next().is_some()
    }

    /// True if an entity of this dimension is in a group.
    pub(super) fn has_group(&self, dimension: i64) -> bool {
        self.of(dimension).any(|groups| !groups.is_empty())
    }

    fn of(&self, dimension: i64) -> impl Iterator<Item = &Vec<u64>> {
        self.0.iter().filter(move |(key, _)| key.0 == dimension).map(|(_, groups)| groups)
    }
}
