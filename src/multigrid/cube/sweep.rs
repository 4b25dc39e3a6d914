//! Half-sweeps and transfers on whole grids, plane by plane.
//!
//! Red only depends on black and black on red: the order of the planes, and hence the number of
//! threads, does not change a single bit of the result.

use super::level::{Level, for_each_pair_of_planes, for_each_plane, is_long, mirrored, plane, row};
use super::stencil::{Boundary, Row, walk};
use crate::multigrid::rows::{
    Colour, Rows, deinterleave, interleave, long_and_short, stride, worse,
};

/// What the values of a grid stand for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Problem {
    /// The solution of the Signorini problem of this grid.
    Obstacle,
    /// A correction for a finer grid, linear, with springs on the boundary.
    Correction,
}

impl Problem {
    fn boundary(self, inverse_diagonal: &[f64]) -> Boundary<'_> {
        match self {
            Problem::Obstacle => Boundary::Obstacle,
            Problem::Correction => Boundary::Springs(inverse_diagonal),
        }
    }
}

/// Half-sweep over one colour; the factor acts inside, boundary unknowns are minimised exactly.
pub(super) fn relax(level: &mut Level, problem: Problem, colour: Colour, factor: f64) {
    let Level { n, values: [red, black], load, inverse_diagonal, .. } = level;
    let (n, boundary) = (*n, problem.boundary(inverse_diagonal));
    let (own, other): (_, &[f64]) = match colour {
        Colour::Red => (red, black),
        Colour::Black => (black, red),
    };
    for_each_plane(n, own, |k, plane| {
        for (j, target) in plane.chunks_exact_mut(stride(n)).enumerate() {
            Row::new(n, [j, k], colour, load, other).relax(boundary, factor, target);
        }
        0.0
    });
}

/// Red values become those that one relaxation of a correction by the given factor makes from zero.
pub(super) fn start_red(level: &mut Level, factor: f64) {
    let Level { n, values: [red, _], load, inverse_diagonal, .. } = level;
    let (n, boundary) = (*n, Boundary::Springs(inverse_diagonal));
    for_each_plane(n, red, |k, plane| {
        for (j, target) in plane.chunks_exact_mut(stride(n)).enumerate() {
            let load = &load[Colour::Red as usize][row(n, j, k)];
            let inner = |target: &mut [f64], range: std::ops::Range<usize>| {
                for (value, load) in target[range.clone()].iter_mut().zip(&load[range]) {
                    *value = factor / 6.0 * load;
                }
            };
            walk(n, [j, k], Colour::Red, target, inner, |target, m, node| {
                target[m] = boundary.relax(node, load[m]);
            });
        }
        0.0
    });
}

/// Black values become the interpolated values of the coarser grid.
///
/// Coarse values are nonnegative on the boundary, hence so are their means. Red values need none: the
/// half-sweep that follows replaces them.
pub(super) fn interpolate(fine: &mut Level, coarse: &Level) {
    let n = fine.n;
    for_each_plane(n, &mut fine.values[1], |k, plane| {
        let mut prolongation = Prolongation::new(n, &coarse.values);
        for (j, target) in plane.chunks_exact_mut(stride(n)).enumerate() {
            let means = prolongation.row(j, k);
            target[..means.len()].copy_from_slice(means);
        }
        0.0
    });
}

/// The interpolated correction is added to the black values that are not in contact.
pub(super) fn correct(fine: &mut Level, problem: Problem, coarse: &Level) {
    let Level { n, values: [_, black], inverse_diagonal, .. } = fine;
    let (n, boundary) = (*n, problem.boundary(inverse_diagonal));
    for_each_plane(n, black, |k, plane| {
        let mut prolongation = Prolongation::new(n, &coarse.values);
        for (j, target) in plane.chunks_exact_mut(stride(n)).enumerate() {
            let means = prolongation.row(j, k);
            let inner = |target: &mut [f64], range: std::ops::Range<usize>| {
                for (value, mean) in target[range.clone()].iter_mut().zip(&means[range]) {
                    *value += mean;
                }
            };
            walk(n, [j, k], Colour::Black, target, inner, |target, m, node| {
                target[m] = boundary.corrected(node, target[m], means[m]);
            });
        }
        0.0
    });
}

