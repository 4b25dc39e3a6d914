//! The cells of a uniform grid as a piecewise constant f sees them: on most it is constant, few are cut.
//!
//! A row of cells is painted like the pieces themselves, the last over the others; only cells that a border
//! crosses and no later piece covers are integrated, in closed form on the square.

mod monomials;
mod slices;
mod sweep;

pub use slices::CutCube;
pub use sweep::{Moments, SweepCut};

use super::grid::Grid;
use crate::problem::region::Region;
use crate::problem::shape::Convex;
use std::ops::Range;

/// Integrals of f times the bilinear hat functions of the corners ll, lr, ul, ur of a cell, from those of f times 1, X,
/// Y and XY.
#[inline(always)]
pub fn bilinear([one, x, y, xy]: [f64; 4]) -> [f64; 4] {
    let (mean, x, y) = (0.25 * one, 0.5 * x, 0.5 * y);
    [mean - x - y + xy, mean + x - y - xy, mean - x + y - xy, mean + x + y + xy]
}

/// Goes over the cells of a grid in rows along x; `N` is 1 on the square, 2 on the cube.
pub struct Rows<'a, P, const N: usize> {
    /// Coordinates of the grid lines, the same along every axis.
    lines: Vec<f64>,
    background: f64,
    pieces: &'a [(P, f64)],
    /// The pieces that reach into the row, in painting order.
    present: Vec<Present<P>>,
    /// Ends of runs of cells, sorted.
    ends: Vec<usize>,
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

/// Next part of a row of cells, from left to right.
pub enum CellRun<'r, P> {
    /// Cells on which f has one value.
    Constant(Range<usize>, f64),
    /// A cell that a border crosses: its place, the value where no piece is, and the pieces there, of which the
    /// first wins, in the coordinates of the cell, which run from -1/2 to 1/2.
    Cut(usize, f64, &'r mut dyn Iterator<Item = (P, f64)>),
}

impl<'a, P: Convex<N>, const N: usize> Rows<'a, P, N> {
    /// The cells between these grid lines under `background` and `pieces`, of which the last wins.
    pub fn new(lines: Vec<f64>, background: f64, pieces: &'a [(P, f64)]) -> Self {
        Self { lines, background, pieces, present: Vec::new(), ends: Vec::new() }
    }

    /// Shows f on a row of cells to `visit`, from left to right.
    pub fn runs(&mut self, at: [usize; N], mut visit: impl FnMut(CellRun<'_, P>)) {
        let n = self.lines.len() - 1;
        self.find_present(at.map(|k| [self.lines[k], self.lines[k + 1]]));
        let Self { lines, background, present, ends, .. } = self;
        let ranges = present.iter().flat_map(|piece| [&piece.touched, &piece.covered]);
        ends.clear();
        ends.extend(ranges.flat_map(|range| [range.start, range.end]).chain([n]));
        ends.sort_unstable();
        let middle = |k: usize| 0.5 * (lines[k] + lines[k + 1]);
        let mut start = 0;
        for &end in ends.iter().filter(|&&end| end > 0) {
            if start == end {
                continue;
            }
            // What a piece covers hides all below it.
            let lowest = present.iter().rposition(|piece| piece.covered.contains(&start));
            let hidden = lowest.map_or(*background, |k| present[k].value);
            let above = &present[lowest.map_or(0, |k| k + 1)..];
            let here = above.iter().rev().filter(|piece| piece.touched.contains(&start));
            if here.clone().next().is_none() {
                visit(CellRun::Constant(start..end, hidden));
            } else {
                for i in start..end {
                    let seen = |p: &Present<P>| {
                        (p.shape.seen_from(middle(i), at.map(middle), 1.0 / n as f64), p.value)
                    };
                    visit(CellRun::Cut(i, hidden, &mut here.clone().map(seen)));
                }
            }
            start = end;
        }
    }

    /// Writes f on the cells of a row to `values`. A cell that a border crosses gets 0 and is shown to `cut`, from
    /// left to right, as in [`CellRun::Cut`].
    ///
    /// # Panics
    /// If there is not one value per cell.
    pub fn row(
        &mut self,
        at: [usize; N],
        values: &mut [f64],
        mut cut: impl FnMut(usize, f64, &mut dyn Iterator<Item = (P, f64)>),
    ) {
        assert_eq!(values.len(), self.lines.len() - 1);
        self.runs(at, |run| match run {
            CellRun::Constant(cells, value) => values[cells].fill(value),
            CellRun::Cut(i, background, pieces) => {
                values[i] = 0.0;
                cut(i, background, pieces);
            }
        });
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
    cut: SweepCut,
}

impl<'a> Cells<'a> {
    /// The cells of `grid` under `background` and `pieces`, of which the last wins.
    pub fn new(grid: Grid, background: f64, pieces: &'a [(Region, f64)]) -> Self {
        let lines = (0..grid.side()).map(|i| grid.coordinate(i)).collect();
        Self { rows: Rows::new(lines, background, pieces), cut: SweepCut::default() }
    }

    /// Writes f on the cells of the `j`-th row, from below, to `values`; a cell that a border crosses gets 0
    /// and is shown to `cut` instead, from left to right.
    ///
    /// # Panics
    /// If there is not one value per cell.
    pub fn row(&mut self, j: usize, values: &mut [f64], mut cut: impl FnMut(usize, &mut SweepCut)) {
        let Self { rows, cut: cell } = self;
        rows.row([j], values, |i, background, pieces| {
            cell.set(background, pieces);
            cut(i, cell);
        });
    }

    /// Shows f on the `j`-th row, from below, to `visit`: runs of cells with one value, and cells that a border
    /// crosses, which have none.
    pub fn runs(
        &mut self,
        j: usize,
        mut visit: impl FnMut(Range<usize>, Result<f64, &mut SweepCut>),
    ) {
        let Self { rows, cut: cell } = self;
        rows.runs([j], |run| match run {
            CellRun::Constant(cells, value) => visit(cells, Ok(value)),
            CellRun::Cut(i, background, pieces) => {
                cell.set(background, pieces);
                visit(i..i + 1, cell.constant().ok_or(cell));
            }
        });
    }
}
