//! Sides of the cells of a triangulation, each numbered once, and the cells around its nodes.

use crate::mesh::{Mesh, sides_of, sorted};

/// Sides of all cells: edges in the plane, triangles in space.
pub(super) struct Sides<const V: usize> {
    /// Numbers of the sides of each cell: opposite to the first vertex, to the second, and so on.
    of_cell: Vec<[u32; V]>,
    /// Numbers of the two cells of each side. At the boundary the second number is the number of cells plus the
    /// position of the facet.
    cells: Vec<[u32; 2]>,
}

/// Neighbour of a cell across a side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Neighbour {
    /// Number of another cell.
    Cell(u32),
    /// Position of a facet of the boundary.
    Facet(u32),
}

impl<const V: usize> Sides<V> {
    /// Sides of a mesh, in the order of their nodes. Each side is found twice: in two cells, or in a cell and among the
    /// facets of the boundary.
    pub(super) fn new<const D: usize>(mesh: &Mesh<D, V>) -> Self {
        let places = places_in_order(mesh);
        let (pairs, rest) = places.as_chunks::<2>();
        assert!(rest.is_empty(), "each side is found twice");
        let cells = mesh.cells().len() as u32;
        let mut sides =
            Self { of_cell: vec![[0; V]; cells as usize], cells: Vec::with_capacity(pairs.len()) };
        for (side, pair) in pairs.iter().enumerate() {
            let owners = pair.map(|place| {
                let (cell, vertex) = (place / V as u32, place % V as u32);
                match cell < cells {
                    true => {
                        sides.of_cell[cell as usize][vertex as usize] = side as u32;
                        cell
                    }
                    false => cells + (place - V as u32 * cells),
                }
            });
            sides.cells.push(owners);
        }
        sides
    }

    /// Number of sides.
    pub(super) fn len(&self) -> usize {
        self.cells.len()
    }

    /// Numbers of the sides of a cell.
    pub(super) fn numbers(&self, cell: u32) -> [u32; V] {
        self.of_cell[cell as usize]
    }

    /// Position of a side among the sides of a cell.
    pub(super) fn slot(&self, cell: u32, side: u32) -> usize {
        let sides = &self.of_cell[cell as usize];
        sides.iter().position(|&other| other == side).expect("the side is one of the cell")
    }

    /// Neighbour of a cell across one of the cell's sides.
    pub(super) fn across(&self, cell: u32, side: u32) -> Neighbour {
        let [one, two] = self.cells[side as usize];
        let other = if one == cell { two } else { one };
        match other.checked_sub(self.of_cell.len() as u32) {
            Some(facet) => Neighbour::Facet(facet),
            None => Neighbour::Cell(other),
        }
    }

    /// True if fluxes through a side are counted out of this cell.
    pub(super) fn leaves(&self, cell: u32, side: u32) -> bool {
        self.cells[side as usize][0] == cell
    }

    /// Outflows of a cell through all its sides.
    pub(super) fn outflows(&self, cell: u32, flux: &[f64]) -> [f64; V] {
        self.numbers(cell).map(|side| match self.leaves(cell, side) {
            true => flux[side as usize],
            false => -flux[side as usize],
        })
    }

    /// Side of a facet of the boundary for each facet.
    pub(super) fn of_facets(&self, facets: usize) -> Vec<u32> {
        let mut sides = vec![0; facets];
        for (side, &[_, other]) in self.cells.iter().enumerate() {
            if let Some(facet) = other.checked_sub(self.of_cell.len() as u32) {
                sides[facet as usize] = side as u32;
            }
        }
        sides
    }

    /// Cell of a side of the boundary.
    pub(super) fn inner_cell(&self, side: u32) -> u32 {
        self.cells[side as usize][0]
    }
}

/// Nodes, in increasing order, of the side at a place: the sides of all cells come first, then the facets.
fn side_at<const D: usize, const V: usize>(mesh: &Mesh<D, V>, place: u32) -> [u32; D] {
    let (cell, vertex) = (place as usize / V, place as usize % V);
    sorted(match mesh.cells().get(cell) {
        Some(cell) => sides_of(cell)[vertex],
        None => mesh.facets()[place as usize - V * mesh.cells().len()].nodes,
    })
}

/// Places of all sides in the order of their nodes, those of equal nodes in increasing order.
fn places_in_order<const D: usize, const V: usize>(mesh: &Mesh<D, V>) -> Vec<u32> {
    // Sorted by the first node through counts, then in small groups.
    let nodes = mesh.points().len();
    let count = (V * mesh.cells().len() + mesh.facets().len()) as u32;
    let mut starts = vec![0u32; nodes + 1];
    for place in 0..count {
        starts[side_at(mesh, place)[0] as usize + 1] += 1;
    }
    for node in 0..nodes {
        starts[node + 1] += starts[node];
    }
    let mut places = vec![0; count as usize];
    // The start of each node moves to its end, which is the start of the next one.
    for place in 0..count {
        let next = &mut starts[side_at(mesh, place)[0] as usize];
        places[*next as usize] = place;
        *next += 1;
    }
    let mut from = 0;
    for &to in &starts[..nodes] {
        let group = &mut places[from as usize..to as usize];
        group.sort_unstable_by_key(|&place| (side_at(mesh, place), place));
        from = to;
    }
    places
}

/// Cells around each node.
pub(super) struct Around {
    /// Position in `cells` after the last cell of each node.
    ends: Vec<u32>,
    cells: Vec<u32>,
}

impl Around {
    /// Cells around this number of nodes.
    pub(super) fn new<const V: usize>(nodes: usize, cells: &[[u32; V]]) -> Self {
        let mut starts = vec![0u32; nodes + 1];
        for &node in cells.as_flattened() {
            starts[node as usize + 1] += 1;
        }
        for node in 0..nodes {
            starts[node + 1] += starts[node];
        }
        let mut around = vec![0; V * cells.len()];
        // The start of each node moves to its end.
        for (number, cell) in cells.iter().enumerate() {
            for &node in cell {
                let next = &mut starts[node as usize];
                around[*next as usize] = number as u32;
                *next += 1;
            }
        }
        Self { ends: starts, cells: around }
    }

    /// Cells around a node.
    pub(super) fn node(&self, node: u32) -> &[u32] {
        let from = if node == 0 { 0 } else { self.ends[node as usize - 1] };
        &self.cells[from as usize..self.ends[node as usize] as usize]
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
        let facets = sides.of_facets(6);
        for cell in 0..6 {
            let [outer, one, two] = sides.numbers(cell);
            assert_eq!(sides.across(cell, outer), Neighbour::Facet(cell));
            assert_eq!((facets[cell as usize], sides.inner_cell(outer)), (outer, cell));
            let mut cells = [one, two].map(|side| sides.across(cell, side));
            cells.sort_by_key(|neighbour| format!("{neighbour:?}"));
            let mut expected = [(cell + 1) % 6, (cell + 5) % 6];
            expected.sort_unstable();
            assert_eq!(cells, expected.map(Neighbour::Cell));
            assert_eq!(sides.slot(cell, two), 2);
        }
        assert_eq!(Around::new(7, mesh.cells()).node(0), [0, 1, 2, 3, 4, 5]);
    }
}
