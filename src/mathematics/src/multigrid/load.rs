//! The load on all grids: split into red and black rows on the finest, restricted by full weighting to the others.

use rayon::prelude::*;

use super::input::LoadStats;
use super::layout::{Slab, places_per_slab, rows_per_slab};
use super::level::MultigridLevel;
use super::rows::{ColourRows, LINE, MIN_PLACES, as_slices, deinterleave, long_and_short};
use super::stencil::coupling;
use super::transfer::{FineLoad, Weighting};
use crate::machine::extremes::max_or_nan;
use crate::machine::simd::{Largest, vectorised};
use crate::machine::threads::in_tasks;
use std::ops::Range;

/// Sets the load of a grid from `F` in natural order, divided by the couplings.
pub(super) fn set_finest<D: Weighting>(natural: &[f64], level: &mut MultigridLevel) -> LoadStats {
    let (n, MultigridLevel { load: [red, black], .. }) = (level.n, level);
    set_slabs::<D>(n, 0..n + 1, natural, [red, black]);
    LoadStats::measure(natural)
}

/// Sets the load of a grid as [`set_finest`], and that of the next coarser grid by full weighting while the load of
/// the finer one is in the cache.
pub(super) fn set_finest_two<D: Weighting>(
    natural: &[f64],
    fine: &mut MultigridLevel,
    coarse: &mut MultigridLevel,
) -> LoadStats {
    let (n, coarse_n) = (fine.n, coarse.n);
    let (places, per_slab) = (places_per_slab::<D>(n), rows_per_slab::<D>(n) * (n + 1));
    let slabs = slabs_per_task::<D>(coarse_n);
    let fine = chunks(&mut fine.load, 2 * slabs * places);
    let coarse_chunks = chunks(&mut coarse.load, slabs * places_per_slab::<D>(coarse_n));
    let parts = fine.zip(coarse_chunks).enumerate();
    let parts = parts.map(|(part, ((red, black), (coarse_red, coarse_black)))| {
        let first = 2 * slabs * part;
        let own = first..first + red.len() / places;
        let mut row = vec![0.0; n / 2 + 1];
        // The slab before, which the first slab of the coarser grid also needs.
        let before_places = if first > 0 { places } else { 0 };
        let mut before = [vec![0.0; before_places], vec![0.0; before_places]];
        vectorised(
            #[inline(always)]
            || {
                let [before_red, before_black] = &mut before;
                if first > 0 {
                    set_slabs::<D>(n, first - 1..first, natural, [before_red, before_black]);
                }
                set_slabs::<D>(n, own.clone(), natural, [red, black]);
                let slabs = [&*red, &*black];
                let fine = FineLoad { slabs, first, before: [before_red, before_black], places };
                let coarse = [coarse_red, coarse_black];
                let largest = weigh_slabs::<D>(n / 2, &fine, first / 2, coarse, &mut row);
                let natural = &natural[own.start * per_slab..own.end * per_slab];
                (LoadStats::measure(natural), largest)
            },
        )
    });
    let (stats, largest): (Vec<_>, Vec<_>) = parts.unzip();
    coarse.load_scale = largest.into_iter().fold(0.0, max_or_nan);
    LoadStats::join(&stats)
}

/// Sets the load of the coarser grid by full weighting of the load of the finer one.
pub(super) fn restrict<D: Weighting>(fine: &MultigridLevel, coarse: &mut MultigridLevel) {
    let (n, places) = (coarse.n, places_per_slab::<D>(fine.n));
    let slabs = slabs_per_task::<D>(n);
    let fine = FineLoad { slabs: as_slices(&fine.load), first: 0, before: [&[]; 2], places };
    let parts = chunks(&mut coarse.load, slabs * places_per_slab::<D>(n)).enumerate();
    let largest = parts.map(|(part, (red, black))| {
        let mut row = vec![0.0; n + 1];
        vectorised(
            #[inline(always)]
            || weigh_slabs::<D>(n, &fine, part * slabs, [red, black], &mut row),
        )
    });
    coarse.load_scale = largest.reduce(|| 0.0, max_or_nan);
}

