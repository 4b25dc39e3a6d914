//! Full weighting on the square, row by row.
//!
//! The weights are 1 at the coarse node, 1/2 at its four nearest and 1/4 at its four diagonal neighbours.

use super::Square;
use crate::multigrid::layout::{At, mirrored};
use crate::multigrid::rows::Colour;
use crate::multigrid::transfer::{FineLoad, Weighting};

impl Weighting for Square {
    #[inline(always)]
    fn weigh_residuals(_: At, [below, middle, above]: [&[f64]; 3], row: &mut [f64]) {
        weigh_red(row, [middle, below, above]);
    }

    #[inline(always)]
    fn weigh_load(at: At, load: &FineLoad, row: &mut [f64]) {
        let middle = 2 * at.s;
        let [below, above] = mirrored(2 * at.n, middle);
        let slabs = [middle, below, above];
        weigh_red(row, slabs.map(|s| load.slab(Colour::Red, s)));
        weigh_black(row, slabs.map(|s| load.slab(Colour::Black, s)));
    }
}

/// Sets a coarse row to the red part of full weighting: the node itself and a quarter of its four diagonal neighbours.
#[inline(always)]
fn weigh_red(coarse: &mut [f64], [middle, lower, upper]: [&[f64]; 3]) {
    let half = coarse.len() - 1;
    coarse[0] = middle[0] + 0.5 * (lower[0] + upper[0]);
    // The loop includes the last node, so that it fills whole vectors; that node is set again afterwards.
    let (inner, middle_inner) = (&mut coarse[1..half + 1], &middle[1..half + 1]);
    let (lower_west, lower_east) = (&lower[..half], &lower[1..half + 1]);
    let (upper_west, upper_east) = (&upper[..half], &upper[1..half + 1]);
    for k in 0..half {
        let diagonals = (lower_west[k] + lower_east[k]) + (upper_west[k] + upper_east[k]);
        inner[k] = middle_inner[k] + 0.25 * diagonals;
    }
    coarse[half] = middle[half] + 0.5 * (lower[half - 1] + upper[half - 1]);
}

/// Adds the black part of full weighting to a coarse row: half of the four nearest neighbours.
#[inline(always)]
fn weigh_black(coarse: &mut [f64], [along, below, above]: [&[f64]; 3]) {
    let half = coarse.len() - 1;
    coarse[0] += 0.5 * (2.0 * along[0] + (below[0] + above[0]));
    let last = coarse[half] + 0.5 * (2.0 * along[half - 1] + (below[half] + above[half]));
    let (inner, below, above) =
        (&mut coarse[1..half + 1], &below[1..half + 1], &above[1..half + 1]);
    let (west, east) = (&along[..half], &along[1..half + 1]);
    for k in 0..half {
        inner[k] += 0.5 * ((west[k] + east[k]) + (below[k] + above[k]));
    }
    coarse[half] = last;
}
