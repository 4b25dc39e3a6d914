//! Sums over cells: energies of the vector and of its recovery, and the distance of the latter to the flux; here
//! cell by cell.

use super::moments::{Moments, difference, mean};
use std::array::from_fn;
use std::f64::consts::PI;

/// Cells whose sums are formed side by side.
pub(super) const LANES: usize = 16;

pub(super) type Lanes = [f64; LANES];

/// Sums over cells. Gradients are in units of differences: in two dimensions h drops out.
///
/// Aligned so that no vector of lanes lies in two lines of the cache.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(align(64))]
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
}

impl<T> Sums<T> {
    /// Lets each sum take its part of `other` into account.
    #[inline(always)]
    pub(super) fn each<U: Copy>(&mut self, other: &Sums<U>, take: impl Fn(&mut T, U)) {
        take(&mut self.distance, other.distance);
        take(&mut self.recovered, other.recovered);
        take(&mut self.recovered_load, other.recovered_load);
        take(&mut self.linear, other.linear);
        take(&mut self.linear_load, other.linear_load);
        take(&mut self.variance, other.variance);
    }
}

impl Sums {
    #[inline(always)]
    pub(super) fn add(&mut self, other: &Self) {
        self.each(other, |sum, part| *sum += part);
    }
}

impl Sums<Lanes> {
    /// The sums over all lanes.
    #[inline(always)]
    pub(super) fn total(&self) -> Sums {
        let mut total = Sums::default();
        total.each(self, |sum, lanes| *sum = lanes.iter().sum());
        total
    }
}

/// A cell at the boundary, or where f is not constant around it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Special<T = f64> {
    /// Values on the lines of the two edges along x, and of those along y: at their ends, and one node further.
    pub lines: [[[T; 4]; 2]; 2],
    /// Coefficients of the bubbles on these edges.
    pub bubbles: [[T; 2]; 2],
    /// Fluxes through the edges left, right, bottom, top that f needs.
    pub flux: [T; 4],
    pub f: Moments<T>,
}

/// Half the sum of the second differences at the ends of an edge: twice its bubble where f is constant around it.
#[inline(always)]
pub(super) fn second([a, b, c, d]: [f64; 4]) -> f64 {
    0.5 * ((d - c) - (b - a))
}

impl Special {
    /// Values at ll, lr, ul, ur.
    #[inline(always)]
    pub(super) fn corners(&self) -> [f64; 4] {
        let [[_, ll, lr, _], [_, ul, ur, _]] = self.lines[0];
        [ll, lr, ul, ur]
    }

    #[inline(always)]
    fn sums(&self) -> Sums {
        let Self { lines: [x, y], bubbles, flux: [left, right, bottom, top], f } = *self;
        let (x, y) = (Axis::new(x, bubbles[0]), Axis::new(y, bubbles[1]));
        // The five-point equation at the corners: its slopes there, and twist.
        let slope = [
            12.0 * f.x + mean(x.third) + difference(y.second),
            12.0 * f.y + mean(y.third) + difference(x.second),
        ];
        let twist = 144.0 * f.xy + difference(x.third) + difference(y.third);
        let distance = x.distance(y.bend(), [left, right], slope[0], twist)
            + y.distance(x.bend(), [bottom, top], slope[1], twist);
        // h / (2 pi) times the norm of f less its bilinear approximation adds to the square root.
        let oscillation = f.oscillation();
        let distance = match oscillation > 0.0 {
            true => (distance.sqrt() + oscillation.sqrt() / (2.0 * PI)).powi(2),
            false => distance,
        };
        // The load of the bilinear function, and of what the bubbles take from it.
        let [ll, lr, ul, ur] = self.corners();
        let turn = (ll + ur) - (lr + ul);
        let bilinear = 0.25 * ((ll + lr) + (ul + ur)) * f.one
            + 0.5 * ((lr + ur) - (ll + ul)) * f.x
            + 0.5 * ((ul + ur) - (ll + lr)) * f.y
            + turn * f.xy;
        let square = |d: [f64; 2]| d[0] * d[0] + d[1] * d[1];
        Sums {
            distance,
            recovered: x.recovered(y.bend()) + y.recovered(x.bend()),
            recovered_load: bilinear - f.bubbles(bubbles),
            linear: 0.5 * (square(x.along) + square(y.along)),
            linear_load: bilinear + turn * f.ridge,
            variance: 0.0,
        }
    }

    /// What the energy of w gains when the bubble on edge `k` along an axis is left out.
    pub(super) fn trace(&self, axis: usize, k: usize) -> f64 {
        let (bubble, opposite) = (self.bubbles[axis][k], self.bubbles[axis][1 - k]);
        let [p, q] = self.lines[1 - axis].map(|[_, p, q, _]| q - p);
        let inward = if k == 0 { mean([p, q]) } else { -mean([p, q]) };
        let [both, turned] = self.f.blended()[axis];
        let load = if k == 0 { 0.5 * both - turned } else { 0.5 * both + turned };
        let energy = (2.0 * opposite - bubble) / 60.0 - (bubble + opposite) / 18.0 - SIXTH * inward;
        bubble * (energy - load)
    }
}

impl Special<Lanes> {
    /// The cell in lane `k`.
    #[inline(always)]
    pub(super) fn lane(&self, k: usize) -> Special {
        Special {
            lines: from_fn(|a| from_fn(|b| from_fn(|c| self.lines[a][b][c][k]))),
            bubbles: from_fn(|a| from_fn(|b| self.bubbles[a][b][k])),
            flux: from_fn(|a| self.flux[a][k]),
            f: self.f.lane(k),
        }
    }
}

