//! A sequence of half-sweeps and transfers in one walk over the memory.
//!
//! # Algorithm
//! Stages take turns on a few slabs at a time. Stage `k` works on slab `s` after stage `k - 1` has finished slabs
//! `s - 1`, `s` and `s + 1`, so that two sweeps, a residual and a restriction cost one trip to the main memory
//! (temporal blocking). With several threads:
//! 1. Cut the grid into blocks of slabs, and run all stages on each block as far as they do not need its neighbours.
//! 2. Run all stages on the slabs that are left at each seam between two blocks.
//!
//! # Easily broken
//! Red values depend on black ones only, and black values on red ones only. So the order of the slabs, and hence the
//! number of threads, does not change a single bit of the result.

use std::marker::PhantomData;
use std::ops::Range;

use rayon::prelude::*;

use super::blocks::{Cuts, PassOutput, SlabBlock, blocks};
use super::layout::{Dimension, Slab, places_per_slab};
use super::level::MultigridLevel;
use super::rows::{self, CHUNK, Colour};
use super::stencil::{Boundary, LevelEquation, ResidualReport, StencilRow, diagonal, edges};
use super::transfer::{CoarseCorrection, Weighting};
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

    fn reads_or_writes_coarser_grid(self) -> bool {
        matches!(self, Stage::Interpolate | Stage::Correct(_) | Stage::Restrict)
    }
}

/// Number of stages of the longest pass.
const MAX_STAGES: usize = 6;

/// Slabs of each stage of a pass.
type StageSlabs = [Range<usize>; MAX_STAGES];

/// Cost of the restriction of a load in sweeps of the finer grid: formulas of nine points at a quarter of
/// the nodes, of twenty-seven at an eighth.
pub(super) const RESTRICT_LOAD: f64 = 0.5;

/// Work of a pass in sweeps of its own grid.
pub(super) fn work(stages: &[Stage]) -> f64 {
    stages.iter().map(|stage| stage.work()).sum()
}

