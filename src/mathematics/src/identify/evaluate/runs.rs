//! Forced and free runs, grid by grid.

use super::{Evaluator, Table};
use crate::discrete::nested::DiscreteLevels;
use crate::discrete::norms::largest;
use crate::identify::moves::MOST_ITERATIONS;
use crate::identify::variant::Variant;
use crate::machine::threads::map_with_room;
use crate::problem::law::Law;
use crate::saddle::batch::LANES;
use crate::saddle::{Engine, Method, Pair, RunStart, tolerance};
use std::array::from_fn;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Iterations a free run makes on a grid, in multiples of the largest published count, plus this many.
const FREE_FACTOR: usize = 4;
const FREE_EXTRA: usize = 20;
/// Share of the largest value of f whose move moves the iterates by more than rounding errors do.
const ROUNDING: f64 = 1e-10;

impl Evaluator<'_> {
    /// Iterations of a forced run of a row.
    fn last(&self, row: usize, level: usize) -> usize {
        self.target.counts[row][level] + self.variant.uncounted
    }

    /// Puts runs, each of an f given by its values and of a row, into the lanes of a grid.
    fn enter(
        &mut self,
        geometry: usize,
        level: usize,
        runs: &[(&[f64], usize)],
        pairs: &mut [Pair],
    ) {
        let (mut load, mut made_for) = (Vec::new(), None);
        for (lane, (&(values, row), start)) in runs.iter().zip(pairs).enumerate() {
            if !self.variant.prolong_multiplier {
                start.a.fill(0.0);
            }
            // The rows of one f have the same load vector.
            if made_for != Some(values) {
                load = self.load(geometry, level, values);
                made_for = Some(values);
            }
            let (method, r) = (Method::ArrowHurwicz, self.target.r[row]);
            let run = RunStart { load: &load, method, r, pair: start };
            self.lanes[level].enter(lane, &run);
        }
    }

    /// For each of many f, given by their values, which counts come out in a free run: by row and grid.
    ///
    /// # Panics
    /// As [`Self::free`].
    pub fn held(&self, geometry: usize, all: &[Vec<f64>]) -> Vec<Vec<Vec<bool>>> {
        self.held_where(geometry, all, |_, _| self.target.levels())
    }

    /// As [`Self::held`], on the first grids that are asked for, so many by the place of an f and the number of a row;
    /// the other counts are said to come out.
    pub(in crate::identify) fn held_where(
        &self,
        geometry: usize,
        all: &[Vec<f64>],
        asked: impl Fn(usize, usize) -> usize,
    ) -> Vec<Vec<Vec<bool>>> {
        let (rows, levels) = (self.target.r.len(), self.target.levels());
        // Runs of one row on as many grids end about together.
        let mut places = Vec::new();
        for (row, grids) in (0..rows).flat_map(|row| (1..=levels).map(move |grids| (row, grids))) {
            let those = (0..all.len()).filter(|&k| asked(k, row) == grids);
            places.extend(those.map(|k| (k, row, grids)));
        }
        let batches: Vec<_> = places.chunks(LANES).collect();
        let each = batches.len().div_ceil(4 * rayon::current_num_threads()).max(1);
        let done = map_with_room(
            0..batches.len(),
            each,
            || self.clone(),
            |evaluator, number| {
                let batch = batches[number].iter();
                let runs: Vec<_> = batch.clone().map(|&(k, row, _)| (&all[k][..], row)).collect();
                evaluator.free_in_lanes(geometry, &runs, batch.map(|place| place.2).max())
            },
        );
        let mut held = vec![vec![vec![true; levels]; rows]; all.len()];
        for (&(k, row, _), (counts, _)) in places.iter().zip(done.into_iter().flatten()) {
            let pairs = counts.iter().zip(&self.target.counts[row]);
            let found = pairs.map(|(ours, published)| *ours == Some(*published));
            held[k][row].iter_mut().zip(found).for_each(|(held, found)| *held = found);
        }
        held
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
        let (measure, uncounted) = (self.variant.measure.in_lanes(), self.variant.uncounted);
        let halt = self.halt;
        let mut held = [true; LANES];
        for level in 0..=finest {
            if held == [false; LANES] {
                break;
            }
            self.enter_all(geometry, level, values, row);
            let (last, tolerance) = (self.last(row, level), tolerance(level + 1));
            let limits = held.map(|held| held.then_some(last));
            self.iterate(level, limits, None, |lanes, n, _| {
                if is_set(halt) {
                    held = [false; LANES];
                } else if n > uncounted {
                    let bounds = held.map(|held| held.then_some(tolerance));
                    let within = lanes.within(measure, bounds);
                    held = from_fn(|k| held[k] && within[k] == (n == last));
                }
                held.map(|held| !held)
            });
        }
        held
    }

    /// For which of many f, given by their values, bounds tell that no f whose values are within `reach` of theirs
    /// gives all counts on the coarsest grid.
    pub(in crate::identify) fn missed_around(
        &mut self,
        geometry: usize,
        all: &[[f64; 2]],
        reach: f64,
    ) -> Vec<bool> {
        let mut missed = vec![false; all.len()];
        for row in (0..self.target.r.len()).rev() {
            let open: Vec<usize> = (0..all.len()).filter(|&k| !missed[k]).collect();
            for some in open.chunks(LANES) {
                let values: Vec<_> = some.iter().map(|&k| &all[k]).collect();
                let run = self.missed_in_lanes(geometry, in_lanes(&values), row, reach);
                some.iter().zip(run).for_each(|(&k, is_missed)| missed[k] = is_missed);
            }
        }
        missed
    }

    /// In which lanes bounds tell that no f within `reach` gives the count of a row on the coarsest grid.
    fn missed_in_lanes(
        &mut self,
        geometry: usize,
        values: [&[f64]; LANES],
        row: usize,
        reach: f64,
    ) -> [bool; LANES] {
        let (measure, uncounted) = (self.variant.measure.in_lanes(), self.variant.uncounted);
        let (halt, tolerance, last) = (self.halt, tolerance(1), self.last(row, 0));
        let moves = Arc::clone(&self.moves);
        let reach = values.map(|values| reach + ROUNDING * largest(values));
        let mut missed = [false; LANES];
        self.enter_all(geometry, 0, values, row);
        let limits = [Some(last.min(MOST_ITERATIONS)); LANES];
        self.iterate(0, limits, None, |lanes, n, _| {
            if n > uncounted {
                let (worst, moves) = (lanes.worst(measure), moves[geometry][row][n - 1]);
                missed = from_fn(|k| {
                    let room = moves * reach[k];
                    // Before the last iteration the measure stays above the tolerance.
                    let is_missed = match n == last {
                        true => worst[k] > tolerance + room,
                        false => worst[k] < tolerance - room,
                    };
                    is_missed || missed[k]
                });
            }
            missed.map(|missed| missed || is_set(halt))
        });
        missed
    }

    /// Counts so many f whose screening has failed on the coarsest grid.
    pub(in crate::identify) fn discard(&mut self, count: usize) {
        self.entered[0] += count as u64;
    }

    /// Places of those among many f, given by their values on the pieces, that give all counts.
    ///
    /// Grid by grid and row by row from the last: nearly all fail soon.
    ///
    /// # Panics
    /// As [`Self::free`].
    pub(in crate::identify) fn screened<V: AsRef<[f64]>>(
        &mut self,
        geometry: usize,
        all: &[V],
    ) -> Vec<usize> {
        let mut passed: Vec<usize> = (0..all.len()).collect();
        for level in 0..self.target.levels() {
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
        let (counts, delta_a) = self.free_in_lanes(geometry, &rows, None).into_iter().unzip();
        Table { counts, delta_a }
    }

    /// Free runs side by side, each of an f given by its values and of a row: its counts, and its last change of the
    /// multiplier on the finest grid. If it is only asked which counts are `held`, on so many grids, no run goes beyond
    /// the published count on the last of them.
    fn free_in_lanes(
        &mut self,
        geometry: usize,
        runs: &[(&[f64], usize)],
        held: Option<usize>,
    ) -> Vec<(Vec<Option<usize>>, f64)> {
        let mut ends = vec![(Vec::new(), 0.0); runs.len()];
        let grids = self.grids[..held.unwrap_or(self.grids.len())].to_vec();
        let mut pairs = vec![Pair::zero((grids[0], Law::SIGNORINI)); runs.len()];
        let Variant { measure, uncounted, prolongation, .. } = self.variant;
        let measure = measure.in_lanes();
        for level in 0..grids.len() {
            if level > 0 {
                let levels = DiscreteLevels::Grids(&grids, Law::SIGNORINI);
                pairs
                    .iter_mut()
                    .for_each(|pair| *pair = pair.interpolated(levels, level, prolongation));
            }
            self.enter(geometry, level, runs, &mut pairs);
            let most = self.target.counts.iter().map(|row| row[level]).max().unwrap_or(0);
            let (limit, tolerance) = (FREE_FACTOR * most + FREE_EXTRA, tolerance(level + 1));
            let is_last = held == Some(level + 1);
            let limit = |row: usize| if is_last { self.last(row, level) } else { limit };
            let limits = from_fn(|k| runs.get(k).map(|&(_, row)| limit(row)));
            let done = self.iterate(level, limits, Some(&mut pairs), |lanes, n, open| {
                let asked = n > uncounted;
                lanes.within(measure, open.map(|open| (open && asked).then_some(tolerance)))
            });
            for ((counts, delta_a), end) in ends.iter_mut().zip(done.iter().flatten()) {
                counts.push(end.count().map(|sweeps| sweeps - uncounted));
                *delta_a = end.change();
            }
        }
        ends
    }
}

fn is_set(halt: Option<&AtomicBool>) -> bool {
    halt.is_some_and(|halt| halt.load(Ordering::Relaxed))
}

/// Values of f in all lanes, the last ones as often as there are lanes left.
fn in_lanes<V: AsRef<[f64]>>(some: &[V]) -> [&[f64]; LANES] {
    from_fn(|k| some[k.min(some.len() - 1)].as_ref())
}
