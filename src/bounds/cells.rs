//! Sums over cells: energies of the vector and of its recovery, and the distance of the latter to the flux.

use super::moments::{Moments, difference, mean};
use std::f64::consts::PI;
use std::ops::Range;

/// Sums over cells. Gradients are in units of differences: in two dimensions h drops out.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Sums<T = f64> {
    /// `|grad w - sigma|^2` with the oscillation of f.
    pub distance: T,
    /// `|grad w|^2`, w the recovery.
    pub recovered: T,
    /// `(f, w)`.
    pub recovered_load: T,
    /// `|grad v|^2`, v the piecewise linear function.
    pub linear: T,
    /// `(f, v)`.
    pub linear_load: T,
    /// What the residual varies within regular cells: the square of its L2 norm there less its means,
    /// times `h^2`.
    pub variance: T,
    /// Sum over regular cells of the squares of the means of the residual, times `h^4`.
    pub means: T,
}

impl<T> Sums<T> {
    /// Lets each sum take its part of `other` into account.
    #[inline(always)]
    fn each<U: Copy>(&mut self, other: &Sums<U>, take: impl Fn(&mut T, U)) {
        take(&mut self.distance, other.distance);
        take(&mut self.recovered, other.recovered);
        take(&mut self.recovered_load, other.recovered_load);
        take(&mut self.linear, other.linear);
        take(&mut self.linear_load, other.linear_load);
        take(&mut self.variance, other.variance);
        take(&mut self.means, other.means);
    }
}

impl Sums {
    #[inline(always)]
    pub(super) fn add(&mut self, other: &Self) {
        self.each(other, |sum, part| *sum += part);
    }
}

/// Regular cells whose sums are formed side by side.
pub(super) const LANES: usize = 16;

type Lanes = [f64; LANES];

/// Sums over cells in which, and around which, f has one value; `mass` is its integral over a cell. The
/// rows of nodes are those below the cells, at their lower and upper edges, and above; they are longer than
/// [`LANES`] by three nodes at least. Writes the means of the residual times `h^2` to `means`.
#[inline(always)]
pub(super) fn regular(
    rows: [&[f64]; 4],
    cells: Range<usize>,
    mass: f64,
    means: &mut [f64],
) -> Sums {
    let (mut lanes, mut start) = (Sums::<Lanes>::default(), cells.start);
    while start + LANES <= cells.end {
        let found = add_block(rows, start, mass, &mut lanes);
        means[start..start + LANES].copy_from_slice(&found);
        start += LANES;
    }
    if start < cells.end {
        // A block that also holds cells of others, which do not count.
        let first = start.min(rows[0].len() - 2 - LANES);
        let counted = start - first..cells.end - first;
        let mut block = Sums::<Lanes>::default();
        let found = add_block(rows, first, mass, &mut block);
        means[start..cells.end].copy_from_slice(&found[counted.clone()]);
        let mut share = [0.0; LANES];
        share[counted].fill(1.0);
        lanes.each(&block, |lanes, block| {
            for lane in 0..LANES {
                lanes[lane] += share[lane] * block[lane];
            }
        });
    }
    let mut sums = Sums::default();
    sums.each(&lanes, |sum, lanes| *sum = lanes.iter().sum());
    let linear = 0.25 * sums.linear;
    Sums {
        distance: sums.distance / 2880.0,
        recovered: linear + sums.recovered / 2880.0,
        recovered_load: mass * sums.recovered_load / 48.0,
        linear,
        linear_load: mass * sums.linear_load / 12.0,
        variance: sums.variance / 144.0,
        means: sums.means,
    }
}