/// Bytes per node of its own grid that a pass moves if it reads and writes every slab once.
///
/// Red values are never read: each pass begins with a half-sweep that replaces them. Black values that the first
/// stage replaces are not read either. Most processors fetch a cache line before it is overwritten; that is not
/// counted.
pub(super) fn traffic<D: Dimension>(stages: &[Stage]) -> f64 {
    let black = match stages.first() {
        Some(Stage::Interpolate | Stage::StartRed(_)) => 0.0,
        _ => 4.0,
    };
    let (values, load, coarse) = (8.0, 8.0, 8.0 / f64::from(1 << D::AXES));
    let transfers = stages.iter().filter(|stage| stage.reads_or_writes_coarser_grid()).count();
    black + values + load + coarse * transfers as f64
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
pub(super) fn run<D: Weighting>(
    level: &mut MultigridLevel,
    coarse: &mut MultigridLevel,
    problem: LevelProblem,
    stages: &[Stage],
) -> Option<f64> {
    let count = blocks::<D>(level.n);
    level.reserve(count);
    let n = level.n;
    let MultigridLevel { values, load, inverse_diagonal, in_contact, buffers, limit, .. } = level;
    let boundary = match problem {
        LevelProblem::BoundaryLaw => Boundary::Law { limit: *limit },
        LevelProblem::Correction => Boundary::Springs(inverse_diagonal),
    };
    let (load, coarse_values) = (rows::as_slices(load), rows::as_slices(&coarse.values));
    let (equation, dimension) = (LevelEquation { load, boundary }, PhantomData);
    let pass = Pass::<D> { n, stages, equation, coarse_values, dimension };
    let coarse_load = &mut coarse.load;
    let output = PassOutput { n, values, in_contact, coarse_load, buffers };
    let natural = if count == 1 { pass.run_whole(output) } else { pass.run_blocks(output, count) };
    let is_measured =
        problem == LevelProblem::BoundaryLaw && matches!(stages, [.., Stage::Restrict]);
    is_measured.then_some(natural)
}

/// Input of a pass.
struct Pass<'a, D> {
    n: usize,
    stages: &'a [Stage],
    equation: LevelEquation<'a>,
    coarse_values: [&'a [f64]; 2],
    dimension: PhantomData<D>,
}

/// Slabs of one stage in one chunk of a pass.
struct StageChunk {
    slabs: Range<usize>,
    /// First slab of this stage in the block.
    first: usize,
}

impl<D: Weighting> Pass<'_, D> {
    /// Runs all stages in one thread; returns the natural residual.
    fn run_whole(&self, mut output: PassOutput) -> f64 {
        let mut slabs = StageSlabs::default();
        slabs[..self.stages.len()].fill(0..self.n + 1);
        self.run_vectorised(&mut output.whole(), &slabs)
    }

    /// Runs all stages on `count` blocks, then on the seams between them; returns the natural residual.
    fn run_blocks(&self, mut output: PassOutput, count: usize) -> f64 {
        let cuts = Cuts::new(self.n, count);
        let mut blocks = output.split::<D>(&cuts);
        let inside = blocks.par_iter_mut().map(|block| {
            let slabs = self.slabs_inside(&block.slabs);
            self.run_vectorised(block, &slabs)
        });
        let inside = inside.reduce(|| 0.0, max_or_nan);
        let mut blocks = output.split::<D>(&cuts.middles(self.n));
        let between = blocks.par_iter_mut().zip(cuts.inner()).map(|(block, &seam)| {
            let slabs = self.slabs_at_seam(seam);
            self.run_vectorised(block, &slabs)
        });
        max_or_nan(inside, between.reduce(|| 0.0, max_or_nan))
    }

    /// Number of slabs that a stage keeps away from the end of a block; even for the restriction.
    fn margin(&self, stage: usize) -> usize {
        match self.stages[stage] {
            Stage::Restrict => (stage + 2) & !1,
            _ => stage + 1,
        }
    }

    /// Slabs of a block that each stage can complete without the neighbouring blocks.
    fn slabs_inside(&self, block: &Range<usize>) -> StageSlabs {
        let mut slabs = StageSlabs::default();
        for (stage, slabs) in slabs[..self.stages.len()].iter_mut().enumerate() {
            let margin = self.margin(stage);
            let first = if block.start == 0 { 0 } else { block.start + margin };
            let end = if block.end == self.n + 1 { block.end } else { block.end - margin };
            *slabs = first..end;
        }
        slabs
    }

    /// Slabs that each stage has left at the cut before slab `seam`.
    fn slabs_at_seam(&self, seam: usize) -> StageSlabs {
        let mut slabs = StageSlabs::default();
        for (stage, slabs) in slabs[..self.stages.len()].iter_mut().enumerate() {
            let margin = self.margin(stage);
            *slabs = match self.stages[stage] {
                // One coarse slab more on each side, which the blocks could not complete.
                Stage::Restrict => seam - margin - 1..seam + margin + 2,
                _ => seam - margin..seam + margin,
            };
        }
        slabs
    }

    fn run_vectorised(&self, block: &mut SlabBlock, slabs: &StageSlabs) -> f64 {
        vectorised(
            #[inline(always)]
            || self.run_specialised(block, slabs),
        )
    }

    /// Runs all stages on the block, with `n` as a constant on small grids.
    ///
    /// On short rows loop counters and bounds checks take as long as the arithmetic, unless `n` is a constant.
    #[inline(always)]
    fn run_specialised(&self, block: &mut SlabBlock, slabs: &StageSlabs) -> f64 {
        match (D::AXES, self.n) {
            (2, 8) => Self { n: 8, ..*self }.run_slabs(block, slabs),
            (2, 16) => Self { n: 16, ..*self }.run_slabs(block, slabs),
            (2, 32) => Self { n: 32, ..*self }.run_slabs(block, slabs),
            (2, 64) => Self { n: 64, ..*self }.run_slabs(block, slabs),
            _ => self.run_slabs(block, slabs),
        }
    }

    /// Runs all stages on the block, each on its slabs.
    #[inline(always)]
    fn run_slabs(&self, block: &mut SlabBlock, slabs: &StageSlabs) -> f64 {
        let (mut begin, mut end) = (usize::MAX, 0);
        for (lag, (_, slabs)) in self.stages.iter().zip(slabs).enumerate() {
            (begin, end) = (begin.min(slabs.start + lag), end.max(slabs.end + lag));
        }
        // Few enough that all stages together stay in the cache.
        let chunk = CHUNK.div_ceil(places_per_slab::<D>(self.n));
        let mut natural = Largest::default();
        for time in (begin..end).step_by(chunk) {
            for (lag, (stage, slabs)) in self.stages.iter().zip(slabs).enumerate() {
                let from = time.saturating_sub(lag).max(slabs.start);
                let to = (time + chunk).saturating_sub(lag).min(slabs.end);
                let chunk = StageChunk { slabs: from..to, first: slabs.start };
                self.run_stage(block, *stage, chunk, &mut natural);
            }
        }
        natural.value()
    }

    /// Runs one stage on some slabs; `natural` collects the natural residuals.
    #[inline(always)]
    fn run_stage(
        &self,
        block: &mut SlabBlock,
        stage: Stage,
        StageChunk { slabs, first }: StageChunk,
        natural: &mut Largest,
    ) {
        let (n, places, start) = (self.n, places_per_slab::<D>(self.n), block.slabs.start);
        let [red, black] = &mut block.values;
        match stage {
            Stage::Interpolate => {
                for s in slabs {
                    let black = &mut black[(s - start) * places..][..places];
                    block.buffers.interpolate::<D>(Slab { n, s }, self.coarse_values, black);
                }
            }
            Stage::Correct(factor) => {
                let (values, boundary) = (self.coarse_values, self.equation.boundary);
                for s in slabs {
                    let black = &mut black[(s - start) * places..][..places];
                    let correction = CoarseCorrection { values, factor, boundary };
                    block.buffers.correct::<D>(Slab { n, s }, correction, black);
                }
            }
            Stage::StartRed(factor) => {
                for s in slabs {
                    self.start_red(s, factor, &mut red[(s - start) * places..][..places]);
                }
            }
            Stage::Relax(colour, factor) => {
                let (target, other): (_, &[f64]) = match colour {
                    Colour::Red => (red, black),
                    Colour::Black => (black, red),
                };
                let load = self.equation.load[colour as usize];
                for s in slabs {
                    let target = &mut target[(s - start) * places..][..places];
                    for at in (Slab { n, s }).rows::<D>() {
                        let row = StencilRow::new::<D>(at, colour, load, other, start);
                        row.relax::<D>(self.equation.boundary, factor, &mut target[at.in_slab()]);
                    }
                }
            }
            Stage::Restrict => {
                for s in slabs {
                    block.restrict::<D>(Slab { n, s }, first, self.equation, natural);
                }
            }
        }
    }

    #[inline(always)]
    fn start_red(&self, s: usize, factor: f64, target: &mut [f64]) {
        let (factor, places) = (factor / diagonal::<D>(), target.len());
        let load = &self.equation.load[Colour::Red as usize][s * places..][..places];
        for at in (Slab { n: self.n, s }).rows::<D>() {
            let (load, target) = (&load[at.in_slab()], &mut target[at.in_slab()]);
            target.iter_mut().zip(load).for_each(|(value, load)| *value = factor * load);
            for (m, node) in edges::<D>(at, Colour::Red) {
                target[m] = self.equation.boundary.relax::<D>(node, load[m]);
            }
        }
    }
}

