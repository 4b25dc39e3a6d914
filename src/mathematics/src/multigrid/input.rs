//! Validation of the input of a solver: numbers of cells, lengths, finite numbers, a load that the flux can balance.

use crate::discrete::network::{Network, count_components};
use crate::machine::extremes::max_or_second;
use crate::machine::simd::LANES;
use crate::problem::law::{Law, LawError};

/// Reason for which a solver rejects its input.
#[derive(Clone, Debug, thiserror::Error, PartialEq)]
pub enum InputError {
    /// Number of cells per side that cannot be used.
    #[error("{cells} cells per side: must be {rule}; the nearest: {}", in_words(nearest))]
    GridSize {
        /// The number.
        cells: usize,
        /// Description of the numbers that can be used.
        rule: &'static str,
        /// Next smaller and next larger number that can be used, as far as there are such.
        nearest: Vec<usize>,
    },
    /// A field whose length is not the number of nodes.
    #[error("{found} numbers given for the {expected} nodes of the grid")]
    Length {
        /// Length of the field.
        found: usize,
        /// Number of nodes.
        expected: usize,
    },
    /// Name of a field that contains an infinity or a NaN, or whose sum overflows.
    #[error("the {0} contains a number that is not finite, or its sum overflows")]
    NotFinite(&'static str),
    /// Sum of a load, which is zero or positive.
    #[error("the load sums to {0:e}: without a negative sum the problem has no unique solution")]
    NotCoercive(f64),
    /// A load that the flux under another law than the paper's cannot balance.
    #[error(transparent)]
    Law(#[from] LawError),
}

fn in_words(numbers: &[usize]) -> String {
    numbers.iter().map(usize::to_string).collect::<Vec<_>>().join(" and ")
}

/// Odd factors of the numbers of cells per side that can be used.
const ODD_FACTORS: [usize; 4] = [1, 3, 5, 7];

/// Returns the cells per side of the coarsest grid for `n` cells per side, or `None` if `n` cannot be used.
pub(super) fn coarsest_cells(n: usize) -> Option<usize> {
    let odd = n.checked_shr(n.trailing_zeros())?;
    // Four cells per side are solved directly, which is cheaper than a further coarsening to two.
    let coarsest = if odd == 1 { n.min(4) } else { 2 * odd };
    (n.is_multiple_of(2) && ODD_FACTORS.contains(&odd)).then_some(coarsest)
}

/// Next smaller and next larger number of cells per side than `n` that can be used.
pub(super) fn nearest_sizes(n: usize) -> Vec<usize> {
    let powers = (1..usize::BITS).map(|k| 1_usize << k);
    let sizes = powers.flat_map(|power| ODD_FACTORS.map(|odd| power.checked_mul(odd)));
    let sizes: Vec<usize> = sizes.flatten().collect();
    let below = sizes.iter().copied().filter(|&size| size < n).max();
    let above = sizes.iter().copied().filter(|&size| size > n).min();
    below.into_iter().chain(above).collect()
}

/// Checks that a field has one number for each node.
pub(crate) fn check_length(expected: usize, field: &[f64]) -> Result<(), InputError> {
    let found = field.len();
    if found == expected { Ok(()) } else { Err(InputError::Length { found, expected }) }
}

/// Checks that a start has one finite number for each node, also when divided by `scale`.
pub(super) fn check_start(expected: usize, start: &[f64], scale: f64) -> Result<(), InputError> {
    check_length(expected, start)?;
    let finite = start.iter().all(|value| (value / scale).is_finite());
    if finite { Ok(()) } else { Err(InputError::NotFinite("start")) }
}

/// Connected component of a network with a load.
pub(crate) struct LoadedComponent {
    /// True if y = 0 at a node.
    pub(crate) has_fixed: bool,
    /// Length or area of the boundary in contact.
    pub(crate) measure: f64,
    /// Sum of the load.
    pub(crate) sum: f64,
}

impl LoadedComponent {
    /// Checks the condition (2): the flux can balance the load by more than its rounding error, or a node is fixed.
    pub(crate) fn check(&self, law: Law, rounding: f64) -> Result<(), InputError> {
        if self.has_fixed {
            return Ok(());
        }
        match law.check_solvable_by(rounding, self.sum, self.measure) {
            Err(_) if law.is_signorini() => Err(InputError::NotCoercive(self.sum)),
            checked => Ok(checked?),
        }
    }
}

/// Returns the connected components of a network. `components` has the number of each node's component.
pub(crate) fn loaded_components(
    network: &Network,
    components: &[u32],
    load: &[f64],
) -> Vec<LoadedComponent> {
    let count = count_components(components);
    let mut loads = vec![Vec::new(); count];
    if count > 1 {
        for (&component, value) in components.iter().zip(load) {
            loads[component as usize].push(*value);
        }
    }
    let mut found = Vec::with_capacity(count);
    for part in &loads {
        let LoadStats { sum, lost, .. } = LoadStats::measure(if count > 1 { part } else { load });
        found.push(LoadedComponent { has_fixed: false, measure: 0.0, sum: sum + lost });
    }
    for &node in network.fixed() {
        found[components[node as usize] as usize].has_fixed = true;
    }
    for contact in network.contact() {
        found[components[contact.node] as usize].measure += contact.measure;
    }
    found
}

/// Checks that a load is finite, and that the flux can balance it over each connected component without fixed nodes: for
/// the paper's law, that its sum is negative, the condition (2). `components` has the number of each node's component.
/// Returns for each component whether it has a fixed node.
///
/// # Errors
/// [`InputError::NotFinite`], [`InputError::NotCoercive`] and [`InputError::Law`].
pub(crate) fn check_components(
    network: &Network,
    components: &[u32],
    law: Law,
    load: &[f64],
) -> Result<Vec<bool>, InputError> {
    let found = loaded_components(network, components, load);
    if !found.iter().map(|of| of.sum).sum::<f64>().is_finite() {
        return Err(InputError::NotFinite("load"));
    }
    for of in &found {
        of.check(law, 0.0)?;
    }
    Ok(found.iter().map(|of| of.has_fixed).collect())
}

/// Range of the largest entry for which a load is not rescaled.
const NOT_RESCALED: std::ops::Range<f64> = 1e-100..1e100;

/// Largest entry and sum of a load, from which its scale and its validity follow.
pub(crate) struct LoadStats {
    /// Largest absolute value.
    pub(super) largest: f64,
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
    pub(super) fn join(parts: &[Self]) -> Self {
        let mut all = Self { largest: 0.0, sum: 0.0, lost: 0.0 };
        for part in parts {
            all.largest = all.largest.max(part.largest);
            (all.sum, all.lost) = two_sum(all.sum, all.lost + part.lost, part.sum);
        }
        all
    }

    /// Power of two by which to divide the load, so that squares and ratios of its entries neither overflow nor
    /// underflow; 1 if they do not do so anyway.
    pub(crate) fn scale(&self) -> f64 {
        if NOT_RESCALED.contains(&self.largest) { 1.0 } else { power_of_two_near(self.largest) }
    }

    /// Sum of the entries.
    pub(super) fn sum(&self) -> f64 {
        self.sum + self.lost
    }

    /// Checks that all entries are finite, and that the flux through a boundary of this `perimeter` can balance their sum.
    pub(crate) fn check(&self, law: Law, perimeter: f64) -> Result<(), InputError> {
        let sum = self.sum();
        if !sum.is_finite() {
            return Err(InputError::NotFinite("load"));
        }
        match law.check_solvable(sum, perimeter) {
            Err(_) if law.is_signorini() => Err(InputError::NotCoercive(sum)),
            checked => Ok(checked?),
        }
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
        (self.sums[lane], self.losses[lane]) = two_sum(self.sums[lane], self.losses[lane], sum);
    }

    #[inline(always)]
    fn lane(&self, lane: usize) -> LoadStats {
        LoadStats { largest: self.largest[lane], sum: self.sums[lane], lost: self.losses[lane] }
    }
}

/// Adds `value` to `sum`, and the rounding error of that addition to `lost` (Knuth's exact transformation).
#[inline(always)]
fn two_sum(sum: f64, lost: f64, value: f64) -> (f64, f64) {
    let next = sum + value;
    let part = next - sum;
    (next, lost + ((sum - (next - part)) + (value - part)))
}

/// Power of two within a factor of two of `x`. It and its inverse are normal numbers.
fn power_of_two_near(x: f64) -> f64 {
    const EXPONENT_BITS: u64 = 0x7ff << 52;
    let tiny = f64::MIN_POSITIVE * 4.0;
    f64::from_bits(x.clamp(tiny, 1.0 / tiny).to_bits() & EXPONENT_BITS)
}
