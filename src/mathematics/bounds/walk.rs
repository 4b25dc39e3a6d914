//! The sweep over the cells: one pass over the vector, row by row.

use super::NoBound;
use super::cells::{Batch, Special, Sums};
use super::data::{AllCells, Cursor, Run};
use super::flux::Reactions;
use super::moments::Moments;
use super::recovery::{Extended, values};
use super::regular::Regular;
use super::residual::Pyramid;
use super::strip::Strip;
use crate::discrete::grid::Grid;
use crate::discrete::simd::vectorised;
use crate::problem::source::Source;
use std::borrow::Cow;
use std::f64::consts::PI;

/// The sums over all cells, and what the boundary adds.
#[derive(Default)]
pub(super) struct Total {
    pub sums: Sums,
    /// `<sigma.n, w>`, the work of the reactions on the recovery.
    pub work: f64,
    /// What the energy of the recovery gains when its bubbles on the boundary are left out.
    pub trace: f64,
    /// A bound of the flux that the residual takes.
    pub residual: f64,
    /// The largest |v|.
    pub largest: f64,
    /// Integral of |f|.
    pub mass: f64,
}

/// The sums for the nodal vector `v`, which is not negative on the boundary.
///
/// `recovered`, if given, receives the recovery on the grid of half the width.
pub(super) fn total(
    grid: Grid,
    f: &Source,
    v: &[f64],
    recovered: Option<&mut [f64]>,
) -> Result<Total, NoBound> {
    let data = AllCells::new(grid, f);
    if data.integral >= 0.0 {
        return Err(NoBound::NotCoercive);
    }
    let outer: Vec<f64> = grid.boundary().map(|node| v[node]).collect();
    let reactions = Reactions::new(grid, v, &outer, &data);
    let strip = Strip::new(Extended::new(grid, v, &reactions), data.is_linear(v));
    let walk = Walk::new(&data, strip, recovered);
    Ok(vectorised(
        #[inline(always)]
        || walk.run(),
    ))
}

/// Rows of cells whose sums are added up before they join the others: in lanes, no sum has more terms than half a
/// row has cells.
const BLOCK: usize = 8;

struct Walk<'a> {
    grid: Grid,
    data: &'a AllCells<'a>,
    strip: Strip<'a>,
    /// Rows j to j + 2 of cells, where j is the row at which the walk stands; empty beyond the boundary.
    cells: [Cow<'a, [Run]>; 3],
    /// Cells of the row that need more than the regular formulas, as inclusive ranges.
    special: Vec<[usize; 2]>,
    /// The means of the residual in the row, times `h^2`, but for rounding errors.
    means: Vec<f64>,
    pyramid: Pyramid,
    total: Total,
    /// The sums over cells of the last rows, at most [`BLOCK`].
    regular: Regular,
    batch: Batch,
    /// Sum of the squares of residuals that are rounding errors, each times `h^2`.
    noise: f64,
    recovered: Option<&'a mut [f64]>,
}

impl<'a> Walk<'a> {
    fn new(data: &'a AllCells<'a>, strip: Strip<'a>, recovered: Option<&'a mut [f64]>) -> Self {
        let (grid, n) = (strip.v.grid, strip.v.grid.cells());
        Self {
            grid,
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
            recovered,
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
            self.write_recovered(j);
            self.sum(j);
            if (j + 1).is_multiple_of(BLOCK) {
                self.settle();
            }
        }
        self.batch.flush();
        self.settle();
        let Self { total, pyramid, noise, .. } = &mut self;
        // Poincaré's constant is h / pi on cells and 1 / pi on the square.
        let inside = (total.sums.variance.sqrt() + n as f64 * noise.sqrt()) / PI;
        total.residual = pyramid.bound() + inside;
        self.total
    }

    /// Adds the sums over the last rows to those over all.
    fn settle(&mut self) {
        self.total.sums.add(&self.regular.take());
        self.total.sums.add(&self.batch.take());
    }

    /// Adds row `j` of cells to the sums, and their residuals to the pyramid.
    #[inline(always)]
    fn sum(&mut self, j: usize) {
        let n = self.grid.cells();
        self.strip.find_special(j, &mut self.special);
        let (row, special) =
            (std::mem::take(&mut self.cells[0]), std::mem::take(&mut self.special));
        // Where a residual can only be a rounding error.
        let floor = 16.0 * f64::EPSILON * self.total.largest;
        let (mut cursor, mut start, mut residual) = (Cursor(&row), 0, false);
        for k in 0..=special.len() {
            let [from, to] = special.get(k).copied().unwrap_or([n, n]);
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

    /// Adds cell (i, j), and what the reactions on its edges do, to the sums; returns the mean of the residual
    /// times `h^2`.
    #[inline(always)]
    fn add_special(&mut self, i: usize, j: usize, f: Moments) -> f64 {
        let residual = self.strip.set(self.batch.next(), [i, j], f);
        self.total.mass += f.square.sqrt();
        if self.strip.outer(i, j).as_flattened().contains(&true) {
            self.add_outer(i, j);
        }
        self.batch.push();
        residual
    }

    /// Adds what the reactions on the edges of cell (i, j) do to the sums.
    fn add_outer(&mut self, i: usize, j: usize) {
        let (cells, lane) = self.batch.next();
        let cell = cells.lane(lane);
        let (outer, Reactions { left, right, bottom, top, .. }) =
            (self.strip.outer(i, j), self.strip.v.reactions);
        let reactions = [[&bottom[i..], &top[i..]], [&left[j..], &right[j..]]];
        for (axis, k) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            if outer[axis][k] {
                let [_, p, q, _] = cell.lines[axis][k];
                self.total.work += work([p, q], reactions[axis][k], cell.bubbles[axis][k]);
                self.total.trace += cell.trace(axis, k);
            }
        }
    }

    /// Writes what the recovery is on row `j` of cells to its rows of the grid of half the width.
    fn write_recovered(&mut self, j: usize) {
        let Some(out) = self.recovered.take() else { return };
        let side = 2 * self.grid.cells() + 1;
        let mut cells = Special::default();
        for i in 0..self.grid.cells() {
            self.strip.set((&mut cells, 0), [i, j], Moments::default());
            for (k, values) in values(&cells.lane(0)).iter().enumerate() {
                let start = (2 * j + k) * side + 2 * i;
                out[start..start + 3].copy_from_slice(values);
            }
        }
        self.recovered = Some(out);
    }
}

/// The largest |v|. Compared as numbers: as integers, as in [`Largest`](crate::discrete::simd::Largest), the whole
/// walk takes a tenth longer; what is no number shows in the sums.
#[inline(always)]
fn largest(v: &[f64]) -> f64 {
    const LANES: usize = 16;
    let larger = |a: f64, b: f64| if a > b { a } else { b };
    let (blocks, rest) = v.as_chunks::<LANES>();
    let mut largest = [0.0; LANES];
    for block in blocks {
        for (largest, v) in largest.iter_mut().zip(block) {
            *largest = larger(v.abs(), *largest);
        }
    }
    rest.iter().map(|v| v.abs()).chain(largest).fold(0.0, larger)
}

/// The work of the reactions `a` at the ends of an edge on the function there, with values `v`.
fn work(v: [f64; 2], a: &[f64], bubble: f64) -> f64 {
    let linear = a[0] * (2.0 * v[0] + v[1]) + a[1] * (v[0] + 2.0 * v[1]);
    linear / 6.0 - bubble * (a[0] + a[1]) / 12.0
}