/// Adds the regular cells from `start` on to the sums, and returns the means of the residual.
///
/// The formulas are those of [`Special`] with f constant around the cell, in sums and differences of opposite
/// edges.
#[inline(always)]
fn add_block(
    [below, lower, upper, above]: [&[f64]; 4],
    start: usize,
    mass: f64,
    sums: &mut Sums<Lanes>,
) -> Lanes {
    // Columns of nodes, from the one left of the cells on.
    let (d1, d2) = (column(below, start), column(below, start + 1));
    let (a0, a1) = (column(lower, start - 1), column(lower, start));
    let (a2, a3) = (column(lower, start + 1), column(lower, start + 2));
    let (b0, b1) = (column(upper, start - 1), column(upper, start));
    let (b2, b3) = (column(upper, start + 1), column(upper, start + 2));
    let (u1, u2) = (column(above, start), column(above, start + 1));
    let mut means = [0.0; LANES];
    for i in 0..LANES {
        // Sums and differences of the two rows, and of the outer rows.
        let (s0, s1, s2, s3) = (b0[i] + a0[i], b1[i] + a1[i], b2[i] + a2[i], b3[i] + a3[i]);
        let (t0, t1, t2, t3) = (b0[i] - a0[i], b1[i] - a1[i], b2[i] - a2[i], b3[i] - a3[i]);
        let (us, ut, ds, dt) = (u2[i] + u1[i], u2[i] - u1[i], d2[i] + d1[i], d2[i] - d1[i]);
        let (x, y, turn, corners) = (s2 - s1, t2 + t1, t2 - t1, s2 + s1);
        // Four times what the bubbles of one axis bend along the other.
        let (g, e) = ((ut + dt) - x, (t3 + t0) - y);
        // Third differences, summed over opposite edges, and their differences.
        let (p, q) = ((s3 - s0) - 3.0 * x, (us - ds) - 3.0 * y);
        let (dp, dq) = ((t3 - t0) - 3.0 * turn, (ut - dt) - 3.0 * turn);
        // Four times the bubbles, summed over opposite edges.
        let (along, across) = ((s3 + s0) - corners, (us + ds) - corners);
        let laplacian = along + across;
        // Twice the slopes of the residual, its twist and its mean.
        let (r, o, twist, mean) = (p + g, q + e, dp + dq, 0.25 * laplacian + mass);
        let (third, slope) = (p * p + q * q, r * r + o * o);
        let (steep, turned) = (x * x + y * y, turn * turn);
        let (bubbles, bent) = (along * along + across * across, g * x + e * y);
        // In units that `regular` puts right.
        let cell = Sums {
            distance: 7.0 * (third + (dp * dp + dq * dq)) + 8.0 * (p * r + q * o) + 6.0 * slope,
            recovered: 11.0 * (g * g + e * e) + 15.0 * bubbles - 120.0 * bent - 960.0 * turned,
            recovered_load: 12.0 * corners - laplacian,
            linear: steep + (turned + turned),
            linear_load: 3.0 * corners + turn,
            variance: 3.0 * slope + twist * twist,
            means: mean * mean,
        };
        means[i] = mean;
        sums.each(&cell, |lanes, part| lanes[i] += part);
    }
    means
}

#[inline(always)]
fn column(row: &[f64], start: usize) -> &[f64; LANES] {
    row[start..start + LANES].try_into().expect("as long as that")
}

/// What a cell shows along one axis, on its two edges in that direction.
#[derive(Clone, Copy)]
pub(super) struct Axis {
    /// Differences.
    pub along: [f64; 2],
    /// Third differences.
    pub third: [f64; 2],
    /// Coefficients of the bubbles.
    pub bubble: [f64; 2],
    /// Half the sum of the second differences at both ends: twice the bubble but where that is changed.
    pub second: [f64; 2],
}

impl Axis {
    /// From the values on the lines of both edges: at their ends, and one node further at each end.
    #[inline(always)]
    pub(super) fn new([p, q]: [[f64; 4]; 2]) -> Self {
        let third = |[a, b, c, d]: [f64; 4]| (d - a) - 3.0 * (c - b);
        let second = |[a, b, c, d]: [f64; 4]| 0.5 * ((d - c) - (b - a));
        let second = [second(p), second(q)];
        Self {
            along: [p[2] - p[1], q[2] - q[1]],
            third: [third(p), third(q)],
            bubble: [0.5 * second[0], 0.5 * second[1]],
            second,
        }
    }

