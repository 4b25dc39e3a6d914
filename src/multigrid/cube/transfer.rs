//! Full weighting on the cube, row by row.

use super::Cube;
use crate::multigrid::buffers::Sums;
use crate::multigrid::layout::{At, mirrored};
use crate::multigrid::rows::{Colour, long_and_short};
use crate::multigrid::transfer::Weighting;

/// Half of the sum over a node and its neighbours in the surrounding cube, with weights 1, 1/2, 1/4, 1/8 by
/// distance. The half is the ratio of the couplings on both grids.
impl Weighting for Cube {
    #[inline(always)]
    fn weigh_residuals(at: At, residuals: [&[f64]; 3], sums: &mut Sums) {
        weigh(at, sums, |sums, fine, slab, weight| {
            let residual = &residuals[slab][fine.in_slab()];
            let sum = if fine.is_long(Colour::Red) { &mut sums.even } else { &mut sums.odd };
            add(sum, residual, weight);
        });
    }

    #[inline(always)]
    fn weigh_load<'a>(at: At, load: impl Fn(Colour, usize) -> &'a [f64], sums: &mut Sums) {
        weigh(at, sums, |sums, fine, _, weight| {
            let halves = [Colour::Red, Colour::Black].map(|c| &load(c, fine.s)[fine.in_slab()]);
            let [long, short] = long_and_short(fine.r + fine.s, halves);
            add(&mut sums.even, long, weight);
            add(&mut sums.odd, short, weight);
        });
    }
}

/// Makes the coarse row `at`; `add_row` adds a row of the finer grid, in the slab below, at or above the
/// coarse one (0, 1, 2), to the sums at even and at odd columns.
#[inline(always)]
fn weigh(at: At, sums: &mut Sums, add_row: impl Fn(&mut Sums, At, usize, f64)) {
    let n = 2 * at.n;
    sums.even.fill(0.0);
    sums.odd.fill(0.0);
    let near = |i: usize| {
        let [before, after] = mirrored(n, i);
        [(before, 0.5), (i, 1.0), (after, 0.5)]
    };
    for (slab, (s, weight_s)) in near(2 * at.s).into_iter().enumerate() {
        for (r, weight_r) in near(2 * at.r) {
            add_row(sums, At { n, r, s }, slab, weight_r * weight_s);
        }
    }
    let half = at.n;
    let (even, odd) = (&sums.even[..half + 1], &sums.odd[..half]);
    let row = &mut sums.row[..half + 1];
    row[0] = 0.5 * (even[0] + odd[0]);
    row[half] = 0.5 * (even[half] + odd[half - 1]);
    for i in 1..half {
        row[i] = 0.5 * (even[i] + 0.5 * (odd[i - 1] + odd[i]));
    }
}

#[inline(always)]
fn add(sum: &mut [f64], row: &[f64], weight: f64) {
    sum.iter_mut().zip(row).for_each(|(sum, value)| *sum += weight * value);
}
