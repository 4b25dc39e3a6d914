//! Sums over cells: energies of the vector and of its recovery, and the distance from the recovery's gradient to the
//! flux; here for cells at the boundary and at jumps of f, one by one.

use super::flux::EdgeFluxes;
use super::moments::{BubbleLoad, CellMoments, difference, mean};
use std::f64::consts::PI;

/// Number of cells whose sums are formed side by side.
pub(super) const LANES: usize = 16;

/// One number for each of [`LANES`] cells.
pub(super) type CellLanes = [f64; LANES];

/// Sums over cells. Gradients are in units of differences, since in two dimensions h cancels.
///
/// The alignment keeps each vector of lanes within whole cache lines.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(align(64))]
pub(super) struct Sums<T = f64> {
    /// `|grad w - sigma|^2`, including the oscillation of f.
    pub distance: T,
    /// `|grad w|^2`, w the recovery.
    pub recovered: T,
    /// `(f, w)`.
    pub recovered_load: T,
    /// `|grad v|^2`, v the piecewise linear function.
    pub linear: T,
    /// `(f, v)`.
    pub linear_load: T,
    /// Variance of the residual within regular cells: the square of the L2 norm of the residual less its means, times
    /// `h^2`.
    pub variance: T,
}

impl<T> Sums<T> {
    /// Calls `take` with each number and the same number of `other`.
    #[inline(always)]
    pub(super) fn each<U>(&mut self, other: &Sums<U>, take: impl Fn(&mut T, &U)) {
        let Self { distance, recovered, recovered_load, linear, linear_load, variance } = self;
        take(distance, &other.distance);
        take(recovered, &other.recovered);
        take(recovered_load, &other.recovered_load);
        take(linear, &other.linear);
        take(linear_load, &other.linear_load);
        take(variance, &other.variance);
    }
}

impl Sums {
    #[inline(always)]
    pub(super) fn add(&mut self, other: &Self) {
        self.each(other, |sum, part| *sum += part);
    }
}

impl Sums<CellLanes> {
    /// Sums over all lanes.
    #[inline(always)]
    pub(super) fn total(&self) -> Sums {
        let mut total = Sums::default();
        total.each(self, |sum, lanes| *sum = lanes.iter().sum());
        total
    }
}

/// A cell at the boundary, or where f is not constant around it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SpecialCell {
    /// Values on the lines of the two edges along x, and of the two along y: at their ends, and one node further at
    /// each end.
    pub lines: [[[f64; 4]; 2]; 2],
    /// Coefficients of the bubbles on these edges.
    pub bubbles: [[f64; 2]; 2],
    /// Fluxes through the edges that f and its load require.
    pub flux: EdgeFluxes,
    /// Moments of f.
    pub f: CellMoments,
}

/// Half the sum of the second differences at the ends of an edge: twice the coefficient of its bubble if f is constant
/// around it.
#[inline(always)]
pub(super) fn second([a, b, c, d]: [f64; 4]) -> f64 {
    0.5 * ((d - c) - (b - a))
}

/// Third difference on the line of an edge.
#[inline(always)]
fn third([a, b, c, d]: [f64; 4]) -> f64 {
    (d - a) - 3.0 * (c - b)
}

/// Sum of two squares.
#[inline(always)]
fn sum_of_squares(d: [f64; 2]) -> f64 {
    d[0] * d[0] + d[1] * d[1]
}

impl SpecialCell {
    /// Values at ll, lr, ul, ur.
    #[inline(always)]
    pub(super) fn corners(&self) -> [f64; 4] {
        let [[_, ll, lr, _], [_, ul, ur, _]] = self.lines[0];
        [ll, lr, ul, ur]
    }