    /// The same without the bubbles of the edges on the boundary.
    fn cut(self, outer: [bool; 2]) -> Self {
        let [p, q] = self.bubble;
        Self { bubble: [if outer[0] { 0.0 } else { p }, if outer[1] { 0.0 } else { q }], ..self }
    }

    /// How the bubbles of this axis bend the slope along the other.
    fn bend(&self) -> f64 {
        difference(self.bubble)
    }

    /// Mean square of this component of `grad w`.
    #[inline(always)]
    fn recovered(&self, bend: f64) -> f64 {
        let slope = mean(self.along) - SIXTH * bend;
        let change = difference(self.along).powi(2) + 4.0 * mean(self.bubble).powi(2);
        let square = difference(self.bubble).powi(2) * 5.0 + bend * bend;
        slope * slope + TWELFTH * (change + square * (1.0 / 15.0))
    }

    /// Mean square of this component of `grad w - sigma`.
    #[inline(always)]
    fn distance(&self, bend: f64, flux: [f64; 2], slope: f64, twist: f64) -> f64 {
        let third = [mean(self.third), difference(self.third)];
        let constant = SIXTH * (third[0] + bend) + mean(flux) + TWELFTH * slope;
        let across = SIXTH * (third[1] + 0.25 * twist);
        let along = mean(self.second) + difference(flux) - 2.0 * mean(self.bubble);
        let both = difference(self.second) - 2.0 * difference(self.bubble);
        let quadratic = 0.5 * (third[0] - slope);
        let mixed = 0.5 * third[1] - 0.75 * twist;
        let linear = across * across + along * along + TWELFTH * both * both;
        let square = quadratic * quadratic + TWELFTH * mixed * mixed + bend * bend;
        constant * constant + TWELFTH * (linear + square * (1.0 / 15.0))
    }
}

const SIXTH: f64 = 1.0 / 6.0;
const TWELFTH: f64 = 1.0 / 12.0;

/// A cell at the boundary, or where f is not constant around it.
pub(super) struct Special {
    /// Values at ll, lr, ul, ur.
    pub corners: [f64; 4],
    pub x: Axis,
    pub y: Axis,
    /// Fluxes through the edges left, right, bottom, top that f needs.
    pub flux: [f64; 4],
    /// Which of these edges are on the boundary.
    pub outer: [bool; 4],
}

impl Special {
    /// Sums over the cell for f with these moments, and the mean of the residual times `h^2`.
    #[inline(always)]
    pub(super) fn sums(&self, f: &Moments) -> (Sums, f64) {
        let Self { corners, x, y, flux, .. } = self;
        // The five-point equation at the corners: its mean there, slopes, and twist.
        let laplacian = mean(x.second) + mean(y.second);
        let slope = [
            12.0 * f.x + mean(x.third) + difference(y.second),
            12.0 * f.y + mean(y.third) + difference(x.second),
        ];
        let twist = 144.0 * f.xy + difference(x.third) + difference(y.third);
        let distance = x.distance(y.bend(), [flux[0], flux[1]], slope[0], twist)
            + y.distance(x.bend(), [flux[2], flux[3]], slope[1], twist);
        // h / (2 pi) times the norm of f less its bilinear approximation adds to the square root.
        let oscillation = f.oscillation();
        let distance = match oscillation > 0.0 {
            true => (distance.sqrt() + oscillation.sqrt() / (2.0 * PI)).powi(2),
            false => distance,
        };
        // The load of the bilinear function, and of what the bubbles take from it.
        let [ll, lr, ul, ur] = corners;
        let turn = (ll + ur) - (lr + ul);
        let bilinear = 0.25 * ((ll + lr) + (ul + ur)) * f.one
            + 0.5 * ((lr + ur) - (ll + ul)) * f.x
            + 0.5 * ((ul + ur) - (ll + lr)) * f.y
            + turn * f.xy;
        let square = |d: [f64; 2]| d[0] * d[0] + d[1] * d[1];
        let sums = Sums {
            distance,
            recovered: recovered(x, y),
            recovered_load: bilinear - f.bubbles(x.bubble, y.bubble),
            linear: 0.5 * (square(x.along) + square(y.along)),
            linear_load: bilinear + turn * f.ridge,
            ..Sums::default()
        };
        (sums, f.one + laplacian + (flux[1] - flux[0]) + (flux[3] - flux[2]))
    }

