//! Forced and free runs, grid by grid.

use super::{Entry, Evaluator, Forced, Level, Limit, Table, grid};
use crate::saddle::batch::LANES;
use crate::saddle::{Pair, tolerance};
use rayon::prelude::*;

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
    pub(in crate::identify) fn screened(&mut self, all: &[(usize, Vec<f64>)]) -> Vec<bool> {
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
