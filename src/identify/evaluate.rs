//! One candidate against one table: forced and free runs, grid by grid.

use super::space::Geometry;
use super::variant::{ResidualTime, Variant};
use super::{COARSEST, IdentifyError, Target};
use crate::discrete::grid::Grid;
use crate::discrete::load::load;
use crate::discrete::transfer::Prolongation;
use crate::saddle::batch::{AsDefined, LANES, Lanes, Measure};
use crate::saddle::{Pair, tolerance};
use rayon::prelude::*;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Misfit of a stop that comes too early, beyond what the measure lacks.
const EARLY: f64 = 0.02;
/// Largest misfit of one cell; beyond it the size says nothing.
const CELL_CAP: f64 = 3.0;
/// Iterations a free run makes on a grid, in multiples of the largest published count, plus this many.
const FREE_FACTOR: usize = 4;
const FREE_EXTRA: usize = 20;

/// When a forced run is given up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limit {
    /// Total misfit above which nothing more is wanted.
    pub misfit: f64,
    /// Number of coarse grids on which no misfit at all is allowed.
    pub exact_grids: usize,
}

impl Limit {
    /// The run goes to its end.
    pub const NONE: Self = Self { misfit: f64::INFINITY, exact_grids: 0 };
    /// The run ends at the first count that does not come out.
    pub const EXACT: Self = Self { misfit: 0.0, exact_grids: 0 };
}

/// What a forced run says: how far each published count is from coming out.
#[derive(Clone, Debug, PartialEq)]
pub struct Forced {
    /// `misfit[k][level]`: zero if and only if row k stops there at the published count, given
    /// that it did so on the coarser grids.
    pub misfit: Vec<Vec<f64>>,
    /// Change of the multiplier in the last iteration on the finest grid, one per row; empty if the
    /// run was cut short.
    pub delta_a: Vec<f64>,
    /// Grids run to the end before the misfit passed the limit.
    pub levels: usize,
    /// Sum of all entries of `misfit`.
    pub total: f64,
}

impl Forced {
    /// Whether every count comes out.
    pub fn is_exact(&self) -> bool {
        self.total == 0.0 && !self.delta_a.is_empty()
    }
}

/// A table as the iteration gives it, when it stops by itself.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// `counts[k][level]`; `None` where the iteration was given up.
    pub counts: Vec<Vec<Option<usize>>>,
    /// Last change of the multiplier on the finest grid, one per row.
    pub delta_a: Vec<f64>,
}

/// Runs candidates of some geometries under one variant against one table, in the lanes of [`Lanes`].
///
/// Everything that does not depend on the values of f is prepared once: the load vectors of the
/// pieces, of which that of f is the combination, and all buffers. Clone it for another thread.
pub struct Evaluator<'a> {
    target: &'a Target,
    variant: Variant,
    prolongation: Prolongation,
    /// `basis[geometry][level][p]`: load vector of the indicator of piece p.
    basis: Arc<Vec<Vec<Vec<Vec<f64>>>>>,
    levels: Vec<Level>,
    entered: Vec<u64>,
    /// When set, forced runs and screenings are given up.
    halt: Option<&'a AtomicBool>,
}

/// A grid with the iterates on it.
struct Level {
    grid: Grid,
    lanes: Lanes<f64>,
    /// In each lane, the node that last failed the comparison: the likeliest to fail next.
    witness: [usize; LANES],
    load: Vec<f64>,
}

/// What a lane runs: values of f, one per piece, and a row of the table.
#[derive(Clone, Copy)]
struct Entry<'v> {
    values: &'v [f64],
    row: usize,
}

impl<'a> Evaluator<'a> {
    /// Prepares the load vectors and buffers.
    ///
    /// # Errors
    /// [`IdentifyError`] if the target is not a table.
    pub fn new(
        target: &'a Target,
        variant: &Variant,
        geometries: &[Geometry],
    ) -> Result<Self, IdentifyError> {
        target.validate()?;
        let (against_x, against_y) = variant.mirrored();
        let basis = |geometry: &Geometry, level: usize| -> Vec<Vec<f64>> {
            let grid = grid(level);
            let turn = |v: Vec<f64>| mirror(grid, v, against_x, against_y);
            let piece = |p| turn(load(grid, &geometry.indicator(p), variant.load));
            (0..geometry.pieces()).map(piece).collect()
        };
        let levels = |geometry| (0..target.levels()).map(|level| basis(geometry, level)).collect();
        let basis: Vec<_> = geometries.iter().map(levels).collect();
        Ok(Self::with_basis(target, *variant, basis.into()))
    }

