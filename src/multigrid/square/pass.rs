//! A sequence of half-sweeps and transfers carried through a grid in one walk over the memory.
//!
//! Stage `s` works on row `j` as soon as stage `s - 1` has left rows `j - 1`, `j` and `j + 1`, so that
//! two sweeps, a residual and a restriction cost one trip to the main memory (temporal blocking).
//! Red only depends on black and black on red: the order of the rows, and hence the number of
//! threads, does not change a single bit of the result.

use std::ops::Range;

use rayon::prelude::*;

use super::level::Level;
use super::stencil::{Boundary, EdgeNode, Row, perimeter};
use super::transfer::{CoarseRows, Restriction, weigh_load};
use crate::multigrid::rows::{Colour, Rows, deinterleave, long_and_short, max_abs, stride, worse};

/// One step of a pass.
#[derive(Clone, Copy, Debug)]
pub(super) enum Stage {
    /// Black values become the interpolated values of the coarser grid.
    Interpolate,
    /// The interpolated correction, times the factor, is added to the black values that are not in
    /// contact.
    Correct(f64),
    /// Red values become those that one relaxation by the given factor makes from zero.
    StartRed(f64),
    /// Half-sweep over one colour; the factor acts inside, boundary unknowns are minimised exactly.
    Relax(Colour, f64),
    /// Residual of the red nodes, full weighting into the load of the coarser grid.
    ///
    /// Must follow `Relax(Black, 1.0)`, which leaves no residual at the black nodes.
    Restrict,
}

impl Stage {
    /// Cost in sweeps of the same grid: visits of unknowns; two-point formulas count half a visit.
    fn work(self) -> f64 {
        match self {
            Stage::Interpolate | Stage::Correct(_) | Stage::StartRed(_) => 0.25,
            Stage::Relax(..) => 0.5,
            // Residual of one colour, and five-point formulas at a quarter of the nodes.
            Stage::Restrict => 0.75,
        }
    }
}

/// Cost of [`restrict_load`] in sweeps of the finer grid: nine-point formulas at a quarter of the nodes.
pub(super) const RESTRICT_LOAD: f64 = 0.5;

/// Work of a pass in sweeps of its own grid.
pub(super) fn work(stages: &[Stage]) -> f64 {
    stages.iter().map(|stage| stage.work()).sum()
}

/// Bytes per node of its own grid that a pass moves if it reads and writes every row once.
///
/// Red values are never read: each pass begins with a half-sweep that replaces them. What the first
/// stage replaces at the black nodes is not read either. Fetching lines only to overwrite them, which
/// most processors do, is not counted.
pub(super) fn traffic(stages: &[Stage]) -> f64 {
    let black = match stages.first() {
        Some(Stage::Interpolate | Stage::StartRed(_)) => 0.0,
        _ => 4.0,
    };
    let (values, load, quarter) = (8.0, 8.0, 2.0);
    let coarse =
        |stage: &&Stage| matches!(stage, Stage::Interpolate | Stage::Correct(_) | Stage::Restrict);
    black + values + load + quarter * stages.iter().filter(coarse).count() as f64
}

/// What the values of a grid stand for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Problem {
    /// The solution of the Signorini problem of this grid.
    Obstacle,
    /// A correction for a finer grid, linear, with springs on the boundary.
    Correction,
}

/// Grids with fewer cells per side are walked by one thread: waking the others takes longer.
const PARALLEL_FROM: usize = 256;
/// Rows per block at least; must exceed twice the number of stages by a good margin.
const MIN_BLOCK_ROWS: usize = 64;

/// Runs `stages` on `level`; returns the natural residual `max |min(y, A y - F)|`, interior rows
/// without the `min`, of the red nodes if the last stage restricts, 0 otherwise.
pub(super) fn run(
    level: &mut Level,
    coarse: &mut Level,
    problem: Problem,
    stages: &[Stage],
) -> f64 {
    let n = level.n;
    let Level { values, load, inverse_diagonal, .. } = level;
    let boundary = match problem {
        Problem::Obstacle => Boundary::Obstacle,
        Problem::Correction => Boundary::Springs(inverse_diagonal),
    };
    let walk = Walk { n, stages, boundary, load, coarse_values: &coarse.values };
    let threads = rayon::current_num_threads();
    let blocks = if threads == 1 || n < PARALLEL_FROM {
        1
    } else {
        (4 * threads).min((n + 1) / MIN_BLOCK_ROWS)
    };
    if blocks == 1 {
        let whole = &Cuts(vec![0, n + 1]);
        let mut jobs = walk.split(values, &mut coarse.load, whole);
        return walk.run(&mut jobs[0], |_| 0..n + 1);
    }
    // First every block as far as it gets without its neighbours, then the seams between blocks.
    let cuts = Cuts((0..blocks).map(|b| (b * n / blocks) & !1).chain([n + 1]).collect());
    let seams = cuts.middles(n);
    let inside = walk
        .split(values, &mut coarse.load, &cuts)
        .par_iter_mut()
        .map(|job| {
            let Range { start, end } = job.rows;
            walk.run(job, |stage| {
                let margin = walk.margin(stage);
                let first = if start == 0 { 0 } else { start + margin };
                first..if end == n + 1 { end } else { end - margin }
            })
        })
        .reduce(|| 0.0, worse);
    let between = walk
        .split(values, &mut coarse.load, &seams)
        .par_iter_mut()
        .zip(&cuts.0[1..])
        .map(|(job, &seam)| {
            walk.run(job, |stage| {
                let margin = walk.margin(stage);
                match stages[stage] {
                    // One coarse row more on each side: those the blocks could not complete.
                    Stage::Restrict => seam - margin - 1..seam + margin + 2,
                    _ => seam - margin..seam + margin,
                }
            })
        })
        .reduce(|| 0.0, worse);
    worse(inside, between)
}