/// Natural residual over all nodes: `max |A y - F|` inside, and that of the law on the boundary.
pub(super) fn natural_residual<D: Dimension>(level: &MultigridLevel) -> f64 {
    let places = places_per_slab::<D>(level.n);
    let slabs = in_tasks((0..level.n + 1).into_par_iter(), 2 * places);
    let residuals = slabs.map_init(
        || vec![0.0; places],
        |buffer, s| {
            vectorised(
                #[inline(always)]
                || slab_residual::<D>(level, s, buffer),
            )
        },
    );
    residuals.reduce(|| 0.0, max_or_nan)
}

/// Natural residual of one slab; `buffer` holds one colour of a slab.
#[inline(always)]
fn slab_residual<D: Dimension>(level: &MultigridLevel, s: usize, buffer: &mut [f64]) -> f64 {
    let (n, places) = (level.n, buffer.len());
    let mut natural = Largest::default();
    let mut report = ResidualReport { natural: &mut natural, contact: None };
    for colour in [Colour::Red, Colour::Black] {
        let (own, other) = (colour as usize, &level.values[colour.other() as usize]);
        let values = &level.values[own][s * places..(s + 1) * places];
        for at in (Slab { n, s }).rows::<D>() {
            let row = StencilRow::new::<D>(at, colour, &level.load[own], other, 0);
            let (values, target) = (&values[at.in_slab()], &mut buffer[at.in_slab()]);
            row.residual::<D>(Boundary::Law { limit: level.limit }, values, target, &mut report);
        }
    }
    natural.value()
}

#[cfg(test)]
pub(super) mod tests {
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
    fn after_a_pass<D: Weighting>(n: usize) -> (Vec<Vec<f64>>, Vec<bool>, f64) {
        let (mut level, mut coarse) =
            (MultigridLevel::new::<D>(n), MultigridLevel::new::<D>(n / 2));
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
        let (stages, dimension) = (&stages, PhantomData);
        let pass = Pass::<D> { n, stages, equation, coarse_values, dimension };
        let coarse_load = &mut coarse.load;
        let mut output = PassOutput { n, values, in_contact, coarse_load, buffers };
        let slabs = std::array::from_fn(|_| 0..n + 1);
        let natural = pass.run_specialised(&mut output.whole(), &slabs);
        let fields = level.values.iter().chain(&coarse.load).map(|half| half.to_vec());
        (fields.collect(), level.in_contact, natural)
    }

    /// Fails if vector instructions change a bit of a pass.
    pub(in crate::multigrid) fn compare<D: Weighting>(n: usize) {
        let results = with_each(
            #[inline(always)]
            || after_a_pass::<D>(n),
        );
        assert!(results.iter().all(|result| *result == results[0]));
    }
}
