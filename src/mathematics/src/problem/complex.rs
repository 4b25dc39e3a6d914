//! Complex numbers, which here are also vectors of the plane.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// Complex number, or vector of the plane.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Complex {
    /// Real part, or first coordinate.
    pub(crate) re: f64,
    /// Imaginary part, or second coordinate.
    pub(crate) im: f64,
}

impl Complex {
    #[inline(always)]
    pub(crate) const fn new(re: f64, im: f64) -> Self {
        Self { re, im }
    }

    /// e^{i angle}.
    pub(crate) fn unit(angle: f64) -> Self {
        let (im, re) = libm::sincos(angle);
        Self { re, im }
    }

    #[inline(always)]
    pub(crate) fn scaled(self, factor: f64) -> Self {
        Self::new(factor * self.re, factor * self.im)
    }

    /// Sum with a real number.
    #[inline(always)]
    pub(crate) fn shifted(self, by: f64) -> Self {
        Self::new(self.re + by, self.im)
    }

    #[inline(always)]
    pub(crate) fn conj(self) -> Self {
        Self::new(self.re, -self.im)
    }

    /// Vector turned to the left by a right angle.
    #[inline(always)]
    pub(crate) fn turned(self) -> Self {
        Self::new(-self.im, self.re)
    }

    /// Re(conj(self) other), the scalar product.
    #[inline(always)]
    pub(crate) fn dot(self, other: Self) -> f64 {
        self.re * other.re + self.im * other.im
    }

    /// Im(conj(self) other): positive if `other` points to the left of `self`.
    #[inline(always)]
    pub(crate) fn cross(self, other: Self) -> f64 {
        self.re * other.im - self.im * other.re
    }

    #[inline(always)]
    pub(crate) fn coordinates(self) -> [f64; 2] {
        [self.re, self.im]
    }

    #[inline(always)]
    pub(crate) fn norm2(self) -> f64 {
        self.dot(self)
    }

    #[inline(always)]
    pub(crate) fn norm(self) -> f64 {
        self.norm2().sqrt()
    }

    #[inline(always)]
    pub(crate) fn cubed(self) -> Self {
        self * self * self
    }

    /// Principal root: its real part is not negative, and its imaginary part has the sign of that of the number.
    ///
    /// Neither part is a difference of nearly equal numbers.
    #[inline(always)]
    pub(crate) fn sqrt(self) -> Self {
        let large = (0.5 * (self.norm() + self.re.abs())).sqrt();
        let small = if large == 0.0 { self.im } else { 0.5 * self.im / large };
        match (self.re >= 0.0, self.im.is_sign_negative()) {
            (true, _) => Self::new(large, small),
            (false, false) => Self::new(small, large),
            (false, true) => Self::new(-small, -large),
        }
    }
}

impl Add for Complex {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self::new(self.re + other.re, self.im + other.im)
    }
}

impl Sub for Complex {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self::new(self.re - other.re, self.im - other.im)
    }
}

impl Neg for Complex {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self::new(-self.re, -self.im)
    }
}

impl Mul for Complex {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self::new(self.re * other.re - self.im * other.im, self.re * other.im + self.im * other.re)
    }
}

impl Div for Complex {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        (self * other.conj()).scaled(1.0 / other.norm2())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn roots_square_to_the_number_and_lie_to_the_right() {
        for re in [-2.0, -1e-9, 0.0, 1e-9, 3.0] {
            for im in [-2.0, -1e-12, -0.0, 0.0, 1e-12, 3.0] {
                let z = Complex::new(re, im);
                let root = z.sqrt();
                assert!((root * root - z).norm() <= 4e-16 * z.norm(), "{z:?} {root:?}");
                assert!(root.re >= 0.0, "{z:?} {root:?}");
                assert_eq!(root.im.is_sign_negative(), im.is_sign_negative(), "{z:?} {root:?}");
            }
        }
    }

    #[test]
    fn division_undoes_multiplication() {
        let [a, b] = [Complex::new(0.3, -1.7), Complex::new(-2.5, 0.125)];
        assert!((a * b / b - a).norm() < 1e-15);
    }
}
