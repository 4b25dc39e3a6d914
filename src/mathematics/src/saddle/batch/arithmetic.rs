//! Numbers of all lanes.

use super::LANES;
use crate::problem::law::Law;
use std::array::from_fn;
use std::ops::{Add, Mul, Sub};

/// A number per lane.
#[derive(Clone, Copy, Default)]
#[repr(align(64))]
pub struct V(pub [f64; LANES]);

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

    /// In each lane, the point of the law's interval next to a flux.
    #[inline(always)]
    pub(super) fn project(self, law: Law) -> Self {
        Self(self.0.map(|flux| law.project(flux)))
    }
}
