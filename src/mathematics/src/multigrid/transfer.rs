//! Linear prolongation and its transpose, full weighting, slab by slab.
//!
//! Both act between red and black rows. Only black values are prolongated, since the following half-sweep replaces all
//! red values. Only red residuals are restricted, since black residuals vanish after a half-sweep over the black nodes.

use super::buffers::Buffers;
use super::layout::{At, Dimension, Slab, mirrored, places_per_slab, row_from};
use super::rows::{Colour, deinterleave, long_and_short};
use super::stencil::{Boundary, edges};

/// Full weighting of one slab, which differs between the square and the cube.
pub(super) trait Weighting: Dimension {
    /// Sets `row`, row `at` of the coarser grid in natural order, to the full weighting of red residuals.
    ///
    /// `residuals` are the fine slabs below, at and above the coarse slab, mirrored at the boundary.
    fn weigh_residuals(at: At, residuals: [&[f64]; 3], row: &mut [f64]);

    /// Sets `row`, row `at` of the coarser grid in natural order, to the full weighting of the load of both colours.
    fn weigh_load(at: At, load: &FineLoad, row: &mut [f64]);
}

/// Red and black load of some slabs of the finer grid.
#[derive(Clone, Copy)]
pub(super) struct FineLoad<'a> {
    /// Red and black slabs from `first` on.
    pub(super) slabs: [&'a [f64]; 2],
    pub(super) first: usize,
    /// The red and the black slab before `first`, or empty slices if no slab there is needed.
    pub(super) before: [&'a [f64]; 2],
    /// Number of places of one colour in a slab.
    pub(super) places: usize,
}

impl<'a> FineLoad<'a> {
    /// Slab `s` of one colour.
    #[inline(always)]
    pub(super) fn slab(&self, colour: Colour, s: usize) -> &'a [f64] {
        match s.checked_sub(self.first) {
            Some(s) => &self.slabs[colour as usize][s * self.places..(s + 1) * self.places],
            None => self.before[colour as usize],
        }
    }
}

/// A correction on the coarser grid that is to be added to a slab.
#[derive(Clone, Copy)]
pub(super) struct CoarseCorrection<'a> {
    /// Red and black values of the coarser grid.
    pub(super) values: [&'a [f64]; 2],
    pub(super) factor: f64,
    /// Boundary condition of the finer grid.
    pub(super) boundary: Boundary<'a>,
}

/// Red and black load of the coarser grid from slab `first` on.
pub(super) struct CoarseLoad<'a> {
    pub(super) first: usize,
    pub(super) red: &'a mut [f64],
    pub(super) black: &'a mut [f64],
}

/// Row `at` of both colours of a grid, its long part first.
#[inline(always)]
fn long_and_short_row<D: Dimension>([red, black]: [&[f64]; 2], at: At) -> [&[f64]; 2] {
    let row = [row_from::<D>(red, 0, at), row_from::<D>(black, 0, at)];
    long_and_short(at.r + at.s, row)
}

/// Coarse indices next to the fine index `i`; equal if `i` lies on the coarser grid.
#[inline(always)]
fn coarse_neighbours(i: usize) -> [usize; 2] {
    [i / 2, i.div_ceil(2)]
}

