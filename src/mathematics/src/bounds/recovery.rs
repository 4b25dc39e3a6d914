//! The nodal vector, continued beyond the boundary, and the recovery on one edge and on one cell.

use super::cells::SpecialCell;
use super::flux::Reactions;
use crate::discrete::grid::Grid;

/// A nodal vector with one layer of nodes beyond the boundary, by reflection plus twice the reaction.
///
/// The five-point equation then holds at boundary nodes as well, so that every stencil is that of the interior.
pub(super) struct Extended<'a> {
    pub grid: Grid,
    pub reactions: &'a Reactions,
    v: &'a [f64],
    /// Rows of nodes below and above the square.
    beyond: [Vec<f64>; 2],
}

impl<'a> Extended<'a> {
    pub(super) fn new(grid: Grid, v: &'a [f64], reactions: &'a Reactions) -> Self {
        let below = reflected(&v[grid.index(0, 1)..], &reactions.bottom);
        let above = reflected(&v[grid.index(0, grid.cells() - 1)..], &reactions.top);
        Self { grid, reactions, v, beyond: [below, above] }
    }

    /// Values on row `j` of nodes.
    #[inline(always)]
    pub(super) fn row(&self, j: usize) -> &[f64] {
        let side = self.grid.side();
        &self.v[j * side..(j + 1) * side]
    }

    /// Values on four rows of nodes: below row `j` of cells, at its lower and upper edges, and above it.
    #[inline(always)]
    pub(super) fn rows(&self, j: usize) -> [&[f64]; 4] {
        let [below, above] = &self.beyond;
        let below = if j > 0 { self.row(j - 1) } else { below };
        let above = if j + 2 < self.grid.side() { self.row(j + 2) } else { above };
        [below, self.row(j), self.row(j + 1), above]
    }

    /// Values on the lines of the horizontal and of the vertical edges of cell (i, j): at their ends, and one
    /// node further at each end.
    #[inline(always)]
    pub(super) fn around(&self, i: usize, j: usize) -> [[[f64; 4]; 2]; 2] {
        let Reactions { left, right, .. } = self.reactions;
        let [below, lower, upper, above] = self.rows(j);
        let [[b, c], [f, g]] = [lower, upper].map(|row| [row[i], row[i + 1]]);
        let [a, e] = match i {
            0 => [c + 2.0 * left[j], g + 2.0 * left[j + 1]],
            _ => [lower[i - 1], upper[i - 1]],
        };
        let [d, h] = match i + 2 < lower.len() {
            true => [lower[i + 2], upper[i + 2]],
            false => [b + 2.0 * right[j], f + 2.0 * right[j + 1]],
        };
        let vertical = [[below[i], b, f, above[i]], [below[i + 1], c, g, above[i + 1]]];
        [[[a, b, c, d], [e, f, g, h]], vertical]
    }
}

/// Continues a row next to the boundary beyond it: the values plus twice the reactions `a`.
fn reflected(v: &[f64], a: &[f64]) -> Vec<f64> {
    v.iter().zip(a).map(|(v, a)| v + 2.0 * a).collect()
}

/// Values of the recovery at the corners, the midpoints of edges and the centre of a cell, row by row.
pub(super) fn values(cell: &SpecialCell) -> [[f64; 3]; 3] {
    let ([ll, lr, ul, ur], [[bottom, top], [left, right]]) = (cell.corners(), cell.bubbles);
    let centre = 0.25 * ((ll + lr) + (ul + ur)) - 0.125 * ((bottom + top) + (left + right));
    [
        [ll, at_midpoint(ll, lr, bottom), lr],
        [at_midpoint(ll, ul, left), centre, at_midpoint(lr, ur, right)],
        [ul, at_midpoint(ul, ur, top), ur],
    ]
}

/// Value of the recovery at the midpoint of an edge with values p and q at its ends.
fn at_midpoint(p: f64, q: f64, bubble: f64) -> f64 {
    0.5 * (p + q) - 0.25 * bubble
}
