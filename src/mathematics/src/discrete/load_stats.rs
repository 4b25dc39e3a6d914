//! Largest entry and sum of a load vector, in one pass.

use crate::machine::extremes::{max_or_second, two_sum};
use crate::machine::simd::LANES;

/// Range of the largest entry for which a load is not rescaled.
const NOT_RESCALED: std::ops::Range<f64> = 1e-100..1e100;

/// Largest entry and sum of a load, from which its scale and its validity follow.
pub(crate) struct LoadStats {
    /// Largest absolute value.
    pub(crate) largest: f64,
    /// Rounded sum of the entries; not finite if an entry is not.
    sum: f64,
    /// Difference between the exact sum and `sum`.
    lost: f64,
}

impl LoadStats {
    /// Measures a load in one pass at the speed of the memory.
    ///
    /// Sums of four entries are rounded, all other additions are compensated. That is enough to find the sign of a
    /// sum that is 1e-15 times the sum of the absolute values.
    #[inline(always)]
    pub(crate) fn measure(values: &[f64]) -> Self {
        let mut lanes = LaneStats::default();
        let (blocks, rest) = values.as_chunks::<{ 4 * LANES }>();
        for block in blocks {
            let (a, b) = block.split_at(2 * LANES);
            let ((a, b), (c, d)) = (a.split_at(LANES), b.split_at(LANES));
            for lane in 0..LANES {
                let (a, b, c, d) = (a[lane], b[lane], c[lane], d[lane]);
                let size =
                    max_or_second(max_or_second(a.abs(), b.abs()), max_or_second(c.abs(), d.abs()));
                lanes.take(lane, size, (a + b) + (c + d));
            }
        }
        for row in rest.chunks(LANES) {
            for (lane, &value) in row.iter().enumerate() {
                lanes.take(lane, value.abs(), value);
            }
        }
        Self::join(&std::array::from_fn::<_, LANES, _>(|lane| lanes.lane(lane)))
    }

    /// Stats of the concatenation of several parts.
    pub(crate) fn join(parts: &[Self]) -> Self {
        let mut all = Self { largest: 0.0, sum: 0.0, lost: 0.0 };
        for part in parts {
            all.largest = all.largest.max(part.largest);
            (all.sum, all.lost) = add(all.sum, all.lost + part.lost, part.sum);
        }
        all
    }

    /// Power of two by which to divide the load, so that squares and ratios of its entries neither overflow nor
    /// underflow; 1 if they do not do so anyway.
    pub(crate) fn scale(&self) -> f64 {
        if NOT_RESCALED.contains(&self.largest) { 1.0 } else { power_of_two_near(self.largest) }
    }

    /// Sum of the entries.
    pub(crate) fn sum(&self) -> f64 {
        self.sum + self.lost
    }
}

/// [`LoadStats`] of interleaved parts of a load, side by side in vector lanes.
struct LaneStats {
    largest: [f64; LANES],
    sums: [f64; LANES],
    losses: [f64; LANES],
}

impl Default for LaneStats {
    #[inline(always)]
    fn default() -> Self {
        Self { largest: [0.0; LANES], sums: [0.0; LANES], losses: [0.0; LANES] }
    }
}

impl LaneStats {
    /// Adds `sum`, a sum of entries of absolute value `size` at most, to a lane.
    #[inline(always)]
    fn take(&mut self, lane: usize, size: f64, sum: f64) {
        self.largest[lane] = max_or_second(size, self.largest[lane]);
        (self.sums[lane], self.losses[lane]) = add(self.sums[lane], self.losses[lane], sum);
    }

    #[inline(always)]
    fn lane(&self, lane: usize) -> LoadStats {
        LoadStats { largest: self.largest[lane], sum: self.sums[lane], lost: self.losses[lane] }
    }
}

/// Adds `value` to `sum`, and the rounding error of that addition to `lost`.
#[inline(always)]
fn add(sum: f64, lost: f64, value: f64) -> (f64, f64) {
    let [next, remainder] = two_sum(sum, value);
    (next, lost + remainder)
}

/// Power of two within a factor of two of `x`. It and its inverse are normal numbers.
fn power_of_two_near(x: f64) -> f64 {
    const EXPONENT_BITS: u64 = 0x7ff << 52;
    let tiny = f64::MIN_POSITIVE * 4.0;
    f64::from_bits(x.clamp(tiny, 1.0 / tiny).to_bits() & EXPONENT_BITS)
}
