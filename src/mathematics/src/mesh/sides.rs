//! Sides of the cells of a triangulation, each numbered once, with the cells that share them.

use super::{Edges, Mesh, sorted};

/// Sides of all cells: edges in the plane, triangles in space.
pub(crate) struct Sides<const V: usize> {
    /// Numbers of the sides of each cell: opposite to the first vertex, to the second, and so on.
    pub(super) of_cell: Vec<[u32; V]>,
    /// Exclusive or of the numbers of the two cells of each side, from which each cell finds the other. At the boundary
    /// the second number is the number of cells plus the position of the facet.
    pub(super) both_cells: Vec<u32>,
    /// Side of each facet of the boundary.
    pub(super) of_facet: Vec<BoundarySide>,
    /// Edges of all cells; none in the plane, where the sides are the edges.
    pub(super) edges: Option<Edges>,
}

/// Side of the boundary.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct BoundarySide {
    /// Number of the side.
    pub side: u32,
    /// Number of its cell.
    pub cell: u32,
}

/// Neighbour of a cell across a side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Neighbour {
    /// Number of another cell.
    Cell(u32),
    /// Position of a facet of the boundary.
    Facet(u32),
}

impl<const V: usize> Sides<V> {
    /// Sides of a mesh, in the order of their nodes. Each side is found twice: in two cells, or in a cell and among the
    /// facets of the boundary.
    pub(crate) fn new<const D: usize>(mesh: &Mesh<D, V>) -> Self {
        let edges = (D > 2).then(|| Edges::new(mesh.points().len(), mesh.cells()));
        let keys = keys_in_order(mesh, edges.as_ref());
        let (pairs, rest) = keys.as_chunks::<2>();
        assert!(rest.is_empty(), "each side is found twice");
        let cells = mesh.cells().len() as u32;
        let mut sides = Self {
            of_cell: vec![[0; V]; cells as usize],
            both_cells: Vec::with_capacity(pairs.len()),
            of_facet: vec![BoundarySide::default(); mesh.facets().len()],
            edges,
        };
        for (side, pair) in pairs.iter().enumerate() {
            let owners = pair.map(|key| {
                let place = key as u32;
                let (cell, vertex) = (place / V as u32, place % V as u32);
                match cell < cells {
                    true => {
                        sides.of_cell[cell as usize][vertex as usize] = side as u32;
                        cell
                    }
                    false => cells + (place - V as u32 * cells),
                }
            });
            let [one, two] = owners;
            if let Some(facet) = two.checked_sub(cells) {
                sides.of_facet[facet as usize] = BoundarySide { side: side as u32, cell: one };
            }
            sides.both_cells.push(one ^ two);
        }
        sides
    }

    /// Number of sides.
    pub(crate) fn len(&self) -> usize {
        self.both_cells.len()
    }

    /// Numbers of the sides of a cell.
    pub(crate) fn numbers(&self, cell: u32) -> [u32; V] {
        self.of_cell[cell as usize]
    }

    /// Number of edges.
    pub(crate) fn edges(&self) -> usize {
        self.edges.as_ref().map_or(self.len(), Edges::len)
    }

    /// Number of the edge between two vertices of a cell, the later one second.
    #[inline(always)]
    pub(crate) fn edge(&self, cell: u32, [i, j]: [usize; 2]) -> usize {
        match &self.edges {
            // The side lies opposite to the third vertex.
            None => self.numbers(cell)[3 - i - j] as usize,
            Some(edges) => edges.of_cell::<V>(cell as usize, [i, j]),
        }
    }

    /// Position of a side among the sides of a cell.
    #[inline(always)]
    pub(crate) fn slot(&self, cell: u32, side: u32) -> usize {
        position(&self.of_cell[cell as usize], side)
    }

    /// Neighbour of a cell across one of the cell's sides.
    pub(crate) fn across(&self, cell: u32, side: u32) -> Neighbour {
        let other = self.other(cell, side);
        match other.checked_sub(self.of_cell.len() as u32) {
            Some(facet) => Neighbour::Facet(facet),
            None => Neighbour::Cell(other),
        }
    }

    /// Number of the other cell of a side, or of cells plus the position of the facet.
    fn other(&self, cell: u32, side: u32) -> u32 {
        self.both_cells[side as usize] ^ cell
    }

    /// True if fluxes through a side are counted out of this cell: out of that with the lower number.
    pub(crate) fn leaves(&self, cell: u32, side: u32) -> bool {
        cell < self.other(cell, side)
    }

