//! Memory layout of the nodes and numbering of the boundary nodes.
//!
//! Nodes lie in rows along x. The five-point stencil of a row needs the two neighbouring rows and no others.

use super::rows::{Colour, stride};

/// Part of the cell around node `i` that lies inside, along one axis.
#[inline(always)]
pub(super) fn share(n: usize, i: usize) -> f64 {
    if i == 0 || i == n { 0.5 } else { 1.0 }
}

/// Neighbours `i - 1` and `i + 1`, mirrored at the boundary.
#[inline(always)]
pub(super) fn mirrored(n: usize, i: usize) -> [usize; 2] {
    [if i > 0 { i - 1 } else { 1 }, if i < n { i + 1 } else { n - 1 }]
}

/// Number of nodes of a grid.
pub(super) fn nodes(n: usize) -> usize {
    (n + 1) * (n + 1)
}

/// Number of boundary nodes of a grid. They are numbered in natural order.
pub(super) fn boundary_nodes(n: usize) -> usize {
    4 * n
}

/// Number of boundary nodes before row `j`, where `j` is at most `n + 1`.
pub(super) fn boundary_before(n: usize, j: usize) -> usize {
    if j > n { boundary_nodes(n) } else { GridRow { n, j }.first_boundary() }
}

/// Row `j`, from below, of a grid with `n` cells per side.
#[derive(Clone, Copy, Debug)]
pub(super) struct GridRow {
    pub(super) n: usize,
    pub(super) j: usize,
}

impl GridRow {
    /// True if the row of this colour starts on the boundary and has `n / 2 + 1` nodes, one more than the row of the
    /// other colour.
    #[inline(always)]
    pub(super) fn is_long(self, colour: Colour) -> bool {
        colour.first_column(self.j) == 0
    }

    /// True if only the two ends of the row lie on the boundary.
    #[inline(always)]
    pub(super) fn is_inner(self) -> bool {
        0 < self.j && self.j < self.n
    }

    /// Part of the cells around the row that lies inside, across the row.
    #[inline(always)]
    pub(super) fn share(self) -> f64 {
        share(self.n, self.j)
    }

    /// Number of the first boundary node of the row. All nodes of the first and the last row are numbered, of any other
    /// row only the two ends.
    #[inline(always)]
    pub(super) fn first_boundary(self) -> usize {
        if self.j == 0 { 0 } else { self.n + 1 + 2 * (self.j - 1) }
    }

    /// The row of one colour, of which `rows` holds all rows from `first` on.
    #[inline(always)]
    pub(super) fn of(self, rows: &[f64], first: usize) -> &[f64] {
        &rows[(self.j - first) * stride(self.n)..][..stride(self.n)]
    }
}

/// Number of the boundary node `[i, j]`.
pub(super) fn boundary_number(n: usize, [i, j]: [usize; 2]) -> usize {
    let row = GridRow { n, j };
    row.first_boundary() + if row.is_inner() { usize::from(i == n) } else { i }
}
