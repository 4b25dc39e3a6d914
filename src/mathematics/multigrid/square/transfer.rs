//! Full weighting on the square, row by row.

use super::Square;
use crate::multigrid::layout::{At, mirrored};
use crate::multigrid::rows::Colour;
use crate::multigrid::transfer::Weighting;

impl Weighting for Square {
    #[inline(always)]
    fn weigh_residuals(_: At, [below, middle, above]: [&[f64]; 3], row: &mut [f64]) {
        weigh_red(row, [middle, below, above]);
    }

    #[inline(always)]
    fn weigh_load<'a>(at: At, load: impl Fn(Colour, usize) -> &'a [f64], row: &mut [f64]) {
        let middle = 2 * at.s;
        let [below, above] = mirrored(2 * at.n, middle);
        let rows = |colour: Colour| [middle, below, above].map(|s| load(colour, s));
        weigh_red(row, rows(Colour::Red));
        weigh_black(row, rows(Colour::Black));
    }
}

/// The red part of full weighting: the node itself and a quarter of its four diagonal neighbours.
#[inline(always)]
fn weigh_red(coarse: &mut [f64], [middle, lower, upper]: [&[f64]; 3]) {
    let half = coarse.len() - 1;
    coarse[0] = middle[0] + 0.5 * (lower[0] + upper[0]);
    // Up to the last one, which is replaced: whole vectors.
    let (inner, middle_inner) = (&mut coarse[1..half + 1], &middle[1..half + 1]);
    let (lower_west, lower_east) = (&lower[..half], &lower[1..half + 1]);
    let (upper_west, upper_east) = (&upper[..half], &upper[1..half + 1]);
    for k in 0..half {
        let diagonals = (lower_west[k] + lower_east[k]) + (upper_west[k] + upper_east[k]);
        inner[k] = middle_inner[k] + 0.25 * diagonals;
    }
    coarse[half] = middle[half] + 0.5 * (lower[half - 1] + upper[half - 1]);
}

/// The black part of full weighting: half of the four nearest neighbours.
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
