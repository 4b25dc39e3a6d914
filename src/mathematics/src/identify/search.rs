//! The search: every point of a lattice of values, on every geometry of a family.
//!
//! 1. Candidates are numbered and cut into items of [`ITEM`]; rayon runs the items of a batch side by side.
//! 2. Those that miss a count on the coarsest grids are discarded, many in one pass ([`Evaluator::screened`]).
//! 3. The others make a forced run ([`Evaluator::forced`]), as far as the best candidates of earlier batches allow.
//! 4. The best of all are run in full, and explained.
//!
//! An item knows only what earlier batches found, and results are merged in an order of their own: what is found, and the
//! number of runs, do not depend on the number of threads.

use super::evaluate::Evaluator;
use super::rank::{Best, Found, Ranked, evaluate, explain};
use super::space::{Candidate, Geometry, Lattice, Space, decimals};
use super::variant::Variant;
use super::{IdentifyError, Target};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};

/// Candidates in one item.
const ITEM: u64 = 4096;
/// Items in one batch.
const BATCH: u64 = 8;
/// Largest number of candidates that is surely counted without rounding.
const MOST: f64 = 9_007_199_254_740_992.0;

/// Question of a search. Two equal requests give equal reports.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Request {
    /// Family of f.
    pub space: Space,
    /// Values allowed: one lattice for both pieces, or one per piece.
    pub values: Vec<Lattice>,
    /// Reading of the method.
    pub variant: Variant,
    /// True if f must have a negative integral, as (2) asks.
    pub negative_integral: bool,
    /// Number of coarse grids on which every count must come out. Two discard nearly everything at a cost of
    /// microseconds.
    pub exact_grids: usize,
    /// Number of candidates to keep.
    pub top: usize,
}

/// State of a search after a batch.
#[derive(Clone, Debug, PartialEq)]
pub struct SearchProgress {
    /// Number of items done.
    pub done: u64,
    /// Number of all items.
    pub all: u64,
    /// Number of candidates tried.
    pub tried: u64,
    /// Number of runs that entered each grid.
    pub entered: Vec<u64>,
    /// Smallest objective so far.
    pub best: Option<f64>,
}

/// Result of a search. It serialises to the artifact of the pipeline.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SearchReport {
    /// Version of this format.
    pub schema: u8,
    /// The question.
    pub request: Request,
    /// True if every item was done.
    pub complete: bool,
    /// Number of candidates tried.
    pub tried: u64,
    /// Number of runs that entered each grid.
    pub entered: Vec<u64>,
    /// The best candidates: those with every count first, then by [`super::Score::total`].
    pub found: Vec<Found>,
}

/// Searches on the threads of the current rayon pool.
///
/// `observe` is called after each batch, on the calling thread. Once `stop` is set, runs end within an iteration: a
/// published count may be larger than anybody waits for. The report then has what was found until then.
///
/// # Errors
/// [`IdentifyError`] if the request makes no sense, or the target is no table.
pub fn search(
    request: &Request,
    target: &Target,
    stop: &AtomicBool,
    observe: &mut dyn FnMut(&SearchProgress),
) -> Result<SearchReport, IdentifyError> {
    let space = CandidateSpace::new(request)?;
    let evaluator = Evaluator::new(target, &request.variant, &space.geometries)?.halted_by(stop);
    let items = space.count().div_ceil(ITEM);
    let mut progress = SearchProgress {
        done: 0,
        all: items,
        tried: 0,
        entered: vec![0; target.levels()],
        best: None,
    };
    let mut best = Best::new(request.top);
    while progress.done < items && !stop.load(Ordering::Relaxed) {
        let end = (progress.done + BATCH).min(items);
        let batch: Vec<u64> = (progress.done..end).collect();
        let ran: Vec<Item> = batch
            .into_par_iter()
            .with_max_len(1)
            .map_init(|| evaluator.clone(), |evaluator, item| space.run(item, evaluator, &best))
            .collect();
        for item in ran {
            progress.tried += item.tried;
            progress.entered.iter_mut().zip(&item.entered).for_each(|(sum, n)| *sum += n);
            best.merge(item.best);
        }
        if stop.load(Ordering::Relaxed) {
            break;
        }
        progress.done = end;
        progress.best = best.objective();
        observe(&progress);
    }
    // What was found is explained in any case.
    let mut evaluator = Evaluator::new(target, &request.variant, &space.geometries)?;
    let found = best.list().iter().map(|Ranked { candidate, .. }| {
        explain(&mut evaluator, &space.geometries[candidate.geometry], candidate)
    });
    Ok(SearchReport {
        schema: 1,
        request: request.clone(),
        complete: progress.done == items,
        found: found.collect(),
        tried: progress.tried,
        entered: progress.entered,
    })
}

