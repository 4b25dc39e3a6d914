//! Forced and free runs, grid by grid.

use super::{Evaluator, Forced, Level, Table, grid};
use crate::saddle::batch::LANES;
use crate::saddle::{Pair, tolerance};
use rayon::prelude::*;
use std::array::from_fn;

/// Misfit of a stop that comes too early, beyond what the measure lacks.
const EARLY: f64 = 0.02;
/// Largest misfit of one cell; beyond it the size says nothing.
const CELL_CAP: f64 = 3.0;
/// Iterations a free run makes on a grid, in multiples of the largest published count, plus this many.
const FREE_FACTOR: usize = 4;
const FREE_EXTRA: usize = 20;

impl Evaluator<'_> {
    /// Iterations of a forced run of a row.
    fn last(&self, row: usize, level: usize) -> usize {
        self.target.counts[row][level] + self.variant.uncounted
    }

    /// Makes the published number of iterations on every grid, for all rows.
    ///
    /// Gives up as soon as the misfit passes `limit`.
    ///
    /// # Panics
    /// If there is no such geometry, or not one value per piece.
    pub fn forced(&mut self, geometry: usize, values: &[f64], limit: f64) -> Forced {
        let (rows, grids) = (self.target.r.len(), self.target.levels());
        let misfit_of_all = vec![vec![0.0; grids]; rows];
        let mut forced = Forced { misfit: misfit_of_all, delta_a: Vec::new(), total: 0.0 };
        let mut pairs = vec![Pair::zero(grid(0)); rows];
        for level in 0..grids {
            self.enter(geometry, level, values, &pairs);
            let mut delta_a = vec![0.0; rows];
            let last = (0..rows).map(|row| self.last(row, level)).collect::<Vec<_>>();
            let tolerance = tolerance(level + 1);
            for n in 1..=last.iter().copied().max().unwrap_or(0) {
                if self.is_halted() {
                    return Forced { total: f64::INFINITY, ..forced };
                }
                let first = self.variant.uncounted + 1;
                let running = |k: usize| (first..=last[k]).contains(&n);
                let mut failed = false;
                let change = self.iterate(level, |at, measure| {
                    for k in (0..rows).filter(|&k| running(k)) {
                        let ends = n == last[k];
                        // Before its last iteration a lane only has to be above the tolerance.
                        if ends || at.lanes.within(k, measure, tolerance, &mut at.witness[k]) {
                            let misfit = misfit(at.lanes.worst(measure)[k], tolerance, ends);
                            let cell = &mut forced.misfit[k][level];
                            *cell = (*cell + misfit).min(CELL_CAP);
                            failed |= misfit > 0.0;
                        }
                    }
                });
                if failed {
                    let so_far: f64 = forced.misfit.iter().map(|lane| lane[level]).sum();
                    if forced.total + so_far > limit {
                        forced.total += so_far;
                        return forced;
                    }
                }
                for k in (0..rows).filter(|&k| n == last[k]) {
                    delta_a[k] = change[k];
                    pairs[k] = self.passed_on(level, k);
                }
            }
            forced.total += forced.misfit.iter().map(|lane| lane[level]).sum::<f64>();
            if level + 1 == grids {
                forced.delta_a = delta_a;
            }
        }
        forced
    }

    /// For each of many f, given by their values, which counts come out in a forced run: by row and grid, every
    /// count whatever comes of the others.
    ///
    /// # Panics
    /// As [`Self::forced`].
    pub fn held(&self, geometry: usize, all: &[Vec<f64>]) -> Vec<Vec<Vec<bool>>> {
        let (rows, grids) = (self.target.r.len(), self.target.levels());
        let batches: Vec<(&[Vec<f64>], usize)> =
            all.chunks(LANES).flat_map(|some| (0..rows).map(move |row| (some, row))).collect();
        let run = |evaluator: &mut Self, &(some, row): &(&[Vec<f64>], usize)| {
            evaluator.held_in_lanes(geometry, in_lanes(some), row, grids, true)
        };
        let done: Vec<_> = batches.par_iter().map_init(|| self.clone(), run).collect();
        let of = |k: usize| {
            let rows = done[k / LANES * rows..][..rows].iter();
            rows.map(|grids| grids.iter().map(|held| held[k % LANES]).collect()).collect()
        };
        (0..all.len()).map(of).collect()
    }

    /// In which lanes the counts of a row come out, grid by grid.
    ///
    /// Unless every count is wanted, the run ends as soon as there is no lane in which all did.
    fn held_in_lanes(
        &mut self,
        geometry: usize,
        values: [&[f64]; LANES],
        row: usize,
        grids: usize,
        every: bool,
    ) -> Vec<[bool; LANES]> {
        let mut all = vec![[false; LANES]; grids];
        for (level, held) in all.iter_mut().enumerate() {
            self.enter_all(geometry, level, values, row);
            let (last, tolerance) = (self.last(row, level), tolerance(level + 1));
            *held = [true; LANES];
            for n in 1..=last {
                if self.is_halted() || !every && *held == [false; LANES] {
                    return all;
                }
                let counted = n > self.variant.uncounted;
                self.iterate(level, |at, measure| {
                    if counted {
                        let Level { lanes, witness, .. } = at;
                        let bounds = held.map(|held| held.then_some(tolerance));
                        let within = lanes.all_within(measure, bounds, witness);
                        *held = from_fn(|k| held[k] && within[k] == (n == last));
                    }
                });
            }
        }
        all
    }

    /// Places of those among many f, given by their values on the pieces, that give all counts on so many coarse
    /// grids.
    ///
    /// Grid by grid and row by row: nearly all fail soon.
    ///
    /// # Panics
    /// As [`Self::forced`].
    pub(in crate::identify) fn screened<V: AsRef<[f64]>>(
        &mut self,
        geometry: usize,
        all: &[V],
        grids: usize,
    ) -> Vec<usize> {
        let mut passed: Vec<usize> = (0..all.len()).collect();
        for level in 0..grids.min(self.target.levels()) {
            let entered = passed.len();
            for row in 0..self.target.r.len() {
                let mut held = Vec::with_capacity(passed.len());
                for some in passed.chunks(LANES) {
                    let values: Vec<_> = some.iter().map(|&k| &all[k]).collect();
                    let run =
                        self.held_in_lanes(geometry, in_lanes(&values), row, level + 1, false);
                    held.extend(some.iter().zip(run[level]).filter(|(_, held)| *held));
                }
                passed = held.into_iter().map(|(&k, _)| k).collect();
            }
            let failed = (entered - passed.len()) as u64;
            self.entered[..=level].iter_mut().for_each(|entered| *entered += failed);
        }
        passed
    }

    /// The table of counts as the stopping rule gives it.
    ///
    /// # Panics
    /// If there is no such geometry, or not one value per piece.
    pub fn free(&mut self, geometry: usize, values: &[f64]) -> Table {
        let (rows, grids) = (self.target.r.len(), self.target.levels());
        let mut table = Table { counts: vec![vec![None; grids]; rows], delta_a: vec![0.0; rows] };
        let mut pairs = vec![Pair::zero(grid(0)); rows];
        for level in 0..grids {
            self.enter(geometry, level, values, &pairs);
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
}

/// Values of f in all lanes, the last ones as often as there are lanes left.
fn in_lanes<V: AsRef<[f64]>>(some: &[V]) -> [&[f64]; LANES] {
    from_fn(|k| some[k.min(some.len() - 1)].as_ref())
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