/// Rows at which the grid is cut: all even, except the last, `n + 1`.
struct Cuts(Vec<usize>);

impl Cuts {
    /// Cuts in the middle of the blocks: one piece around every inner cut.
    fn middles(&self, n: usize) -> Cuts {
        let inner = &self.0[1..self.0.len() - 1];
        let between = inner.windows(2).map(|pair| ((pair[0] + pair[1]) / 2) & !1);
        Cuts([0].into_iter().chain(between).chain([n + 1]).collect())
    }

    /// Splits rows of `stride` numbers; `scale` is 2 to cut the rows of the coarser grid.
    fn split<'a>(
        &self,
        mut rows: &'a mut [f64],
        stride: usize,
        scale: usize,
    ) -> Vec<&'a mut [f64]> {
        let mut pieces = Vec::with_capacity(self.0.len());
        for pair in self.0.windows(2) {
            let height = pair[1].div_ceil(scale) - pair[0].div_ceil(scale);
            let (piece, rest) = rows.split_at_mut(height * stride);
            pieces.push(piece);
            rows = rest;
        }
        pieces
    }
}

/// A run of rows of both colours, with the coarse rows it may write.
struct Job<'a> {
    rows: Range<usize>,
    values: [&'a mut [f64]; 2],
    coarse_load: [&'a mut [f64]; 2],
}

struct Walk<'a> {
    n: usize,
    stages: &'a [Stage],
    boundary: Boundary<'a>,
    load: &'a [Rows; 2],
    coarse_values: &'a [Rows; 2],
}