    fn with_basis(
        target: &'a Target,
        variant: Variant,
        basis: Arc<Vec<Vec<Vec<Vec<f64>>>>>,
    ) -> Self {
        let (against_x, against_y) = variant.mirrored();
        let prolongation = match variant.prolongation {
            // Turning the square over once swaps its diagonals.
            Prolongation::RisingDiagonal if against_x != against_y => Prolongation::FallingDiagonal,
            Prolongation::FallingDiagonal if against_x != against_y => Prolongation::RisingDiagonal,
            rule => rule,
        };
        let level = |level| {
            let grid = grid(level);
            let lanes = Lanes::new(grid, variant.order, variant.corner_weight());
            Level { grid, lanes, witness: [0; LANES], load: vec![0.0; grid.nodes()] }
        };
        let levels = (0..target.levels()).map(level).collect();
        let entered = vec![0; target.levels()];
        Self { target, variant, prolongation, levels, basis, entered, halt: None }
    }

    /// The same, but that a forced run ends as one that misses every count once `halt` is set.
    pub fn halted_by(self, halt: &'a AtomicBool) -> Self {
        Self { halt: Some(halt), ..self }
    }

    fn is_halted(&self) -> bool {
        self.halt.is_some_and(|halt| halt.load(Ordering::Relaxed))
    }

    /// How many runs have entered each grid so far.
    pub fn entered(&self) -> &[u64] {
        &self.entered
    }

    /// Makes the published number of iterations on every grid, for all rows.
    ///
    /// Gives up as soon as the misfit passes `limit`.
    ///
    /// # Panics
    /// If there is no such geometry, or not one value per piece.
    pub fn forced(&mut self, geometry: usize, values: &[f64], limit: Limit) -> Forced {
        let entries: Vec<_> = (0..self.target.r.len()).map(|row| Entry { values, row }).collect();
        self.force(geometry, &entries, limit)
    }

    /// [`Forced::misfit`] of many values of f, the lanes filled with equal rows, which take equally long.
    ///
    /// # Panics
    /// As [`Self::forced`].
    pub fn misfits(&self, geometry: usize, all: &[Vec<f64>]) -> Vec<Vec<Vec<f64>>> {
        let rows = self.target.r.len();
        let batches: Vec<(usize, &[Vec<f64>])> =
            all.chunks(LANES).flat_map(|some| (0..rows).map(move |row| (row, some))).collect();
        let run = |evaluator: &mut Self, &(row, some): &(usize, &[Vec<f64>])| {
            let entries: Vec<_> = some.iter().map(|values| Entry { values, row }).collect();
            evaluator.force(geometry, &entries, Limit::NONE).misfit
        };
        let done: Vec<_> = batches.par_iter().map_init(|| self.clone(), run).collect();
        let of = |k: usize| (0..rows).map(move |row| (k / LANES * rows + row, k % LANES));
        (0..all.len())
            .map(|k| of(k).map(|(batch, lane)| done[batch][lane].clone()).collect())
            .collect()
    }

