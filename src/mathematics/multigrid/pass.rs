//! A sequence of half-sweeps and transfers carried through a grid in one walk over the memory.
//!
//! Stages take turns on a few slabs at a time. Stage `k` works on slab `s` when stage `k - 1` has left slabs
//! `s - 1`, `s` and `s + 1`, so that two sweeps, a residual and a restriction cost one trip to the main memory
//! (temporal blocking).
//! Red only depends on black and black on red: the order of the slabs, and hence the number of
//! threads, does not change a single bit of the result.

use std::marker::PhantomData;
use std::ops::Range;

use rayon::prelude::*;

use super::blocks::{Block, Cuts, Target, blocks};
use super::layout::{At, Dimension, slab};
use super::level::Level;
use super::rows::{self, CHUNK, Colour, worse};
use super::stencil::{Boundary, Row, diagonal, edges};
use super::transfer::Weighting;
use crate::discrete::simd::{Largest, vectorised};
use crate::discrete::threads::in_tasks;

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
    /// Residual of the red nodes, full weighting into the load of the coarser grid; the contact set is read.
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
            // Residual of one colour, and long formulas at a quarter of the nodes or fewer.
            Stage::Restrict => 0.75,
        }
    }
}

/// Stages of the longest pass.
const MAX_STAGES: usize = 6;

/// Cost of the restriction of a load in sweeps of the finer grid: formulas of nine points at a quarter of
/// the nodes, of twenty-seven at an eighth.
pub(super) const RESTRICT_LOAD: f64 = 0.5;

/// Work of a pass in sweeps of its own grid.
pub(super) fn work(stages: &[Stage]) -> f64 {
    stages.iter().map(|stage| stage.work()).sum()
}

/// Bytes per node of its own grid that a pass moves if it reads and writes every slab once.
///
/// Red values are never read: each pass begins with a half-sweep that replaces them. What the first
/// stage replaces at the black nodes is not read either. Fetching lines only to overwrite them, which
/// most processors do, is not counted.
pub(super) fn traffic<D: Dimension>(stages: &[Stage]) -> f64 {
    let black = match stages.first() {
        Some(Stage::Interpolate | Stage::StartRed(_)) => 0.0,
        _ => 4.0,
    };
    let (values, load, coarse) = (8.0, 8.0, 8.0 / f64::from(1 << D::AXES));
    let meets =
        |stage: &&Stage| matches!(stage, Stage::Interpolate | Stage::Correct(_) | Stage::Restrict);
    black + values + load + coarse * stages.iter().filter(meets).count() as f64
}

/// What the values of a grid stand for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Problem {
    /// The solution of the Signorini problem of this grid.
    Obstacle,
    /// A correction for a finer grid, linear, with springs on the boundary.
    Correction,
}

/// Runs `stages` on `level`; returns the natural residual `max |min(y, A y - F)|`, inside without the `min`,
/// of the red nodes if the problem is an obstacle problem and the last stage restricts, 0 otherwise.
pub(super) fn run<D: Weighting>(
    level: &mut Level,
    coarse: &mut Level,
    problem: Problem,
    stages: &[Stage],
) -> f64 {
    let count = blocks::<D>(level.n);
    level.reserve(count);
    let n = level.n;
    let Level { values, load, inverse_diagonal, in_contact, buffers, .. } = level;
    let boundary = match problem {
        Problem::Obstacle => Boundary::Obstacle,
        Problem::Correction => Boundary::Springs(inverse_diagonal),
    };
    let (load, coarse_values) = (rows::of(load), rows::of(&coarse.values));
    let walk = Walk::<D> { n, stages, boundary, load, coarse_values, dimension: PhantomData };
    let coarse_load = &mut coarse.load;
    let mut target = Target { n, values, in_contact, coarse_load, buffers };
    if count == 1 {
        return walk.run(&mut target.whole(), &walk.slabs(|_| 0..n + 1));
    }
    // First every block as far as it gets without its neighbours, then the seams between blocks.
    let cuts = Cuts::new(n, count);
    let inside = target
        .split::<D>(&cuts)
        .par_iter_mut()
        .map(|block| {
            let Range { start, end } = block.slabs;
            let slabs = walk.slabs(|stage| {
                let margin = walk.margin(stage);
                let first = if start == 0 { 0 } else { start + margin };
                first..if end == n + 1 { end } else { end - margin }
            });
            walk.run(block, &slabs)
        })
        .reduce(|| 0.0, worse);
    let between = target
        .split::<D>(&cuts.middles(n))
        .par_iter_mut()
        .zip(cuts.inner())
        .map(|(block, &seam)| {
            let slabs = walk.slabs(|stage| {
                let margin = walk.margin(stage);
                match stages[stage] {
                    // One coarse slab more on each side: those the blocks could not complete.
                    Stage::Restrict => seam - margin - 1..seam + margin + 2,
                    _ => seam - margin..seam + margin,
                }
            });
            walk.run(block, &slabs)
        })
        .reduce(|| 0.0, worse);
    worse(inside, between)
}

