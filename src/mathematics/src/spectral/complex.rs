//! Functions of complex numbers that loops take from [`elementary`], and a distance in the plane.

use crate::problem::complex::Complex;
use crate::spectral::elementary;

/// Principal logarithm; finite at zero.
#[inline(always)]
pub(crate) fn ln(z: Complex) -> Complex {
    Complex::new(0.5 * elementary::ln(z.norm2()), arg(z))
}

/// Angle from the first axis, in (-pi, pi].
#[inline(always)]
pub(crate) fn arg(z: Complex) -> f64 {
    elementary::atan2(z.im, z.re)
}

/// Distance of a point from a segment.
pub(crate) fn distance([a, b]: [Complex; 2], point: Complex) -> f64 {
    let along = b - a;
    let t = along.dot(point - a) / along.norm2();
    (a + along.scaled(t.clamp(0.0, 1.0)) - point).norm()
}