    /// A forced run in each lane; entries of the result are those of `entries`.
    fn force(&mut self, geometry: usize, entries: &[Entry], limit: Limit) -> Forced {
        let (lanes, grids) = (entries.len(), self.target.levels());
        let mut forced = Forced {
            misfit: vec![vec![0.0; grids]; lanes],
            delta_a: Vec::new(),
            levels: 0,
            total: 0.0,
        };
        let mut pairs = vec![Pair::zero(grid(0)); lanes];
        for level in 0..grids {
            self.enter(geometry, level, entries, &pairs);
            let mut delta_a = vec![0.0; lanes];
            let last = entries.iter().map(|entry| self.last(entry.row, level)).collect::<Vec<_>>();
            let tolerance = tolerance(level + 1);
            let most = if level < limit.exact_grids { 0.0 } else { limit.misfit };
            for n in 1..=last.iter().copied().max().unwrap_or(0) {
                if self.is_halted() {
                    return Forced { total: f64::INFINITY, ..forced };
                }
                let first = self.variant.uncounted + 1;
                let running = |k: usize| (first..=last[k]).contains(&n);
                let mut failed = false;
                let change = self.iterate(level, |at, measure| {
                    for k in (0..lanes).filter(|&k| running(k)) {
                        let ends = n == last[k];
                        // Before its last iteration a lane only has to be above the tolerance.
                        if ends || at.lanes.within(k, measure, tolerance, &mut at.witness[k]) {
                            let misfit = misfit(at.lanes.worst(k, measure), tolerance, ends);
                            let cell = &mut forced.misfit[k][level];
                            *cell = (*cell + misfit).min(CELL_CAP);
                            failed |= misfit > 0.0;
                        }
                    }
                });
                if failed {
                    let so_far: f64 = forced.misfit.iter().map(|lane| lane[level]).sum();
                    if forced.total + so_far > most {
                        forced.total += so_far;
                        return forced;
                    }
                }
                for k in (0..lanes).filter(|&k| n == last[k]) {
                    delta_a[k] = change[k];
                    pairs[k] = self.passed_on(level, k);
                }
            }
            forced.levels = level + 1;
            forced.total += forced.misfit.iter().map(|lane| lane[level]).sum::<f64>();
            if level + 1 == grids {
                forced.delta_a = delta_a;
            }
        }
        forced
    }

    /// Which of many values of f, with their geometries, give all counts on the coarsest grid.
    ///
    /// Row by row, each lane with the next values as soon as it is free: nearly all fail soon.
    ///
    /// # Panics
    /// As [`Self::forced`].
    pub(super) fn screened(&mut self, all: &[(usize, Vec<f64>)]) -> Vec<bool> {
        let mut passed = vec![true; all.len()];
        for row in 0..self.target.r.len() {
            let candidates: Vec<usize> = (0..all.len()).filter(|&k| passed[k]).collect();
            let (last, mut waiting) = (self.last(row, 0), candidates.into_iter());
            // Per lane, which values it runs, and the iterations it has made.
            let mut runs: [Option<(usize, usize)>; LANES] = [None; LANES];
            let zero = Pair::zero(grid(0));
            loop {
                for (lane, run) in runs.iter_mut().enumerate().filter(|(_, run)| run.is_none()) {
                    if let Some(k) = waiting.next() {
                        let (geometry, values) = &all[k];
                        self.levels[0].combine(&self.basis[*geometry][0], values);
                        let Level { lanes, load, .. } = &mut self.levels[0];
                        lanes.enter(lane, self.target.r[row], load, 0.0, &zero);
                        *run = Some((k, 0));
                    }
                }
                if runs.iter().all(Option::is_none) || self.is_halted() {
                    break;
                }
                let first = self.variant.uncounted + 1;
                self.iterate(0, |at, measure| {
                    for (lane, run) in runs.iter_mut().enumerate() {
                        let Some((k, n)) = run else { continue };
                        *n += 1;
                        let stops = *n >= first
                            && at.lanes.within(lane, measure, tolerance(1), &mut at.witness[lane]);
                        if stops || *n == last {
                            passed[*k] = stops && *n == last;
                            *run = None;
                        }
                    }
                });
            }
        }
        self.entered[0] += passed.iter().filter(|passed| !**passed).count() as u64;
        passed
    }

