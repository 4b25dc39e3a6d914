//! Linear prolongation and its transpose, full weighting, slab by slab.
//!
//! Both act between red and black rows. Only black values are prolongated, since the half-sweep that
//! follows replaces all red ones; only red residuals are restricted, since black ones vanish after a
//! half-sweep over the black nodes.

use std::ops::Range;

use super::layout::{At, Dimension, rows_per_slab, slab};
use super::level::Level;
use super::rows::{Colour, Rows, deinterleave, long_and_short, max_abs, stride, worse};
use super::stencil::{Boundary, Row, coupling, walk};

/// Full weighting of one slab: what differs between the square and the cube.
pub trait Weighting: Dimension {
    /// Full weighting of red residuals into the row `at` of the coarser grid, in natural order. `residuals`
    /// are the slabs below, at and above the coarse one, mirrored at the boundary.
    fn weigh_residuals(at: At, residuals: [&[f64]; 3], sums: &mut Sums);

    /// The same of the load of both colours; `load(colour, s)` is a slab of the finer grid.
    fn weigh_load<'a>(at: At, load: impl Fn(Colour, usize) -> &'a [f64], sums: &mut Sums);
}

/// Numbers along one coarse row.
pub struct Sums {
    /// Sums over rows of the finer grid, at even and at odd columns.
    pub(super) even: Vec<f64>,
    pub(super) odd: Vec<f64>,
    /// The coarse row.
    pub(super) row: Vec<f64>,
}

impl Sums {
    pub(super) fn new(coarse_n: usize) -> Self {
        let nodes = || vec![0.0; coarse_n + 1];
        Self { even: nodes(), odd: nodes(), row: nodes() }
    }
}

/// What a pass over one block of slabs needs beside the grids.
pub(super) struct Buffers {
    /// Residuals of the last three slabs of red nodes, slab `s` in place `s % 3`.
    residuals: [Vec<f64>; 3],
    sums: Sums,
}

impl Buffers {
    /// For `n` cells in a row and slabs of so many places.
    pub(super) fn new(n: usize, slab: usize) -> Self {
        let residuals = [(); 3].map(|()| vec![0.0; slab]);
        Self { residuals, sums: Sums::new(n / 2) }
    }

    pub(super) fn bytes(&self) -> usize {
        let Sums { even, odd, row } = &self.sums;
        let all = self.residuals.iter().chain([even, odd, row]);
        all.map(|numbers| size_of_val(&numbers[..])).sum()
    }

    /// Calls `with(row, one, two, weight)` for each row of slab `s` that has black nodes whose prolongation is
    /// `weight (one + two)`, both in natural order of the coarser grid.
    #[inline(always)]
    fn prolongate<D: Dimension>(
        &mut self,
        n: usize,
        s: usize,
        coarse: &[Rows; 2],
        mut with: impl FnMut(At, &[f64], f64),
    ) {
        let (half, rows) = (n / 2, rows_per_slab::<D>(n / 2));
        let stride = stride(half);
        let beside = |i: usize| [i / 2, i.div_ceil(2)];
        let Sums { even, odd, row } = &mut self.sums;
        for at in At::of_slab::<D>(n, s) {
            let ([south, north], [below, above]) = (beside(at.r), beside(at.s));
            let mut count = 0.0;
            for s in below..=above {
                for r in south..=north {
                    let place = (s * rows + r) * stride..(s * rows + r + 1) * stride;
                    let [red, black] = [&coarse[0][place.clone()], &coarse[1][place]];
                    let [long, short] = long_and_short(r + s, [red, black]);
                    add_or_set(count == 0.0, even, long);
                    add_or_set(count == 0.0, odd, short);
                    count += 1.0;
                }
            }
            let (even, odd) = (&even[..half / 2 + 1], &odd[..half / 2 + 1]);
            means(at.is_long(Colour::Black), even, odd, row);
            let weight = if at.is_long(Colour::Black) { 1.0 / count } else { 0.5 / count };
            with(at, row, weight);
        }
    }

    /// Sets the black slab to the prolongation.
    ///
    /// Coarse values are nonnegative on the boundary, hence so are their means.
    #[inline(always)]
    pub(super) fn interpolate<D: Dimension>(
        &mut self,
        (n, s): (usize, usize),
        coarse: &[Rows; 2],
        black: &mut [f64],
    ) {
        self.prolongate::<D>(n, s, coarse, |at, row, weight| {
            let len = if at.is_long(Colour::Black) { n / 2 + 1 } else { n / 2 };
            let target = &mut black[at.in_slab()][..len];
            target.iter_mut().zip(row).for_each(|(value, sum)| *value = weight * sum);
        });
    }

