//! The load on all grids: split into red and black rows on the finest, restricted by full weighting to the others.

use rayon::prelude::*;

use super::level::MultigridLevel;
use super::rows::{
    ColourRows, GridRow, LINE, MIN_PLACES, as_slices, deinterleave, long_and_short, stride,
};
use super::transfer::weigh_load;
use crate::discrete::load_stats::LoadStats;
use crate::machine::extremes::max_or_nan;
use crate::machine::simd::{Largest, vectorised};
use crate::machine::threads::in_tasks;
use std::ops::Range;

/// Sets the load of a grid from `F` in natural order, divided by the shares of the nodes.
pub(super) fn set_finest(natural: &[f64], level: &mut MultigridLevel) -> LoadStats {
    let (n, places) = (level.n, stride(level.n));
    let rows = 2 * rows_per_task(n / 2);
    let parts = chunks(&mut level.load, rows * places).enumerate();
    let stats = parts.map(|(part, (red, black))| {
        let own = rows * part..rows * part + red.len() / places;
        vectorised(
            #[inline(always)]
            || {
                set_rows(n, own.clone(), natural, [red, black]);
                LoadStats::measure(&natural[own.start * (n + 1)..own.end * (n + 1)])
            },
        )
    });
    LoadStats::join(&stats.collect::<Vec<_>>())
}

/// Sets the load of the coarser grid by full weighting of the load of the finer one.
pub(super) fn restrict(fine: &MultigridLevel, coarse: &mut MultigridLevel) {
    let n = coarse.n;
    let rows = rows_per_task(n);
    let fine = as_slices(&fine.load);
    let parts = chunks(&mut coarse.load, rows * stride(n)).enumerate();
    let largest = parts.map(|(part, (red, black))| {
        let mut row = vec![0.0; n + 1];
        vectorised(
            #[inline(always)]
            || weigh_rows(n, fine, part * rows, [red, black], &mut row),
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

/// Number of rows of the load that one task works on.
fn rows_per_task(n: usize) -> usize {
    MIN_PLACES.div_ceil(stride(n))
}

/// Chunks of `places` places of each colour.
fn chunks(
    [red, black]: &mut [ColourRows; 2],
    places: usize,
) -> impl IndexedParallelIterator<Item = (&mut [f64], &mut [f64])> {
    in_tasks(red.par_chunks_mut(places).zip(black.par_chunks_mut(places)), 2 * places)
}

/// Sets some rows of the load of the mirrored stencil from `F` in natural order.
#[inline(always)]
fn set_rows(n: usize, rows: Range<usize>, natural: &[f64], [red, black]: [&mut [f64]; 2]) {
    let stride = stride(n);
    let halves = red.chunks_exact_mut(stride).zip(black.chunks_exact_mut(stride));
    for (j, (red, black)) in rows.zip(halves) {
        let source = &natural[j * (n + 1)..][..n + 1];
        let [long, short] = long_and_short(j, [red, black]);
        deinterleave(source, long, short);
        let factor = 1.0 / (GridRow { n, j }).share();
        if factor != 1.0 {
            long.iter_mut().chain(&mut *short).for_each(|entry| *entry *= factor);
        }
        long[0] *= 2.0;
        long[n / 2] *= 2.0;
    }
}

/// Sets rows of the load of a grid with `n` cells per side, from row `first` on, to the full weighting of the finer
/// load; `row` is a buffer. Returns the largest entry before the division by the shares of the nodes.
#[inline(always)]
fn weigh_rows(
    n: usize,
    fine: [&[f64]; 2],
    first: usize,
    [red, black]: [&mut [f64]; 2],
    row: &mut [f64],
) -> f64 {
    let stride = stride(n);
    let mut largest = Largest::default();
    let halves = red.chunks_exact_mut(stride).zip(black.chunks_exact_mut(stride));
    for (j, (red, black)) in (first..).zip(halves) {
        let at = GridRow { n, j };
        weigh_load(at, fine, row);
        let factor = at.share();
        largest.see(factor, &row[1..n]);
        largest.see(0.5 * factor, &[row[0], row[n]]);
        let [long, short] = long_and_short(j, [red, black]);
        deinterleave(row, long, short);
    }
    largest.value()
}
