//! The search: every f with one value on a quadrant, any of the four, and another elsewhere, both from a lattice.
//!
//! 1. Candidates are numbered and cut into items of [`ITEM`]; rayon runs the items of a batch side by side.
//! 2. Those that miss a count are discarded, grid by grid, many in one pass ([`Evaluator::screened`]).
//! 3. The others are run in full.
//!
//! Results are merged in the order of the items: what is found, and the number of runs, do not depend on the number of
//! threads.

use super::evaluate::Evaluator;
use super::found::{Found, found};
use super::space::{Geometry, Lattice};
use super::variant::Variant;
use super::{IdentifyError, Target};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::cmp::Reverse;
use std::sync::atomic::{AtomicBool, Ordering};

/// Candidates in one item.
const ITEM: u64 = 4096;
/// Items in one batch.
const BATCH: u64 = 8;
/// Number of right-hand sides that are kept.
const KEPT: usize = 20;

/// Result of a search. It serialises to the artifact of the pipeline.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SearchReport {
    /// True if no candidate was left out because the search was stopped.
    pub complete: bool,
    /// Number of candidates tried: those with a negative integral, as (2) asks.
    pub tried: u64,
    /// Number of candidates that reach each grid: all counts on the coarser ones come out.
    pub reached: Vec<u64>,
    /// Number of candidates with all counts.
    pub exact: u64,
    /// Candidates with all counts, at most twenty: those with the most values of Delta a to both digits, and of these
    /// those that are the shortest to write, come first.
    pub found: Vec<Found>,
}

/// Searches on the threads of the current rayon pool.
///
/// `observe` is called after each batch, on the calling thread, with the share of the candidates that are done. Once
/// `stop` is set, runs end within an iteration: a published count may be larger than anybody waits for. The report then
/// has what was found until then.
///
/// # Errors
/// [`IdentifyError`] if the target is no table.
pub fn search(
    lattice: &Lattice,
    variant: &Variant,
    target: &Target,
    stop: &AtomicBool,
    observe: &mut dyn FnMut(f64, &SearchReport),
) -> Result<SearchReport, IdentifyError> {
    let candidates = Candidates { geometries: Geometry::odd_quadrants(), lattice };
    let evaluator = Evaluator::new(target, variant, &candidates.geometries)?.halted_by(stop);
    let items = candidates.count().div_ceil(ITEM);
    let mut report = SearchReport { reached: vec![0; target.levels()], ..SearchReport::default() };
    let mut done = 0;
    while done < items && !stop.load(Ordering::Relaxed) {
        let end = (done + BATCH).min(items);
        let batch: Vec<u64> = (done..end).collect();
        let ran: Vec<SearchReport> = batch
            .into_par_iter()
            .with_max_len(1)
            .map_init(|| evaluator.clone(), |evaluator, item| candidates.run(item, evaluator))
            .collect();
        ran.into_iter().for_each(|item| report.merge(item));
        if stop.load(Ordering::Relaxed) {
            break;
        }
        done = end;
        observe(done as f64 / items as f64, &report);
    }
    report.complete = done == items;
    Ok(report)
}

impl SearchReport {
    fn merge(&mut self, item: Self) {
        self.tried += item.tried;
        self.exact += item.exact;
        self.reached.iter_mut().zip(&item.reached).for_each(|(sum, n)| *sum += n);
        self.found.extend(item.found);
        self.found.sort_by_key(|found| (Reverse(found.delta_a_exact), found.f.len()));
        self.found.truncate(KEPT);
    }
}

/// The candidates, numbered from zero: quadrant by quadrant, the value on the quadrant running fastest.
struct Candidates<'a> {
    geometries: [Geometry; 4],
    lattice: &'a Lattice,
}

impl Candidates<'_> {
    /// Number of candidates, those without a negative integral included.
    fn count(&self) -> u64 {
        self.per_quadrant() * self.geometries.len() as u64
    }

    fn per_quadrant(&self) -> u64 {
        self.lattice.points() * self.lattice.points()
    }

    /// Runs the candidates of one item.
    fn run(&self, item: u64, evaluator: &mut Evaluator<'_>) -> SearchReport {
        let before = evaluator.entered().to_vec();
        let mut report = SearchReport::default();
        let (mut next, end) = (item * ITEM, ((item + 1) * ITEM).min(self.count()));
        while next < end {
            let geometry = (next / self.per_quadrant()) as usize;
            let last = end.min((geometry as u64 + 1) * self.per_quadrant());
            let candidates: Vec<_> =
                (next..last).filter_map(|number| self.values(number)).collect();
            let exact = evaluator.screened(geometry, &candidates);
            report.tried += candidates.len() as u64;
            report.exact += exact.len() as u64;
            for values in exact.into_iter().map(|k| &candidates[k]) {
                report.found.push(found(evaluator, geometry, &self.geometries[geometry], values));
            }
            next = last;
        }
        let now = evaluator.entered().iter().zip(&before);
        report.reached = now.map(|(now, before)| now - before).collect();
        for reached in &mut report.reached {
            *reached += report.exact;
        }
        report
    }

    /// Values of a candidate on the quadrant and elsewhere, by its number; `None` if its integral is not negative.
    fn values(&self, number: u64) -> Option<[f64; 2]> {
        let (number, points) = (number % self.per_quadrant(), self.lattice.points());
        self.lattice.values([number % points, number / points])
    }
}
