//! Names of elements by the physical groups to which they belong.

use super::elements::FileElement;
use super::error::GmshError;
use super::groups::{GroupNames, GroupSets};
use crate::mesh::{Names, sorted};
use std::collections::{BTreeMap, BTreeSet, HashMap};

/// Physical groups of a file.
pub(super) struct Groups {
    pub(super) names: GroupNames,
    pub(super) sets: GroupSets,
}

/// Names of the sets of groups of one dimension.
pub(super) struct Labels {
    pub(super) names: Vec<Names>,
    /// Position of the names of each set. Sets with the same names are one.
    pub(super) positions: HashMap<u32, u16>,
}

impl Groups {
    /// Leaves out elements of a lower dimension that are on no cell, and counts them.
    ///
    /// # Errors
    /// [`GmshError::Mixed`] if one of them is in a group.
    pub(super) fn on_cells<const K: usize>(
        &self,
        mut elements: Vec<FileElement<K>>,
        has_cell: &[bool],
        [kind, cell]: [&'static str; 2],
        left_out: &mut usize,
    ) -> Result<Vec<FileElement<K>>, GmshError> {
        let mut strays = elements.iter().filter(|element| !element.is_on(has_cell));
        if let Some(named) = strays.find(|stray| !self.sets.groups(stray.groups).is_empty()) {
            return Err(GmshError::Mixed { element: named.tag, kind, cell });
        }
        let before = elements.len();
        elements.retain(|element| element.is_on(has_cell));
        *left_out += before - elements.len();
        Ok(elements)
    }

    /// Cells, each once: version 2.2 writes one of several groups once for each, one after the other.
    pub(super) fn cells_once<const V: usize>(
        &mut self,
        cells: Vec<FileElement<V>>,
    ) -> Result<Vec<FileElement<V>>, GmshError> {
        let mut once: Vec<FileElement<V>> = Vec::with_capacity(cells.len());
        for cell in cells {
            match once.last_mut().filter(|last| last.nodes == cell.nodes) {
                None => once.push(cell),
                Some(last) => {
                    let united = self.sets.union(last.groups, cell.groups);
                    if united == last.groups {
                        return Err(GmshError::Twice { one: last.tag, two: cell.tag });
                    }
                    last.groups = united;
                }
            }
        }
        Ok(once)
    }

    /// Sides that are in groups, each once, with all its groups.
    pub(super) fn sides_once<const D: usize>(
        &mut self,
        sides: &[FileElement<D>],
    ) -> Vec<FileElement<D>> {
        let mut once: Vec<FileElement<D>> = Vec::new();
        let mut positions: HashMap<[u32; D], usize> = HashMap::new();
        for side in sides {
            if self.sets.groups(side.groups).is_empty() {
                continue;
            }
            let position = *positions.entry(sorted(side.nodes)).or_insert(once.len());
            match once.get_mut(position) {
                None => once.push(FileElement { ..*side }),
                Some(first) => first.groups = self.sets.union(first.groups, side.groups),
            }
        }
        once
    }

    /// Names of all sets that elements have, in the order of their numbers, and of all groups that the file names and
    /// no element has.
    pub(super) fn labels(
        &mut self,
        dimension: i64,
        sets: impl Iterator<Item = u32>,
    ) -> Result<Labels, GmshError> {
        let used: BTreeSet<u32> = sets.collect();
        let mut by_groups: BTreeMap<&[u64], Option<u32>> = BTreeMap::new();
        by_groups.extend(used.iter().map(|&set| (self.sets.groups(set), Some(set))));
        let names: BTreeMap<u64, &str> = self.names.select(dimension).collect();
        let in_sets: BTreeSet<u64> =
            by_groups.keys().flat_map(|groups| groups.iter().copied()).collect();
        let unused: Vec<[u64; 1]> =
            names.keys().filter(|group| !in_sets.contains(group)).map(|&group| [group]).collect();
        by_groups.extend(unused.iter().map(|group| (&group[..], None)));
        if by_groups.len() > u16::MAX as usize {
            return Err(GmshError::Groups(by_groups.len()));
        }
        let mut labels = Labels { names: Vec::new(), positions: HashMap::new() };
        for (groups, set) in by_groups {
            check_names(groups, &names)?;
            let label = label(groups, &names);
            let known = labels.names.iter().position(|known| *known == label);
            let position = known.unwrap_or(labels.names.len());
            if known.is_none() {
                labels.names.push(label);
            }
            labels.positions.extend(set.map(|set| (set, position as u16)));
        }
        Ok(labels)
    }
}

/// Name of what is in no group.
const WITHOUT_GROUP: &str = "domain";

/// Checks that no name of a group is also the number of one of these groups without a name or, for none, the name of
/// what is in no group.
fn check_names(groups: &[u64], names: &BTreeMap<u64, &str>) -> Result<(), GmshError> {
    if groups.is_empty() && names.values().any(|name| *name == WITHOUT_GROUP) {
        return Err(GmshError::NameOfNone(WITHOUT_GROUP));
    }
    let without_name = groups.iter().filter(|group| !names.contains_key(group));
    for &number in without_name {
        if let Some((&named, _)) = names.iter().find(|(_, name)| **name == number.to_string()) {
            return Err(GmshError::NameIsNumber { named, number });
        }
    }
    Ok(())
}

/// Names of some groups.
fn label(groups: &[u64], names: &BTreeMap<u64, &str>) -> Names {
    let mut label = Names::default();
    for group in groups {
        match names.get(group) {
            Some(name) => label.add(name),
            None => label.add(&group.to_string()),
        }
    }
    if groups.is_empty() { WITHOUT_GROUP.into() } else { label }
}
