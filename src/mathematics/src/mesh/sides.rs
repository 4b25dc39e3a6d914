//! Sides of the cells of a triangulation, each numbered once, with the cells that share them.

use super::{Edges, Mesh, sides_of, sorted};

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
        let places = places_in_order(mesh);
        let (pairs, rest) = places.as_chunks::<2>();
        assert!(rest.is_empty(), "each side is found twice");
        let cells = mesh.cells().len() as u32;
        let mut sides = Self {
            of_cell: vec![[0; V]; cells as usize],
            both_cells: Vec::with_capacity(pairs.len()),
            of_facet: vec![BoundarySide::default(); mesh.facets().len()],
            edges: (D > 2).then(|| Edges::new(mesh.points().len(), mesh.cells())),
        };
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

    /// Number of the edge between two vertices of a cell with these nodes.
    #[inline(always)]
    pub(crate) fn edge(&self, cell: u32, nodes: &[u32; V], [i, j]: [usize; 2]) -> usize {
        match &self.edges {
            // The side lies opposite to the third vertex.
            None => self.numbers(cell)[3 - i - j] as usize,
            Some(edges) => edges.between(nodes[i], nodes[j]),
        }
    }

    /// Position of a side among the sides of a cell.
    pub(crate) fn slot(&self, cell: u32, side: u32) -> usize {
        let sides = &self.of_cell[cell as usize];
        sides.iter().position(|&other| other == side).expect("the side is one of the cell")
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
    let mut starts = vec![0u32; nodes + 1];
    for_each_first(mesh, |_, first| starts[first as usize + 1] += 1);
    for node in 0..nodes {
        starts[node + 1] += starts[node];
    }
    let mut places = vec![0; V * mesh.cells().len() + mesh.facets().len()];
    // The start of each node moves to its end, which is the start of the next one.
    for_each_first(mesh, |place, first| {
        let next = &mut starts[first as usize];
        places[*next as usize] = place;
        *next += 1;
    });
    let (mut from, mut keys) = (0, Vec::new());
    for &to in &starts[..nodes] {
        let group = &mut places[from as usize..to as usize];
        keys.clear();
        for &place in &*group {
            let others = side_at(mesh, place);
            let [second, third] = [others[1], if D == 3 { others[D - 1] } else { 0 }];
            // Second and third node and place in one number, which is compared faster than three.
            keys.push((u128::from(second) << 64) | (u128::from(third) << 32) | u128::from(place));
        }
        keys.sort_unstable();
        group.iter_mut().zip(&keys).for_each(|(place, key)| *place = *key as u32);
        from = to;
    }
    places
}

/// Calls a function with the place of each side and its lowest node.
fn for_each_first<const D: usize, const V: usize>(
    mesh: &Mesh<D, V>,
    mut visit: impl FnMut(u32, u32),
) {
    let mut place = 0;
    for cell in mesh.cells() {
        for vertex in 0..V {
            let others = (0..V).filter(|k| *k != vertex).map(|k| cell[k]);
            visit(place, others.fold(u32::MAX, u32::min));
            place += 1;
        }
    }
    for facet in mesh.facets() {
        visit(place, facet.nodes.into_iter().fold(u32::MAX, u32::min));
        place += 1;
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
