//! Facets of the boundary: sides that one cell alone has, with the parts to which they belong.

use super::error::MeshError;
use super::facet_boxes::FacetBoxes;
use super::{Condition, Facet, MeshData, Part};
use std::collections::HashMap;

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
}

/// Cells at a side.
struct SideCells {
    /// Position of the first cell.
    first: u32,
    /// True if the first cell has the side in the even order of its nodes.
    is_even: bool,
    count: u8,
}

impl<const D: usize, const V: usize> MeshData<D, V> {
    /// Boundary of the cells, which are numbered in the positive sense. Named facets inside the domain are left out,
    /// and so are parts that have no others.
    ///
    /// # Errors
    /// Cells that overlap at a facet, and parts that name no facet or one facet twice.
    pub(super) fn boundary(&mut self) -> Result<BoundaryFacets<D>, MeshError> {
        let sides = self.cells_of_sides()?;
        let parts = self.parts_of_facets(&sides)?;
        let (mut facets, mut owners) = (Vec::new(), Vec::new());
        for (k, cell) in self.cells.iter().enumerate() {
            for nodes in sides_of(cell) {
                let key = sorted(nodes);
                if sides[&key].count == 1 {
                    let part = parts.get(&key).copied();
                    let part = part.unwrap_or_else(|| default_part(&mut self.parts));
                    facets.push(Facet { nodes, part });
                    owners.push(k as u32);
                }
            }
        }
        let corners = facets.iter().map(|facet| facet.nodes.map(|node| self.points[node as usize]));
        let boxes = FacetBoxes::new(corners);
        let inside = self.keep_parts_of(&mut facets)?;
        Ok(BoundaryFacets { facets, cells: owners, boxes, inside })
    }

    /// Cells at each side, by its nodes in increasing order.
    fn cells_of_sides(&self) -> Result<HashMap<[u32; D], SideCells>, MeshError> {
        let mut sides: HashMap<[u32; D], SideCells> = HashMap::with_capacity(2 * self.cells.len());
        for (k, cell) in self.cells.iter().enumerate() {
            for (without, nodes) in sides_of(cell).into_iter().enumerate() {
                // A cyclic order of four vertices is even for every other first vertex, of three vertices for all.
                let is_even = is_even(nodes) == (V == 3 || without.is_multiple_of(2));
                let key = sorted(nodes);
                let new = SideCells { first: k as u32, is_even, count: 0 };
                let side = sides.entry(key).or_insert(new);
                side.count += 1;
                if side.count > 2 {
                    let (cell, nodes) = (self.tags.cell(k), self.tags.all(key));
                    return Err(MeshError::Overlap { cell, nodes });
                }
                if side.count == 2 && side.is_even == is_even {
                    let cells = [side.first as usize, k].map(|cell| self.tags.cell(cell));
                    return Err(MeshError::Fold { cells, nodes: self.tags.all(key) });
                }
            }
        }
        Ok(sides)
    }

    /// Part of each named facet, by its nodes in increasing order.
    fn parts_of_facets(
        &self,
        sides: &HashMap<[u32; D], SideCells>,
    ) -> Result<HashMap<[u32; D], u16>, MeshError> {
        let mut parts: HashMap<[u32; D], u16> = HashMap::new();
        for facet in &self.facets {
            let name = |part: u16| self.parts[part as usize].names.to_string();
            let key = sorted(facet.nodes);
            if !sides.contains_key(&key) {
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
}

/// Position of the part `boundary`, which is added if there is none.
fn default_part<const D: usize>(parts: &mut Vec<Part<D>>) -> u16 {
    const NAME: &str = "boundary";
    let position = parts.iter().rposition(|part| part.names == NAME.into()).unwrap_or_else(|| {
        parts.push(Part { names: NAME.into(), condition: Condition::default(), curve: None });
        parts.len() - 1
    });
    position as u16
}

/// Returns the facets of a cell: the vertices without the first, without the second, and so on; those of a triangle in
/// the sense of the triangle.
pub(crate) fn sides_of<const D: usize, const V: usize>(cell: &[u32; V]) -> [[u32; D]; V] {
    std::array::from_fn(|without| std::array::from_fn(|k| cell[(without + 1 + k) % V]))
}

/// Returns numbers in increasing order.
pub(crate) fn sorted<const K: usize>(mut numbers: [u32; K]) -> [u32; K] {
    numbers.sort_unstable();
    numbers
}

/// True if an even number of pairs of numbers stand in decreasing order.
fn is_even<const K: usize>(numbers: [u32; K]) -> bool {
    let pairs = (0..K).flat_map(|k| (0..k).map(move |i| [i, k]));
    pairs.filter(|&[i, k]| numbers[i] > numbers[k]).count().is_multiple_of(2)
}
