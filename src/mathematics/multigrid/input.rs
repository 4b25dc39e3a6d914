//! What a load must satisfy before a solver accepts it.

use crate::discrete::simd::LANES;

/// What can be wrong with the input of a solver.
#[derive(Clone, Debug, thiserror::Error, PartialEq)]
pub enum InputError {
    /// So many cells per side, which must be of another form.
    #[error("{0} cells per side: must be {1}")]
    GridSize(usize, &'static str),
    /// So many numbers, where there are more or fewer nodes.
    #[error("{found} numbers given for the {expected} nodes of the grid")]
    Length {
        /// Numbers given.
        found: usize,
        /// Nodes.
        expected: usize,
    },
    /// A field with an infinity or a NaN, or whose sum overflows.
    #[error("the {0} contains a number that is not finite, or sums to none")]
    NotFinite(&'static str),
    /// The sum of a load that is not negative.
    #[error("the load sums to {0:e}: without a negative sum the problem has no unique solution")]
    NotCoercive(f64),
}

/// Checks that there is one number for each node.
pub(super) fn check_length(expected: usize, field: &[f64]) -> Result<(), InputError> {
    let found = field.len();
    if found == expected { Ok(()) } else { Err(InputError::Length { found, expected }) }
}

/// Checks that a start has one finite number for each node, also when divided by `scale`.
pub(super) fn check_start(expected: usize, start: &[f64], scale: f64) -> Result<(), InputError> {
    check_length(expected, start)?;
    let finite = start.iter().all(|value| (value / scale).is_finite());
    if finite { Ok(()) } else { Err(InputError::NotFinite("start")) }
}

/// Loads whose largest entry lies in here are not rescaled.
const COMFORTABLE: std::ops::Range<f64> = 1e-100..1e100;

/// What must be known of a load before it is used.
pub(super) struct Extent {
    pub(super) largest: f64,
    /// The sign of the sum decides whether there is a solution; not finite if a value is not.
    sum: f64,
    /// What rounding took from the sum.
    lost: f64,
}

impl Extent {
    /// Rounds sums of four numbers, and only these: enough for a sum 1e-15 times the sum of the absolute
    /// values, at the speed of the memory.
    #[inline(always)]
    pub(super) fn of(values: &[f64]) -> Self {
        let mut largest = [0.0_f64; LANES];
        let (mut sums, mut losses) = ([0.0; LANES], [0.0; LANES]);
        let mut see = |lane: usize, size: f64, sum: f64| {
            largest[lane] = larger(size, largest[lane]);
            (sums[lane], losses[lane]) = two_sum(sums[lane], losses[lane], sum);
        };
        let (blocks, rest) = values.as_chunks::<{ 4 * LANES }>();
        for block in blocks {
            let (a, b) = block.split_at(2 * LANES);
            let ((a, b), (c, d)) = (a.split_at(LANES), b.split_at(LANES));
            for lane in 0..LANES {
                let (a, b, c, d) = (a[lane], b[lane], c[lane], d[lane]);
                let size = larger(larger(a.abs(), b.abs()), larger(c.abs(), d.abs()));
                see(lane, size, (a + b) + (c + d));
            }
        }
        for row in rest.chunks(LANES) {
            for (lane, &value) in row.iter().enumerate() {
                see(lane, value.abs(), value);
            }
        }
        let of_lane = |lane| Self { largest: largest[lane], sum: sums[lane], lost: losses[lane] };
        Self::join(&std::array::from_fn::<_, LANES, _>(of_lane))
    }

    pub(super) fn join(parts: &[Self]) -> Self {
        let mut all = Self { largest: 0.0, sum: 0.0, lost: 0.0 };
        for part in parts {
            all.largest = all.largest.max(part.largest);
            (all.sum, all.lost) = two_sum(all.sum, all.lost + part.lost, part.sum);
        }
        all
    }

    /// A power of two by which to divide the load, so that squares and ratios of the numbers stay within
    /// the range of double precision; 1 where they do anyway.
    pub(super) fn scale(&self) -> f64 {
        if COMFORTABLE.contains(&self.largest) { 1.0 } else { power_of_two_near(self.largest) }
    }

    pub(super) fn check(&self) -> Result<(), InputError> {
        let sum = self.sum + self.lost;
        if !sum.is_finite() {
            return Err(InputError::NotFinite("load"));
        }
        if sum >= 0.0 { Err(InputError::NotCoercive(sum)) } else { Ok(()) }
    }
}

/// Adds to a sum and to the rounding errors it has made so far (Knuth's exact transformation).
#[inline(always)]
fn two_sum(sum: f64, lost: f64, value: f64) -> (f64, f64) {
    let next = sum + value;
    let part = next - sum;
    (next, lost + ((sum - (next - part)) + (value - part)))
}

/// The maximum in one machine instruction, which `f64::max` is not.
#[inline(always)]
fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// A power of two within a factor of two of `x`, itself and its inverse normal numbers.
fn power_of_two_near(x: f64) -> f64 {
    const EXPONENT_BITS: u64 = 0x7ff << 52;
    let tiny = f64::MIN_POSITIVE * 4.0;
    f64::from_bits(x.clamp(tiny, 1.0 / tiny).to_bits() & EXPONENT_BITS)
}
