//! Spanning trees of the cells: one for each part of the domain whose cells are connected through sides.

use crate::mesh::{Neighbour, Sides};

/// Way of a cell without another one before it.
const ROOT: u32 = u32::MAX;

/// Spanning trees of all cells, breadth first from the cell with the lowest number of each.
pub(super) struct CellForest {
    /// Cells of one tree after the other, each after that to which its way leads.
    order: Vec<u32>,
    /// Side of each cell through which its way to the root leads.
    ways: Vec<u32>,
    /// Number of the tree of each cell.
    pub tree_of: Vec<u32>,
    /// Position in the order at which each tree begins, and the number of cells.
    starts: Vec<u32>,
}

impl CellForest {
    /// Trees of the cells with these sides.
    pub(super) fn new<const V: usize>(sides: &Sides<V>, cells: usize) -> Self {
        const NONE: u32 = u32::MAX;
        let mut found = Self {
            order: Vec::with_capacity(cells),
            ways: vec![ROOT; cells],
            tree_of: vec![NONE; cells],
            starts: Vec::new(),
        };
        for root in 0..cells as u32 {
            if found.tree_of[root as usize] != NONE {
                continue;
            }
            let tree = found.starts.len() as u32;
            let mut place = found.order.len();
            found.starts.push(place as u32);
            found.tree_of[root as usize] = tree;
            found.order.push(root);
            while let Some(&cell) = found.order.get(place) {
                for side in sides.numbers(cell) {
                    if let Neighbour::Cell(next) = sides.across(cell, side)
                        && found.tree_of[next as usize] == NONE
                    {
                        found.tree_of[next as usize] = tree;
                        found.ways[next as usize] = side;
                        found.order.push(next);
                    }
                }
                place += 1;
            }
        }
        found.starts.push(cells as u32);
        found
    }

    /// Number of trees.
    pub(super) fn trees(&self) -> usize {
        self.starts.len() - 1
    }

    /// Cells of a tree.
    pub(super) fn cells(&self, tree: usize) -> &[u32] {
        &self.order[self.starts[tree] as usize..self.starts[tree + 1] as usize]
    }

    /// Root of a tree.
    pub(super) fn root(&self, tree: usize) -> u32 {
        self.order[self.starts[tree] as usize]
    }

    /// Carries what is missing in each cell, and in those whose ways lead through it, to the roots, where the sums
    /// are in the end.
    pub(super) fn carry_to_roots<const V: usize>(
        &self,
        sides: &Sides<V>,
        flux: &mut [f64],
        missing: &mut [f64],
    ) {
        for &cell in self.order.iter().rev() {
            let through = missing[cell as usize];
            if let Some(next) = self.step(sides, flux, cell, through) {
                missing[next as usize] += through;
            }
        }
    }

    /// Carries an outflow from the root of a tree to a cell of it.
    pub(super) fn carry_from_root<const V: usize>(
        &self,
        sides: &Sides<V>,
        flux: &mut [f64],
        to: u32,
        outflow: f64,
    ) {
        let mut cell = to;
        while let Some(next) = self.step(sides, flux, cell, -outflow) {
            cell = next;
        }
    }

    /// Adds an outflow through the side of a cell that leads to the root; returns the cell there, none at the root.
    fn step<const V: usize>(
        &self,
        sides: &Sides<V>,
        flux: &mut [f64],
        cell: u32,
        outflow: f64,
    ) -> Option<u32> {
        let side = self.ways[cell as usize];
        if side == ROOT {
            return None;
        }
        flux[side as usize] += if sides.leaves(cell, side) { outflow } else { -outflow };
        match sides.across(cell, side) {
            Neighbour::Cell(next) => Some(next),
            Neighbour::Facet(_) => unreachable!("ways lead to cells"),
        }
    }
}
