//! The surroundings of a row of cells: the nodal vector, continued beyond the boundary, the fluxes that f and its load
//! require, and the recovery on one edge and on one cell.

use super::cells::{LANES, SpecialCell, second};
use super::data::{ColumnSpan, MomentRun};
use super::flux::{NodeFluxes, Reactions, through_edges};
use super::moments::{CellMoments, mean};
use crate::bounds::boundary::limit_bubble;
use crate::discrete::grid::Grid;

/// The nodal vector, and the fluxes around four rows of nodes: below row j of cells, at its lower and upper edges, and
/// above it.
pub(super) struct FluxStrip<'a> {
    pub v: Extended<'a>,
    fluxes: [NodeFluxes; 4],
}

impl<'a> FluxStrip<'a> {
    /// Starts two rows below the first one, where all fluxes are zero.
    pub(super) fn new(v: Extended<'a>) -> Self {
        let fluxes = [0; 4].map(|_| NodeFluxes::zero(v.grid.cells()));
        Self { v, fluxes }
    }

    /// Moves up one row. The new row of nodes lies between these rows of cells; a missing row of cells is empty.
    pub(super) fn advance(&mut self, below: &[MomentRun], above: &[MomentRun]) {
        self.fluxes.rotate_left(1);
        self.fluxes[3].set(below, above);
    }

    /// Finds the cells of row `j` that are at the boundary or within two cells of a seam of f. Writes them as spans
    /// from left to right.
    pub(super) fn find_special(&self, j: usize, special: &mut Vec<ColumnSpan>) {
        let n = self.v.grid.cells();
        special.clear();
        if j == 0 || j == n - 1 || n < LANES + 2 {
            special.push(ColumnSpan { first: 0, last: n - 1 });
            return;
        }
        special.extend([0, n - 1].map(|cell| ColumnSpan { first: cell, last: cell }));
        for seam in self.fluxes.iter().flat_map(|row| &row.seams) {
            let (first, last) = (seam.first.saturating_sub(2), (seam.last + 1).min(n - 1));
            special.push(ColumnSpan { first, last });
        }
        special.sort_unstable();
        special.dedup_by(|next, span| {
            let joined = next.first <= span.last + 1;
            if joined {
                span.last = span.last.max(next.last);
            }
            joined
        });
    }

    /// Flags for the two edges of cell (i, j) along x, and the two along y, that are true on the boundary.
    #[inline(always)]
    pub(super) fn on_boundary(&self, i: usize, j: usize) -> [[bool; 2]; 2] {
        let last = self.v.grid.cells() - 1;
        [[j == 0, j == last], [i == 0, i == last]]
    }

    /// Cell (i, j), over which f has the moments `f`, and the mean of the residual times `h^2`.
    #[inline(always)]
    pub(super) fn cell(&self, [i, j]: [usize; 2], f: CellMoments) -> (SpecialCell, f64) {
        let (lines, on_boundary) = (self.v.around(i, j), self.on_boundary(i, j));
        let seconds = lines.map(|lines| lines.map(second));
        let (flux, bends) = match self.fluxes.iter().any(|row| !row.seams.is_empty()) {
            true => (through_edges(&self.fluxes[1], &self.fluxes[2], i), self.bends(i, j)),
            false => Default::default(),
        };
        let mut bubbles = [[0.0; 2]; 2];
        for (axis, k) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            let ([_, p, q, _], bubble) = (lines[axis][k], 0.5 * seconds[axis][k] + bends[axis][k]);
            bubbles[axis][k] =
                if on_boundary[axis][k] { limit_bubble(bubble, [p, q]) } else { bubble };
        }
        let ([x, y], [along, up]) = (seconds.map(mean), flux.changes());
        (SpecialCell { lines, bubbles, flux, f }, f.one + (x + y) + along + up)
    }

    /// Contribution of the fluxes that f requires to the bubbles of cell (i, j) along both axes: half the change of
    /// the flux over a cell, averaged over the two cells at the edge.
    #[inline(always)]
    pub(super) fn bends(&self, i: usize, j: usize) -> [[f64; 2]; 2] {
        let n = self.v.grid.cells();
        let [x, y] = self.flux_changes(i, 1);
        // Beyond the boundary the change is taken to be that of the cell itself.
        let below = if j > 0 { self.flux_changes(i, 0)[0] } else { x };
        let above = if j + 1 < n { self.flux_changes(i, 2)[0] } else { x };
        let left = if i > 0 { self.flux_changes(i - 1, 1)[1] } else { y };
        let right = if i + 1 < n { self.flux_changes(i + 1, 1)[1] } else { y };
        [[below, above].map(|near| 0.25 * (x + near)), [left, right].map(|near| 0.25 * (y + near))]
    }

    /// Changes along x and along y of the fluxes through cell `i`, between rows `row` and `row + 1` of the nodes.
    #[inline(always)]
    fn flux_changes(&self, i: usize, row: usize) -> [f64; 2] {
        through_edges(&self.fluxes[row], &self.fluxes[row + 1], i).changes()
    }
}

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
