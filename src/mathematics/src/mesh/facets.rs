//! Facets of the boundary: sides that one cell alone has, with the parts to which they belong.

use super::error::MeshError;
use super::facet_boxes::FacetBoxes;
use super::{Facet, MeshData, Part};
use crate::problem::law::Law;
use std::collections::BTreeMap;

/// Facets of the boundary, with what tells how they lie to each other.
pub(super) struct BoundaryFacets<const D: usize> {
    /// Facets in the order of the cells.
    pub(super) facets: Vec<Facet<D>>,
    /// Position of the cell of each facet.
    pub(super) cells: Vec<u32>,
    /// Boxes of the facets.
    pub(super) boxes: FacetBoxes<D>,
    /// Names of parts that lie inside the domain.
    pub(super) inside: Vec<String>,
    /// Sides of all cells.
    pub(super) sides: CellSides<D>,
}

/// Side of a cell.
#[derive(Clone, Copy)]
pub(super) struct CellSide<const D: usize> {
    /// Nodes in increasing order.
    pub(super) nodes: [u32; D],
    /// Position of the cell.
    pub(super) cell: u32,
    /// Position of the vertex that the side is without.
    without: u8,
    /// True if the cell has the side in the even order of its nodes.
    is_even: bool,
}

/// Sides of all cells, by their nodes in increasing order; the same sides of several cells in the order of the cells.
pub(super) struct CellSides<const D: usize> {
    /// Position of the first side whose lowest node is this one, and the number of all.
    starts: Vec<u32>,
    sides: Vec<CellSide<D>>,
}

impl<const D: usize> CellSides<D> {
    fn new<const V: usize>(nodes: usize, cells: &[[u32; V]]) -> Self {
        let mut starts = vec![0u32; nodes + 1];
        for_each_side(cells, |side: CellSide<D>| starts[side.nodes[0] as usize + 1] += 1);
        for node in 0..nodes {
            starts[node + 1] += starts[node];
        }
        let mut next = starts.clone();
        let empty = CellSide { nodes: [0; D], cell: 0, without: 0, is_even: false };
        let mut sides = vec![empty; starts[nodes] as usize];
        for_each_side(cells, |side: CellSide<D>| {
            let place = &mut next[side.nodes[0] as usize];
            sides[*place as usize] = side;
            *place += 1;
        });
        for node in 0..nodes {
            sides[starts[node] as usize..starts[node + 1] as usize].sort_by_key(|side| side.nodes);
        }
        Self { starts, sides }
    }

    /// True if a cell has the side with these nodes in increasing order.
    fn has(&self, nodes: [u32; D]) -> bool {
        let [from, to] = [0, 1].map(|k| self.starts[nodes[0] as usize + k] as usize);
        self.sides[from..to].iter().any(|side| side.nodes == nodes)
    }

    /// Cells at each side.
    pub(super) fn groups(&self) -> impl Iterator<Item = &[CellSide<D>]> {
        self.sides.chunk_by(|one, two| one.nodes == two.nodes)
    }
}

/// First of the cells at a side, in their order, that cannot be there: a second one on the same side of it as the
/// first, or a third one.
fn fault_at<const D: usize>(group: &[CellSide<D>]) -> Option<CellSide<D>> {
    match group {
        [one, two, ..] if one.is_even == two.is_even => Some(*two),
        [_, _, three, ..] => Some(*three),
        _ => None,
    }
}

/// Calls `visit` with all sides of all cells.
fn for_each_side<const D: usize, const V: usize>(
    cells: &[[u32; V]],
    mut visit: impl FnMut(CellSide<D>),
) {
    for (k, cell) in cells.iter().enumerate() {
        for (without, nodes) in sides_of(cell).into_iter().enumerate() {
            // A cyclic order of four vertices is even for every other first vertex, of three vertices for all.
            let is_even = is_even(nodes) == (V == 3 || without.is_multiple_of(2));
            let (nodes, cell, without) = (sorted(nodes), k as u32, without as u8);
            visit(CellSide { nodes, cell, without, is_even });
        }
    }
}

impl<const D: usize, const V: usize> MeshData<D, V> {
    /// Boundary of the cells, which are numbered in the positive sense. Named facets inside the domain are left out,
    /// and so are parts that have no others.
    ///
    /// # Errors
    /// Cells that overlap at a facet, and parts that name no facet or one facet twice.
    pub(super) fn boundary(&mut self) -> Result<BoundaryFacets<D>, MeshError> {
        let sides = CellSides::new(self.points.len(), &self.cells);
        self.check_sides(&sides)?;
        let parts = self.parts_of_facets(&sides)?;
        let single = sides.groups().filter_map(|group| match group {
            [side] => Some(*side),
            _ => None,
        });
        let mut single: Vec<CellSide<D>> = single.collect();
        single.sort_by_key(|side| (side.cell, side.without));
        let (mut facets, mut owners) = (Vec::new(), Vec::new());
        let mut default = None;
        for CellSide { nodes: key, cell, without, .. } in single {
            let part = match (parts.get(&key), default) {
                (Some(&part), _) | (None, Some(part)) => part,
                (None, None) => *default.insert(self.add_default_part()?),
            };
            let nodes = sides_of(&self.cells[cell as usize])[usize::from(without)];
            facets.push(Facet { nodes, part });
            owners.push(cell);
        }
        let corners = facets.iter().map(|facet| facet.nodes.map(|node| self.points[node as usize]));
        let boxes = FacetBoxes::new(corners);
        let inside = self.keep_parts_of(&mut facets)?;
        Ok(BoundaryFacets { facets, cells: owners, boxes, inside, sides })
    }