struct Walk<'a, D> {
    n: usize,
    stages: &'a [Stage],
    boundary: Boundary<'a>,
    load: [&'a [f64]; 2],
    coarse_values: [&'a [f64]; 2],
    dimension: PhantomData<D>,
}

impl<D: Weighting> Walk<'_, D> {
    /// Slabs that a stage keeps away from the end of a block; even for the restriction.
    fn margin(&self, stage: usize) -> usize {
        match self.stages[stage] {
            Stage::Restrict => (stage + 2) & !1,
            _ => stage + 1,
        }
    }

    /// The slabs of each stage.
    fn slabs(&self, of_stage: impl Fn(usize) -> Range<usize>) -> [Range<usize>; MAX_STAGES] {
        std::array::from_fn(|stage| if stage < self.stages.len() { of_stage(stage) } else { 0..0 })
    }

    fn run(&self, block: &mut Block, slabs: &[Range<usize>; MAX_STAGES]) -> f64 {
        vectorised(
            #[inline(always)]
            || self.wave(block, slabs),
        )
    }

    /// Carries all stages through the block, each on its slabs.
    #[inline(always)]
    fn wave(&self, block: &mut Block, slabs: &[Range<usize>; MAX_STAGES]) -> f64 {
        // On short rows counting and checking take as long as the numbers, unless `n` is a constant.
        match (D::AXES, self.n) {
            (2, 8) => Self { n: 8, ..*self }.carry(block, slabs),
            (2, 16) => Self { n: 16, ..*self }.carry(block, slabs),
            (2, 32) => Self { n: 32, ..*self }.carry(block, slabs),
            (2, 64) => Self { n: 64, ..*self }.carry(block, slabs),
            _ => self.carry(block, slabs),
        }
    }

    #[inline(always)]
    fn carry(&self, block: &mut Block, slabs: &[Range<usize>; MAX_STAGES]) -> f64 {
        let stages = || self.stages.iter().zip(slabs).enumerate();
        let begin = stages().map(|(lag, (_, slabs))| slabs.start + lag).min();
        let end = stages().map(|(lag, (_, slabs))| slabs.end + lag).max();
        // So few that all stages together stay in the cache.
        let chunk = CHUNK.div_ceil(slab::<D>(self.n));
        let mut natural = Largest::default();
        for time in (begin.unwrap_or(0)..end.unwrap_or(0)).step_by(chunk) {
            for (lag, (stage, slabs)) in stages() {
                let from = time.saturating_sub(lag).max(slabs.start);
                let to = (time + chunk).saturating_sub(lag).min(slabs.end);
                self.step(block, *stage, from..to, slabs.start, &mut natural);
            }
        }
        natural.value()
    }

    /// One stage on some slabs; `first` is the first slab of this stage, `natural` takes in natural residuals.
    #[inline(always)]
    fn step(
        &self,
        block: &mut Block,
        stage: Stage,
        slabs: Range<usize>,
        first: usize,
        natural: &mut Largest,
    ) {
        let (n, slab, start) = (self.n, slab::<D>(self.n), block.slabs.start);
        let [red, black] = &mut block.values;
        match stage {
            Stage::Interpolate => {
                for s in slabs {
                    let black = &mut black[(s - start) * slab..][..slab];
                    block.buffers.interpolate::<D>((n, s), self.coarse_values, black);
                }
            }
            Stage::Correct(factor) => {
                let (coarse, boundary) = (self.coarse_values, self.boundary);
                for s in slabs {
                    let black = &mut black[(s - start) * slab..][..slab];
                    block.buffers.correct::<D>((n, s), coarse, boundary, factor, black);
                }
            }
            Stage::StartRed(factor) => {
                for s in slabs {
                    self.start_red(s, factor, &mut red[(s - start) * slab..][..slab]);
                }
            }
            Stage::Relax(colour, factor) => {
                let (target, other): (_, &[f64]) = match colour {
                    Colour::Red => (red, black),
                    Colour::Black => (black, red),
                };
                let load = self.load[colour as usize];
                for s in slabs {
                    let target = &mut target[(s - start) * slab..][..slab];
                    for at in At::of_slab::<D>(n, s) {
                        let row = Row::new::<D>(at, colour, load, other, start);
                        row.relax::<D>(self.boundary, factor, &mut target[at.in_slab()]);
                    }
                }
            }
            Stage::Restrict => {
                for s in slabs {
                    block.restrict::<D>((n, s, first), self.boundary, self.load, natural);
                }
            }
        }
    }

    #[inline(always)]
    fn start_red(&self, s: usize, factor: f64, target: &mut [f64]) {
        let (factor, slab) = (factor / diagonal::<D>(), target.len());
        let load = &self.load[Colour::Red as usize][s * slab..][..slab];
        for at in At::of_slab::<D>(self.n, s) {
            let (load, target) = (&load[at.in_slab()], &mut target[at.in_slab()]);
            target.iter_mut().zip(load).for_each(|(value, load)| *value = factor * load);
            for (m, edge) in edges::<D>(at, Colour::Red) {
                target[m] = self.boundary.relax::<D>(edge, load[m]);
            }
        }
    }
}