impl Buffers {
    /// Neighbours on the coarser grid of the black nodes of row `at`.
    #[inline(always)]
    fn neighbours<'b, D: Dimension>(
        &'b mut self,
        at: At,
        coarse: [&'b [f64]; 2],
    ) -> CoarseNeighbours<'b> {
        let n = at.n / 2;
        let ([south, north], [below, above]) = (coarse_neighbours(at.r), coarse_neighbours(at.s));
        let [mut even, mut odd] = long_and_short_row::<D>(coarse, At { n, r: south, s: below });
        let Self { even: even_sum, odd: odd_sum, .. } = self;
        let rest = [(north, below), (south, above), (north, above)];
        let rest = match (south < north, below < above) {
            (false, false) => &rest[..0],
            (true, false) => &rest[..1],
            (false, true) => &rest[1..2],
            (true, true) => &rest[..],
        };
        for (k, &(r, s)) in rest.iter().enumerate() {
            let [long, short] = long_and_short_row::<D>(coarse, At { n, r, s });
            if k == 0 {
                set_sum(even_sum, even, long);
                set_sum(odd_sum, odd, short);
            } else {
                add_row(even_sum, long);
                add_row(odd_sum, short);
            }
        }
        if !rest.is_empty() {
            (even, odd) = (even_sum, odd_sum);
        }
        let (long, pairs) = (at.is_long(Colour::Black), n / 2);
        let weight = if long { 1.0 } else { 0.5 } / (rest.len() + 1) as f64;
        CoarseNeighbours { long, even: &even[..pairs + 1], odd: &odd[..pairs], weight }
    }

    /// Sets the black values of a slab to the prolongation.
    ///
    /// Coarse values are nonnegative on the boundary, hence so are their means.
    #[inline(always)]
    pub(super) fn interpolate<D: Dimension>(
        &mut self,
        slab: Slab,
        coarse: [&[f64]; 2],
        black: &mut [f64],
    ) {
        for at in slab.rows::<D>() {
            let near = self.neighbours::<D>(at, coarse);
            let (target, weight, half) = (&mut black[at.in_slab()], near.weight, at.n / 2);
            near.combine(&mut target[..half], |_, sum| weight * sum);
            if near.long {
                target[half] = weight * near.sum(half);
            }
        }
    }

    /// Adds a correction to the black values of a slab, except at nodes in contact; under the law no value changes its sign.
    #[inline(always)]
    pub(super) fn correct<D: Dimension>(
        &mut self,
        slab: Slab,
        correction: CoarseCorrection,
        black: &mut [f64],
    ) {
        let CoarseCorrection { values, factor, boundary } = correction;
        for at in slab.rows::<D>() {
            let near = self.neighbours::<D>(at, values);
            let (target, weight) = (&mut black[at.in_slab()], factor * near.weight);
            // The loop covers the whole row, so that it is aligned; the ends are then set again.
            let ends = [target[0], target[at.n / 2]];
            let inner = at.is_inner::<D>();
            if inner {
                near.combine(&mut target[..at.n / 2], |value, sum| value + weight * sum);
            }
            for (m, node) in edges::<D>(at, Colour::Black) {
                let value = if inner { ends[usize::from(m > 0)] } else { target[m] };
                target[m] = boundary.corrected(node, value, weight * near.sum(m));
            }
        }
    }

    /// Buffer for the residuals of slab `s`.
    #[inline(always)]
    pub(super) fn residuals(&mut self, s: usize) -> &mut [f64] {
        &mut self.residuals[s % 3]
    }

    /// Sets the slab of the coarse load whose three fine slabs of residuals are complete with `slab`, if there is one.
    ///
    /// Slabs must come in increasing order from `first` on.
    #[inline(always)]
    pub(super) fn restrict<D: Weighting>(
        &mut self,
        Slab { n, s }: Slab,
        first: usize,
        coarse_load: CoarseLoad,
    ) {
        let emitted = if s == n {
            n / 2
        } else if s % 2 == 1 && (s == 1 || s >= first + 2) {
            s / 2
        } else {
            return;
        };
        let middle = 2 * emitted;
        let [below, above] = mirrored(n, middle);
        let residuals = [below, middle, above].map(|s| &self.residuals[s % 3][..]);
        let places = places_per_slab::<D>(n / 2);
        let start = (emitted - coarse_load.first) * places;
        let red = &mut coarse_load.red[start..start + places];
        let black = &mut coarse_load.black[start..start + places];
        for at in (Slab { n: n / 2, s: emitted }).rows::<D>() {
            D::weigh_residuals(at, residuals, &mut self.row);
            let halves = [&mut red[at.in_slab()], &mut black[at.in_slab()]];
            let [long, short] = long_and_short(at.r + at.s, halves);
            deinterleave(&self.row, long, short);
        }
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

/// Adds a row to `sum`.
#[inline(always)]
fn add_row(sum: &mut [f64], row: &[f64]) {
    sum.iter_mut().zip(row).for_each(|(sum, row)| *sum += row);
}
