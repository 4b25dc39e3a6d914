//! A sequence of half-sweeps and transfers in one walk over the memory.
//!
//! # Algorithm
//! Stages take turns on a few rows at a time. Stage `k` works on row `j` after stage `k - 1` has finished rows
//! `j - 1`, `j` and `j + 1`, so that two sweeps, a residual and a restriction cost one trip to the main memory
//! (temporal blocking). With several threads:
//! 1. Cut the grid into blocks of rows, and run all stages on each block as far as they do not need its neighbours.
//! 2. Run all stages on the rows that are left at each seam between two blocks.
//!
//! # Easily broken
//! Red values depend on black ones only, and black values on red ones only. So the order of the rows, and hence the
//! number of threads, does not change a single bit of the result.

use std::ops::Range;

use rayon::prelude::*;

use super::blocks::{Cuts, PassOutput, RowBlock, blocks};
use super::level::MultigridLevel;
use super::rows::{self, CHUNK, Colour, GridRow, stride};
use super::stencil::{Boundary, INVERSE, LevelEquation, ResidualReport, StencilRow, edges};
use super::transfer::CoarseCorrection;
use crate::machine::extremes::max_or_nan;
use crate::machine::simd::{Largest, vectorised};
use crate::machine::threads::in_tasks;

/// One step of a pass.
#[derive(Clone, Copy, Debug)]
pub(super) enum Stage {
    /// Sets the black values to the interpolated values of the coarser grid.
    Interpolate,
    /// Adds the interpolated correction, times the factor, to the black values that are not in contact.
    Correct(f64),
    /// Sets the red values to the result of one relaxation from zero by the given factor.
    StartRed(f64),
    /// Half-sweep over one colour. The factor is applied inside; boundary unknowns are minimised exactly.
    Relax(Colour, f64),
    /// Restricts the residual of the red nodes to the load of the coarser grid, and sets the contact flags.
    ///
    /// Must follow `Relax(Black, 1.0)`, which leaves no residual at the black nodes.
    Restrict,
}

impl Stage {
    /// Cost in sweeps of the same grid: visits of unknowns, where two-point formulas count half a visit.
    fn work(self) -> f64 {
        match self {
            Stage::Interpolate | Stage::Correct(_) | Stage::StartRed(_) => 0.25,
            Stage::Relax(..) => 0.5,
            // Residual of one colour, and long formulas at a quarter of the nodes or fewer.
            Stage::Restrict => 0.75,
        }
    }
}

/// Number of stages of the longest pass.
const MAX_STAGES: usize = 6;

/// Rows of each stage of a pass.
type StageRows = [Range<usize>; MAX_STAGES];

/// Cost of the restriction of a load in sweeps of the finer grid: formulas of nine points at a quarter of
/// the nodes.
pub(super) const RESTRICT_LOAD: f64 = 0.5;

/// Work of a pass in sweeps of its own grid.
pub(super) fn work(stages: &[Stage]) -> f64 {
    stages.iter().map(|stage| stage.work()).sum()
}

/// Problem of which the values of a grid are the unknowns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum LevelProblem {
    /// The problem of this grid, under the law.
    BoundaryLaw,
    /// A correction for a finer grid: linear, with springs on the boundary.
    Correction,
}

/// Runs `stages` on `level`.
///
/// If the problem is that under the law and the last stage restricts, returns the natural residual of the red nodes;
/// otherwise `None`.
pub(super) fn run(
    level: &mut MultigridLevel,
    coarse: &mut MultigridLevel,
    problem: LevelProblem,
    stages: &[Stage],
) -> Option<f64> {
    let count = blocks(level.n);
    level.reserve(count);
    let n = level.n;
    let MultigridLevel { values, load, inverse_diagonal, in_contact, buffers, limit, .. } = level;
    let boundary = match problem {
        LevelProblem::BoundaryLaw => Boundary::Law { limit: *limit },
        LevelProblem::Correction => Boundary::Springs(inverse_diagonal),
    };
    let (load, coarse_values) = (rows::as_slices(load), rows::as_slices(&coarse.values));
    let pass = Pass { n, stages, equation: LevelEquation { load, boundary }, coarse_values };
    let coarse_load = &mut coarse.load;
    let output = PassOutput { n, values, in_contact, coarse_load, buffers };
    let natural = if count == 1 { pass.run_whole(output) } else { pass.run_blocks(output, count) };
    let is_measured =
        problem == LevelProblem::BoundaryLaw && matches!(stages, [.., Stage::Restrict]);
    is_measured.then_some(natural)
}

/// Input of a pass.
struct Pass<'a> {
    n: usize,
    stages: &'a [Stage],
    equation: LevelEquation<'a>,
    coarse_values: [&'a [f64]; 2],
}

/// Rows of one stage in one chunk of a pass.
struct StageChunk {
    rows: Range<usize>,
    /// First row of this stage in the block.
    first: usize,
}