impl Walk<'_> {
    /// Rows that a stage keeps away from the end of a block; even for the restriction.
    fn margin(&self, stage: usize) -> usize {
        match self.stages[stage] {
            Stage::Restrict => (stage + 2) & !1,
            _ => stage + 1,
        }
    }

    fn split<'a>(
        &self,
        values: &'a mut [Rows; 2],
        coarse_load: &'a mut [Rows; 2],
        cuts: &Cuts,
    ) -> Vec<Job<'a>> {
        let (stride, coarse_stride) = (stride(self.n), stride(self.n / 2));
        let [red, black] = values;
        let [coarse_red, coarse_black] = coarse_load;
        let fine = cuts.split(red, stride, 1).into_iter().zip(cuts.split(black, stride, 1));
        let coarse = (cuts.split(coarse_red, coarse_stride, 2).into_iter()).zip(cuts.split(
            coarse_black,
            coarse_stride,
            2,
        ));
        (cuts.0.windows(2).zip(fine).zip(coarse))
            .map(|((pair, fine), coarse)| Job {
                rows: pair[0]..pair[1],
                values: [fine.0, fine.1],
                coarse_load: [coarse.0, coarse.1],
            })
            .collect()
    }

    /// Carries all stages through the job as a wave; `rows_of` gives the rows of each stage.
    ///
    /// With AVX2 the same operations in the same order are a quarter faster; the bits agree.
    fn run(&self, job: &mut Job, rows_of: impl Fn(usize) -> Range<usize>) -> f64 {
        #[cfg(target_arch = "x86_64")]
        if std::arch::is_x86_feature_detected!("avx2") {
            // SAFETY: the processor has the only feature that the function is compiled for.
            return unsafe { self.run_avx2(job, rows_of) };
        }
        self.run_portable(job, rows_of)
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2")]
    fn run_avx2(&self, job: &mut Job, rows_of: impl Fn(usize) -> Range<usize>) -> f64 {
        self.run_portable(job, rows_of)
    }

    #[inline(always)]
    fn run_portable(&self, job: &mut Job, rows_of: impl Fn(usize) -> Range<usize>) -> f64 {
        let (stride, coarse_stride) = (stride(self.n), stride(self.n / 2));
        let mut corrections = CoarseRows::new(self.n / 2, self.coarse_values);
        let mut restriction = Restriction::new(self.n);
        let ranges: Vec<_> = (0..self.stages.len()).map(rows_of).collect();
        let first = ranges.iter().enumerate().map(|(s, rows)| rows.start + s).min();
        let last = ranges.iter().enumerate().map(|(s, rows)| rows.end + s).max();
        for time in first.unwrap_or(0)..last.unwrap_or(0) {
            for (lag, (stage, rows)) in self.stages.iter().zip(&ranges).enumerate() {
                if time < lag || !rows.contains(&(time - lag)) {
                    continue;
                }
                let j = time - lag;
                match *stage {
                    Stage::Interpolate => {
                        let target = row_mut(job.values[1], j - job.rows.start, stride);
                        corrections.interpolate(j, target);
                    }
                    Stage::Correct(factor) => {
                        let target = row_mut(job.values[1], j - job.rows.start, stride);
                        corrections.correct((self.n, j), self.boundary, factor, target);
                    }
                    Stage::StartRed(factor) => {
                        let target = row_mut(job.values[0], j - job.rows.start, stride);
                        self.start_red(j, factor, target);
                    }
                    Stage::Relax(colour, factor) => {
                        let [red, black] = &mut job.values;
                        let (own, other) = match colour {
                            Colour::Red => (red, &**black),
                            Colour::Black => (black, &**red),
                        };
                        let target = row_mut(own, j - job.rows.start, stride);
                        self.relax(
                            Row::new(self.n, j, colour, self.load, other, job.rows.start),
                            factor,
                            target,
                        );
                    }
                    Stage::Restrict => {
                        let [red, black] = &job.values;
                        let local = j - job.rows.start;
                        let red = &red[local * stride..(local + 1) * stride];
                        let row =
                            Row::new(self.n, j, Colour::Red, self.load, black, job.rows.start);
                        let first_coarse = job.rows.start.div_ceil(2);
                        let [coarse_red, coarse_black] = &mut job.coarse_load;
                        restriction.add_row(row, self.boundary, red, rows.start, move |coarse_j| {
                            let at = coarse_j - first_coarse;
                            [
                                row_mut(coarse_red, at, coarse_stride),
                                row_mut(coarse_black, at, coarse_stride),
                            ]
                        });
                    }
                }
            }
        }
        restriction.natural_residual
    }

    #[inline(always)]
    fn relax(&self, row: Row, factor: f64, target: &mut [f64]) {
        let edge = |node, _, sum| self.boundary.relax(node, sum);
        if factor == 1.0 {
            row.update(target, |_, sum| 0.25 * sum, edge);
        } else {
            let (keep, take) = (1.0 - factor, 0.25 * factor);
            row.update(target, |value, sum| keep * value + take * sum, edge);
        }
    }

    #[inline(always)]
    fn start_red(&self, j: usize, factor: f64, target: &mut [f64]) {
        let stride = target.len();
        let load = &self.load[Colour::Red as usize][j * stride..(j + 1) * stride];
        for (value, load) in target.iter_mut().zip(load) {
            *value = 0.25 * factor * load;
        }
        let n = self.n;
        let mut on_boundary = |k: usize, i: usize| {
            let node = EdgeNode { perimeter: perimeter(n, i, j), inverse_diagonal: 0.5 };
            target[k] = self.boundary.relax(node, load[k]);
        };
        if j == 0 || j == n {
            (0..n / 2 + 1).for_each(|k| on_boundary(k, 2 * k));
        } else if Colour::Red.first_column(j) == 0 {
            on_boundary(0, 0);
            on_boundary(n / 2, n);
        }
    }
}

#[inline(always)]
fn row_mut(rows: &mut [f64], j: usize, stride: usize) -> &mut [f64] {
    &mut rows[j * stride..(j + 1) * stride]
}

/// Natural residual `max |min(y, A y - F)|` over all nodes, interior ones without the `min`.
pub(super) fn natural_residual(level: &Level) -> f64 {
    let (n, stride) = (level.n, level.stride());
    let of_row = |j: usize| {
        let mut residual = vec![0.0; stride];
        let of_colour = |colour: Colour| {
            let own = &level.values[colour as usize][j * stride..(j + 1) * stride];
            let other = &level.values[colour.other() as usize];
            residual.copy_from_slice(own);
            let row = Row::new(n, j, colour, &level.load, other, 0);
            row.replace_by_residual(Boundary::Obstacle, &mut residual)
        };
        Colour::BOTH.map(of_colour).into_iter().fold(0.0, worse)
    };
    (0..n + 1).into_par_iter().with_min_len(MIN_BLOCK_ROWS).map(of_row).reduce(|| 0.0, worse)
}

/// Load of the coarser grid: full weighting of the load of the finer one.
pub(super) fn restrict_load(fine: &Level, coarse: &mut Level) {
    let stride = coarse.stride();
    let [red, black] = &mut coarse.load;
    coarse.load_scale = red
        .par_chunks_exact_mut(stride)
        .zip(black.par_chunks_exact_mut(stride))
        .enumerate()
        .with_min_len(MIN_BLOCK_ROWS)
        .map(|(j, (red, black))| {
            let [long, short] = long_and_short(j, [red, black]);
            let mut row = vec![0.0; fine.n / 2 + 1];
            weigh_load(fine, j, &mut row);
            deinterleave(&row, long, short);
            max_abs(&row)
        })
        .reduce(|| 0.0, worse);
}
