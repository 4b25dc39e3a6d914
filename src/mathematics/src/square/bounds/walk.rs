//! The sweep over the cells: one pass over the vector, row by row.

use super::cells::{Batch, SpecialCell, Sums};
use super::data::{AllCells, ColumnSpan, Cursor, MomentRun};
use super::flux::Reactions;
use super::moments::CellMoments;
use super::regular::Regular;
use super::residual::Pyramid;
use super::strip::{Extended, FluxStrip};
use crate::bounds::boundary::{PartLaw, Slips};
use crate::discrete::grid::Grid;
use crate::machine::extremes::max_or_second;
use crate::machine::simd::vectorised;
use crate::problem::law::Law;
use std::borrow::Cow;
use std::f64::consts::PI;

/// Sums over all cells and over the boundary.
#[derive(Default)]
pub(super) struct Total {
    pub sums: Sums,
    /// Integral of `j(w) + sigma.n w` over the boundary, w the recovery; for the paper's law the work of the reactions.
    pub work: f64,
    /// Integral of j(w) over the boundary.
    pub recovered_potential: f64,
    /// Integral of j(v) over the boundary.
    pub linear_potential: f64,
    /// Increase of the energy of the recovery if its bubbles on the boundary are left out.
    pub boundary_bubble_gain: f64,
    /// Upper bound of the norm of a flux whose divergence is the residual.
    pub residual: f64,
    /// Largest |v|.
    pub largest: f64,
    /// Integral of |f|.
    pub mass: f64,
    /// [`Reactions::flow`].
    pub flow: f64,
}

/// Computes the sums for the nodal vector `v`, whose values on the boundary the law must allow, with the ends of its
/// interval that the reactions reach. The law must be able to balance the integral of f.
pub(super) fn total(data: &AllCells<'_>, law: Law, v: &[f64]) -> (Total, Slips) {
    let grid = data.grid();
    let outer: Vec<f64> = grid.boundary().map(|node| v[node]).collect();
    let reactions = Reactions::new(grid, law, v, &outer, data);
    let extended = Extended::new(grid, v, &reactions);
    let strip = FluxStrip::new(extended);
    let law = PartLaw::new(law, grid.h());
    let sweep = CellSweep::new(data, law, strip);
    let total = vectorised(
        #[inline(always)]
        || sweep.run(),
    );
    (Total { flow: reactions.flow, ..total }, reactions.slips)
}

/// Number of rows of cells whose sums are formed in lanes before they are added to the total: no lane sums more terms
/// than half a row has cells.
const BLOCK: usize = 8;

/// State of the sweep over the rows of cells.
struct CellSweep<'a> {
    grid: Grid,
    /// Law of an edge of the boundary.
    law: PartLaw,
    data: &'a AllCells<'a>,
    strip: FluxStrip<'a>,
    /// Rows j to j + 2 of cells, where j is the current row; empty beyond the boundary.
    cells: [Cow<'a, [MomentRun]>; 3],
    /// Cells of the current row to which the regular formulas do not apply.
    special: Vec<ColumnSpan>,
    /// Means of the residual in the cells of the current row, times `h^2`; zero where they are rounding errors.
    means: Vec<f64>,
    pyramid: Pyramid,
    total: Total,
    /// Sums over regular cells of the last rows, at most [`BLOCK`].
    regular: Regular,
    /// Sums over special cells of the same rows.
    batch: Batch,
    /// Sum of the squares of the means, times `h^2`, of residuals that are rounding errors.
    noise: f64,
}

impl<'a> CellSweep<'a> {
    fn new(data: &'a AllCells<'a>, law: PartLaw, strip: FluxStrip<'a>) -> Self {
        let (grid, n) = (strip.v.grid, strip.v.grid.cells());
        Self {
            grid,
            law,
            data,
            strip,
            cells: Default::default(),
            special: Vec::new(),
            means: vec![0.0; n],
            pyramid: Pyramid::new(n),
            total: Total::default(),
            regular: Regular::default(),
            batch: Batch::default(),
            noise: 0.0,
        }
    }

    #[inline(always)]
    fn run(mut self) -> Total {
        let n = self.grid.cells();
        [self.cells[1], self.cells[2]] = [self.data.row(0), self.data.row(1)];
        self.strip.advance(&[], &self.cells[1]);
        self.strip.advance(&self.cells[1], &self.cells[2]);
        self.total.largest = largest(self.strip.v.row(0)).max(largest(self.strip.v.row(1)));
        for j in 0..n {
            self.cells.rotate_left(1);
            self.cells[2] = if j + 2 < n { self.data.row(j + 2) } else { Cow::default() };
            self.strip.advance(&self.cells[1], &self.cells[2]);
            let ahead = largest(self.strip.v.row(n.min(j + 2)));
            self.total.largest = self.total.largest.max(ahead);
            self.sum(j);
            if (j + 1).is_multiple_of(BLOCK) {
                self.settle();
            }
        }
        self.batch.flush();
        self.settle();
        let Self { total, pyramid, noise, .. } = &mut self;
        // Poincaré's constant is h / pi on a cell and 1 / pi on the square.
        let inside = (total.sums.variance.sqrt() + n as f64 * noise.sqrt()) / PI;
        total.residual = pyramid.bound() + inside;
        self.total
    }

