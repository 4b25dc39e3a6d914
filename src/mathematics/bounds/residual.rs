//! A bound of the flux that a residual takes: Poincaré's inequality on squares of all sizes.

use std::f64::consts::PI;

/// Sums of squares of a piecewise constant function, by the size of the squares on which it varies.
///
/// With `P_l` the mean over squares of `2^l` by `2^l` cells, `r = sum (P_l - P_{l+1}) r`, and
/// `(P_l - P_{l+1}) r` has no mean on squares of width `2^(l+1) h`, where Poincaré's constant is the width
/// over pi (its extremal function is cos(pi x / width)). One flux for each level gives
/// `|grad w| <= sum_l 2^(l+1) h / pi |(P_l - P_{l+1}) r|` for the solution of `-Lap w = r`.
pub(super) struct Pyramid {
    levels: Vec<Level>,
    zeros: Vec<f64>,
    /// Sum and sum of squares of the blocks that cannot be halved any more.
    top: [f64; 2],
}

/// Blocks of one size.
#[derive(Default)]
struct Level {
    /// Blocks per side.
    side: usize,
    /// Whether the lower one of a pair of rows is there.
    waiting: bool,
    /// That row; empty for zeros.
    lower: Vec<f64>,
    /// Sums over the blocks of the pair.
    sums: Vec<f64>,
    /// Sum over the blocks of the next size of the variance of their four parts.
    variance: f64,
}

impl Pyramid {
    pub(super) fn new(n: usize) -> Self {
        let sides = (0..=n.trailing_zeros()).map(|level| n >> level);
        let level = |side| Level { side, ..Level::default() };
        Self { levels: sides.map(level).collect(), zeros: vec![0.0; n], top: [0.0; 2] }
    }

    /// Adds the next row of cells, each times `h^2`; an empty one is zero.
    #[inline(always)]
    pub(super) fn push<'a>(&'a mut self, mut row: &'a [f64]) {
        let (_, halving) = self.levels.split_last_mut().expect("a level at least");
        for Level { side, waiting, lower, sums, variance } in halving {
            *waiting = !*waiting;
            if *waiting {
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
            self.top[0] += block;
            self.top[1] += block * block;
        }
    }

    /// The bound of `|grad w|`.
    pub(super) fn bound(&self) -> f64 {
        let (last, others) = self.levels.split_last().expect("a level at least");
        let below: f64 = others.iter().map(|level| level.variance.sqrt()).sum();
        let side = last.side as f64;
        let [sum, squares] = self.top;
        let top = (squares - (sum / side) * (sum / side)).max(0.0);
        (2.0 * below + side * top.sqrt()) / PI
    }
}

/// Writes sums over each four neighbouring blocks of two rows, and returns what these vary within the fours.
#[inline(always)]
fn halve(below: &[f64], above: &[f64], sums: &mut Vec<f64>) -> f64 {
    // Sums kept apart, so that they can be added to at once.
    const LANES: usize = 8;
    let mut variances = [0.0; LANES];
    let mut halve = |sums: &mut [f64], below: &[f64], above: &[f64]| {
        for (k, (sum, variance)) in sums.iter_mut().zip(&mut variances).enumerate() {
            let [left, right] = [2 * k, 2 * k + 1].map(|k| below[k] + above[k]);
            let [p, q] = [2 * k, 2 * k + 1].map(|k| below[k] - above[k]);
            *sum = left + right;
            // Within the columns, and between them.
            *variance += 0.5 * (p * p + q * q) + 0.25 * (left - right) * (left - right);
        }
    };
    sums.resize(below.len() / 2, 0.0);
    let (whole, rest) = sums.as_chunks_mut::<LANES>();
    let (below, below_rest) = below.as_chunks::<{ 2 * LANES }>();
    let (above, above_rest) = above.as_chunks::<{ 2 * LANES }>();
    for (sums, (below, above)) in whole.iter_mut().zip(below.iter().zip(above)) {
        halve(sums, below, above);
    }
    halve(rest, below_rest, above_rest);
    variances.iter().sum()
}