    #[inline(always)]
    pub(super) fn sums(&self) -> Sums {
        let Self { lines: [x, y], bubbles, flux, f } = *self;
        let EdgeFluxes { left, right, bottom, top } = flux;
        let (x, y) = (Axis::new(x, bubbles[0]), Axis::new(y, bubbles[1]));
        // Slopes and twist of the residual of the five-point equation at the corners.
        let slopes = [
            12.0 * f.x + mean(x.third) + difference(y.second),
            12.0 * f.y + mean(y.third) + difference(x.second),
        ];
        let twist = 144.0 * f.xy + difference(x.third) + difference(y.third);
        let distance = x.distance(y.bend(), [left, right], slopes[0], twist)
            + y.distance(x.bend(), [bottom, top], slopes[1], twist);
        // To the square root, h / (2 pi) times the norm of f less its bilinear approximation is added.
        let oscillation = f.oscillation();
        let distance = match oscillation > 0.0 {
            true => (distance.sqrt() + oscillation.sqrt() / (2.0 * PI)).powi(2),
            false => distance,
        };
        // (f, w) for the bilinear interpolant w; the bubbles are subtracted below.
        let [ll, lr, ul, ur] = self.corners();
        let turn = (ll + ur) - (lr + ul);
        let bilinear = 0.25 * ((ll + lr) + (ul + ur)) * f.one
            + 0.5 * ((lr + ur) - (ll + ul)) * f.x
            + 0.5 * ((ul + ur) - (ll + lr)) * f.y
            + turn * f.xy;
        Sums {
            distance,
            recovered: x.recovered(y.bend()) + y.recovered(x.bend()),
            recovered_load: bilinear - f.bubbles(bubbles),
            linear: 0.5 * (sum_of_squares(x.along) + sum_of_squares(y.along)),
            linear_load: bilinear + turn * f.ridge,
            variance: 0.0,
        }
    }

    /// Increase of the energy of w if the bubble on edge `k` along an axis is left out.
    pub(super) fn boundary_bubble_gain(&self, axis: usize, k: usize) -> f64 {
        let (bubble, opposite) = (self.bubbles[axis][k], self.bubbles[axis][1 - k]);
        let [p, q] = self.lines[1 - axis].map(|[_, p, q, _]| q - p);
        let inward = if k == 0 { mean([p, q]) } else { -mean([p, q]) };
        let BubbleLoad { sum, half_difference } = self.f.blended()[axis];
        let load = if k == 0 { 0.5 * sum - half_difference } else { 0.5 * sum + half_difference };
        let energy = (2.0 * opposite - bubble) / 60.0 - (bubble + opposite) / 18.0 - SIXTH * inward;
        bubble * (energy - load)
    }
}

/// Differences on the two edges of a cell along one axis.
#[derive(Clone, Copy)]
struct Axis {
    /// First differences.
    along: [f64; 2],
    /// Third differences.
    third: [f64; 2],
    /// Mean second differences, see [`second`].
    second: [f64; 2],
    /// Coefficients of the bubbles.
    bubble: [f64; 2],
}

impl Axis {
    #[inline(always)]
    fn new(lines: [[f64; 4]; 2], bubble: [f64; 2]) -> Self {
        Self {
            along: lines.map(|[_, p, q, _]| q - p),
            third: lines.map(third),
            second: lines.map(second),
            bubble,
        }
    }

    /// Contribution of the bubbles of this axis to the slope along the other axis.
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
        let mixed = 0.5 * third[1] - 0.25 * twist;
        let linear = across * across + along * along + TWELFTH * both * both;
        let square = quadratic * quadratic + TWELFTH * mixed * mixed + bend * bend;
        constant * constant + TWELFTH * (linear + square * (1.0 / 15.0))
    }
}

const SIXTH: f64 = 1.0 / 6.0;
const TWELFTH: f64 = 1.0 / 12.0;

/// Special cells that are collected until there is one for each lane, and the sums over the cells before them.
#[derive(Default)]
pub(super) struct Batch {
    /// Number of cells in `cells`.
    filled: usize,
    cells: [SpecialCell; LANES],
    sums: Sums<CellLanes>,
}

impl Batch {
    /// Adds a cell to the batch.
    #[inline(always)]
    pub(super) fn push(&mut self, cell: &SpecialCell) {
        self.cells[self.filled] = *cell;
        self.filled += 1;
        if self.filled == LANES {
            self.sum(LANES);
        }
    }

    /// Adds the first `cells` cells to the sums, and empties all lanes.
    #[inline(always)]
    fn sum(&mut self, cells: usize) {
        for k in 0..cells {
            self.sums.each(&self.cells[k].sums(), |lanes, part| lanes[k] += part);
        }
        self.filled = 0;
    }

    /// Adds all cells of the batch to the sums.
    pub(super) fn flush(&mut self) {
        self.sum(self.filled);
    }

    /// Returns the sums so far, and resets them to zero.
    #[inline(always)]
    pub(super) fn take(&mut self) -> Sums {
        std::mem::take(&mut self.sums).total()
    }
}

#[cfg(test)]
mod tests {
    use super::super::regular::Regular;
    use super::*;
    use crate::machine::simd::with_each;
    use std::array::from_fn;
    use std::ops::Range;

    /// Number between -`size` and `size` that looks random.
    fn noise(k: usize, frequency: f64, size: f64) -> f64 {
        libm::sin(k as f64 * frequency) * size
    }

