//! The nodal vector continued beyond the boundary, and the recovery on one edge and on one cell.

use super::cells::Special;
use super::flux::Reactions;
use crate::discrete::grid::Grid;

/// A nodal vector with one layer of nodes beyond the boundary, by reflection plus twice the reaction: so the
/// five-point equation holds on the boundary as inside, and every stencil is that of the interior.
pub(super) struct Extended<'a> {
    pub grid: Grid,
    pub v: &'a [f64],
    pub reactions: &'a Reactions,
}

impl<'a> Extended<'a> {
    /// The values on row `j` of nodes.
    pub(super) fn row(&self, j: usize) -> &'a [f64] {
        let side = self.grid.side();
        &self.v[j * side..(j + 1) * side]
    }

    /// The values on row `j` of nodes from the one left of cell `i` to two right of it.
    #[inline(always)]
    fn line(&self, i: usize, j: usize) -> [f64; 4] {
        let (row, Reactions { left, right, .. }) = (self.row(j), self.reactions);
        let before = if i == 0 { row[1] + 2.0 * left[j] } else { row[i - 1] };
        let after = row.get(i + 2).copied().unwrap_or_else(|| row[i] + 2.0 * right[j]);
        [before, row[i], row[i + 1], after]
    }

    /// The values on the lines of the horizontal and of the vertical edges of cell (i, j): at their ends, and one
    /// node further at each end.
    #[inline(always)]
    pub(super) fn around(&self, i: usize, j: usize) -> [[[f64; 4]; 2]; 2] {
        let Reactions { bottom, top, .. } = self.reactions;
        let last = self.grid.cells() - 1;
        let below =
            |i: usize| if j == 0 { self.row(1)[i] + 2.0 * bottom[i] } else { self.row(j - 1)[i] };
        let above =
            |i: usize| if j == last { self.row(j)[i] + 2.0 * top[i] } else { self.row(j + 2)[i] };
        let (a, b) = (self.line(i, j), self.line(i, j + 1));
        [[a, b], [[below(i), a[1], b[1], above(i)], [below(i + 1), a[2], b[2], above(i + 1)]]]
    }
}

/// The coefficient of the bubble on an edge of the boundary with end values `p` and `q`, cut so that the
/// function stays nonnegative: its Bernstein coefficients are p, (p + q - c) / 2 and q.
pub(super) fn admissible(bubble: f64, p: f64, q: f64) -> f64 {
    if p == 0.0 && q == 0.0 { 0.0 } else { bubble.min(p + q) }
}

/// What the recovery is at the corners, the middles of edges and the centre of a cell, row by row.
pub(super) fn values(cell: &Special) -> [[f64; 3]; 3] {
    let [ll, lr, ul, ur] = cell.corners;
    let ([bottom, top], [left, right]) = (cell.x.bubble, cell.y.bubble);
    let middle = |p: f64, q: f64, bubble: f64| 0.5 * (p + q) - 0.25 * bubble;
    let centre = 0.25 * ((ll + lr) + (ul + ur)) - 0.125 * ((bottom + top) + (left + right));
    [
        [ll, middle(ll, lr, bottom), lr],
        [middle(ll, ul, left), centre, middle(lr, ur, right)],
        [ul, middle(ul, ur, top), ur],
    ]
}
