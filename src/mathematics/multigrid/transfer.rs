//! Linear prolongation and its transpose, full weighting, slab by slab.
//!
//! Both act between red and black rows. Only black values are prolongated, since the half-sweep that
//! follows replaces all red ones; only red residuals are restricted, since black ones vanish after a
//! half-sweep over the black nodes.

use super::buffers::Buffers;
use super::layout::{At, Dimension, mirrored, rows_per_slab, slab};
use super::rows::{Colour, deinterleave, long_and_short, stride};
use super::stencil::{Boundary, edges};

/// Full weighting of one slab: what differs between the square and the cube.
pub trait Weighting: Dimension {
    /// Full weighting of red residuals into `row`, that `at` of the coarser grid, in natural order. `residuals`
    /// are the slabs below, at and above the coarse one, mirrored at the boundary.
    fn weigh_residuals(at: At, residuals: [&[f64]; 3], row: &mut [f64]);

    /// The same of the load of both colours; `load(colour, s)` is a slab of the finer grid.
    fn weigh_load<'a>(at: At, load: impl Fn(Colour, usize) -> &'a [f64], row: &mut [f64]);
}

impl Buffers {
    /// The sums whose multiples by a weight are the prolongation to the black nodes of a row, and the weight.
    #[inline(always)]
    fn neighbours<'b, D: Dimension>(
        &'b mut self,
        at: At,
        coarse: [&'b [f64]; 2],
    ) -> (Neighbours<'b>, f64) {
        let (half, rows) = (at.n / 2, rows_per_slab::<D>(at.n / 2));
        let stride = stride(half);
        let coarse_row = |r: usize, s: usize| {
            let row = |of_colour: &'b [f64]| &of_colour[(s * rows + r) * stride..][..stride];
            long_and_short(r + s, coarse.map(row))
        };
        let beside = |i: usize| [i / 2, i.div_ceil(2)];
        let ([south, north], [below, above]) = (beside(at.r), beside(at.s));
        let [mut even, mut odd] = coarse_row(south, below);
        let Self { even: even_sum, odd: odd_sum, .. } = self;
        let rest = [(north, below), (south, above), (north, above)];
        let rest = match (south < north, below < above) {
            (false, false) => &rest[..0],
            (true, false) => &rest[..1],
            (false, true) => &rest[1..2],
            (true, true) => &rest[..],
        };
        for (k, &(r, s)) in rest.iter().enumerate() {
            let [long, short] = coarse_row(r, s);
            add(k == 0, even_sum, even, long);
            add(k == 0, odd_sum, odd, short);
        }
        if !rest.is_empty() {
            (even, odd) = (even_sum, odd_sum);
        }
        let (long, pairs) = (at.is_long(Colour::Black), half / 2);
        let sums = Neighbours { long, even: &even[..pairs + 1], odd: &odd[..pairs] };
        (sums, if long { 1.0 } else { 0.5 } / (rest.len() + 1) as f64)
    }

    /// Sets the black slab to the prolongation.
    ///
    /// Coarse values are nonnegative on the boundary, hence so are their means.
    #[inline(always)]
    pub(super) fn interpolate<D: Dimension>(
        &mut self,
        (n, s): (usize, usize),
        coarse: [&[f64]; 2],
        black: &mut [f64],
    ) {
        for at in At::of_slab::<D>(n, s) {
            let (sums, weight) = self.neighbours::<D>(at, coarse);
            let target = &mut black[at.in_slab()];
            sums.combine(&mut target[..n / 2], |_, sum| weight * sum);
            if sums.long {
                target[n / 2] = weight * sums.at(n / 2);
            }
        }
    }

    /// Adds `factor` times the prolongation to the black slab, except at nodes in contact; projects.
    #[inline(always)]
    pub(super) fn correct<D: Dimension>(
        &mut self,
        (n, s): (usize, usize),
        coarse: [&[f64]; 2],
        boundary: Boundary,
        factor: f64,
        black: &mut [f64],
    ) {
        for at in At::of_slab::<D>(n, s) {
            let (sums, weight) = self.neighbours::<D>(at, coarse);
            let (target, weight) = (&mut black[at.in_slab()], factor * weight);
            // The whole row, aligned; the ends again.
            let ends = [target[0], target[n / 2]];
            let inner = at.is_inner::<D>();
            if inner {
                sums.combine(&mut target[..n / 2], |value, sum| value + weight * sum);
            }
            for (m, edge) in edges::<D>(at, Colour::Black) {
                let value = if inner { ends[usize::from(m > 0)] } else { target[m] };
                target[m] = boundary.corrected(edge, value, weight * sums.at(m));
            }
        }
    }

    /// Room for the residuals of slab `s`.
    #[inline(always)]
    pub(super) fn residuals(&mut self, s: usize) -> &mut [f64] {
        &mut self.residuals[s % 3]
    }

    /// Makes the slab of the coarse load whose three fine slabs are complete with slab `s`, if there is one.
    ///
    /// Slabs must come in increasing order from `first` on; the coarse load begins with slab `first_coarse`.
    #[inline(always)]
    pub(super) fn restrict<D: Weighting>(
        &mut self,
        (n, s, first): (usize, usize, usize),
        (first_coarse, [red, black]): (usize, [&mut [f64]; 2]),
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
        let slab = slab::<D>(n / 2);
        let own = (emitted - first_coarse) * slab..(emitted - first_coarse + 1) * slab;
        let (red, black) = (&mut red[own.clone()], &mut black[own]);
        for at in At::of_slab::<D>(n / 2, emitted) {
            D::weigh_residuals(at, residuals, &mut self.row);
            let halves = [&mut red[at.in_slab()], &mut black[at.in_slab()]];
            let [long, short] = long_and_short(at.r + at.s, halves);
            deinterleave(&self.row, long, short);
        }
    }
}

/// Sums over rows of the coarser grid, at even and at odd columns, beside a row of black nodes.
#[derive(Clone, Copy)]
struct Neighbours<'a> {
    /// Whether every other node of the row lies at a column of the coarser grid; otherwise all lie between two.
    long: bool,
    even: &'a [f64],
    odd: &'a [f64],
}

impl Neighbours<'_> {
    /// The sum at the `m`-th black node.
    #[inline(always)]
    fn at(self, m: usize) -> f64 {
        let Self { long, even, odd } = self;
        let of_column = |m: usize| if m.is_multiple_of(2) { even[m / 2] } else { odd[m / 2] };
        if long { of_column(m) } else { of_column(m) + of_column(m + 1) }
    }

    /// Replaces each `t` of an even number of places by `with(t, sum)`.
    #[inline(always)]
    fn combine(self, target: &mut [f64], with: impl Fn(f64, f64) -> f64) {
        let Self { long, even, odd } = self;
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

/// Adds a row to a sum, which if `first` is another row.
#[inline(always)]
fn add(first: bool, sum: &mut [f64], other: &[f64], row: &[f64]) {
    let pairs = sum.iter_mut().zip(row);
    if first {
        pairs.zip(other).for_each(|((sum, row), other)| *sum = other + row);
    } else {
        pairs.for_each(|(sum, row)| *sum += row);
    }
}