impl Pass<'_> {
    /// Runs all stages in one thread; returns the natural residual.
    fn run_whole(&self, mut output: PassOutput) -> f64 {
        let mut rows = StageRows::default();
        rows[..self.stages.len()].fill(0..self.n + 1);
        self.run_vectorised(&mut output.whole(), &rows)
    }

    /// Runs all stages on `count` blocks, then on the seams between them; returns the natural residual.
    fn run_blocks(&self, mut output: PassOutput, count: usize) -> f64 {
        let cuts = Cuts::new(self.n, count);
        let mut blocks = output.split(&cuts);
        let inside = blocks.par_iter_mut().map(|block| {
            let rows = self.rows_inside(&block.rows);
            self.run_vectorised(block, &rows)
        });
        let inside = inside.reduce(|| 0.0, max_or_nan);
        let mut blocks = output.split(&cuts.middles(self.n));
        let between = blocks.par_iter_mut().zip(cuts.inner()).map(|(block, &seam)| {
            let rows = self.rows_at_seam(seam);
            self.run_vectorised(block, &rows)
        });
        max_or_nan(inside, between.reduce(|| 0.0, max_or_nan))
    }

    /// Number of rows that a stage keeps away from the end of a block; even for the restriction.
    fn margin(&self, stage: usize) -> usize {
        match self.stages[stage] {
            Stage::Restrict => (stage + 2) & !1,
            _ => stage + 1,
        }
    }

    /// Rows of a block that each stage can complete without the neighbouring blocks.
    fn rows_inside(&self, block: &Range<usize>) -> StageRows {
        let mut rows = StageRows::default();
        for (stage, rows) in rows[..self.stages.len()].iter_mut().enumerate() {
            let margin = self.margin(stage);
            let first = if block.start == 0 { 0 } else { block.start + margin };
            let end = if block.end == self.n + 1 { block.end } else { block.end - margin };
            *rows = first..end;
        }
        rows
    }

    /// Rows that each stage has left at the cut before row `seam`.
    fn rows_at_seam(&self, seam: usize) -> StageRows {
        let mut rows = StageRows::default();
        for (stage, rows) in rows[..self.stages.len()].iter_mut().enumerate() {
            let margin = self.margin(stage);
            *rows = match self.stages[stage] {
                // One coarse row more on each side, which the blocks could not complete.
                Stage::Restrict => seam - margin - 1..seam + margin + 2,
                _ => seam - margin..seam + margin,
            };
        }
        rows
    }

    fn run_vectorised(&self, block: &mut RowBlock, rows: &StageRows) -> f64 {
        vectorised(
            #[inline(always)]
            || self.run_specialised(block, rows),
        )
    }

    /// Runs all stages on the block, with `n` as a constant on small grids.
    ///
    /// On short rows loop counters and bounds checks take as long as the arithmetic, unless `n` is a constant.
    #[inline(always)]
    fn run_specialised(&self, block: &mut RowBlock, rows: &StageRows) -> f64 {
        match self.n {
            8 => Self { n: 8, ..*self }.run_rows(block, rows),
            16 => Self { n: 16, ..*self }.run_rows(block, rows),
            32 => Self { n: 32, ..*self }.run_rows(block, rows),
            64 => Self { n: 64, ..*self }.run_rows(block, rows),
            _ => self.run_rows(block, rows),
        }
    }

    /// Runs all stages on the block, each on its rows.
    #[inline(always)]
    fn run_rows(&self, block: &mut RowBlock, rows: &StageRows) -> f64 {
        let (mut begin, mut end) = (usize::MAX, 0);
        for (lag, (_, rows)) in self.stages.iter().zip(rows).enumerate() {
            (begin, end) = (begin.min(rows.start + lag), end.max(rows.end + lag));
        }
        // Few enough that all stages together stay in the cache.
        let chunk = CHUNK.div_ceil(stride(self.n));
        let mut natural = Largest::default();
        for time in (begin..end).step_by(chunk) {
            for (lag, (stage, rows)) in self.stages.iter().zip(rows).enumerate() {
                let from = time.saturating_sub(lag).max(rows.start);
                let to = (time + chunk).saturating_sub(lag).min(rows.end);
                let chunk = StageChunk { rows: from..to, first: rows.start };
                self.run_stage(block, *stage, chunk, &mut natural);
            }
        }
        natural.value()
    }

    /// Runs one stage on some rows; `natural` collects the natural residuals.
    #[inline(always)]
    fn run_stage(
        &self,
        block: &mut RowBlock,
        stage: Stage,
        StageChunk { rows, first }: StageChunk,
        natural: &mut Largest,
    ) {
        let (n, stride, start) = (self.n, stride(self.n), block.rows.start);
        let [red, black] = &mut block.values;
        match stage {
            Stage::Interpolate => {
                for j in rows {
                    let black = &mut black[(j - start) * stride..][..stride];
                    block.buffers.interpolate(GridRow { n, j }, self.coarse_values, black);
                }
            }
            Stage::Correct(factor) => {
                let (values, boundary) = (self.coarse_values, self.equation.boundary);
                for j in rows {
                    let black = &mut black[(j - start) * stride..][..stride];
                    let correction = CoarseCorrection { values, factor, boundary };
                    block.buffers.correct(GridRow { n, j }, correction, black);
                }
            }
            Stage::StartRed(factor) => {
                for j in rows {
                    let target = &mut red[(j - start) * stride..][..stride];
                    self.start_red(GridRow { n, j }, factor, target);
                }
            }
            Stage::Relax(colour, factor) => {
                let (target, other): (_, &[f64]) = match colour {
                    Colour::Red => (red, black),
                    Colour::Black => (black, red),
                };
                let load = self.equation.load[colour as usize];
                for j in rows {
                    let target = &mut target[(j - start) * stride..][..stride];
                    let stencil = StencilRow::new(GridRow { n, j }, colour, load, other, start);
                    stencil.relax(self.equation.boundary, factor, target);
                }
            }
            Stage::Restrict => {
                for j in rows {
                    block.restrict(GridRow { n, j }, first, self.equation, natural);
                }
            }
        }
    }

    #[inline(always)]
    fn start_red(&self, row: GridRow, factor: f64, target: &mut [f64]) {
        let load = row.of(self.equation.load[Colour::Red as usize], 0);
        let factor = factor * INVERSE;
        target.iter_mut().zip(load).for_each(|(value, load)| *value = factor * load);
        for (m, node) in edges(row, Colour::Red) {
            target[m] = self.equation.boundary.relax(node, load[m]);
        }
    }
}

