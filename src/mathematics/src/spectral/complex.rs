//! Complex numbers, which here are also vectors of the plane.

use super::elementary::{atan2, ln};
use std::ops::{Add, Mul, Neg, Sub};

/// Complex number, or vector of the plane.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Complex {
    pub re: f64,
    pub im: f64,
}

impl Complex {
    pub(super) const fn new(re: f64, im: f64) -> Self {
        Self { re, im }
    }

    /// e^{i angle}.
    pub(super) fn unit(angle: f64) -> Self {
        let (im, re) = libm::sincos(angle);
        Self { re, im }
    }

    pub(super) fn scaled(self, factor: f64) -> Self {
        Self::new(factor * self.re, factor * self.im)
    }

    pub(super) fn conj(self) -> Self {
        Self::new(self.re, -self.im)
    }

    /// Vector turned to the left by a right angle.
    pub(super) fn turned(self) -> Self {
        Self::new(-self.im, self.re)
    }

    /// Re(conj(self) other), the scalar product.
    pub(super) fn dot(self, other: Self) -> f64 {
        self.re * other.re + self.im * other.im
    }

    /// Im(conj(self) other): positive if `other` points to the left of `self`.
    pub(super) fn cross(self, other: Self) -> f64 {
        self.re * other.im - self.im * other.re
    }

    pub(super) fn coordinates(self) -> [f64; 2] {
        [self.re, self.im]
    }

    pub(super) fn norm2(self) -> f64 {
        self.dot(self)
    }

    pub(super) fn norm(self) -> f64 {
        self.norm2().sqrt()
    }

    /// Principal logarithm; finite at zero.
    #[inline(always)]
    pub(super) fn ln(self) -> Self {
        Self::new(0.5 * ln(self.norm2()), self.arg())
    }

    #[inline(always)]
    pub(super) fn arg(self) -> f64 {
        atan2(self.im, self.re)
    }
}

/// Distance of a point from a segment.
pub(super) fn distance([a, b]: [Complex; 2], point: Complex) -> f64 {
    let along = b - a;
    let t = along.dot(point - a) / along.norm2();
    (a + along.scaled(t.clamp(0.0, 1.0)) - point).norm()
}

impl Add for Complex {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self::new(self.re + other.re, self.im + other.im)
    }
}

impl Sub for Complex {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self::new(self.re - other.re, self.im - other.im)
    }
}

impl Neg for Complex {
    type Output = Self;
    fn neg(self) -> Self {
        Self::new(-self.re, -self.im)
    }
}

impl Mul for Complex {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self::new(self.re * other.re - self.im * other.im, self.re * other.im + self.im * other.re)
    }
}
