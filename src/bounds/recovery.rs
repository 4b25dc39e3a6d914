//! The nodal vector continued beyond the boundary, and the recovery on one edge and on one cell.

use super::cells::Special;
use super::flux::Reactions;
use crate::discrete::grid::Grid;

/// A nodal vector with one layer of nodes beyond the boundary, by reflection plus twice the reaction: so the
/// five-point equation holds on the boundary as inside, and every stencil is that of the interior.
pub(super) struct Extended<'a> {
    side: usize,
    v: &'a [f64],
    bottom: Vec<f64>,
    top: Vec<f64>,
    left: Vec<f64>,
    right: Vec<f64>,
}

impl<'a> Extended<'a> {
    pub(super) fn new(grid: Grid, v: &'a [f64], reactions: &Reactions) -> Self {
        let (side, n) = (grid.side(), grid.cells());
        let beyond = |reactions: &[f64], inner: &dyn Fn(usize) -> usize| -> Vec<f64> {
            reactions.iter().enumerate().map(|(k, a)| v[inner(k)] + 2.0 * a).collect()
        };
        Self {
            side,
            v,
            bottom: beyond(&reactions.bottom, &|i| grid.index(i, 1)),
            top: beyond(&reactions.top, &|i| grid.index(i, n - 1)),
            left: beyond(&reactions.left, &|j| grid.index(1, j)),
            right: beyond(&reactions.right, &|j| grid.index(n - 1, j)),
        }
    }

    /// The values on row `j` of nodes.
    pub(super) fn row(&self, j: usize) -> &'a [f64] {
        &self.v[j * self.side..(j + 1) * self.side]
    }

    /// The values on row `j` of nodes from the one left of cell `i` to two right of it.
    #[inline(always)]
    fn line(&self, i: usize, j: usize) -> [f64; 4] {
        let row = self.row(j);
        let at = |k: usize| row.get(i + k - 1).copied().unwrap_or(self.right[j]);
        [if i == 0 { self.left[j] } else { row[i - 1] }, row[i], row[i + 1], at(3)]
    }

    /// The values on the lines of the horizontal and of the vertical edges of cell (i, j): at their ends, and one
    /// node further at each end.
    #[inline(always)]
    pub(super) fn around(&self, i: usize, j: usize) -> [[[f64; 4]; 2]; 2] {
        let below = if j == 0 { &self.bottom } else { self.row(j - 1) };
        let above = if j + 3 > self.side { &self.top } else { self.row(j + 2) };
        let (a, b) = (self.line(i, j), self.line(i, j + 1));
        [[a, b], [[below[i], a[1], b[1], above[i]], [below[i + 1], a[2], b[2], above[i + 1]]]]
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