/// Natural residual `max |min(y, A y - F)|` over all nodes, interior ones without the `min`.
pub(super) fn natural_residual<D: Dimension>(level: &Level) -> f64 {
    let slab = slab::<D>(level.n);
    let slabs = in_tasks((0..level.n + 1).into_par_iter(), 2 * slab);
    let of_slab = |residual: &mut Vec<f64>, s: usize| {
        vectorised(
            #[inline(always)]
            || slab_residual::<D>(level, s, residual),
        )
    };
    slabs.map_init(|| vec![0.0; slab], of_slab).reduce(|| 0.0, worse)
}

/// The natural residual of one slab; `residual` is room for one colour of it.
#[inline(always)]
fn slab_residual<D: Dimension>(level: &Level, s: usize, residual: &mut [f64]) -> f64 {
    let (n, slab) = (level.n, residual.len());
    let mut natural = Largest::default();
    for colour in [Colour::Red, Colour::Black] {
        let (own, other) = (colour as usize, &level.values[colour.other() as usize]);
        let values = &level.values[own][s * slab..(s + 1) * slab];
        for at in At::of_slab::<D>(n, s) {
            let row = Row::new::<D>(at, colour, &level.load[own], other, 0);
            let (values, target) = (&values[at.in_slab()], &mut residual[at.in_slab()]);
            row.residual::<D>(Boundary::Obstacle, values, target, &mut natural, |_, _| ());
        }
    }
    natural.value()
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::discrete::simd::with_each;

    /// Values, coarse load and contact set after a pass, and its natural residual.
    #[inline(always)]
    fn after_a_pass<D: Weighting>(n: usize) -> (Vec<Vec<f64>>, Vec<bool>, f64) {
        let (mut level, mut coarse) = (Level::new::<D>(n), Level::new::<D>(n / 2));
        level.reserve(1);
        let noise = |half: &mut [f64], k: f64| {
            for (i, value) in half.iter_mut().enumerate() {
                *value = libm::sin(k * i as f64 * 12.9898) - 0.2;
            }
        };
        noise(&mut level.values[1], 1.0);
        level.load.iter_mut().for_each(|half| noise(half, 2.0));
        coarse.values.iter_mut().for_each(|half| noise(half, 3.0));
        let stages = [
            Stage::Correct(1.08),
            Stage::Relax(Colour::Red, 1.0),
            Stage::Relax(Colour::Black, 1.15),
            Stage::Relax(Colour::Red, 1.15),
            Stage::Relax(Colour::Black, 1.0),
            Stage::Restrict,
        ];
        let Level { values, load, in_contact, buffers, .. } = &mut level;
        let (load, coarse_values) = (rows::of(load), rows::of(&coarse.values));
        let boundary = Boundary::Obstacle;
        let (stages, dimension) = (&stages, PhantomData);
        let walk = Walk::<D> { n, stages, boundary, load, coarse_values, dimension };
        let coarse_load = &mut coarse.load;
        let mut target = Target { n, values, in_contact, coarse_load, buffers };
        let natural = walk.wave(&mut target.whole(), &walk.slabs(|_| 0..n + 1));
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
