//! The load on all grids: on the finest as it is given, on the others by full weighting.

use rayon::prelude::*;

use super::input::Extent;
use super::layout::{At, rows_per_slab, slab};
use super::level::Level;
use super::rows::{Colour, LINE, MIN_PLACES, Rows, deinterleave, long_and_short, worse};
use super::stencil::coupling;
use super::transfer::Weighting;
use crate::discrete::simd::{Largest, vectorised};
use crate::discrete::threads::in_tasks;
use std::ops::Range;

/// Sets the load of a grid from `F` in natural order, divided by the couplings.
pub(super) fn take<D: Weighting>(natural: &[f64], level: &mut Level) -> Extent {
    let (n, Level { load: [red, black], .. }) = (level.n, level);
    take_slabs::<D>(n, 0..n + 1, natural, [red, black]);
    Extent::of(natural)
}

/// The same, and sets the load of the coarser grid too, while that of the finer one is in the cache.
pub(super) fn take_and_weigh<D: Weighting>(
    natural: &[f64],
    fine: &mut Level,
    coarse: &mut Level,
) -> Extent {
    let n = fine.n;
    let (slab, per_slab) = (slab::<D>(n), rows_per_slab::<D>(n) * (n + 1));
    let (coarse_slab, slabs) = piece::<D>(coarse.n);
    let fine = pieces(&mut fine.load, 2 * slabs * slab);
    let pieces = fine.zip(pieces(&mut coarse.load, slabs * coarse_slab)).enumerate();
    let parts = pieces.map(|(piece, ((red, black), (coarse_red, coarse_black)))| {
        let first = 2 * slabs * piece;
        let own = first..first + red.len() / slab;
        let mut row = vec![0.0; n / 2 + 1];
        // The slab before, which the first of the coarser grid needs too.
        let mut before =
            if first > 0 { [vec![0.0; slab], vec![0.0; slab]] } else { [vec![], vec![]] };
        vectorised(
            #[inline(always)]
            || {
                let [before_red, before_black] = &mut before;
                if first > 0 {
                    take_slabs::<D>(n, first - 1..first, natural, [before_red, before_black]);
                }
                take_slabs::<D>(n, own.clone(), natural, [red, black]);
                let of_slab = |colour: Colour, s: usize| match s.checked_sub(first) {
                    Some(s) => &[&*red, &*black][colour as usize][s * slab..(s + 1) * slab],
                    None => &before[colour as usize],
                };
                let coarse = [coarse_red, coarse_black];
                let largest = weigh_slabs::<D>(n / 2, of_slab, first / 2, coarse, &mut row);
                let natural = &natural[own.start * per_slab..own.end * per_slab];
                (Extent::of(natural), largest)
            },
        )
    });
    let (extents, largest): (Vec<_>, Vec<_>) = parts.unzip();
    coarse.load_scale = largest.into_iter().fold(0.0, worse);
    Extent::join(&extents)
}

/// Makes the load of the coarser grid by full weighting of that of the finer one.
pub(super) fn weigh<D: Weighting>(fine: &Level, coarse: &mut Level) {
    let (fine_slab, (slab, slabs)) = (slab::<D>(fine.n), piece::<D>(coarse.n));
    let of_slab =
        |colour: Colour, s: usize| &fine.load[colour as usize][s * fine_slab..(s + 1) * fine_slab];
    let n = coarse.n;
    let pieces = pieces(&mut coarse.load, slabs * slab).enumerate();
    let largest = pieces.map(|(piece, (red, black))| {
        let mut row = vec![0.0; n + 1];
        vectorised(
            #[inline(always)]
            || weigh_slabs::<D>(n, of_slab, piece * slabs, [red, black], &mut row),
        )
    });
    coarse.load_scale = largest.reduce(|| 0.0, worse);
}

/// Euclidean norm of the load of the mirrored stencil, the same bits for any number of threads.
pub(super) fn norm(level: &Level) -> f64 {
    let squares = |places: &[f64]| {
        vectorised(
            #[inline(always)]
            || {
                let mut lanes = [0.0; LINE];
                // Rows are rounded to whole lines, with zeros.
                for line in places.as_chunks::<LINE>().0 {
                    (0..LINE).for_each(|lane| lanes[lane] += line[lane] * line[lane]);
                }
                lanes.iter().sum::<f64>()
            },
        )
    };
    let [red, black] = level.load.each_ref().map(|half| half.par_chunks(MIN_PLACES));
    // Side by side: one after the other they would be split between threads however short they are.
    let halves = in_tasks(red.zip(black), 2 * MIN_PLACES);
    let sums: Vec<f64> = halves.map(|(red, black)| squares(red) + squares(black)).collect();
    sums.iter().sum::<f64>().sqrt()
}

/// Places of one colour in a slab, and slabs in a piece of the load that one task works on.
fn piece<D: Weighting>(n: usize) -> (usize, usize) {
    let slab = slab::<D>(n);
    (slab, MIN_PLACES.div_ceil(slab))
}

/// Pieces of so many places of each colour.
fn pieces(
    [red, black]: &mut [Rows; 2],
    places: usize,
) -> impl IndexedParallelIterator<Item = (&mut [f64], &mut [f64])> {
    in_tasks(red.par_chunks_mut(places).zip(black.par_chunks_mut(places)), 2 * places)
}

/// From `F` in natural order to the load of the mirrored stencil, for some slabs.
#[inline(always)]
fn take_slabs<D: Weighting>(
    n: usize,
    slabs: Range<usize>,
    natural: &[f64],
    [red, black]: [&mut [f64]; 2],
) {
    let (rows, slab, inside) = (rows_per_slab::<D>(n), slab::<D>(n), 1.0 / coupling::<D>(n));
    let halves = red.chunks_exact_mut(slab).zip(black.chunks_exact_mut(slab));
    for (s, (red, black)) in slabs.zip(halves) {
        for at in At::of_slab::<D>(n, s) {
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

/// Slabs of the load of a grid with `n` cells per side, from `first` on: full weighting of that of the finer one,
/// `finer(colour, s)` its slabs; `row` is room for a row. Returns the largest entry before the division by couplings.
#[inline(always)]
fn weigh_slabs<'a, D: Weighting>(
    n: usize,
    finer: impl Fn(Colour, usize) -> &'a [f64] + Copy,
    first: usize,
    [red, black]: [&mut [f64]; 2],
    row: &mut [f64],
) -> f64 {
    let slab = slab::<D>(n);
    let mut largest = Largest::default();
    let slabs = red.chunks_exact_mut(slab).zip(black.chunks_exact_mut(slab));
    for (s, (red, black)) in (first..).zip(slabs) {
        for at in At::of_slab::<D>(n, s) {
            D::weigh_load(at, finer, row);
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
