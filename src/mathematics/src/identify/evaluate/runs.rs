//! Forced and free runs, grid by grid.

use super::{Evaluator, Forced, Level, Table, grid};
use crate::saddle::batch::{LANES, LaneStart};
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
            self.entered[level] += 1;
            let load = self.load(geometry, level, values);
            for (row, (&r, start)) in self.target.r.iter().zip(&pairs).enumerate() {
                let run = LaneStart { r, load: &load, weight: 0.0, start };
                self.levels[level].lanes.enter(row, &run);
            }
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

    /// For each of many f, given by their values, which counts come out in a free run: by row and grid.
    ///
    /// # Panics
    /// As [`Self::forced`].
    pub fn held(&self, geometry: usize, all: &[Vec<f64>]) -> Vec<Vec<Vec<bool>>> {
        let rows = self.target.r.len();
        // Runs of one row end about together.
        let row = |row| all.iter().map(move |values| (&values[..], row));
        let runs: Vec<_> = (0..rows).flat_map(row).collect();
        let batches: Vec<_> = runs.chunks(LANES).collect();
        let run = |evaluator: &mut Self, batch: &&[_]| evaluator.free_in_lanes(geometry, batch);
        let done: Vec<_> = batches.par_iter().map_init(|| self.clone(), run).collect();
        let done: Vec<_> = done.into_iter().flatten().collect();
        let of_row = |k: usize, row: usize| {
            let (counts, _) = &done[row * all.len() + k];
            let pairs = counts.iter().zip(&self.target.counts[row]);
            pairs.map(|(ours, published)| *ours == Some(*published)).collect()
        };
        (0..all.len()).map(|k| (0..rows).map(|row| of_row(k, row)).collect()).collect()
    }

    /// In which lanes the counts of a row come out on all grids up to one, in a forced run that ends as soon as there
    /// is no such lane.
    fn held_in_lanes(
        &mut self,
        geometry: usize,
        values: [&[f64]; LANES],
        row: usize,
        finest: usize,
    ) -> [bool; LANES] {
        let mut held = [true; LANES];
        for level in 0..=finest {
            self.enter_all(geometry, level, values, row);
            let (last, tolerance) = (self.last(row, level), tolerance(level + 1));
            for n in 1..=last {
                if self.is_halted() || held == [false; LANES] {
                    return [false; LANES];
                }
                let counted = n > self.variant.uncounted;
                self.iterate(level, |at, measure| {
                    if counted {
                        let Level { lanes, witness, .. } = at;
                        let bounds = held.map(|held| held.then_some(tolerance));
                        let within = lanes.all_within(measure, bounds, witness);
                        held = from_fn(|k| held[k] && within[k] == (n == last));
                    }
                });
            }
        }
        held
    }

    /// Places of those among many f, given by their values on the pieces, that give all counts on so many coarse
    /// grids.
    ///
    /// Grid by grid and row by row from the last: nearly all fail soon.
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
            // The last row, of the smallest r, discards most.
            for row in (0..self.target.r.len()).rev() {
                let mut held = Vec::with_capacity(passed.len());
                for some in passed.chunks(LANES) {
                    let values: Vec<_> = some.iter().map(|&k| &all[k]).collect();
                    let run = self.held_in_lanes(geometry, in_lanes(&values), row, level);
                    held.extend(some.iter().zip(run).filter(|(_, held)| *held));
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
        let rows: Vec<_> = (0..self.target.r.len()).map(|row| (values, row)).collect();
        let (counts, delta_a) = self.free_in_lanes(geometry, &rows).into_iter().unzip();
        Table { counts, delta_a }
    }

    /// Free runs side by side, each of an f given by its values and of a row: its counts, and its last change of the
    /// multiplier on the finest grid.
    fn free_in_lanes(
        &mut self,
        geometry: usize,
        runs: &[(&[f64], usize)],
    ) -> Vec<(Vec<Option<usize>>, f64)> {
        let mut ends = vec![(Vec::new(), 0.0); runs.len()];
        let mut pairs = vec![Pair::zero(grid(0)); runs.len()];
        for level in 0..self.target.levels() {
            for (lane, (&(values, row), start)) in runs.iter().zip(&pairs).enumerate() {
                let load = self.load(geometry, level, values);
                let run = LaneStart { r: self.target.r[row], load: &load, weight: 0.0, start };
                self.levels[level].lanes.enter(lane, &run);
            }
            let most = self.target.counts.iter().map(|row| row[level]).max().unwrap_or(0);
            let tolerance = tolerance(level + 1);
            let mut open: [bool; LANES] = from_fn(|k| k < runs.len());
            let mut counts = [None; LANES];
            for n in 1..=FREE_FACTOR * most + FREE_EXTRA {
                let mut stops = [false; LANES];
                let change = self.iterate(level, |at, measure| {
                    let bounds = open.map(|open| open.then_some(tolerance));
                    stops = at.lanes.all_within(measure, bounds, &mut at.witness);
                });
                (0..runs.len()).filter(|&k| open[k]).for_each(|k| ends[k].1 = change[k]);
                let Some(counted) = n.checked_sub(self.variant.uncounted).filter(|&c| c > 0) else {
                    continue;
                };
                for k in (0..runs.len()).filter(|&k| stops[k]) {
                    (open[k], counts[k]) = (false, Some(counted));
                    pairs[k] = self.passed_on(level, k);
                }
                if open == [false; LANES] {
                    break;
                }
            }
            for k in 0..runs.len() {
                ends[k].0.push(counts[k]);
                if open[k] {
                    pairs[k] = self.passed_on(level, k);
                }
            }
        }
        ends
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