    /// Sums over regular cells with a constant f, by the formulas for a special cell.
    struct CellByCell {
        sums: Sums,
        /// Mean of the residual in each cell.
        residuals: Vec<f64>,
    }

    fn laplacian(rows: &[Vec<f64>; 4], j: usize, i: usize) -> f64 {
        rows[j][i - 1] + rows[j][i + 1] + rows[j - 1][i] + rows[j + 1][i] - 4.0 * rows[j][i]
    }

    fn cell_by_cell(rows: &[Vec<f64>; 4], cells: Range<usize>, mass: f64) -> CellByCell {
        let (mut total, mut residuals) = (Sums::default(), vec![0.0; 59]);
        for i in cells {
            let along = [1, 2].map(|j| from_fn(|k| rows[j][i + k - 1]));
            let across = [i, i + 1].map(|i| from_fn(|j| rows[j][i]));
            let lines = [along, across];
            let bubbles = lines.map(|lines| lines.map(|line| 0.5 * second(line)));
            let (x, y) = (Axis::new(lines[0], bubbles[0]), Axis::new(lines[1], bubbles[1]));
            let (flux, f) = (EdgeFluxes::default(), CellMoments::constant(mass));
            let mut sums = SpecialCell { lines, bubbles, flux, f }.sums();
            // Without the field that follows the residual inside the cell.
            sums.distance =
                x.distance(y.bend(), [0.0; 2], 0.0, 0.0) + y.distance(x.bend(), [0.0; 2], 0.0, 0.0);
            let at = [(1, i), (1, i + 1), (2, i), (2, i + 1)].map(|(j, i)| laplacian(rows, j, i));
            let slopes = [at[1] + at[3] - at[0] - at[2], at[2] + at[3] - at[0] - at[1]];
            let twist = at[0] + at[3] - at[1] - at[2];
            sums.variance = (slopes[0].powi(2) + slopes[1].powi(2)) / 48.0 + twist * twist / 144.0;
            residuals[i] = 0.25 * at.iter().sum::<f64>() + mass;
            total.add(&sums);
        }
        CellByCell { sums: total, residuals }
    }

    fn assert_sums_agree(mut found: Sums, expected: &Sums) {
        found.each(expected, |found, expected| {
            let tolerance = 1e-12 * expected.abs().max(1e3);
            assert!((*found - expected).abs() < tolerance, "{found} {expected}");
        });
    }

    #[test]
    fn blocks_of_regular_cells_have_the_sums_of_single_cells() {
        let rows: [Vec<f64>; 4] =
            from_fn(|j| (0..60).map(|i| noise(60 * j + i, 12.9898, 43.7)).collect());
        let mass = 0.3;
        for cells in [1..17, 1..58, 5..40, 50..58, 30..31] {
            let expected = cell_by_cell(&rows, cells.clone(), mass);
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
            let expected_squares: f64 = expected.residuals.iter().map(|mean| mean * mean).sum();
            for (sums, squares, means) in &found {
                assert_eq!(*sums, found[0].0, "all instruction sets give the same bits");
                assert!((squares - expected_squares).abs() < 1e-12 * expected_squares.max(1e3));
                assert_sums_agree(*sums, &expected.sums);
                let mut pairs = means.iter().zip(&expected.residuals);
                assert!(pairs.all(|(p, q)| (p - q).abs() < 1e-11));
            }
        }
    }

    #[test]
    fn a_batch_has_the_sums_of_single_cells() {
        let (mut batch, mut expected) = (Batch::default(), Sums::default());
        for k in 0..2 * LANES + 3 {
            let numbers: [f64; 70] = from_fn(|place| noise(100 * k + place, 78.233, 3.7));
            let [one, x, y, xy, xx, yy, xxy, xyy, ridge, _]: [f64; 10] =
                from_fn(|place| numbers[60 + place]);
            let [left, right, bottom, top] = from_fn(|edge| numbers[30 + edge]);
            let cell = SpecialCell {
                lines: from_fn(|a| from_fn(|b| from_fn(|c| numbers[8 * a + 4 * b + c]))),
                bubbles: from_fn(|a| from_fn(|b| numbers[20 + 2 * a + b])),
                flux: EdgeFluxes { left, right, bottom, top },
                f: CellMoments { one, x, y, xy, xx, yy, xxy, xyy, ridge, square: 1e3 },
            };
            batch.push(&cell);
            expected.add(&cell.sums());
        }
        batch.flush();
        assert_sums_agree(batch.take(), &expected);
    }
}
