//! Linear prolongation and its transpose, full weighting, row by row.
//!
//! Both act between red and black rows. Only black values are prolongated, since the following half-sweep replaces all
//! red values. Only red residuals are restricted, since black residuals vanish after a half-sweep over the black nodes.
//! The weights are 1 at the coarse node, 1/2 at its four nearest and 1/4 at its four diagonal neighbours.

use super::rows::{Buffers, Colour, GridRow, deinterleave, long_and_short, mirrored, stride};
use super::stencil::{Boundary, edges};

/// A correction on the coarser grid that is to be added to a row.
#[derive(Clone, Copy)]
pub(super) struct CoarseCorrection<'a> {
    /// Red and black values of the coarser grid.
    pub(super) values: [&'a [f64]; 2],
    pub(super) factor: f64,
    /// Boundary condition of the finer grid.
    pub(super) boundary: Boundary<'a>,
}

/// Red and black load of the coarser grid from row `first` on.
pub(super) struct CoarseLoad<'a> {
    pub(super) first: usize,
    pub(super) red: &'a mut [f64],
    pub(super) black: &'a mut [f64],
}

/// A row of both colours of a grid, its long part first.
#[inline(always)]
fn long_and_short_row([red, black]: [&[f64]; 2], row: GridRow) -> [&[f64]; 2] {
    long_and_short(row.j, [row.of(red, 0), row.of(black, 0)])
}

impl Buffers {
    /// Neighbours on the coarser grid of the black nodes of a row.
    #[inline(always)]
    fn neighbours<'b>(&'b mut self, row: GridRow, coarse: [&'b [f64]; 2]) -> CoarseNeighbours<'b> {
        let n = row.n / 2;
        // Equal if the row lies on the coarser grid.
        let (below, above) = (row.j / 2, row.j.div_ceil(2));
        let [mut even, mut odd] = long_and_short_row(coarse, GridRow { n, j: below });
        let mut weight = 1.0;
        if below < above {
            let [long, short] = long_and_short_row(coarse, GridRow { n, j: above });
            set_sum(&mut self.even, even, long);
            set_sum(&mut self.odd, odd, short);
            (even, odd, weight) = (&self.even, &self.odd, 0.5);
        }
        let (long, pairs) = (row.is_long(Colour::Black), n / 2);
        if !long {
            weight *= 0.5;
        }
        CoarseNeighbours { long, even: &even[..pairs + 1], odd: &odd[..pairs], weight }
    }

    /// Sets the black values of a row to the prolongation.
    #[inline(always)]
    pub(super) fn interpolate(&mut self, row: GridRow, coarse: [&[f64]; 2], black: &mut [f64]) {
        let near = self.neighbours(row, coarse);
        let (weight, half) = (near.weight, row.n / 2);
        near.combine(&mut black[..half], |_, sum| weight * sum);
        if near.long {
            black[half] = weight * near.sum(half);
        }
    }

    /// Adds a correction to the black values of a row, except at nodes in contact; under the law no value changes its
    /// sign.
    #[inline(always)]
    pub(super) fn correct(
        &mut self,
        row: GridRow,
        correction: CoarseCorrection,
        black: &mut [f64],
    ) {
        let CoarseCorrection { values, factor, boundary } = correction;
        let near = self.neighbours(row, values);
        let (weight, half, inner) = (factor * near.weight, row.n / 2, row.is_inner());
        // The loop covers the whole row, so that it is aligned; the ends are then set again.
        let ends = [black[0], black[half]];
        if inner {
            near.combine(&mut black[..half], |value, sum| value + weight * sum);
        }
        for (m, node) in edges(row, Colour::Black) {
            let value = if inner { ends[usize::from(m > 0)] } else { black[m] };
            black[m] = boundary.corrected(node, value, weight * near.sum(m));
        }
    }

    /// Buffer for the residuals of row `j`.
    #[inline(always)]
    pub(super) fn residuals(&mut self, j: usize) -> &mut [f64] {
        &mut self.residuals[j % 3]
    }

    /// Sets the row of the coarse load whose three fine rows of residuals are complete with row `j`, if there is one.
    ///
    /// Rows must come in increasing order from `first` on.
    #[inline(always)]
    pub(super) fn restrict(
        &mut self,
        GridRow { n, j }: GridRow,
        first: usize,
        coarse_load: CoarseLoad,
    ) {
        let emitted = if j == n {
            n / 2
        } else if j % 2 == 1 && (j == 1 || j >= first + 2) {
            j / 2
        } else {
            return;
        };
        let middle = 2 * emitted;
        let [below, above] = mirrored(n, middle);
        let residuals = [middle, below, above].map(|j| &self.residuals[j % 3][..]);
        let stride = stride(n / 2);
        let own =
            (emitted - coarse_load.first) * stride..(emitted - coarse_load.first + 1) * stride;
        weigh_red(&mut self.row, residuals);
        let halves = [&mut coarse_load.red[own.clone()], &mut coarse_load.black[own]];
        let [long, short] = long_and_short(emitted, halves);
        deinterleave(&self.row, long, short);
    }
}

/// Sums over the coarse rows next to a row of black nodes, at even and at odd columns of the coarser grid.
#[derive(Clone, Copy)]
struct CoarseNeighbours<'a> {
    /// True if the row is long: then each of its nodes lies at a column of the coarser grid, otherwise between two.
    long: bool,
    even: &'a [f64],
    odd: &'a [f64],
    /// Ratio of the prolongation to the sums.
    weight: f64,
}