/// Trilinear interpolation to the black nodes of a row.
struct Prolongation<'a> {
    n: usize,
    coarse: &'a [Rows; 2],
    /// Coarse values along x, mean over the coarse rows beside the fine one.
    along: Vec<f64>,
    one: Vec<f64>,
    means: Vec<f64>,
}

impl<'a> Prolongation<'a> {
    /// `n` is the number of cells along a fine row.
    fn new(n: usize, coarse: &'a [Rows; 2]) -> Self {
        let buffer = || vec![0.0; n / 2 + 1];
        Self { n, coarse, along: buffer(), one: buffer(), means: buffer() }
    }

    /// Means at the black nodes of fine row `(j, k)`.
    #[inline(always)]
    fn row(&mut self, j: usize, k: usize) -> &[f64] {
        let half = self.n / 2;
        let beside = |i: usize| [i / 2, i.div_ceil(2)];
        let ([south, north], [below, above]) = (beside(j), beside(k));
        self.along.fill(0.0);
        let mut rows = 0.0;
        for k in below..=above {
            for j in south..=north {
                let [red, black] = self.coarse.each_ref().map(|rows| &rows[row(half, j, k)]);
                let [long, short] = long_and_short(j + k, [red, black]);
                interleave(long, short, &mut self.one);
                self.along.iter_mut().zip(&self.one).for_each(|(sum, value)| *sum += value);
                rows += 1.0;
            }
        }
        if is_long(Colour::Black, j, k) {
            let scale = 1.0 / rows;
            self.means.iter_mut().zip(&self.along).for_each(|(mean, sum)| *mean = scale * sum);
            return &self.means;
        }
        let (west, east) = (&self.along[..half], &self.along[1..]);
        let scale = 0.5 / rows;
        for ((mean, west), east) in self.means.iter_mut().zip(west).zip(east) {
            *mean = scale * (west + east);
        }
        &self.means[..half]
    }
}

/// Residual of the red nodes, full weighting into the load of the coarser grid; returns the natural
/// residual `max |min(y, A y - F)|`, inside without the `min`, of the red nodes.
///
/// Must follow a half-sweep over the black nodes by factor 1, which leaves no residual there. `buffer`
/// has room for one colour.
pub(super) fn restrict(
    fine: &Level,
    problem: Problem,
    coarse: &mut Level,
    buffer: &mut [f64],
) -> f64 {
    let Level { n, values: [red, black], load, inverse_diagonal, .. } = fine;
    let (n, boundary) = (*n, problem.boundary(inverse_diagonal));
    let residuals = &mut buffer[..(n + 1) * plane(n)];
    let natural = for_each_plane(n, residuals, |k, plane| {
        let rows = plane.chunks_exact_mut(stride(n)).enumerate();
        let of_row = |(j, residual): (usize, &mut [f64])| {
            residual.copy_from_slice(&red[row(n, j, k)]);
            Row::new(n, [j, k], Colour::Red, load, black).replace_by_residual(boundary, residual)
        };
        rows.map(of_row).fold(0.0, worse)
    });
    let residuals = &*residuals;
    let half = n / 2;
    for_each_pair_of_planes(half, &mut coarse.load, |k, planes| {
        let mut weighting = Weighting::new(half);
        weighting.plane(k, planes, |sums, [j, k], weight| {
            let residual = &residuals[row(n, j, k)];
            let sum = if is_long(Colour::Red, j, k) { &mut sums.0 } else { &mut sums.1 };
            add(sum, residual, weight);
        })
    });
    natural
}