/// Natural residual over all nodes: `max |A y - F|` inside, and that of the law on the boundary.
pub(super) fn natural_residual(level: &MultigridLevel) -> f64 {
    let stride = stride(level.n);
    let rows = in_tasks((0..level.n + 1).into_par_iter(), 2 * stride);
    let residuals = rows.map_init(
        || vec![0.0; stride],
        |buffer, j| {
            vectorised(
                #[inline(always)]
                || row_residual(level, j, buffer),
            )
        },
    );
    residuals.reduce(|| 0.0, max_or_nan)
}

/// Natural residual of one row; `buffer` holds one colour of a row.
#[inline(always)]
fn row_residual(level: &MultigridLevel, j: usize, buffer: &mut [f64]) -> f64 {
    let row = GridRow { n: level.n, j };
    let mut natural = Largest::default();
    let mut report = ResidualReport { natural: &mut natural, contact: None };
    for colour in [Colour::Red, Colour::Black] {
        let (own, other) = (colour as usize, &level.values[colour.other() as usize]);
        let stencil = StencilRow::new(row, colour, &level.load[own], other, 0);
        let (values, boundary) =
            (row.of(&level.values[own], 0), Boundary::Law { limit: level.limit });
        stencil.residual(boundary, values, buffer, &mut report);
    }
    natural.value()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::machine::simd::with_each;

    /// Fills a field with numbers of both signs that differ for each `k`.
    #[inline(always)]
    fn fill_with_noise(half: &mut [f64], k: f64) {
        for (i, value) in half.iter_mut().enumerate() {
            *value = libm::sin(k * i as f64 * 12.9898) - 0.2;
        }
    }

    /// Values, coarse load and contact set after a pass, and its natural residual.
    #[inline(always)]
    fn after_a_pass(n: usize) -> (Vec<Vec<f64>>, Vec<bool>, f64) {
        let (mut level, mut coarse) = (MultigridLevel::new(n), MultigridLevel::new(n / 2));
        level.reserve(1);
        fill_with_noise(&mut level.values[1], 1.0);
        level.load.iter_mut().for_each(|half| fill_with_noise(half, 2.0));
        coarse.values.iter_mut().for_each(|half| fill_with_noise(half, 3.0));
        let stages = [
            Stage::Correct(1.08),
            Stage::Relax(Colour::Red, 1.0),
            Stage::Relax(Colour::Black, 1.15),
            Stage::Relax(Colour::Red, 1.15),
            Stage::Relax(Colour::Black, 1.0),
            Stage::Restrict,
        ];
        let MultigridLevel { values, load, in_contact, buffers, .. } = &mut level;
        let (load, coarse_values) = (rows::as_slices(load), rows::as_slices(&coarse.values));
        let equation = LevelEquation { load, boundary: Boundary::Law { limit: f64::INFINITY } };
        let pass = Pass { n, stages: &stages, equation, coarse_values };
        let coarse_load = &mut coarse.load;
        let mut output = PassOutput { n, values, in_contact, coarse_load, buffers };
        let rows = std::array::from_fn(|_| 0..n + 1);
        let natural = pass.run_specialised(&mut output.whole(), &rows);
        let fields = level.values.iter().chain(&coarse.load).map(|half| half.to_vec());
        (fields.collect(), level.in_contact, natural)
    }

    #[test]
    fn vector_instructions_do_not_change_a_bit() {
        for n in [32, 36, 128] {
            let results = with_each(
                #[inline(always)]
                || after_a_pass(n),
            );
            assert!(results.iter().all(|result| *result == results[0]), "{n}");
        }
    }
}
