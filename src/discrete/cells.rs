//! The cells of a uniform grid as a piecewise constant f sees them: on most it is constant, few are cut.

use super::grid::Grid;
use super::sweep::{Cut, Moments};
use crate::problem::region::Region;
use std::ops::Range;

/// Goes over the cells of a grid row by row.
pub struct Cells<'a> {
    grid: Grid,
    /// Coordinates of the grid lines.
    lines: Vec<f64>,
    background: f64,
    pieces: &'a [(Region, f64)],
    /// The pieces that reach into the row, in painting order.
    present: Vec<Present>,
    cut: Cut,
}

/// A piece in a row of cells.
struct Present {
    region: Region,
    value: f64,
    /// Cells that it touches.
    touched: Range<usize>,
    /// Cells that it covers.
    covered: Range<usize>,
}

impl<'a> Cells<'a> {
    /// The cells of `grid` under `background` and `pieces`, the last of which wins.
    pub fn new(grid: Grid, background: f64, pieces: &'a [(Region, f64)]) -> Self {
        let lines = (0..grid.side()).map(|i| grid.coordinate(i)).collect();
        Self { grid, lines, background, pieces, present: Vec::new(), cut: Cut::default() }
    }

    /// Writes f on the cells of the `j`-th row, from below, to `values`; a cell that a border crosses gets 0
    /// and is shown to `cut` instead, from left to right.
    ///
    /// # Panics
    /// If there is not one value per cell.
    pub fn row(&mut self, j: usize, values: &mut [f64], mut cut: impl FnMut(usize, &mut Cut)) {
        let n = self.grid.cells();
        assert_eq!(values.len(), n);
        self.find_present([self.lines[j], self.lines[j + 1]]);
        values.fill(self.background);
        for piece in &self.present {
            values[piece.touched.clone()].fill(CUT);
            values[piece.covered.clone()].fill(piece.value);
        }
        if self.present.iter().all(|piece| piece.touched == piece.covered) {
            return;
        }
        let h = self.grid.h();
        for (i, value) in values.iter_mut().enumerate() {
            if !value.is_nan() {
                continue;
            }
            *value = 0.0;
            let centre = [i, j].map(|k| 0.5 * (self.lines[k] + self.lines[k + 1]));
            // What a piece covers hides all below it.
            let lowest = self.present.iter().rposition(|piece| piece.covered.contains(&i));
            let background = lowest.map_or(self.background, |k| self.present[k].value);
            let above = &self.present[lowest.map_or(0, |k| k + 1)..];
            let here = above.iter().rev().filter(|piece| piece.touched.contains(&i));
            self.cut.set(background, here.map(|p| (p.region.seen_from(centre, h), p.value)));
            cut(i, &mut self.cut);
        }
    }

    fn find_present(&mut self, y: [f64; 2]) {
        let n = self.grid.cells();
        self.present.clear();
        for &(region, value) in self.pieces {
            let Some([left, right]) = region.extent(y) else { continue };
            // Casting saturates, so that what is infinite ends at the last cell.
            let start = ((left + 0.5) * n as f64).floor() as usize;
            let end = (((right + 0.5) * n as f64).ceil() as usize).min(n);
            if start < end {
                // A convex region covers a cell if it holds the corners.
                let [below, above] = y.map(|y| region.along(&self.lines, y));
                let first = below.start.max(above.start);
                let last = below.end.min(above.end).saturating_sub(1);
                let (covered, touched) = match first < last {
                    true => (first..last, start.min(first)..end.max(last)),
                    false => (start..start, start..end),
                };
                self.present.push(Present { region, value, touched, covered });
            }
        }
    }
}

/// Marks a cell that a border crosses; no value of f is like it.
const CUT: f64 = f64::NAN;

/// Moments of f on each cell of a row: `h^2` times those of the unit cell are the integrals over the cell.
pub fn moments(cells: &mut Cells, j: usize) -> Vec<Moments> {
    let mut values = vec![0.0; cells.grid.cells()];
    let mut cut = Vec::new();
    cells.row(j, &mut values, |i, cell| cut.push((i, cell.moments())));
    let mut row: Vec<_> = values.into_iter().map(Moments::constant).collect();
    for (i, moments) in cut {
        row[i] = moments;
    }
    row
}