/// What a cell shows along one axis, on its two edges in that direction.
#[derive(Clone, Copy)]
struct Axis {
    /// Differences.
    along: [f64; 2],
    /// Third differences.
    third: [f64; 2],
    /// As [`second`].
    second: [f64; 2],
    /// Coefficients of the bubbles.
    bubble: [f64; 2],
}

impl Axis {
    #[inline(always)]
    fn new(lines: [[f64; 4]; 2], bubble: [f64; 2]) -> Self {
        let third = |[a, b, c, d]: [f64; 4]| (d - a) - 3.0 * (c - b);
        Self {
            along: lines.map(|[_, p, q, _]| q - p),
            third: lines.map(third),
            second: lines.map(second),
            bubble,
        }
    }

    /// How the bubbles of this axis bend the slope along the other.
    #[inline(always)]
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

/// Special cells that wait until there are as many as lanes, and the sums over those before them.
#[derive(Default)]
pub(super) struct Batch {
    /// How many cells wait.
    waiting: usize,
    cells: Special<Lanes>,
    sums: Sums<Lanes>,
}

impl Batch {
    /// Room for the next cell: the lanes, and which of them.
    #[inline(always)]
    pub(super) fn next(&mut self) -> (&mut Special<Lanes>, usize) {
        (&mut self.cells, self.waiting)
    }

    /// Lets that cell wait with the others.
    #[inline(always)]
    pub(super) fn push(&mut self) {
        self.waiting += 1;
        if self.waiting == LANES {
            self.sum(LANES);
        }
    }

    /// Sums over the first cells that wait, so many of them, and lets none wait.
    #[inline(always)]
    fn sum(&mut self, cells: usize) {
        for k in 0..cells {
            self.sums.each(&self.cells.lane(k).sums(), |lanes, part| lanes[k] += part);
        }
        self.waiting = 0;
    }

    /// Sums over the cells that wait.
    pub(super) fn flush(&mut self) {
        self.sum(self.waiting);
    }

    /// The sums so far, which are zero afterwards.
    #[inline(always)]
    pub(super) fn take(&mut self) -> Sums {
        std::mem::take(&mut self.sums).total()
    }
}

#[cfg(test)]
mod tests {
    use super::super::regular::Regular;
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
                let lines = [[line(1), line(2)], [column(i), column(i + 1)]];
                let bubbles = lines.map(|lines| lines.map(|line| 0.5 * second(line)));
                let (x, y) = (Axis::new(lines[0], bubbles[0]), Axis::new(lines[1], bubbles[1]));
                let cell = Special { lines, bubbles, flux: [0.0; 4], f: Moments::constant(mass) };
                let mut sums = cell.sums();
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
                residuals[i] = 0.25 * at.iter().sum::<f64>() + mass;
                want.add(&sums);
            }
            let found = with_each(
                #[inline(always)]
                || {
                    let mut means = vec![0.0; 59];
                    let views = [&rows[0][..], &rows[1], &rows[2], &rows[3]];
                    let mut regular = Regular::default();
                    let squares = regular.add(views, cells.clone(), mass, &mut means);
                    (regular.take(), squares, means)
                },
            );
            let want_squares: f64 = residuals.iter().map(|mean| mean * mean).sum();
            for (sums, squares, means) in &found {
                assert_eq!(*sums, found[0].0, "the same with all instructions");
                assert!((squares - want_squares).abs() < 1e-12 * want_squares.max(1e3));
                sums.clone().each(&want, |found, want| {
                    assert!((*found - want).abs() < 1e-12 * want.abs().max(1e3), "{found} {want}");
                });
                assert!(means.iter().zip(&residuals).all(|(p, q)| (p - q).abs() < 1e-11));
            }
        }
    }

    #[test]
    fn a_batch_sums_what_its_cells_have_one_by_one() {
        let wave = |k: usize| libm::sin(k as f64 * 78.233) * 3.7;
        let (mut batch, mut want) = (Batch::default(), Sums::default());
        for k in 0..2 * LANES + 3 {
            let number = |place: usize| wave(100 * k + place);
            let [one, x, y, xy, xx, yy, xxy, xyy, ridge, _]: [f64; 10] =
                from_fn(|place| number(60 + place));
            let cell = Special {
                lines: from_fn(|a| from_fn(|b| from_fn(|c| number(8 * a + 4 * b + c)))),
                bubbles: from_fn(|a| from_fn(|b| number(20 + 2 * a + b))),
                flux: from_fn(|edge| number(30 + edge)),
                f: Moments { one, x, y, xy, xx, yy, xxy, xyy, ridge, square: 1e3 },
            };
            let (cells, lane) = batch.next();
            for (axis, edge) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                let line = cell.lines[axis][edge];
                (0..4).for_each(|node| cells.lines[axis][edge][node][lane] = line[node]);
                cells.bubbles[axis][edge][lane] = cell.bubbles[axis][edge];
            }
            (0..4).for_each(|edge| cells.flux[edge][lane] = cell.flux[edge]);
            cells.f.each(&cell.f, |lanes, moment| lanes[lane] = moment);
            batch.push();
            want.add(&cell.sums());
        }
        batch.flush();
        batch.take().each(&want, |found, want| {
            assert!((*found - want).abs() < 1e-12 * want.abs().max(1e3), "{found} {want}");
        });
    }
}
