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

/// Part of a row of cells.
enum RowPart<'r> {
    /// Cells on which f has one value.
    Constant(f64),
    /// A cell that a border crosses.
    Cut(&'r mut SweepCut),
}

/// Goes over the cells of the square in rows along x.
pub struct Cells<'a> {
    /// Coordinates of the grid lines, the same along both axes.
    lines: Vec<f64>,
    background: f64,
    pieces: &'a [(Region, f64)],
    /// The pieces that reach into the row, in painting order.
    present: Vec<Present>,
    /// Ends of runs of cells, sorted.
    ends: Vec<usize>,
    cut: SweepCut,
}

/// A piece in a row of cells.
struct Present {
    shape: Region,
    value: f64,
    /// Cells that it touches.
    touched: Range<usize>,
    /// Cells that it covers.
    covered: Range<usize>,
}

impl<'a> Cells<'a> {
    /// The cells of `grid` under `background` and `pieces`, of which the last wins.
    pub fn new(grid: Grid, background: f64, pieces: &'a [(Region, f64)]) -> Self {
        let lines = (0..grid.side()).map(|i| grid.coordinate(i)).collect();
        let (present, ends, cut) = (Vec::new(), Vec::new(), SweepCut::default());
        Self { lines, background, pieces, present, ends, cut }
    }

    /// Shows f on the `j`-th row, from below, to `visit`: runs of cells with one value, and cells that a border
    /// crosses.
    fn visit_row(&mut self, j: usize, mut visit: impl FnMut(Range<usize>, RowPart<'_>)) {
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
                visit(start..end, RowPart::Constant(hidden));
            } else {
                for i in start..end {
                    let seen = |p: &Present| {
                        (p.shape.seen_from(middle(i), [middle(j)], 1.0 / n as f64), p.value)
                    };
                    cut.set(hidden, here.clone().map(seen));
                    visit(i..i + 1, RowPart::Cut(cut));
                }
            }
            start = end;
        }
    }

    /// Writes f on the cells of the `j`-th row, from below, to `values`; a cell that a border crosses gets 0
    /// and is shown to `cut` instead, from left to right.
    ///
    /// # Panics
    /// If there is not one value per cell.
    pub fn row(&mut self, j: usize, values: &mut [f64], mut cut: impl FnMut(usize, &mut SweepCut)) {
        assert_eq!(values.len(), self.lines.len() - 1);
        self.visit_row(j, |cells, part| match part {
            RowPart::Constant(value) => values[cells].fill(value),
            RowPart::Cut(cell) => {
                values[cells.start] = 0.0;
                cut(cells.start, cell);
            }
        });
    }

    /// Shows f on the `j`-th row, from below, to `visit`: runs of cells with one value, and cells that a border
    /// crosses, which have none.
    pub fn runs(
        &mut self,
        j: usize,
        mut visit: impl FnMut(Range<usize>, Result<f64, &mut SweepCut>),
    ) {
        self.visit_row(j, |cells, part| match part {
            RowPart::Constant(value) => visit(cells, Ok(value)),
            RowPart::Cut(cell) => visit(cells, cell.constant().ok_or(cell)),
        });
    }

    fn find_present(&mut self, strip: [f64; 2]) {
        let n = self.lines.len() - 1;
        self.present.clear();
        for &(shape, value) in self.pieces {
            let Some([left, right]) = shape.extent([strip]) else { continue };
            // Casts saturate, so that what is infinite ends at the last cell.
            let start = ((left + 0.5) * n as f64).floor() as usize;
            let end = (((right + 0.5) * n as f64).ceil() as usize).min(n);
            if start >= end {
                continue;
            }
            // A convex piece covers a cell if it holds the corners.
            let mut nodes = 0..n + 1;
            for y in strip {
                let held = shape.along(&self.lines, [y]);
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