    /// What the energy of w gains when its bubbles on the boundary are left out.
    pub(super) fn trace(&self, f: &Moments) -> f64 {
        let energy = |x: &Axis, y: &Axis| 0.5 * recovered(x, y) + f.bubbles(x.bubble, y.bubble);
        let [left, right, bottom, top] = self.outer;
        energy(&self.x.cut([bottom, top]), &self.y.cut([left, right])) - energy(&self.x, &self.y)
    }
}

/// `|grad w|^2` over the cell.
#[inline(always)]
fn recovered(x: &Axis, y: &Axis) -> f64 {
    x.recovered(y.bend()) + y.recovered(x.bend())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::discrete::simd::with_each;

    #[test]
    fn blocks_of_regular_cells_sum_what_the_cells_have_one_by_one() {
        let wave = |k: usize| libm::sin(k as f64 * 12.9898) * 43.7;
        let rows: [Vec<f64>; 4] =
            std::array::from_fn(|j| (0..60).map(|i| wave(60 * j + i)).collect());
        let mass = 0.3;
        for cells in [1..17, 1..58, 5..40, 50..58, 30..31] {
            let mut want = Sums::default();
            let mut residuals = vec![0.0; 59];
            for i in cells.clone() {
                let line = |j: usize| [0, 1, 2, 3].map(|k| rows[j][i + k - 1]);
                let column = |i: usize| [0, 1, 2, 3].map(|j| rows[j][i]);
                let (x, y) = (Axis::new([line(1), line(2)]), Axis::new([column(i), column(i + 1)]));
                let corners = [rows[1][i], rows[1][i + 1], rows[2][i], rows[2][i + 1]];
                let cell = Special { corners, x, y, flux: [0.0; 4], outer: [false; 4] };
                let (mut sums, mean) = cell.sums(&Moments::constant(mass));
                // Without the field that follows the residual inside the cell.
                sums.distance = x.distance(y.bend(), [0.0; 2], 0.0, 0.0)
                    + y.distance(x.bend(), [0.0; 2], 0.0, 0.0);
                let laplacian = |j: usize, i: usize| {
                    rows[j][i - 1] + rows[j][i + 1] + rows[j - 1][i] + rows[j + 1][i]
                        - 4.0 * rows[j][i]
                };
                let at = [(1, i), (1, i + 1), (2, i), (2, i + 1)].map(|(j, i)| laplacian(j, i));
                let slopes = [at[1] + at[3] - at[0] - at[2], at[2] + at[3] - at[0] - at[1]];
                let twist = at[0] + at[3] - at[1] - at[2];
                sums.variance =
                    (slopes[0].powi(2) + slopes[1].powi(2)) / 48.0 + twist * twist / 144.0;
                sums.means = mean * mean;
                residuals[i] = mean;
                want.add(&sums);
            }
            let found = with_each(
                #[inline(always)]
                || {
                    let mut means = vec![0.0; 59];
                    let views = [&rows[0][..], &rows[1], &rows[2], &rows[3]];
                    (regular(views, cells.clone(), mass, &mut means), means)
                },
            );
            for (sums, means) in &found {
                assert_eq!(*sums, found[0].0, "the same with all instructions");
                sums.clone().each(&want, |found, want| {
                    assert!((*found - want).abs() < 1e-12 * want.abs().max(1e3), "{found} {want}");
                });
                assert!(means.iter().zip(&residuals).all(|(p, q)| (p - q).abs() < 1e-11));
            }
        }
    }
}
