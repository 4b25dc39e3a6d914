//! Full weighting on the cube, row by row.
//!
//! The result is half of the sum over a node and its 26 neighbours on the finer grid, with weights 1, 1/2, 1/4 and 1/8
//! by distance. The half is the ratio of the couplings on both grids.

use super::Cube;
use crate::multigrid::layout::{At, mirrored};
use crate::multigrid::rows::Colour;
use crate::multigrid::transfer::{FineLoad, Weighting};

impl Weighting for Cube {
    #[inline(always)]
    fn weigh_residuals(at: At, residuals: [&[f64]; 3], row: &mut [f64]) {
        weigh_red(&mut row[..at.n + 1], NeighbourRows::new(at, |slab, _| residuals[slab]));
    }

    #[inline(always)]
    fn weigh_load(at: At, load: &FineLoad, row: &mut [f64]) {
        let row = &mut row[..at.n + 1];
        weigh_red(row, NeighbourRows::new(at, |_, s| load.slab(Colour::Red, s)));
        weigh_black(row, NeighbourRows::new(at, |_, s| load.slab(Colour::Black, s)));
    }
}

/// Rows of one colour of the finer grid around a coarse row, each with as many places as that has nodes.
struct NeighbourRows<'a> {
    middle: &'a [f64],
    sides: [&'a [f64]; 4],
    diagonals: [&'a [f64]; 4],
}

impl<'a> NeighbourRows<'a> {
    /// Takes rows from three slabs: `slab(k, s)` is slab `s` of the finer grid, the `k`-th from below, 0 to 2.
    #[inline(always)]
    fn new(at: At, slab: impl Fn(usize, usize) -> &'a [f64]) -> Self {
        let (n, r, s) = (2 * at.n, 2 * at.r, 2 * at.s);
        let ([south, north], [below, above]) = (mirrored(n, r), mirrored(n, s));
        let (lower, own, upper) = (slab(0, below), slab(1, s), slab(2, above));
        // Written out: a call of `map` is not inlined, and takes as long as a short row.
        Self {
            middle: row_start(own, at.n, r),
            sides: [
                row_start(lower, at.n, r),
                row_start(own, at.n, south),
                row_start(own, at.n, north),
                row_start(upper, at.n, r),
            ],
            diagonals: [
                row_start(lower, at.n, south),
                row_start(lower, at.n, north),
                row_start(upper, at.n, south),
                row_start(upper, at.n, north),
            ],
        }
    }
}

/// First `coarse_n + 1` places of row `r` of a slab of the finer grid.
#[inline(always)]
fn row_start(slab: &[f64], coarse_n: usize, r: usize) -> &[f64] {
    &slab[At { n: 2 * coarse_n, r, s: 0 }.in_slab()][..coarse_n + 1]
}

/// Sets a coarse row to the red part of full weighting: rows at the sides lie between the coarse nodes.
#[inline(always)]
fn weigh_red(coarse: &mut [f64], NeighbourRows { middle, sides, diagonals }: NeighbourRows) {
    let half = coarse.len() - 1;
    coarse[0] = 0.5 * (middle[0] + 0.25 * sum(diagonals, 0) + 0.5 * sum(sides, 0));
    for (k, entry) in (1..).zip(&mut coarse[1..half]) {
        let beside = sum(sides, k - 1) + sum(sides, k);
        *entry = 0.5 * (middle[k] + 0.25 * (sum(diagonals, k) + beside));
    }
    let last = half - 1;
    coarse[half] = 0.5 * (middle[half] + 0.25 * sum(diagonals, half) + 0.5 * sum(sides, last));
}

/// Adds the black part of full weighting to a coarse row: the middle row and the diagonal ones lie between the coarse
/// nodes.
#[inline(always)]
fn weigh_black(coarse: &mut [f64], NeighbourRows { middle, sides, diagonals }: NeighbourRows) {
    let half = coarse.len() - 1;
    let last = half - 1;
    coarse[0] += 0.5 * ((middle[0] + 0.25 * sum(diagonals, 0)) + 0.5 * sum(sides, 0));
    for (k, entry) in (1..).zip(&mut coarse[1..half]) {
        let before = middle[k - 1] + 0.25 * sum(diagonals, k - 1);
        let after = middle[k] + 0.25 * sum(diagonals, k);
        *entry += 0.25 * (before + after + sum(sides, k));
    }
    coarse[half] += 0.5 * ((middle[last] + 0.25 * sum(diagonals, last)) + 0.5 * sum(sides, half));
}

#[inline(always)]
fn sum(rows: [&[f64]; 4], k: usize) -> f64 {
    (rows[0][k] + rows[1][k]) + (rows[2][k] + rows[3][k])
}
