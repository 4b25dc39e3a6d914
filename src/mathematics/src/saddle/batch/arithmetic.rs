//! Numbers of all lanes, and the operations of the iteration that may be rounded in other ways.

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

/// Operations of the iteration, in all lanes at once, that an arithmetic may round in its own way; the defaults are those
/// of [`Plain`](crate::saddle::Plain).
///
/// All other operations are exact but for one rounding each: the mesh width and the diagonals are powers of two.
pub trait Arithmetic {
    /// `load + east + north + south + west`.
    #[inline(always)]
    fn star(&mut self, [load, east, north, south, west]: [V; 5]) -> V {
        (((load + east) + north) + south) + west
    }
    /// `load + first + second + third`: the neighbours of a boundary node times their weights.
    #[inline(always)]
    fn edge(&mut self, [load, first, second, third]: [V; 4]) -> V {
        ((load + first) + second) + third
    }
    /// `a - r y`.
    #[inline(always)]
    fn step(&mut self, a: f64, r: f64, y: f64) -> f64 {
        a - r * y
    }
    /// The new values of a node.
    #[inline(always)]
    fn node(&mut self, y: V) -> V {
        y
    }
    /// A run enters a lane.
    fn enter(&mut self, _lane: usize, _run: usize) {}
    /// It leaves it again.
    fn leave(&mut self, _lane: usize, _run: usize) {}
}

/// Every operation as [`Plain`](crate::saddle::Plain) defines it.
#[derive(Clone, Copy, Debug)]
pub struct AsDefined;

impl Arithmetic for AsDefined {}
