//! Numbers of all lanes.

use super::LANES;
use crate::problem::law::Law;
use std::array::from_fn;
use std::ops::{Add, Mul, Sub};

/// A number per lane.
#[derive(Clone, Copy, Default)]
#[repr(align(64))]
pub(crate) struct V(pub [f64; LANES]);

impl Add for V {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self(from_fn(|l| self.0[l] + other.0[l]))
    }
}

impl Mul for V {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self(from_fn(|l| self.0[l] * other.0[l]))
    }
}

impl Mul<f64> for V {
    type Output = Self;
    #[inline(always)]
    fn mul(self, factor: f64) -> Self {
        self * Self::all(factor)
    }
}

impl Sub for V {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self(from_fn(|l| self.0[l] - other.0[l]))
    }
}

impl V {
    #[inline(always)]
    pub(super) fn all(value: f64) -> Self {
        Self([value; LANES])
    }

    /// The absolute values.
    #[inline(always)]
    pub(super) fn abs(self) -> Self {
        Self(self.0.map(f64::abs))
    }

    /// In each lane, the greater of two numbers; the other one where this is NaN.
    #[inline(always)]
    pub(super) fn greatest(self, other: Self) -> Self {
        Self(from_fn(|l| if self.0[l] > other.0[l] { self.0[l] } else { other.0[l] }))
    }
}

/// A law per lane.
#[derive(Clone)]
pub(super) struct LaneLaws {
    laws: [Law; LANES],
    /// Ends of the intervals.
    pub(super) lo: V,
    pub(super) hi: V,
    /// True if a lane's interval has an upper end.
    pub(super) has_upper: bool,
}

impl LaneLaws {
    /// The same law in all lanes.
    pub(super) fn all(law: Law) -> Self {
        let (lo, hi) = (V::all(law.lo()), V::all(law.hi()));
        Self { laws: [law; LANES], lo, hi, has_upper: law.hi().is_finite() }
    }

    /// Sets the law of a lane.
    pub(super) fn set(&mut self, lane: usize, law: Law) {
        self.laws[lane] = law;
        (self.lo.0[lane], self.hi.0[lane]) = (law.lo(), law.hi());
        self.has_upper = self.laws.iter().any(|law| law.hi().is_finite());
    }

    /// In each lane, the point of the law's interval next to a flux, as [`Law::project`].
    #[inline(always)]
    pub(super) fn project(&self, flux: V) -> V {
        let (lo, hi) = (self.lo, self.hi);
        V(from_fn(|l| {
            let above = if flux.0[l] > lo.0[l] { flux.0[l] } else { lo.0[l] };
            if above < hi.0[l] { above } else { hi.0[l] }
        }))
    }

    /// In each lane, [`Law::residual`].
    #[inline(always)]
    pub(super) fn residual(&self, y: V, gradient: V, measure: f64) -> V {
        V(from_fn(|l| self.laws[l].residual(y.0[l], gradient.0[l], measure)))
    }

    /// In each lane, [`Law::relax`] on a row with this diagonal entry, by which `divided` divides.
    #[inline(always)]
    pub(super) fn relax(
        &self,
        [sum, a, r]: [V; 3],
        diagonal: V,
        measure: f64,
        divided: impl Fn(V) -> V,
    ) -> V {
        let (lo, hi) = (self.lo, self.hi);
        let up = divided(sum + lo * measure);
        let least = V(from_fn(|l| (a.0[l] - lo.0[l]) / r.0[l]));
        let slips_up: [bool; LANES] = from_fn(|l| up.0[l] >= least.0[l]);
        if slips_up.iter().all(|slips| *slips) {
            return up;
        }
        let mut other =
            V(from_fn(|l| (sum.0[l] + measure * a.0[l]) / (diagonal.0[l] + measure * r.0[l])));
        // Without an upper end nothing slips down, and a division for each node is saved.
        if self.has_upper {
            let down = divided(sum + hi * measure);
            let most = V(from_fn(|l| (a.0[l] - hi.0[l]) / r.0[l]));
            other = V(from_fn(|l| if down.0[l] <= most.0[l] { down.0[l] } else { other.0[l] }));
        }
        V(from_fn(|l| if slips_up[l] { up.0[l] } else { other.0[l] }))
    }
}
