//! The sweep over the cells: one pass over the vector, row by row.

use super::cells::{Batch, LANES, Special, Sums, second};
use super::data::{AllCells, Cursor, Run};
use super::flux::{NodeFluxes, Reactions, through_edges};
use super::moments::Moments;
use super::recovery::{Extended, admissible, values};
use super::regular::Regular;
use super::residual::Pyramid;
use super::{NoBound, contact};
use crate::discrete::contact::ContactArc;
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
    pub contact: Vec<ContactArc>,
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
    let contact = contact::arcs(grid, &outer, &reactions.found);
    let walk = Walk::new(&data, Extended::new(grid, v, &reactions), contact, recovered);
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
    v: Extended<'a>,
    /// Rows j to j + 2 of cells, where j is the row at which the walk stands; empty beyond the boundary.
    cells: [Cow<'a, [Run]>; 3],
    /// Fluxes around the nodes of rows j - 1 to j + 2.
    fluxes: [NodeFluxes; 4],
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
    fn new(
        data: &'a AllCells<'a>,
        v: Extended<'a>,
        contact: Vec<ContactArc>,
        recovered: Option<&'a mut [f64]>,
    ) -> Self {
        let (grid, n) = (v.grid, v.grid.cells());
        Self {
            grid,
            data,
            v,
            cells: Default::default(),
            fluxes: [0; 4].map(|_| NodeFluxes::zero(n)),
            special: Vec::new(),
            means: vec![0.0; n],
            pyramid: Pyramid::new(n),
            total: Total { contact, ..Total::default() },
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
        self.fluxes[2].set(&[], &self.cells[1]);
        self.fluxes[3].set(&self.cells[1], &self.cells[2]);
        self.total.largest = largest(self.v.row(0)).max(largest(self.v.row(1)));
        for j in 0..n {
            self.cells.rotate_left(1);
            self.cells[2] = if j + 2 < n { self.data.row(j + 2) } else { Cow::default() };
            self.fluxes.rotate_left(1);
            self.fluxes[3].set(&self.cells[1], &self.cells[2]);
            let ahead = largest(self.v.row(n.min(j + 2)));
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
        self.find_special(j);
        let (row, special) =
            (std::mem::take(&mut self.cells[0]), std::mem::take(&mut self.special));
        // Where a residual can only be a rounding error.
        let floor = 16.0 * f64::EPSILON * self.total.largest;
        let (mut cursor, mut start, mut residual) = (Cursor(&row), 0, false);
        for k in 0..=special.len() {
            let [from, to] = special.get(k).copied().unwrap_or([n, n]);
            while start < from {
                let run = cursor.at(start);
                let mass = run.constant().expect("cells that jumps of f cut are special");
                let cells = start..run.end.min(from);
                let rows = self.v.rows(j);
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
                let mean = self.add_special(i, j, cursor.at(i).moments());
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

    /// Finds the cells of row `j` at the boundary, and those within two cells of a seam of f.
    fn find_special(&mut self, j: usize) {
        let n = self.grid.cells();
        self.special.clear();
        if j == 0 || j == n - 1 || n < LANES + 2 {
            self.special.push([0, n - 1]);
            return;
        }
        self.special.extend([[0, 0], [n - 1, n - 1]]);
        let seams = self.fluxes.iter().flat_map(|row| &row.seams);
        self.special.extend(seams.map(|&[from, to]| [from.saturating_sub(2), (to + 1).min(n - 1)]));
        self.special.sort_unstable();
        self.special.dedup_by(|next, last| {
            let joined = next[0] <= last[1] + 1;
            if joined {
                last[1] = last[1].max(next[1]);
            }
            joined
        });
    }

    /// Adds cell (i, j), and what the reactions on its edges do, to the sums; returns the mean of the residual
    /// times `h^2`.
    #[inline(always)]
    fn add_special(&mut self, i: usize, j: usize, f: Moments) -> f64 {
        let cell = Special { f, ..self.cell(i, j) };
        self.batch.add(&cell);
        self.total.mass += f.square.sqrt();
        if self.outer(i, j).as_flattened().contains(&true) {
            self.add_outer(i, j, &cell);
        }
        cell.residual()
    }

    /// Adds what the reactions on the edges of cell (i, j) do to the sums.
    fn add_outer(&mut self, i: usize, j: usize, cell: &Special) {
        let (outer, Reactions { left, right, bottom, top, .. }) =
            (self.outer(i, j), self.v.reactions);
        let reactions = [[&bottom[i..], &top[i..]], [&left[j..], &right[j..]]];
        for (axis, k) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            if outer[axis][k] {
                let [_, p, q, _] = cell.lines[axis][k];
                self.total.work += work([p, q], reactions[axis][k], cell.bubbles[axis][k]);
                self.total.trace += cell.trace(axis, k);
            }
        }
    }

    /// Which edges of cell (i, j) along x, and along y, are on the boundary.
    #[inline(always)]
    fn outer(&self, i: usize, j: usize) -> [[bool; 2]; 2] {
        let last = self.grid.cells() - 1;
        [[j == 0, j == last], [i == 0, i == last]]
    }

    /// Cell (i, j) with its bubbles, but for f.
    #[inline(always)]
    fn cell(&self, i: usize, j: usize) -> Special {
        let (lines, outer) = (self.v.around(i, j), self.outer(i, j));
        let (flux, bends) = match self.fluxes.iter().any(|row| !row.seams.is_empty()) {
            true => (through_edges(&self.fluxes[1], &self.fluxes[2], i), self.bends(i, j)),
            false => Default::default(),
        };
        let mut bubbles = [[0.0; 2]; 2];
        for axis in 0..2 {
            for k in 0..2 {
                let (line, bend) = (lines[axis][k], bends[axis][k]);
                let bubble = 0.5 * second(line) + bend;
                bubbles[axis][k] = if outer[axis][k] { admissible(bubble, line) } else { bubble };
            }
        }
        Special { lines, bubbles, flux, f: Moments::default() }
    }

    /// What the fluxes that f needs add to the bubbles of cell (i, j) along both axes: half their change over the
    /// cells at the edge, in the mean.
    #[inline(always)]
    fn bends(&self, i: usize, j: usize) -> [[f64; 2]; 2] {
        let n = self.grid.cells();
        let changes = |i: usize, strip: usize| {
            let [left, right, bottom, top] =
                through_edges(&self.fluxes[strip], &self.fluxes[strip + 1], i);
            [right - left, top - bottom]
        };
        let [x, y] = changes(i, 1);
        // Beyond the boundary as here.
        let below = if j > 0 { changes(i, 0)[0] } else { x };
        let above = if j + 1 < n { changes(i, 2)[0] } else { x };
        let left = if i > 0 { changes(i - 1, 1)[1] } else { y };
        let right = if i + 1 < n { changes(i + 1, 1)[1] } else { y };
        [[below, above].map(|near| 0.25 * (x + near)), [left, right].map(|near| 0.25 * (y + near))]
    }

    /// Writes what the recovery is on row `j` of cells to its rows of the grid of half the width.
    fn write_recovered(&mut self, j: usize) {
        let Some(out) = self.recovered.take() else { return };
        let side = 2 * self.grid.cells() + 1;
        for i in 0..self.grid.cells() {
            for (k, values) in values(&self.cell(i, j)).iter().enumerate() {
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
