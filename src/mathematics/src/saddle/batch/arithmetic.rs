//! Formats of numbers, and ways to round the operations of the iteration.

use super::LANES;
use std::array::from_fn;
use std::ops::{Add, Div, Mul, Sub};

/// A format of floating-point numbers.
pub trait Number:
    Copy
    + PartialOrd
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
{
    /// The nearest number of this format.
    fn of(value: f64) -> Self;
    /// This number in double precision.
    fn wide(self) -> f64;
    /// `x * y + z`, rounded once.
    fn fused(x: Self, y: Self, z: Self) -> Self;
}

impl Number for f64 {
    #[inline(always)]
    fn of(value: f64) -> Self {
        value
    }
    #[inline(always)]
    fn wide(self) -> f64 {
        self
    }
    fn fused(x: Self, y: Self, z: Self) -> Self {
        libm::fma(x, y, z)
    }
}

impl Number for f32 {
    #[inline(always)]
    fn of(value: f64) -> Self {
        value as Self
    }
    #[inline(always)]
    fn wide(self) -> f64 {
        f64::from(self)
    }
    fn fused(x: Self, y: Self, z: Self) -> Self {
        libm::fmaf(x, y, z)
    }
}

/// A number per lane.
#[derive(Clone, Copy)]
#[repr(align(64))]
pub struct V<N>(pub [N; LANES]);

impl<N: Number> Add for V<N> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self(from_fn(|l| self.0[l] + other.0[l]))
    }
}

impl<N: Number> Mul for V<N> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self(from_fn(|l| self.0[l] * other.0[l]))
    }
}

impl<N: Number> Mul<f64> for V<N> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, factor: f64) -> Self {
        self * Self::all(factor)
    }
}

impl<N: Number> Default for V<N> {
    fn default() -> Self {
        Self::all(0.0)
    }
}

impl<N: Number> Sub for V<N> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self(from_fn(|l| self.0[l] - other.0[l]))
    }
}

impl<N: Number> V<N> {
    #[inline(always)]
    pub(super) fn all(value: f64) -> Self {
        Self([N::of(value); LANES])
    }

    /// The absolute values.
    #[inline(always)]
    pub(super) fn abs(self) -> Self {
        let zero = N::of(0.0);
        Self(self.0.map(|value| if value < zero { zero - value } else { value }))
    }

    /// In each lane, the greater of two numbers; the other one where this is NaN.
    #[inline(always)]
    pub(super) fn greatest(self, other: Self) -> Self {
        Self(from_fn(|l| if self.0[l] > other.0[l] { self.0[l] } else { other.0[l] }))
    }

    /// In each lane, the lesser of two numbers; the other one where either is NaN.
    #[inline(always)]
    pub(super) fn least(self, other: Self) -> Self {
        Self(from_fn(|l| if self.0[l] < other.0[l] { self.0[l] } else { other.0[l] }))
    }

    /// The positive ones, zero for the others.
    #[inline(always)]
    pub(super) fn positive(self) -> Self {
        self.greatest(Self::all(0.0))
    }
}

/// The operations of the iteration that an arithmetic may round in its own way, in all lanes at once.
///
/// All others are exact but for one rounding each: the mesh width and the diagonals are powers of two.
pub trait Arithmetic<N: Number> {
    /// `south + north + east + load + west`.
    #[inline(always)]
    fn star(&mut self, [south, north, east, load, west]: [V<N>; 5]) -> V<N> {
        ((south + north) + (east + load)) + west
    }
    /// `along + inward + load`: the neighbours on the edge, already halved, and the one inside.
    #[inline(always)]
    fn edge(&mut self, [along, inward, load]: [V<N>; 3]) -> V<N> {
        along + inward + load
    }
    /// `a - r y`.
    #[inline(always)]
    fn step(&mut self, a: N, r: N, y: N) -> N {
        a - r * y
    }
    /// The new values of a node.
    #[inline(always)]
    fn node(&mut self, y: V<N>) -> V<N> {
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

impl<N: Number> Arithmetic<N> for AsDefined {}

/// All sums from the other end.
#[derive(Clone, Copy, Debug)]
pub struct Reversed;

impl<N: Number> Arithmetic<N> for Reversed {
    #[inline(always)]
    fn star(&mut self, [south, north, east, load, west]: [V<N>; 5]) -> V<N> {
        (((west + load) + east) + north) + south
    }
    #[inline(always)]
    fn edge(&mut self, [along, inward, load]: [V<N>; 3]) -> V<N> {
        load + inward + along
    }
}

/// A product and the sum it enters rounded together, as compilers may.
#[derive(Clone, Copy, Debug)]
pub struct Fused;

impl<N: Number> Arithmetic<N> for Fused {
    #[inline(always)]
    fn step(&mut self, a: N, r: N, y: N) -> N {
        N::fused(N::of(-1.0) * r, y, a)
    }
}