/// Result of one item.
struct Item {
    best: Best,
    tried: u64,
    entered: Vec<u64>,
}

/// The candidates of a request, numbered from zero: geometry by geometry, the first value running fastest.
struct CandidateSpace<'a> {
    request: &'a Request,
    geometries: Vec<Geometry>,
    /// Areas of the two pieces of each geometry.
    areas: Vec<[f64; 2]>,
    /// One per piece, both with the same number of places.
    lattices: [Lattice; 2],
    per_geometry: u64,
}

impl<'a> CandidateSpace<'a> {
    fn new(request: &'a Request) -> Result<Self, IdentifyError> {
        let geometries = request.space.geometries();
        let places = request.values.iter().map(Lattice::places).max().unwrap_or(0);
        let lattices = match &request.values[..] {
            [both] => [both.clone(), both.clone()],
            [on_region, elsewhere] => [on_region.refined(places), elsewhere.refined(places)],
            many => return Err(IdentifyError::ValueCount { lists: many.len() }),
        };
        let product: f64 = lattices.iter().map(|lattice| lattice.ticks().len() as f64).product();
        if product * geometries.len() as f64 > MOST {
            return Err(IdentifyError::TooMany);
        }
        let areas = geometries.iter().map(|geometry| {
            let areas = geometry.areas();
            [areas[0], areas[1]]
        });
        let areas = areas.collect();
        Ok(Self { request, geometries, areas, lattices, per_geometry: product as u64 })
    }

    /// Number of candidates.
    fn count(&self) -> u64 {
        self.per_geometry * self.geometries.len() as u64
    }

    /// Runs the candidates of one item, in the light of what earlier batches found.
    fn run(&self, item: u64, evaluator: &mut Evaluator<'_>, earlier: &Best) -> Item {
        let before = evaluator.entered().to_vec();
        let mut best = earlier.successor();
        let mut tried = 0;
        let (mut next, end) = (item * ITEM, ((item + 1) * ITEM).min(self.count()));
        let mut passed = Vec::new();
        while next < end {
            let geometry = (next / self.per_geometry) as usize;
            let last = end.min((geometry as u64 + 1) * self.per_geometry);
            let admitted = self.admitted(geometry, next..last);
            tried += admitted.len() as u64;
            passed.extend(self.screened(geometry, &admitted, evaluator));
            next = last;
        }
        for candidate in passed {
            if let Some(ranked) = evaluate(evaluator, candidate, best.misfit_limit()) {
                best.offer(ranked);
            }
        }
        let entered = evaluator.entered().iter().zip(&before).map(|(now, before)| now - before);
        Item { best, tried, entered: entered.collect() }
    }

    /// Numbers of those candidates that the request does not leave out, all of this geometry.
    fn admitted(&self, geometry: usize, numbers: Range<u64>) -> Vec<u64> {
        let [area, rest] = self.areas[geometry];
        let mut admitted = Vec::new();
        for number in numbers {
            let [on_region, elsewhere] = self.ticks(number);
            let integral = area * on_region as f64 + rest * elsewhere as f64;
            // Areas carry rounding errors; the integral of a candidate is a multiple of a block.
            if !self.request.negative_integral || integral < -1e-6 {
                admitted.push(number);
            }
        }
        admitted
    }

    /// The candidates with these numbers that give all counts on the coarse grids.
    fn screened(
        &self,
        geometry: usize,
        numbers: &[u64],
        evaluator: &mut Evaluator<'_>,
    ) -> impl Iterator<Item = Candidate> {
        let places = self.lattices[0].places();
        let mut values = Vec::with_capacity(2 * numbers.len());
        for &number in numbers {
            values.extend(decimals(&self.ticks(number), places));
        }
        let values: Vec<_> = values.chunks_exact(2).collect();
        let passed = evaluator.screened(geometry, &values, self.request.exact_grids);
        passed.into_iter().map(move |k| {
            let ticks = self.ticks(numbers[k]).into();
            Candidate { geometry, ticks, places }
        })
    }

    /// Values of a candidate on the region and elsewhere, in units of the lattices, by its number.
    fn ticks(&self, number: u64) -> [i64; 2] {
        let [on_region, elsewhere] = self.lattices.each_ref().map(Lattice::ticks);
        let number = (number % self.per_geometry) as usize;
        [on_region[number % on_region.len()], elsewhere[number / on_region.len()]]
    }
}
