//! Numbers of all lanes.

use super::LANES;
use crate::problem::law::Law;
use std::ops::{Add, Div, Mul, Sub};

/// A number per lane, aligned as `L` is.
#[derive(Clone, Copy)]
pub(crate) struct V<const K: usize = LANES, L = LaneAlignment>(pub [f64; K], [L; 0]);

/// Returns the values of a function at the first numbers. That of the standard library is not inlined in every build,
/// and its calls then take far longer than the work.
#[inline(always)]
pub(super) fn each<T: Copy + Default, const N: usize>(value: impl Fn(usize) -> T) -> [T; N] {
    let mut values = [T::default(); N];
    let mut k = 0;
    while k < N {
        values[k] = value(k);
        k += 1;
    }
    values
}

/// Alignment of the numbers of [`LANES`] lanes: with one load each.
#[derive(Clone, Copy)]
#[repr(align(64))]
pub(crate) struct LaneAlignment;

impl<const K: usize, L: Copy> Default for V<K, L> {
    fn default() -> Self {
        Self::of([0.0; K])
    }
}

impl<const K: usize, L: Copy> Add for V<K, L> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self::of(each(|l| self.0[l] + other.0[l]))
    }
}

impl<const K: usize, L: Copy> Div for V<K, L> {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        Self::of(each(|l| self.0[l] / other.0[l]))
    }
}

impl<const K: usize, L: Copy> Mul for V<K, L> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self::of(each(|l| self.0[l] * other.0[l]))
    }
}

impl<const K: usize, L: Copy> Mul<f64> for V<K, L> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, factor: f64) -> Self {
        self * Self::all(factor)
    }
}

impl<const K: usize, L: Copy> Sub for V<K, L> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self::of(each(|l| self.0[l] - other.0[l]))
    }
}

impl<const K: usize, L: Copy> V<K, L> {
    #[inline(always)]
    pub(crate) fn of(numbers: [f64; K]) -> Self {
        Self(numbers, [])
    }

    #[inline(always)]
    pub(super) fn all(value: f64) -> Self {
        Self::of([value; K])
    }

    /// The absolute values.
    #[inline(always)]
    pub(super) fn abs(self) -> Self {
        Self::of(each(|l| self.0[l].abs()))
    }

    /// In each lane, the greater of two numbers; the other one where this is NaN.
    #[inline(always)]
    pub(super) fn greatest(self, other: Self) -> Self {
        Self::of(each(|l| if self.0[l] > other.0[l] { self.0[l] } else { other.0[l] }))
    }
}

/// The law of all lanes.
#[derive(Clone)]
pub(super) struct LaneLaw<const K: usize, L> {
    law: Law,
    /// Ends of the intervals.
    pub(super) lo: V<K, L>,
    pub(super) hi: V<K, L>,
    /// True if the interval has an upper end.
    pub(super) has_upper: bool,
}

impl<const K: usize, L: Copy> LaneLaw<K, L> {
    pub(super) fn new(law: Law) -> Self {
        let (lo, hi) = (V::all(law.lo()), V::all(law.hi()));
        Self { law, lo, hi, has_upper: law.hi().is_finite() }
    }

    /// In each lane, the point of the law's interval next to a flux, as [`Law::project`].
    #[inline(always)]
    pub(super) fn project(&self, flux: V<K, L>) -> V<K, L> {
        let (lo, hi) = (self.lo, self.hi);
        V::of(each(|l| {
            let above = if flux.0[l] > lo.0[l] { flux.0[l] } else { lo.0[l] };
            if above < hi.0[l] { above } else { hi.0[l] }
        }))
    }

    /// In each lane, [`Law::residual`].
    #[inline(always)]
    pub(super) fn residual(&self, y: V<K, L>, gradient: V<K, L>, measure: f64) -> V<K, L> {
        V::of(each(|l| self.law.residual(y.0[l], gradient.0[l], measure)))
    }

    /// In each lane, [`Law::relax`] on a row with this diagonal entry, by which `divided` divides.
    #[inline(always)]
    pub(super) fn relax(
        &self,
        [sum, a, r]: [V<K, L>; 3],
        diagonal: V<K, L>,
        measure: f64,
        divided: impl Fn(V<K, L>) -> V<K, L>,
    ) -> V<K, L> {
        let (lo, hi) = (self.lo, self.hi);
        let up = divided(sum + lo * measure);
        let least = (a - lo) / r;
        let slips_up: [bool; K] = each(|l| up.0[l] >= least.0[l]);
        if slips_up.iter().all(|slips| *slips) {
            return up;
        }
        let mut other = (sum + a * measure) / (diagonal + r * measure);
        // Without an upper end nothing slips down, and a division for each node is saved.
        if self.has_upper {
            let down = divided(sum + hi * measure);
            let most = (a - hi) / r;
            other = V::of(each(|l| if down.0[l] <= most.0[l] { down.0[l] } else { other.0[l] }));
        }
        V::of(each(|l| if slips_up[l] { up.0[l] } else { other.0[l] }))
    }
}