/// Euclidean norm of the load of the mirrored stencil, the same bits for any number of threads.
pub(super) fn norm(level: &MultigridLevel) -> f64 {
    let [red, black] = level.load.each_ref().map(|half| half.par_chunks(MIN_PLACES));
    // Both colours in one task: one after the other they would be split between threads however short they are.
    let halves = in_tasks(red.zip(black), 2 * MIN_PLACES);
    let sums: Vec<f64> = halves.map(|(red, black)| sum_squares(red) + sum_squares(black)).collect();
    sums.iter().sum::<f64>().sqrt()
}

/// Sum of the squares of whole cache lines. Rows are padded to whole lines, with zeros.
fn sum_squares(places: &[f64]) -> f64 {
    vectorised(
        #[inline(always)]
        || {
            let mut lanes = [0.0; LINE];
            for line in places.as_chunks::<LINE>().0 {
                (0..LINE).for_each(|lane| lanes[lane] += line[lane] * line[lane]);
            }
            lanes.iter().sum::<f64>()
        },
    )
}

/// Number of slabs of the load that one task works on.
fn slabs_per_task<D: Weighting>(n: usize) -> usize {
    MIN_PLACES.div_ceil(places_per_slab::<D>(n))
}

/// Chunks of `places` places of each colour.
fn chunks(
    [red, black]: &mut [ColourRows; 2],
    places: usize,
) -> impl IndexedParallelIterator<Item = (&mut [f64], &mut [f64])> {
    in_tasks(red.par_chunks_mut(places).zip(black.par_chunks_mut(places)), 2 * places)
}

/// Sets some slabs of the load of the mirrored stencil from `F` in natural order.
#[inline(always)]
fn set_slabs<D: Weighting>(
    n: usize,
    slabs: Range<usize>,
    natural: &[f64],
    [red, black]: [&mut [f64]; 2],
) {
    let (rows, places) = (rows_per_slab::<D>(n), places_per_slab::<D>(n));
    let inside = 1.0 / coupling::<D>(n);
    let halves = red.chunks_exact_mut(places).zip(black.chunks_exact_mut(places));
    for (s, (red, black)) in slabs.zip(halves) {
        for at in (Slab { n, s }).rows::<D>() {
            let source = &natural[(s * rows + at.r) * (n + 1)..][..n + 1];
            let halves = [&mut red[at.in_slab()], &mut black[at.in_slab()]];
            let [long, short] = long_and_short(at.r + s, halves);
            deinterleave(source, long, short);
            let factor = inside / at.share::<D>();
            if factor != 1.0 {
                long.iter_mut().chain(&mut *short).for_each(|entry| *entry *= factor);
            }
            long[0] *= 2.0;
            long[n / 2] *= 2.0;
        }
    }
}

/// Sets slabs of the load of a grid with `n` cells per side, from slab `first` on, to the full weighting of the finer
/// load; `row` is a buffer. Returns the largest entry before the division by the couplings.
#[inline(always)]
fn weigh_slabs<D: Weighting>(
    n: usize,
    fine: &FineLoad,
    first: usize,
    [red, black]: [&mut [f64]; 2],
    row: &mut [f64],
) -> f64 {
    let places = places_per_slab::<D>(n);
    let mut largest = Largest::default();
    let slabs = red.chunks_exact_mut(places).zip(black.chunks_exact_mut(places));
    for (s, (red, black)) in (first..).zip(slabs) {
        for at in (Slab { n, s }).rows::<D>() {
            D::weigh_load(at, fine, row);
            let factor = coupling::<D>(n) * at.share::<D>();
            largest.see(factor, &row[1..n]);
            largest.see(0.5 * factor, &[row[0], row[n]]);
            let halves = [&mut red[at.in_slab()], &mut black[at.in_slab()]];
            let [long, short] = long_and_short(at.r + at.s, halves);
            deinterleave(row, long, short);
        }
    }
    largest.value()
}
