//! An upper bound of the flux whose divergence is the residual: Poincaré's inequality on squares of all sizes.

use std::f64::consts::PI;

/// Variances of a piecewise constant function r on squares of all sizes.
///
/// With `P_l` the mean over squares of `2^l` by `2^l` cells, `r = sum (P_l - P_{l+1}) r`, and
/// `(P_l - P_{l+1}) r` has no mean on squares of width `2^(l+1) h`, where Poincaré's constant is the width
/// over pi (its extremal function is cos(pi x / width)). One flux for each level gives
/// `|grad w| <= sum_l 2^(l+1) h / pi |(P_l - P_{l+1}) r|` for the solution of `-Lap w = r`.
pub(super) struct Pyramid {
    levels: Vec<PyramidLevel>,
    zeros: Vec<f64>,
    /// Sum over the blocks of the last level, whose number per side is odd.
    top_sum: f64,
    /// Sum of the squares over these blocks.
    top_squares: f64,
}

/// Blocks of cells of one size.
#[derive(Default)]
struct PyramidLevel {
    /// Number of blocks per side.
    side: usize,
    /// True if the lower row of a pair has been given and the upper one has not.
    half_pair: bool,
    /// Lower row of the pair; empty if it is zero.
    lower: Vec<f64>,
    /// Sums over the blocks of the pair.
    sums: Vec<f64>,
    /// Sum over the blocks of the next size of the variance of their four parts.
    variance: f64,
}

impl Pyramid {
    pub(super) fn new(n: usize) -> Self {
        let sides = (0..=n.trailing_zeros()).map(|level| n >> level);
        let levels = sides.map(|side| PyramidLevel { side, ..PyramidLevel::default() }).collect();
        Self { levels, zeros: vec![0.0; n], top_sum: 0.0, top_squares: 0.0 }
    }

    /// Adds the next row of values of r, times `h^2`; an empty slice stands for zeros.
    #[inline(always)]
    pub(super) fn push<'a>(&'a mut self, mut row: &'a [f64]) {
        let (_, halving) = self.levels.split_last_mut().expect("a level at least");
        for PyramidLevel { side, half_pair, lower, sums, variance } in halving {
            *half_pair = !*half_pair;
            if *half_pair {
                lower.clear();
                lower.extend_from_slice(row);
                return;
            }
            if lower.is_empty() && row.is_empty() {
                continue;
            }
            let [below, above] =
                [lower, row].map(|row| if row.is_empty() { &self.zeros[..*side] } else { row });
            *variance += halve(below, above, sums);
            row = sums;
        }
        for block in row {
            self.top_sum += block;
            self.top_squares += block * block;
        }
    }

    /// Upper bound of `|grad w|` for the solution w of `-Lap w = r`.
    pub(super) fn bound(&self) -> f64 {
        let (last, others) = self.levels.split_last().expect("a level at least");
        let below: f64 = others.iter().map(|level| level.variance.sqrt()).sum();
        let side = last.side as f64;
        let mean = self.top_sum / side;
        let top = (self.top_squares - mean * mean).max(0.0);
        (2.0 * below + side * top.sqrt()) / PI
    }
}

/// Number of sums that are formed side by side.
const LANES: usize = 8;

/// Writes the sums over each two by two blocks of two rows, and returns the sum of the variances within the fours.
#[inline(always)]
fn halve(below: &[f64], above: &[f64], sums: &mut Vec<f64>) -> f64 {
    let mut variances = [0.0; LANES];
    sums.resize(below.len() / 2, 0.0);
    let (whole, rest) = sums.as_chunks_mut::<LANES>();
    let (below, below_rest) = below.as_chunks::<{ 2 * LANES }>();
    let (above, above_rest) = above.as_chunks::<{ 2 * LANES }>();
    for (sums, (below, above)) in whole.iter_mut().zip(below.iter().zip(above)) {
        halve_lanes(below, above, sums, &mut variances);
    }
    halve_lanes(below_rest, above_rest, rest, &mut variances);
    variances.iter().sum()
}

/// [`halve`] for at most [`LANES`] sums, each with its own variance.
#[inline(always)]
fn halve_lanes(below: &[f64], above: &[f64], sums: &mut [f64], variances: &mut [f64; LANES]) {
    for (k, (sum, variance)) in sums.iter_mut().zip(variances).enumerate() {
        let [left, right] = [2 * k, 2 * k + 1].map(|k| below[k] + above[k]);
        let [p, q] = [2 * k, 2 * k + 1].map(|k| below[k] - above[k]);
        *sum = left + right;
        // Within the columns, and between them.
        *variance += 0.5 * (p * p + q * q) + 0.25 * (left - right) * (left - right);
    }
}