    /// The table of counts as the stopping rule gives it.
    ///
    /// # Panics
    /// If there is no such geometry, or not one value per piece.
    pub fn free(&mut self, geometry: usize, values: &[f64]) -> Table {
        let (rows, grids) = (self.target.r.len(), self.target.levels());
        let mut table = Table { counts: vec![vec![None; grids]; rows], delta_a: vec![0.0; rows] };
        let entries: Vec<_> = (0..rows).map(|row| Entry { values, row }).collect();
        let mut pairs = vec![Pair::zero(grid(0)); rows];
        for level in 0..grids {
            self.enter(geometry, level, &entries, &pairs);
            let most = (0..rows).map(|k| self.target.counts[k][level]).max().unwrap_or(0);
            let mut done = vec![false; rows];
            for n in 1..=FREE_FACTOR * most + FREE_EXTRA {
                let mut stops = vec![false; rows];
                let change = self.iterate(level, |at, measure| {
                    for k in (0..rows).filter(|&k| !done[k]) {
                        let tolerance = tolerance(level + 1);
                        stops[k] = at.lanes.within(k, measure, tolerance, &mut at.witness[k]);
                    }
                });
                (0..rows).filter(|&k| !done[k]).for_each(|k| table.delta_a[k] = change[k]);
                let Some(counted) = n.checked_sub(self.variant.uncounted).filter(|&c| c > 0) else {
                    continue;
                };
                for k in (0..rows).filter(|&k| stops[k]) {
                    done[k] = true;
                    table.counts[k][level] = Some(counted);
                    pairs[k] = self.passed_on(level, k);
                }
                if done.iter().all(|&done| done) {
                    break;
                }
            }
            for k in (0..rows).filter(|&k| !done[k]) {
                pairs[k] = self.passed_on(level, k);
            }
        }
        table
    }

    /// Sweep and dual step; `judge` is called when the variant evaluates the gradient.
    fn iterate(
        &mut self,
        level: usize,
        mut judge: impl FnMut(&mut Level, Measure),
    ) -> [f64; LANES] {
        let (at, measure) = (&mut self.levels[level], self.variant.measure.in_lanes());
        at.lanes.sweep(&mut AsDefined);
        let early = self.variant.residual == ResidualTime::BeforeDual;
        if early {
            judge(at, measure);
        }
        let change = at.lanes.step([true; LANES], &mut AsDefined);
        if !early {
            judge(at, measure);
        }
        change
    }

    /// Iterations of a forced run of a row.
    fn last(&self, row: usize, level: usize) -> usize {
        self.target.counts[row][level] + self.variant.uncounted
    }

    fn enter(&mut self, geometry: usize, level: usize, entries: &[Entry], starts: &[Pair]) {
        self.entered[level] += 1;
        let at = &mut self.levels[level];
        for (lane, (entry, start)) in entries.iter().zip(starts).enumerate() {
            if lane == 0 || entry.values != entries[lane - 1].values {
                at.combine(&self.basis[geometry][level], entry.values);
            }
            at.lanes.enter(lane, self.target.r[entry.row], &at.load, 0.0, start);
        }
    }

    /// Where lane `k` starts on the next grid.
    fn passed_on(&self, level: usize, k: usize) -> Pair {
        let Level { grid, lanes, .. } = &self.levels[level];
        let mut pair = lanes.pair(k).prolonged(*grid, self.prolongation);
        if !self.variant.prolong_multiplier {
            pair.a.fill(0.0);
        }
        pair
    }
}

impl Level {
    /// Sets the load of the f with these values on the pieces.
    fn combine(&mut self, basis: &[Vec<f64>], values: &[f64]) {
        assert_eq!(values.len(), basis.len());
        self.load.fill(0.0);
        for (piece, &value) in basis.iter().zip(values) {
            for (f, p) in self.load.iter_mut().zip(piece) {
                *f += value * p;
            }
        }
    }
}

/// The grid of a column of the table.
fn grid(level: usize) -> Grid {
    Grid::new(COARSEST << level).expect("fine enough")
}

impl Clone for Evaluator<'_> {
    fn clone(&self) -> Self {
        let basis = Arc::clone(&self.basis);
        Self { halt: self.halt, ..Self::with_basis(self.target, self.variant, basis) }
    }
}

/// By how much a measure fails what its place in the run asks for.
fn misfit(measure: f64, tolerance: f64, last: bool) -> f64 {
    if measure.is_nan() {
        CELL_CAP
    } else if last {
        if measure > tolerance { libm::log(measure / tolerance) } else { 0.0 }
    } else if measure <= tolerance {
        EARLY + (1.0 - measure / tolerance).min(CELL_CAP)
    } else {
        0.0
    }
}

fn mirror(grid: Grid, mut v: Vec<f64>, against_x: bool, against_y: bool) -> Vec<f64> {
    if against_x {
        v.chunks_exact_mut(grid.side()).for_each(<[f64]>::reverse);
    }
    if against_y {
        v = v.chunks_exact(grid.side()).rev().flatten().copied().collect();
    }
    v
}
