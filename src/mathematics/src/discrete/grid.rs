//! Uniform P1 grids of the square (-1/2, 1/2)^2 and the order of their nodes.

use crate::problem::law::{ContactNode, Law};

/// Cells per side of the coarsest grid that has an interior node.
pub const MIN_CELLS: usize = 2;

/// The uniform right-triangle grid with `n` cells of width `h = 1/n` along each side.
///
/// Nodes are numbered row by row, `x` fastest, from the lower left corner; a *nodal vector* has
/// `(n + 1)^2` entries in that order. Boundary nodes are numbered counter-clockwise from the lower
/// left corner; a *boundary vector* has `4 n` entries in that order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Grid {
    n: usize,
}

impl Grid {
    /// Creates the grid with `n` cells per side.
    ///
    /// # Errors
    /// A sentence if `n` is below [`MIN_CELLS`].
    pub fn new(n: usize) -> Result<Self, String> {
        if n < MIN_CELLS {
            return Err(format!(
                "a grid needs at least {MIN_CELLS} cells per side, not {n}; use h = 1/{MIN_CELLS} or finer"
            ));
        }
        Ok(Self { n })
    }

    /// Cells per side.
    pub fn cells(self) -> usize {
        self.n
    }

    /// Nodes per side, `n + 1`: the stride between rows of a nodal vector.
    pub fn side(self) -> usize {
        self.n + 1
    }

    /// Length of a nodal vector.
    pub fn nodes(self) -> usize {
        self.side() * self.side()
    }

    /// Length of the boundary.
    pub const PERIMETER: f64 = 4.0;

    /// Length of a boundary vector.
    pub fn boundary_nodes(self) -> usize {
        4 * self.n
    }

    /// Mesh width.
    pub fn h(self) -> f64 {
        1.0 / self.n as f64
    }

    /// Coordinate of the `i`-th grid line, in [-1/2, 1/2].
    pub fn coordinate(self, i: usize) -> f64 {
        // The quotient is rounded once, so that lines shared by nested grids coincide to the bit.
        i as f64 / self.n as f64 - 0.5
    }

    /// Position in a nodal vector of the node in column `i` and row `j`.
    pub fn index(self, i: usize, j: usize) -> usize {
        j * self.side() + i
    }

    /// Column and row of the `b`-th boundary node, counter-clockwise from the lower left corner.
    pub fn boundary_node(self, b: usize) -> (usize, usize) {
        let (n, along) = (self.n, b % self.n);
        match b / n {
            0 => (along, 0),
            1 => (n, along),
            2 => (n - along, n),
            _ => (0, n - along),
        }
    }

    /// Number of the boundary node in column `i` and row `j`: the inverse of [`Grid::boundary_node`].
    ///
    /// The result has no meaning for an interior node.
    #[inline]
    pub fn boundary_index(self, i: usize, j: usize) -> usize {
        let n = self.n;
        debug_assert!(i == 0 || i == n || j == 0 || j == n, "node ({i}, {j}) is interior");
        if j == 0 {
            i
        } else if i == n {
            n + j
        } else if j == n {
            3 * n - i
        } else {
            4 * n - j
        }
    }

    /// Positions of the boundary nodes in a nodal vector, in boundary order.
    pub fn boundary(self) -> impl Iterator<Item = usize> + Clone {
        (0..self.boundary_nodes()).map(move |b| {
            let (i, j) = self.boundary_node(b);
            self.index(i, j)
        })
    }

    /// Boundary nodes under a law, in boundary order.
    pub fn contact_nodes(self, law: Law) -> Vec<ContactNode> {
        self.boundary().map(|node| ContactNode { node, measure: self.h(), law }).collect()
    }

    /// True if boundary node `b` is a corner of the square.
    pub fn is_corner(self, b: usize) -> bool {
        b.is_multiple_of(self.n)
    }
}

/// Creates the nested grids with `cells[k]` cells per side, each the halving of the one before.
///
/// # Errors
/// A sentence if the list is empty, a grid is too coarse, or two neighbours do not nest.
pub fn nested(cells: &[usize]) -> Result<Vec<Grid>, String> {
    if cells.is_empty() {
        return Err("no grids given; give at least one, such as 1/4".into());
    }
    for pair in cells.windows(2) {
        if pair[1] != 2 * pair[0] {
            let (coarse, fine, want) = (pair[0], pair[1], 2 * pair[0]);
            return Err(format!(
                "grid 1/{fine} does not nest in 1/{coarse}: each grid must halve the one before; use 1/{want}"
            ));
        }
    }
    cells.iter().map(|&n| Grid::new(n)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boundary_runs_once_around_counter_clockwise() {
        let grid = Grid::new(4).unwrap();
        let nodes: Vec<_> = (0..16).map(|b| grid.boundary_node(b)).collect();
        assert_eq!(nodes[..5], [(0, 0), (1, 0), (2, 0), (3, 0), (4, 0)]);
        assert_eq!(nodes[5..9], [(4, 1), (4, 2), (4, 3), (4, 4)]);
        assert_eq!(nodes[9..], [(3, 4), (2, 4), (1, 4), (0, 4), (0, 3), (0, 2), (0, 1)]);
    }

    #[test]
    fn boundary_nodes_are_numbered_both_ways() {
        for n in [2, 3, 8] {
            let grid = Grid::new(n).unwrap();
            for b in 0..grid.boundary_nodes() {
                let (i, j) = grid.boundary_node(b);
                assert_eq!(grid.boundary_index(i, j), b);
            }
        }
    }

    #[test]
    fn only_halvings_nest() {
        assert!(nested(&[4, 8, 16]).is_ok());
        for (cells, said) in [
            (&[][..], "no grids given"),
            (&[1], "a grid needs at least 2 cells per side, not 1"),
            (
                &[4, 12],
                "grid 1/12 does not nest in 1/4: each grid must halve the one before; use 1/8",
            ),
        ] {
            assert!(nested(cells).unwrap_err().starts_with(said), "{cells:?}");
        }
    }
}
