//! Physical groups: their names, and the curves, surfaces and volumes in them.

use super::error::{Fault, GmshError};
use super::scanner::Scanner;
use crate::problem::text::is_forbidden;
use std::collections::{BTreeMap, HashMap};

/// Letters of the longest name.
const LONGEST: usize = 127;

/// Names of physical groups, by dimension and number.
#[derive(Default)]
pub(super) struct GroupNames(BTreeMap<(i64, u64), String>);

impl GroupNames {
    /// Reads the section `$PhysicalNames`, which is text in binary files too.
    pub(super) fn read(scanner: &mut Scanner<'_>) -> Result<Self, GmshError> {
        let mut names = BTreeMap::new();
        let count: u64 = scanner.number("a whole number from 0 on")?;
        for _ in 0..count {
            let dimension: i64 = scanner.number("a dimension")?;
            let group = scanner.number::<i64>("the number of a group")?.unsigned_abs();
            let line = String::from_utf8_lossy(scanner.rest_of_line());
            let Some(name) = name_in_quotes(&line) else {
                return Err(scanner.fault(Fault::Name(group)));
            };
            names.insert((dimension, group), name.to_owned());
        }
        Ok(Self(names))
    }

    /// Names of the groups of one dimension, in the order of their numbers.
    pub(super) fn of(&self, dimension: i64) -> impl Iterator<Item = (u64, &str)> {
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

/// Groups of one entity: a curve, surface or volume of the geometry.
struct Membership {
    first: u64,
    count: u64,
}

/// Entities that are in physical groups, by dimension and number.
#[derive(Default)]
pub(super) struct Entities(HashMap<(i64, i64), Membership>);

impl Entities {
    /// Reads the section `$Entities` of version 4.1.
    pub(super) fn read(scanner: &mut Scanner<'_>) -> Result<Self, GmshError> {
        let mut entities = HashMap::new();
        let mut counts = [0; 4];
        for count in &mut counts {
            *count = scanner.count()?;
        }
        for (dimension, count) in (0..).zip(counts) {
            for _ in 0..count {
                let entity = scanner.whole()?;
                // A point, or the corners of a box.
                let reals = if dimension == 0 { 3 } else { 6 };
                for _ in 0..reals {
                    scanner.real()?;
                }
                let mut membership = Membership { first: 0, count: scanner.count()? };
                for k in 0..membership.count {
                    let group = scanner.whole()?.unsigned_abs();
                    if k == 0 {
                        membership.first = group;
                    }
                }
                if membership.count > 0 {
                    entities.insert((dimension, entity), membership);
                }
                let boundary = if dimension == 0 { 0 } else { scanner.count()? };
                for _ in 0..boundary {
                    scanner.whole()?;
                }
            }
        }
        Ok(Self(entities))
    }

    /// Group of an entity, 0 if there is none.
    pub(super) fn group(&self, dimension: i64, entity: i64) -> Result<u64, Fault> {
        match self.0.get(&(dimension, entity)) {
            None => Ok(0),
            // The group of a point means nothing.
            Some(Membership { first, count }) if *count == 1 || dimension == 0 => Ok(*first),
            Some(Membership { count, .. }) => {
                let kind = match dimension {
                    1 => "curve",
                    2 => "surface",
                    _ => "volume",
                };
                Err(Fault::Entity { kind, entity, groups: *count })
            }
        }
    }
}
