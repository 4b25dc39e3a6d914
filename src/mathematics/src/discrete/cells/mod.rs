//! The cells of a uniform grid as a piecewise constant f sees them: on most it is constant, few are cut.
//!
//! A row of cells is painted like the pieces themselves, the last over the others; only cells that a border
//! crosses and no later piece covers are integrated, in closed form.

mod monomials;
mod slices;
mod sweep;

pub use slices::CutCube;
pub use sweep::{Moments, SweepCut};

use super::grid::Grid;
use crate::problem::shape::Shape;
use std::ops::Range;

/// Integrals of f times the bilinear hat functions of the corners ll, lr, ul, ur of a cell, from those of f times 1, X,
/// Y and XY.
#[inline(always)]
pub fn bilinear([one, x, y, xy]: [f64; 4]) -> [f64; 4] {
    let (mean, x, y) = (0.25 * one, 0.5 * x, 0.5 * y);
    [mean - x - y + xy, mean + x - y - xy, mean - x + y - xy, mean + x + y + xy]
}

/// The cells of the square, gone over in rows along x.
pub struct Cells<'a> {
    /// Coordinates of the grid lines, the same along both axes.
    lines: Vec<f64>,
    background: f64,
    pieces: &'a [(Shape<2>, f64)],
    /// The pieces that reach into the row, in painting order.
    present: Vec<Present>,
    /// Ends of runs of cells, sorted.
    ends: Vec<usize>,
    cut: SweepCut,
}

/// A piece in a row of cells.
struct Present {
    shape: Shape<2>,
    value: f64,
    /// Cells that it touches.
    touched: Range<usize>,
    /// Cells that it covers.
    covered: Range<usize>,
}

/// Next part of a row of cells, from left to right.
enum CellRun<'r> {
    /// Cells on which f has one value.
    Constant(Range<usize>, f64),
    /// A cell that a border crosses: its place, and the pieces there.
    Cut(usize, &'r mut SweepCut),
}

impl<'a> Cells<'a> {
    /// The cells of `grid` under `background` and `pieces`, of which the last wins.
    pub fn new(grid: Grid, background: f64, pieces: &'a [(Shape<2>, f64)]) -> Self {
        Self {
            lines: (0..grid.side()).map(|i| grid.coordinate(i)).collect(),
            background,
            pieces,
            present: Vec::new(),
            ends: Vec::new(),
            cut: SweepCut::default(),
        }
    }

    /// Writes f on the cells of the `j`-th row, from below, to `values`; a cell that a border crosses gets 0
    /// and is shown to `cut` instead, from left to right.
    ///
    /// # Panics
    /// If there is not one value per cell.
    pub fn row(&mut self, j: usize, values: &mut [f64], mut cut: impl FnMut(usize, &mut SweepCut)) {
        assert_eq!(values.len(), self.lines.len() - 1);
        self.visit(j, |run| match run {
            CellRun::Constant(cells, value) => values[cells].fill(value),
            CellRun::Cut(i, cell) => {
                values[i] = 0.0;
                cut(i, cell);
            }
        });
    }

    /// Shows f on the `j`-th row, from below, to `show`: runs of cells with one value, and cells that a border
    /// crosses, which have none.
    pub fn runs(
        &mut self,
        j: usize,
        mut show: impl FnMut(Range<usize>, Result<f64, &mut SweepCut>),
    ) {
        self.visit(j, |run| match run {
            CellRun::Constant(cells, value) => show(cells, Ok(value)),
            CellRun::Cut(i, cell) => show(i..i + 1, cell.constant().ok_or(cell)),
        });
    }

    /// Visits the parts of a row, from left to right.
    fn visit(&mut self, j: usize, mut visit: impl FnMut(CellRun<'_>)) {
        let n = self.lines.len() - 1;
        self.find_present([self.lines[j], self.lines[j + 1]]);
        let Self { lines, background, present, ends, cut, .. } = self;
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
                    let centre = [middle(i), middle(j)];
                    let seen = |Present { shape, value, .. }: &Present| {
                        (shape.seen_from(centre, 1.0 / n as f64), *value)
                    };
                    cut.set(hidden, here.clone().map(seen));
                    visit(CellRun::Cut(i, cut));
                }
            }
            start = end;
        }
    }

    /// Finds the pieces that reach into the row between these heights.
    fn find_present(&mut self, heights: [f64; 2]) {
        let n = self.lines.len() - 1;
        // Of all shapes in the row, whatever their x.
        let strip = [[f64::NEG_INFINITY, f64::INFINITY], heights];
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
            let [below, above] = heights.map(|y| shape.along(&self.lines, [0.0, y]));
            let (first, last) =
                (below.start.max(above.start), below.end.min(above.end).saturating_sub(1));
            let (covered, touched) = match first < last {
                true => (first..last, start.min(first)..end.max(last)),
                false => (start..start, start..end),
            };
            self.present.push(Present { shape, value, touched, covered });
        }
    }
}