    /// Outflows of a cell through all its sides.
    #[inline(always)]
    pub(crate) fn outflows(&self, cell: u32, flux: &[f64]) -> [f64; V] {
        let mut outflows = [0.0; V];
        for (outflow, side) in outflows.iter_mut().zip(self.numbers(cell)) {
            let flux = flux[side as usize];
            *outflow = if self.leaves(cell, side) { flux } else { -flux };
        }
        outflows
    }

    /// Sides of the facets of the boundary, in the order of the facets.
    pub(crate) fn of_facets(&self) -> &[BoundarySide] {
        &self.of_facet
    }
}

/// Position in an array of a number that it has: a search would end where no processor can guess.
#[inline(always)]
pub(crate) fn position<const V: usize>(numbers: &[u32; V], number: u32) -> usize {
    debug_assert!(numbers.contains(&number));
    let mut position = 0;
    for (k, other) in numbers.iter().enumerate() {
        position += k * usize::from(*other == number);
    }
    position
}

/// Keys of all sides in the order of their nodes: the last node and the place, where the sides of all cells come first,
/// then the facets. The edges are those in space.
fn keys_in_order<const D: usize, const V: usize>(
    mesh: &Mesh<D, V>,
    edges: Option<&Edges>,
) -> Vec<u64> {
    // Sorted by all nodes but the last, a node or an edge, through counts, then in small groups.
    let count = edges.map_or(mesh.points().len(), Edges::len);
    let mut starts = vec![0u32; count + 1];
    for_each_side(mesh, edges, |group, _| starts[group + 1] += 1);
    for group in 0..count {
        starts[group + 1] += starts[group];
    }
    let mut keys = vec![0; V * mesh.cells().len() + mesh.facets().len()];
    // The start of each group moves to its end, which is the start of the next one.
    for_each_side(mesh, edges, |group, key| {
        let next = &mut starts[group];
        keys[*next as usize] = key;
        *next += 1;
    });
    let mut from = 0;
    for &to in &starts[..count] {
        keys[from as usize..to as usize].sort_unstable();
        from = to;
    }
    keys
}

/// Calls a function with the node or edge and the key of each side.
#[inline(always)]
fn for_each_side<const D: usize, const V: usize>(
    mesh: &Mesh<D, V>,
    edges: Option<&Edges>,
    mut visit: impl FnMut(usize, u64),
) {
    for (number, cell) in mesh.cells().iter().enumerate() {
        let nodes = sorted(*cell);
        for rank in 0..V {
            // Without one of them the nodes are still in order.
            let [first, second, last] = [0, 1, D - 1].map(|k| nodes[k + usize::from(k >= rank)]);
            let group = edges.map_or(first as usize, |edges| {
                let [i, j] = [first, second].map(|node| position(cell, node));
                edges.of_cell::<V>(number, [i.min(j), i.max(j)])
            });
            let place = V * number + position(cell, nodes[rank]);
            visit(group, (u64::from(last) << 32) | place as u64);
        }
    }
    for (place, facet) in (V * mesh.cells().len()..).zip(mesh.facets()) {
        let nodes = sorted(facet.nodes);
        let group = edges.map_or(nodes[0] as usize, |edges| edges.between(nodes[0], nodes[1]));
        visit(group, (u64::from(nodes[D - 1]) << 32) | place as u64);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::BuiltIn;

    #[test]
    fn sides_have_two_cells_or_a_cell_and_a_facet() {
        let mesh = BuiltIn::Disc.plane().unwrap();
        let sides = Sides::new(&mesh);
        assert_eq!(sides.len(), 12);
        assert_eq!(sides.of_facets().len(), 6);
        for cell in 0..6 {
            let [outer, one, two] = sides.numbers(cell);
            assert_eq!(sides.across(cell, outer), Neighbour::Facet(cell));
            assert_eq!(sides.of_facets()[cell as usize], BoundarySide { side: outer, cell });
            let mut cells = [one, two].map(|side| sides.across(cell, side));
            cells.sort_by_key(|neighbour| format!("{neighbour:?}"));
            let mut expected = [(cell + 1) % 6, (cell + 5) % 6];
            expected.sort_unstable();
            assert_eq!(cells, expected.map(Neighbour::Cell));
            assert_eq!(sides.slot(cell, two), 2);
        }
    }
}