    /// Adds `factor` times the prolongation to the black slab, except at nodes in contact; projects.
    #[inline(always)]
    pub(super) fn correct<D: Dimension>(
        &mut self,
        (n, s): (usize, usize),
        coarse: &[Rows; 2],
        boundary: Boundary,
        factor: f64,
        black: &mut [f64],
    ) {
        self.prolongate::<D>(n, s, coarse, |at, row, weight| {
            let weight = factor * weight;
            let inside = |target: &mut [f64], range: Range<usize>| {
                let sums = &row[range.clone()];
                target[range].iter_mut().zip(sums).for_each(|(value, sum)| *value += weight * sum);
            };
            walk::<D, _>(at, Colour::Black, &mut black[at.in_slab()], inside, |target, m, edge| {
                target[m] = boundary.corrected(edge, target[m], weight * row[m]);
            });
        });
    }

    /// Adds the residual of red slab `s`; emits a coarse slab when its three fine slabs are complete.
    ///
    /// Slabs must come in increasing order from `first` on. `natural_of` replaces a buffer by the residual;
    /// the coarse load begins with slab `first_coarse`.
    #[inline(always)]
    pub(super) fn restrict<D: Weighting>(
        &mut self,
        (n, s, first): (usize, usize, usize),
        natural_of: impl FnOnce(&mut [f64]) -> f64,
        (first_coarse, [red, black]): (usize, [&mut [f64]; 2]),
    ) -> f64 {
        let natural = natural_of(&mut self.residuals[s % 3]);
        let emitted = if s == n {
            n / 2
        } else if s % 2 == 1 && (s == 1 || s >= first + 2) {
            s / 2
        } else {
            return natural;
        };
        let middle = 2 * emitted;
        let [below, above] = super::layout::mirrored(n, middle);
        let residuals = [below, middle, above].map(|s| &self.residuals[s % 3][..]);
        let slab = slab::<D>(n / 2);
        let own = (emitted - first_coarse) * slab..(emitted - first_coarse + 1) * slab;
        let (red, black) = (&mut red[own.clone()], &mut black[own]);
        for at in At::of_slab::<D>(n / 2, emitted) {
            D::weigh_residuals(at, residuals, &mut self.sums);
            let halves = [&mut red[at.in_slab()], &mut black[at.in_slab()]];
            let [long, short] = long_and_short(at.r + at.s, halves);
            deinterleave(&self.sums.row, long, short);
        }
        natural
    }
}

#[inline(always)]
fn add_or_set(set: bool, sums: &mut [f64], row: &[f64]) {
    let pairs = sums.iter_mut().zip(row);
    if set {
        pairs.for_each(|(sum, value)| *sum = *value);
    } else {
        pairs.for_each(|(sum, value)| *sum += value);
    }
}

/// The sums at the black nodes of a row, from those at even and odd columns of the coarser grid: the sums
/// themselves if every other node of the finer row is below one, else those of two neighbours.
#[inline(always)]
fn means(long: bool, even: &[f64], odd: &[f64], row: &mut [f64]) {
    let cells = row.len() - 1;
    let (pairs, end) = row.as_chunks_mut::<2>();
    let (west, east) = (&even[..pairs.len()], &even[even.len() - pairs.len()..]);
    if long {
        for ((pair, even), odd) in pairs.iter_mut().zip(even).zip(odd) {
            *pair = [*even, *odd];
        }
        if let [end] = end {
            *end = even[cells / 2];
        }
    } else {
        for (((pair, west), odd), east) in pairs.iter_mut().zip(west).zip(odd).zip(east) {
            *pair = [west + odd, odd + east];
        }
    }
}

/// The largest natural residual of one slab; leaves its residuals in `target`, which holds its values.
#[inline(always)]
pub(super) fn slab_residual<D: Dimension>(
    (n, s): (usize, usize),
    colour: Colour,
    boundary: Boundary,
    load: &[f64],
    (other, first): (&[f64], usize),
    target: &mut [f64],
    mut see: impl FnMut(usize, bool),
) -> f64 {
    let mut largest = 0.0;
    for at in At::of_slab::<D>(n, s) {
        let row = Row::new::<D>(at, colour, load, other, first);
        let natural = row.replace_by_residual::<D>(boundary, &mut target[at.in_slab()], &mut see);
        largest = worse(largest, natural);
    }
    largest
}

/// One slab of the load of the coarser grid: full weighting of the load of the finer one. Returns its
/// largest entry before the division by couplings.
pub(super) fn restrict_load<D: Weighting>(
    fine: &Level,
    s: usize,
    [red, black]: [&mut [f64]; 2],
    sums: &mut Sums,
) -> f64 {
    let (half, slab) = (fine.n / 2, slab::<D>(fine.n));
    let mut largest = 0.0;
    for at in At::of_slab::<D>(half, s) {
        let load = |colour: Colour, s: usize| &fine.load[colour as usize][s * slab..(s + 1) * slab];
        D::weigh_load(at, load, sums);
        let row = &sums.row;
        let ends = 0.5 * worse(row[0].abs(), row[half].abs());
        largest = worse(largest, at.share::<D>() * worse(max_abs(&row[1..half]), ends));
        let halves = [&mut red[at.in_slab()], &mut black[at.in_slab()]];
        let [long, short] = long_and_short(at.r + at.s, halves);
        deinterleave(row, long, short);
    }
    coupling::<D>(half) * largest
}