impl CoarseNeighbours<'_> {
    /// Sum at column `m` of the coarser grid.
    #[inline(always)]
    fn column(self, m: usize) -> f64 {
        if m.is_multiple_of(2) { self.even[m / 2] } else { self.odd[m / 2] }
    }

    /// Sum over the neighbours of the `m`-th black node.
    #[inline(always)]
    fn sum(self, m: usize) -> f64 {
        if self.long { self.column(m) } else { self.column(m) + self.column(m + 1) }
    }

    /// Replaces each value `t` of an even number of places by `with(t, sum)`.
    #[inline(always)]
    fn combine(self, target: &mut [f64], with: impl Fn(f64, f64) -> f64) {
        let Self { long, even, odd, .. } = self;
        let (pairs, _) = target.as_chunks_mut::<2>();
        let len = pairs.len();
        let (west, odd, east) = (&even[..len], &odd[..len], &even[1..len + 1]);
        if long {
            for ((pair, west), odd) in pairs.iter_mut().zip(west).zip(odd) {
                *pair = [with(pair[0], *west), with(pair[1], *odd)];
            }
        } else {
            for (((pair, west), odd), east) in pairs.iter_mut().zip(west).zip(odd).zip(east) {
                *pair = [with(pair[0], west + odd), with(pair[1], odd + east)];
            }
        }
    }
}

/// Sets `sum` to the sum of two rows.
#[inline(always)]
fn set_sum(sum: &mut [f64], first: &[f64], second: &[f64]) {
    let pairs = sum.iter_mut().zip(second);
    pairs.zip(first).for_each(|((sum, second), first)| *sum = first + second);
}

/// Sets `row`, row `at` of the coarser grid in natural order, to the full weighting of the red and black load.
#[inline(always)]
pub(super) fn weigh_load(at: GridRow, [red, black]: [&[f64]; 2], row: &mut [f64]) {
    let (n, middle) = (2 * at.n, 2 * at.j);
    let [below, above] = mirrored(n, middle);
    let rows = [middle, below, above].map(|j| GridRow { n, j });
    weigh_red(row, rows.map(|row| row.of(red, 0)));
    weigh_black(row, rows.map(|row| row.of(black, 0)));
}

/// Sets a coarse row to the red part of full weighting: the node itself and a quarter of its four diagonal neighbours.
/// The fine rows at, below and above the coarse row are mirrored at the boundary.
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
