//! Full weighting on the cube, row by row.

use super::Cube;
use crate::multigrid::layout::{At, mirrored};
use crate::multigrid::rows::Colour;
use crate::multigrid::transfer::Weighting;

/// Half of the sum over a node and its neighbours in the surrounding cube, with weights 1, 1/2, 1/4, 1/8 by
/// distance. The half is the ratio of the couplings on both grids.
impl Weighting for Cube {
    #[inline(always)]
    fn weigh_residuals(at: At, residuals: [&[f64]; 3], row: &mut [f64]) {
        let residual = |slab: usize, fine: At| &residuals[slab][fine.in_slab()];
        weigh_red(&mut row[..at.n + 1], Around::new(at, residual));
    }

    #[inline(always)]
    fn weigh_load<'a>(at: At, load: impl Fn(Colour, usize) -> &'a [f64], row: &mut [f64]) {
        let row = &mut row[..at.n + 1];
        weigh_red(row, Around::new(at, |_, fine| &load(Colour::Red, fine.s)[fine.in_slab()]));
        weigh_black(row, Around::new(at, |_, fine| &load(Colour::Black, fine.s)[fine.in_slab()]));
    }
}

/// The rows of one colour of the finer grid around a coarse row, each with as many places as that has nodes.
struct Around<'a> {
    middle: &'a [f64],
    sides: [&'a [f64]; 4],
    diagonals: [&'a [f64]; 4],
}

impl<'a> Around<'a> {
    /// `row` is given the slab, 0 to 2 from below, and the place of a row.
    #[inline(always)]
    fn new(at: At, row: impl Fn(usize, At) -> &'a [f64]) -> Self {
        let (n, r, s) = (2 * at.n, 2 * at.r, 2 * at.s);
        let ([south, north], [below, above]) = (mirrored(n, r), mirrored(n, s));
        let row =
            |slab: usize, r: usize| &row(slab, At { n, r, s: [below, s, above][slab] })[..at.n + 1];
        Self {
            middle: row(1, r),
            sides: [row(0, r), row(1, south), row(1, north), row(2, r)],
            diagonals: [row(0, south), row(0, north), row(2, south), row(2, north)],
        }
    }
}

/// The red part of full weighting: rows at the sides lie between the coarse nodes.
#[inline(always)]
fn weigh_red(coarse: &mut [f64], Around { middle, sides, diagonals }: Around) {
    let half = coarse.len() - 1;
    coarse[0] = 0.5 * (middle[0] + 0.25 * sum(diagonals, 0) + 0.5 * sum(sides, 0));
    for (k, entry) in (1..).zip(&mut coarse[1..half]) {
        let beside = sum(sides, k - 1) + sum(sides, k);
        *entry = 0.5 * (middle[k] + 0.25 * (sum(diagonals, k) + beside));
    }
    let last = half - 1;
    coarse[half] = 0.5 * (middle[half] + 0.25 * sum(diagonals, half) + 0.5 * sum(sides, last));
}

/// The black part of full weighting: rows in the middle and on the diagonals lie between the coarse nodes.
#[inline(always)]
fn weigh_black(coarse: &mut [f64], Around { middle, sides, diagonals }: Around) {
    let half = coarse.len() - 1;
    let between = |k: usize| middle[k] + 0.25 * sum(diagonals, k);
    coarse[0] += 0.5 * (between(0) + 0.5 * sum(sides, 0));
    for (k, entry) in (1..).zip(&mut coarse[1..half]) {
        *entry += 0.25 * (between(k - 1) + between(k) + sum(sides, k));
    }
    coarse[half] += 0.5 * (between(half - 1) + 0.5 * sum(sides, half));
}

#[inline(always)]
fn sum(rows: [&[f64]; 4], k: usize) -> f64 {
    (rows[0][k] + rows[1][k]) + (rows[2][k] + rows[3][k])
}
