//! Full weighting, row by row.
//!
//! The weights are 1 at the coarse node, 1/2 at its four nearest and 1/4 at its four diagonal neighbours.

use super::layout::{GridRow, mirrored};
use super::rows::Colour;

/// Red and black load of some rows of the finer grid.
#[derive(Clone, Copy)]
pub(super) struct FineLoad<'a> {
    /// Red and black rows from `first` on.
    pub(super) rows: [&'a [f64]; 2],
    pub(super) first: usize,
    /// The red and the black row before `first`, or empty slices if no row there is needed.
    pub(super) before: [&'a [f64]; 2],
}

impl<'a> FineLoad<'a> {
    /// A row of one colour.
    #[inline(always)]
    fn row(&self, colour: Colour, row: GridRow) -> &'a [f64] {
        if row.j < self.first {
            return self.before[colour as usize];
        }
        row.of(self.rows[colour as usize], self.first)
    }
}

/// Sets `row`, a row of the coarser grid in natural order, to the full weighting of red residuals.
///
/// `residuals` are the fine rows below, at and above the coarse row, mirrored at the boundary.
#[inline(always)]
pub(super) fn weigh_residuals([below, middle, above]: [&[f64]; 3], row: &mut [f64]) {
    weigh_red(row, [middle, below, above]);
}

/// Sets `row`, row `at` of the coarser grid in natural order, to the full weighting of the load of both colours.
#[inline(always)]
pub(super) fn weigh_load(at: GridRow, load: &FineLoad, row: &mut [f64]) {
    let (n, middle) = (2 * at.n, 2 * at.j);
    let [below, above] = mirrored(n, middle);
    let rows = [middle, below, above].map(|j| GridRow { n, j });
    weigh_red(row, rows.map(|row| load.row(Colour::Red, row)));
    weigh_black(row, rows.map(|row| load.row(Colour::Black, row)));
}
/// Sets a coarse row to the red part of full weighting: the node itself and a quarter of its four diagonal neighbours.
#[inline(always)]
fn weigh_red(coarse: &mut [f64], [middle, lower, upper]: [&[f64]; 3]) {
    let half = coarse.len() - 1;
    coarse[0] = middle[0] + 0.5 * (lower[0] + upper[0]);
    // The loop includes the last node, so that it fills whole vectors; that node is set again afterwards.
    let (inner, middle_inner) = (&mut coarse[1..half + 1], &middle[1..half + 1]);
    let (lower_west, lower_east) = (&lower[..half], &lower[1..half + 1]);
    let (upper_west, upper_east) = (&upper[..half], &upper[1..half + 1]);
    for k in 0..half {
        let diagonals = (lower_west[k] + lower_east[k]) + (upper_west[k] + upper_east[k]);
        inner[k] = middle_inner[k] + 0.25 * diagonals;
    }
    coarse[half] = middle[half] + 0.5 * (lower[half - 1] + upper[half - 1]);
}

/// Adds the black part of full weighting to a coarse row: half of the four nearest neighbours.
#[inline(always)]
fn weigh_black(coarse: &mut [f64], [along, below, above]: [&[f64]; 3]) {
    let half = coarse.len() - 1;
    coarse[0] += 0.5 * (2.0 * along[0] + (below[0] + above[0]));
    let last = coarse[half] + 0.5 * (2.0 * along[half - 1] + (below[half] + above[half]));
    let (inner, below, above) =
        (&mut coarse[1..half + 1], &below[1..half + 1], &above[1..half + 1]);
    let (west, east) = (&along[..half], &along[1..half + 1]);
    for k in 0..half {
        inner[k] += 0.5 * ((west[k] + east[k]) + (below[k] + above[k]));
    }
    coarse[half] = last;
}
