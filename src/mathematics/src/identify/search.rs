//! The search: every f with one value on a quadrant, any of the four, and another elsewhere, both from a lattice.
//!
//! 1. Candidates are cut into square tiles of the lattice; rayon runs the tiles of a batch side by side.
//! 2. Blocks of a tile all of whose candidates miss a count on the coarsest grid are discarded by one run in their
//!    middle, and how far the measure moves around it at most.
//! 3. Candidates that miss a count are discarded, grid by grid, many in one pass ([`Evaluator::screened`]).
//! 4. The others are run in full.
//!
//! Results are merged in the order of the tiles: what is found, and the numbers of candidates, do not depend on the
//! number of threads, nor on the blocks.

use super::evaluate::Evaluator;
use super::found::{Found, found};
use super::space::{Geometry, Lattice};
use super::variant::Variant;
use super::{IdentifyError, Target};
use crate::machine::threads::map;
use serde::{Deserialize, Serialize};
use std::cmp::Reverse;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

/// Values along each axis in a tile.
const TILE: u64 = 64;
/// Values along each axis in a block, coarsest first.
const BLOCKS: [u64; 3] = [16, 8, 4];
/// Tiles in one batch.
const BATCH: u64 = 16;
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

impl Target {
    /// Searches for the right-hand sides that give the table under a reading of the method, with values from a range
    /// `MIN:MAX:STEP`, on the threads of the current rayon pool.
    ///
    /// Once `stop` is set, runs end within an iteration: a published count may be larger than anybody waits for. The
    /// report then has what was found until then.
    ///
    /// # Errors
    /// [`IdentifyError`] if this is no table, or the range none.
    pub fn searched(
        &self,
        values: &str,
        variant: &Variant,
        stop: &AtomicBool,
    ) -> Result<SearchReport, IdentifyError> {
        let lattice: Lattice = values.parse()?;
        search(&lattice, variant, self, stop)
    }
}

/// Searches the values of a lattice, as [`Target::searched`].
fn search(
    lattice: &Lattice,
    variant: &Variant,
    target: &Target,
    stop: &AtomicBool,
) -> Result<SearchReport, IdentifyError> {
    let candidates = Candidates { geometries: Geometry::odd_quadrants(), lattice };
    let evaluator = Evaluator::new(target, variant, &candidates.geometries)?.halted_by(stop);
    let tiles = candidates.tiles();
    let mut report = SearchReport { reached: vec![0; target.levels()], ..SearchReport::default() };
    let idle = Mutex::new(Vec::new());
    let run = |tile: &u64| {
        let taken = idle.lock().ok().and_then(|mut idle| idle.pop());
        let mut evaluator = taken.unwrap_or_else(|| evaluator.clone());
        let report = candidates.run(*tile, &mut evaluator);
        idle.lock().expect("nobody panics with it").push(evaluator);
        report
    };
    let mut done = 0;
    while done < tiles && !stop.load(Ordering::Relaxed) {
        let end = (done + BATCH).min(tiles);
        let batch: Vec<u64> = (done..end).collect();
        map(&batch, 1, run).into_iter().for_each(|tile| report.merge(tile));
        if stop.load(Ordering::Relaxed) {
            break;
        }
        done = end;
    }
    report.complete = done == tiles;
    Ok(report)
}

impl SearchReport {
    fn merge(&mut self, tile: Self) {
        self.tried += tile.tried;
        self.exact += tile.exact;
        self.reached.iter_mut().zip(&tile.reached).for_each(|(sum, n)| *sum += n);
        self.found.extend(tile.found);
        self.found.sort_by_key(|found| (Reverse(found.delta_a_exact), found.f.len()));
        self.found.truncate(KEPT);
    }
}

/// The candidates: on each quadrant, pairs of points of the lattice.
struct Candidates<'a> {
    geometries: [Geometry; 4],
    lattice: &'a Lattice,
}