    /// Checks that no side has three cells, nor two on the same side of it; of the faults, that of the first cell.
    fn check_sides(&self, sides: &CellSides<D>) -> Result<(), MeshError> {
        let faults = sides.groups().filter_map(|group| Some((group, fault_at(group)?)));
        let Some((group, fault)) = faults.min_by_key(|(_, fault)| (fault.cell, fault.without))
        else {
            return Ok(());
        };
        let nodes = self.tags.all(fault.nodes);
        let tag = |side: CellSide<D>| self.tags.cell(side.cell as usize);
        match group[1].cell == fault.cell {
            true => Err(MeshError::Fold { cells: [group[0], fault].map(tag), nodes }),
            false => Err(MeshError::Overlap { cell: tag(fault), nodes }),
        }
    }

    /// Part of each named facet, by its nodes in increasing order.
    fn parts_of_facets(&self, sides: &CellSides<D>) -> Result<BTreeMap<[u32; D], u16>, MeshError> {
        let mut parts: BTreeMap<[u32; D], u16> = BTreeMap::new();
        for facet in &self.facets {
            let name = |part: u16| self.parts[part as usize].names.to_string();
            let key = sorted(facet.nodes);
            if !sides.has(key) {
                let nodes = self.tags.all(facet.nodes);
                return Err(MeshError::NoSide { part: name(facet.part), nodes });
            }
            if let Some(other) = parts.insert(key, facet.part).filter(|part| *part != facet.part) {
                let nodes = self.tags.all(facet.nodes);
                return Err(MeshError::TwoParts { one: name(other), two: name(facet.part), nodes });
            }
        }
        Ok(parts)
    }

    /// Leaves out the parts without a facet of the boundary; returns the names of facets inside the domain alone.
    fn keep_parts_of(&mut self, facets: &mut [Facet<D>]) -> Result<Vec<String>, MeshError> {
        let (mut is_named, mut is_kept) =
            (vec![false; self.parts.len()], vec![false; self.parts.len()]);
        self.facets.iter().for_each(|facet| is_named[facet.part as usize] = true);
        facets.iter().for_each(|facet| is_kept[facet.part as usize] = true);
        let mut numbers = Vec::with_capacity(self.parts.len());
        let (mut kept, mut inside): (Vec<Part<D>>, Vec<Part<D>>) = (Vec::new(), Vec::new());
        for (k, part) in std::mem::take(&mut self.parts).into_iter().enumerate() {
            numbers.push(kept.len() as u16);
            match (is_kept[k], is_named[k]) {
                (true, _) => kept.push(part),
                (false, true) => inside.push(part),
                (false, false) => return Err(MeshError::EmptyName(part.names.to_string())),
            }
        }
        facets.iter_mut().for_each(|facet| facet.part = numbers[facet.part as usize]);
        self.parts = kept;
        let mut names: Vec<String> = Vec::new();
        for name in inside.iter().flat_map(|part| part.names.iter()) {
            if !names.contains(name) && !self.parts.iter().any(|part| part.names.contains(name)) {
                names.push(name.clone());
            }
        }
        Ok(names)
    }

    /// Adds a part for facets without one; returns its position.
    fn add_default_part(&mut self) -> Result<u16, MeshError> {
        const NAME: &str = "boundary";
        if self.parts.iter().any(|part| part.names.contains(NAME)) {
            return Err(MeshError::NameOfDefault(NAME));
        }
        self.parts.push(Part { names: NAME.into(), law: Law::SIGNORINI, curve: None });
        Ok((self.parts.len() - 1) as u16)
    }
}

/// Returns the facets of a cell: the vertices without the first, without the second, and so on; those of a triangle in
/// the sense of the triangle.
fn sides_of<const D: usize, const V: usize>(cell: &[u32; V]) -> [[u32; D]; V] {
    std::array::from_fn(|without| std::array::from_fn(|k| cell[(without + 1 + k) % V]))
}

/// Returns numbers in increasing order.
#[inline(always)]
pub(crate) fn sorted<const K: usize>(mut numbers: [u32; K]) -> [u32; K] {
    // Few numbers are exchanged faster than sorted.
    for end in (1..K).rev() {
        for k in 0..end {
            let [a, b] = [numbers[k], numbers[k + 1]];
            [numbers[k], numbers[k + 1]] = [a.min(b), a.max(b)];
        }
    }
    numbers
}

/// True if an even number of pairs of numbers stand in decreasing order.
fn is_even<const K: usize>(numbers: [u32; K]) -> bool {
    let pairs = (0..K).flat_map(|k| (0..k).map(move |i| [i, k]));
    pairs.filter(|&[i, k]| numbers[i] > numbers[k]).count().is_multiple_of(2)
}
