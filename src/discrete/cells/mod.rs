//! The cells of a uniform grid as a piecewise constant f sees them: on most it is constant, few are cut.
//!
//! A row of cells is painted like the pieces themselves, the last over the others; only cells that a border
//! crosses and no later piece covers are integrated, in closed form on the square.

mod monomials;
mod slices;
mod sweep;

pub use slices::CutCube;
pub use sweep::{Cut, Moments};

use super::grid::Grid;
use crate::problem::region::Region;
use crate::problem::shape::Convex;
use std::ops::Range;

/// Goes over the cells of a grid in rows along x; `N` is 1 on the square, 2 on the cube.
pub struct Rows<'a, P, const N: usize> {
    /// Coordinates of the grid lines, the same along every axis.
    lines: Vec<f64>,
    background: f64,
    pieces: &'a [(P, f64)],
    /// The pieces that reach into the row, in painting order.
    present: Vec<Present<P>>,
}

/// A piece in a row of cells.
struct Present<P> {
    shape: P,
    value: f64,
    /// Cells that it touches.
    touched: Range<usize>,
    /// Cells that it covers.
    covered: Range<usize>,
}

/// Marks a cell that a border crosses; no value of f is like it.
const CUT: f64 = f64::NAN;

impl<'a, P: Convex<N>, const N: usize> Rows<'a, P, N> {
    /// The cells between these grid lines under `background` and `pieces`, of which the last wins.
    pub fn new(lines: Vec<f64>, background: f64, pieces: &'a [(P, f64)]) -> Self {
        Self { lines, background, pieces, present: Vec::new() }
    }

    /// Writes f on the cells of a row to `values`. A cell that a border crosses gets 0 and is shown to `cut`, from
    /// left to right: its place, the value where no piece is, and the pieces there, of which the first wins, in
    /// the coordinates of the cell, which run from -1/2 to 1/2.
    ///
    /// # Panics
    /// If there is not one value per cell.
    pub fn row(
        &mut self,
        at: [usize; N],
        values: &mut [f64],
        mut cut: impl FnMut(usize, f64, &mut dyn Iterator<Item = (P, f64)>),
    ) {
        let n = self.lines.len() - 1;
        assert_eq!(values.len(), n);
        self.find_present(at.map(|k| [self.lines[k], self.lines[k + 1]]));
        values.fill(self.background);
        for piece in &self.present {
            values[piece.touched.clone()].fill(CUT);
            values[piece.covered.clone()].fill(piece.value);
        }
        if self.present.iter().all(|piece| piece.touched == piece.covered) {
            return;
        }
        let middle = |k: usize| 0.5 * (self.lines[k] + self.lines[k + 1]);
        for (i, value) in values.iter_mut().enumerate() {
            if !value.is_nan() {
                continue;
            }
            *value = 0.0;
            // What a piece covers hides all below it.
            let lowest = self.present.iter().rposition(|piece| piece.covered.contains(&i));
            let background = lowest.map_or(self.background, |k| self.present[k].value);
            let above = &self.present[lowest.map_or(0, |k| k + 1)..];
            let here = above.iter().rev().filter(|piece| piece.touched.contains(&i));
            let seen = |p: &Present<P>| {
                (p.shape.seen_from(middle(i), at.map(middle), 1.0 / n as f64), p.value)
            };
            cut(i, background, &mut here.map(seen));
        }
    }

    fn find_present(&mut self, strip: [[f64; 2]; N]) {
        let n = self.lines.len() - 1;
        self.present.clear();
        for &(shape, value) in self.pieces {
            let Some([left, right]) = shape.extent(strip) else { continue };
            // Casts saturate, so that what is infinite ends at the last cell.
            let start = ((left + 0.5) * n as f64).floor() as usize;
            let end = (((right + 0.5) * n as f64).ceil() as usize).min(n);
            if start >= end {
                continue;
            }
            // A convex piece covers a cell if it holds the corners.
            let mut nodes = 0..n + 1;
            for corner in 0..1 << N {
                let at = std::array::from_fn(|axis| strip[axis][corner >> axis & 1]);
                let held = shape.along(&self.lines, at);
                nodes = nodes.start.max(held.start)..nodes.end.min(held.end);
            }
            let (first, last) = (nodes.start, nodes.end.saturating_sub(1));
            let (covered, touched) = match first < last {
                true => (first..last, start.min(first)..end.max(last)),
                false => (start..start, start..end),
            };
            self.present.push(Present { shape, value, touched, covered });
        }
    }
}

/// The cells of the square.
pub struct Cells<'a> {
    rows: Rows<'a, Region, 1>,
    cut: Cut,
}

impl<'a> Cells<'a> {
    /// The cells of `grid` under `background` and `pieces`, of which the last wins.
    pub fn new(grid: Grid, background: f64, pieces: &'a [(Region, f64)]) -> Self {
        let lines = (0..grid.side()).map(|i| grid.coordinate(i)).collect();
        Self { rows: Rows::new(lines, background, pieces), cut: Cut::default() }
    }

    /// Writes f on the cells of the `j`-th row, from below, to `values`; a cell that a border crosses gets 0
    /// and is shown to `cut` instead, from left to right.
    ///
    /// # Panics
    /// If there is not one value per cell.
    pub fn row(&mut self, j: usize, values: &mut [f64], mut cut: impl FnMut(usize, &mut Cut)) {
        let Self { rows, cut: cell } = self;
        rows.row([j], values, |i, background, pieces| {
            cell.set(background, pieces);
            cut(i, cell);
        });
    }

    /// Moments of f on each cell of the `j`-th row: `h^2` times those over the unit cell are the integrals over
    /// the cell.
    pub fn moments(&mut self, j: usize) -> Vec<Moments> {
        let mut values = vec![0.0; self.rows.lines.len() - 1];
        let mut cut = Vec::new();
        self.row(j, &mut values, |i, cell| cut.push((i, cell.moments())));
        let mut row: Vec<_> = values.into_iter().map(Moments::constant).collect();
        cut.into_iter().for_each(|(i, moments)| row[i] = moments);
        row
    }
}