impl Candidates<'_> {
    /// Number of tiles, quadrant by quadrant, along the values on the quadrant first.
    fn tiles(&self) -> u64 {
        self.tiles_along() * self.tiles_along() * self.geometries.len() as u64
    }

    fn tiles_along(&self) -> u64 {
        self.lattice.points().div_ceil(TILE)
    }

    /// Runs the candidates of one tile.
    fn run(&self, tile: u64, evaluator: &mut Evaluator<'_>) -> SearchReport {
        let before = evaluator.entered().to_vec();
        let along = self.tiles_along();
        let geometry = (tile / (along * along)) as usize;
        let first = [TILE * (tile % along), TILE * (tile / along % along)];
        let tried = self.within(first, TILE).count();
        let left = self.not_discarded(geometry, first, evaluator);
        evaluator.discard(tried - left.len());
        let candidates: Vec<_> = left.iter().map(|&numbers| self.lattice.values(numbers)).collect();
        let exact = evaluator.screened(geometry, &candidates);
        let mut report = SearchReport {
            tried: tried as u64,
            exact: exact.len() as u64,
            ..SearchReport::default()
        };
        for values in exact.into_iter().map(|k| &candidates[k]) {
            report.found.push(found(evaluator, geometry, &self.geometries[geometry], values));
        }
        let now = evaluator.entered().iter().zip(&before);
        report.reached = now.map(|(now, before)| now - before + report.exact).collect();
        report
    }

    /// Numbers of the candidates in the tile that begins at these numbers, without those of blocks that are discarded.
    fn not_discarded(
        &self,
        geometry: usize,
        tile: [u64; 2],
        evaluator: &mut Evaluator<'_>,
    ) -> Vec<[u64; 2]> {
        let (mut blocks, mut before) = (vec![tile], TILE);
        for side in BLOCKS {
            let parts = blocks.iter().flat_map(|&block| squares(block, before, side));
            let parts = parts.filter(|&part| self.within(part, side).next().is_some());
            let parts: Vec<_> = parts.collect();
            let (_, reach) = self.lattice.middle(tile, side);
            let middles: Vec<_> =
                parts.iter().map(|&part| self.lattice.middle(part, side).0).collect();
            let missed = evaluator.missed_around(geometry, &middles, reach);
            let kept = parts.into_iter().zip(missed).filter(|(_, missed)| !missed);
            (blocks, before) = (kept.map(|(part, _)| part).collect(), side);
        }
        blocks.into_iter().flat_map(|block| self.within(block, before)).collect()
    }

    /// Numbers of the candidates among those of a square of the lattice.
    fn within(&self, first: [u64; 2], side: u64) -> impl Iterator<Item = [u64; 2]> {
        squares(first, side, 1).filter(|&numbers| self.lattice.is_candidate(numbers))
    }
}

/// First numbers of the squares of a lattice, with this many points along a `side`, that make up a `whole` one.
fn squares([i, j]: [u64; 2], whole: u64, side: u64) -> impl Iterator<Item = [u64; 2]> {
    let along = move |first: u64| (first..first + whole).step_by(side as usize);
    along(j).flat_map(move |j| along(i).map(move |i| [i, j]))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Tables 1 and 2 of the paper on the two coarsest grids.
    fn targets() -> [Target; 2] {
        let r = vec![1e6, 10.0, 5.0, 1.0, 0.5];
        [[[1, 2], [1, 2], [1, 2], [1, 2], [1, 3]], [[3, 3], [3, 4], [3, 1], [3, 2], [4, 2]]].map(
            |counts| Target {
                r: r.clone(),
                counts: counts.map(Vec::from).into(),
                delta_a: vec![1.0; 5],
            },
        )
    }

    fn with_variants(targets: &[Target]) -> impl Iterator<Item = (&Target, Variant)> {
        targets.iter().flat_map(|of| Variant::neighbours().into_iter().map(move |v| (of, v)))
    }

    #[test]
    fn blocks_leave_few_candidates() {
        let lattice: Lattice = "-6.5:3.5:0.01".parse().unwrap();
        let candidates = Candidates { geometries: Geometry::odd_quadrants(), lattice: &lattice };
        let target = &targets()[1];
        let mut evaluator =
            Evaluator::new(target, &Variant::default(), &candidates.geometries).unwrap();
        let (mut tried, mut left) = (0, 0);
        for first in squares([0, 0], 1024, TILE).step_by(7) {
            tried += candidates.within(first, TILE).count();
            left += candidates.not_discarded(0, first, &mut evaluator).len();
        }
        assert!(tried > 50_000 && 5 * left < tried, "{left} of {tried}");
    }

    #[test]
    fn what_blocks_discard_would_fail_one_by_one() {
        let lattice: Lattice = "-7:5:0.1".parse().unwrap();
        let candidates = Candidates { geometries: Geometry::odd_quadrants(), lattice: &lattice };
        for (target, variant) in with_variants(&targets()) {
            let evaluator = Evaluator::new(target, &variant, &candidates.geometries).unwrap();
            let (mut by_blocks, mut one_by_one) = (evaluator.clone(), evaluator);
            for tile in 0..candidates.tiles() {
                let along = candidates.tiles_along();
                let geometry = (tile / (along * along)) as usize;
                let first = [TILE * (tile % along), TILE * (tile / along % along)];
                let all: Vec<_> = candidates.within(first, TILE).collect();
                let values: Vec<_> = all.iter().map(|&numbers| lattice.values(numbers)).collect();
                let exact = one_by_one.screened(geometry, &values).len();
                assert_eq!(candidates.run(tile, &mut by_blocks).exact, exact as u64);
            }
            assert_eq!(by_blocks.entered(), one_by_one.entered(), "{variant}");
        }
    }
}