/// Load of the coarser grid: full weighting of the load of the finer one.
pub(super) fn restrict_load(fine: &Level, coarse: &mut Level) {
    let (n, half) = (fine.n, fine.n / 2);
    let largest = for_each_pair_of_planes(half, &mut coarse.load, |k, planes| {
        let mut weighting = Weighting::new(half);
        weighting.plane(k, planes, |sums, [j, k], weight| {
            let [red, black] = fine.load.each_ref().map(|rows| &rows[row(n, j, k)]);
            let [long, short] = long_and_short(j + k, [red, black]);
            add(&mut sums.0, long, weight);
            add(&mut sums.1, short, weight);
        })
    });
    coarse.load_scale = largest / half as f64;
}

#[inline(always)]
fn add(sum: &mut [f64], row: &[f64], weight: f64) {
    sum.iter_mut().zip(row).for_each(|(sum, value)| *sum += weight * value);
}

/// Full weighting: half of the sum over a node and its neighbours in the surrounding cube, with weights
/// 1, 1/2, 1/4, 1/8 by distance. The half is the ratio of the couplings on both grids.
struct Weighting {
    coarse_n: usize,
    /// Sums over nine rows, at the even and at the odd columns.
    sums: (Vec<f64>, Vec<f64>),
    coarse: Vec<f64>,
}

impl Weighting {
    fn new(coarse_n: usize) -> Self {
        let nodes = || vec![0.0; coarse_n + 1];
        Self { coarse_n, sums: (nodes(), vec![0.0; coarse_n]), coarse: nodes() }
    }

    /// Makes plane `k` of a coarse load; `add_row` adds the fine row `(j, k)`, weighted, to the sums at
    /// even and at odd columns. Returns the largest absolute value of the plane.
    #[inline(always)]
    fn plane(
        &mut self,
        k: usize,
        [red, black]: [&mut [f64]; 2],
        add_row: impl Fn(&mut (Vec<f64>, Vec<f64>), [usize; 2], f64),
    ) -> f64 {
        let (half, n) = (self.coarse_n, 2 * self.coarse_n);
        let rows = red.chunks_exact_mut(stride(half)).zip(black.chunks_exact_mut(stride(half)));
        let mut largest = 0.0_f64;
        for (j, (red, black)) in rows.enumerate() {
            self.sums.0.fill(0.0);
            self.sums.1.fill(0.0);
            let near = |i: usize| {
                let [before, after] = mirrored(n, i);
                [(before, 0.5), (i, 1.0), (after, 0.5)]
            };
            for (k, weight_k) in near(2 * k) {
                for (j, weight_j) in near(2 * j) {
                    add_row(&mut self.sums, [j, k], weight_j * weight_k);
                }
            }
            let (even, odd) = (&self.sums.0, &self.sums.1);
            for i in 0..=half {
                let (west, east) = (odd[i.max(1) - 1], odd[i.min(half - 1)]);
                self.coarse[i] = 0.5 * (even[i] + 0.5 * (west + east));
                largest = worse(self.coarse[i].abs(), largest);
            }
            let [long, short] = long_and_short(j + k, [red, black]);
            deinterleave(&self.coarse, long, short);
        }
        largest
    }
}

/// Natural residual `max |min(y, A y - F)|` over all nodes, interior ones without the `min`.
pub(super) fn natural_residual(level: &Level, buffer: &mut [f64]) -> f64 {
    let n = level.n;
    let of_colour = |colour: Colour| {
        let (own, other) = (&level.values[colour as usize], &level.values[colour.other() as usize]);
        for_each_plane(n, &mut buffer[..(n + 1) * plane(n)], |k, plane| {
            let rows = plane.chunks_exact_mut(stride(n)).enumerate();
            let of_row = |(j, residual): (usize, &mut [f64])| {
                residual.copy_from_slice(&own[row(n, j, k)]);
                Row::new(n, [j, k], colour, &level.load, other)
                    .replace_by_residual(Boundary::Obstacle, residual)
            };
            rows.map(of_row).fold(0.0, worse)
        })
    };
    Colour::BOTH.map(of_colour).into_iter().fold(0.0, worse)
}