    /// Adds the sums over the last rows to the total.
    fn settle(&mut self) {
        self.total.sums.add(&self.regular.take());
        self.total.sums.add(&self.batch.take());
    }

    /// Adds row `j` of cells to the sums, and its residuals to the pyramid.
    #[inline(always)]
    fn sum(&mut self, j: usize) {
        let n = self.grid.cells();
        self.strip.find_special(j, &mut self.special);
        let (row, special) =
            (std::mem::take(&mut self.cells[0]), std::mem::take(&mut self.special));
        // Smaller residuals can only be rounding errors.
        let floor = 16.0 * f64::EPSILON * self.total.largest;
        let (mut cursor, mut start, mut residual) = (Cursor(&row), 0, false);
        for k in 0..=special.len() {
            let end = ColumnSpan { first: n, last: n };
            let ColumnSpan { first: from, last: to } = special.get(k).copied().unwrap_or(end);
            while start < from {
                let run = cursor.at(start);
                let mass = run.mass().expect("cells that jumps of f cut are special");
                let cells = start..run.end.min(from);
                let rows = self.strip.v.rows(j);
                let squares = self.regular.add(rows, cells.clone(), mass, &mut self.means);
                self.total.mass += mass.abs() * cells.len() as f64;
                start = cells.end;
                if squares > cells.len() as f64 * floor * floor {
                    residual = true;
                } else {
                    self.noise += squares;
                    self.means[cells].fill(0.0);
                }
            }
            for i in from..n.min(to + 1) {
                let mean = self.add_special(i, j, cursor.at(i).f);
                if mean.abs() > floor {
                    residual = true;
                    self.means[i] = mean;
                } else {
                    self.noise += mean * mean;
                    self.means[i] = 0.0;
                }
            }
            start = to + 1;
        }
        self.special = special;
        self.pyramid.push(if residual { &self.means } else { &[] });
    }

    /// Adds cell (i, j), and the contribution of the reactions on its edges, to the sums. Returns the mean of the
    /// residual times `h^2`.
    #[inline(always)]
    fn add_special(&mut self, i: usize, j: usize, f: CellMoments) -> f64 {
        let (cell, residual) = self.strip.cell([i, j], f);
        self.total.mass += f.square.sqrt();
        if self.strip.on_boundary(i, j).as_flattened().contains(&true) {
            self.add_reactions(&cell, i, j);
        }
        self.batch.push(&cell);
        residual
    }

    /// Adds the contribution of the reactions on the edges of cell (i, j) to the sums.
    fn add_reactions(&mut self, cell: &SpecialCell, i: usize, j: usize) {
        let on_boundary = self.strip.on_boundary(i, j);
        let Reactions { left, right, bottom, top, .. } = self.strip.v.reactions;
        let reactions = [[&bottom[i..], &top[i..]], [&left[j..], &right[j..]]];
        for (axis, k) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            if on_boundary[axis][k] {
                let ([_, p, q, _], bubble) = (cell.lines[axis][k], cell.bubbles[axis][k]);
                let fluxes = [reactions[axis][k][0], reactions[axis][k][1]];
                self.total.work += self.law.work([p, q], fluxes, bubble);
                self.total.recovered_potential += self.law.potential([p, q], bubble);
                self.total.linear_potential += self.law.potential([p, q], 0.0);
                self.total.boundary_bubble_gain += cell.boundary_bubble_gain(axis, k);
            }
        }
    }
}

/// Largest |v|, ignoring NaN, which makes the sums NaN.
///
/// Values are compared as numbers: with integers, as in [`Largest`](crate::machine::simd::Largest), the whole sweep
/// takes a tenth longer.
#[inline(always)]
fn largest(v: &[f64]) -> f64 {
    const LANES: usize = 16;
    let (blocks, rest) = v.as_chunks::<LANES>();
    let mut largest = [0.0; LANES];
    for block in blocks {
        for (largest, v) in largest.iter_mut().zip(block) {
            *largest = max_or_second(v.abs(), *largest);
        }
    }
    rest.iter().map(|v| v.abs()).chain(largest).fold(0.0, max_or_second)
}
