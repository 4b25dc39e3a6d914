//! Conformal map of the square onto the unit disc, on the boundary relative to the corners.
//!
//! `Phi(z) = e^{-i pi/4} sl(K e^{i pi/4} z)` with the lemniscatic sine; Jacobi's functions have the
//! parameter 1/2 throughout. The angle grows like the square of the distance from a corner, so that
//! points near one are known by that distance.

use super::elementary::sincos_pi;
use crate::problem::complex::Complex;
use std::f64::consts::{FRAC_1_SQRT_2, PI};

/// Complete elliptic integral of the parameter 1/2, a quarter of the period.
pub(super) const K: f64 = 1.854_074_677_301_371_9;
/// e^{-pi}, the nome.
const NOME: f64 = 0.043_213_918_263_772_26;
/// 2^{1/4} 2 e^{-pi/4}.
const SN_FACTOR: f64 = 1.084_409_731_080_684_8;
/// 2 e^{-pi/4}.
const CN_FACTOR: f64 = 0.911_876_255_531_992_5;
/// 2^{-1/4}.
const DN_FACTOR: f64 = 0.840_896_415_253_714_5;

/// sn, cn and dn of 2 K t, by theta series to rounding.
#[inline(always)]
pub(super) fn jacobi(t: f64) -> [f64; 3] {
    let [sin, cos] = sincos_pi(t);
    let x = 1.0 - 2.0 * sin * sin;
    const Q2: f64 = NOME * NOME;
    const Q4: f64 = Q2 * Q2;
    const Q6: f64 = Q4 * Q2;
    const Q9: f64 = Q4 * Q4 * NOME;
    const Q12: f64 = Q6 * Q6;
    let even = 4.0 * x * x - 1.0;
    let cubic = 8.0 * x * x * x - 4.0 * x;
    let t1 = sin * (1.0 - Q2 * (1.0 + 2.0 * x) + Q6 * (even + 2.0 * x) - Q12 * (cubic + even));
    let t2 = cos * (1.0 + Q2 * (2.0 * x - 1.0) + Q6 * (even - 2.0 * x) + Q12 * (cubic - even));
    let (c4, c6) = (2.0 * x * x - 1.0, (4.0 * x * x - 3.0) * x);
    let (plus, odd) = (1.0 + 2.0 * Q4 * c4, 2.0 * NOME * x + 2.0 * Q9 * c6);
    let inverse = 1.0 / (plus - odd);
    [SN_FACTOR * t1 * inverse, CN_FACTOR * t2 * inverse, DN_FACTOR * (plus + odd) * inverse]
}

/// Point of the boundary seen from a corner: sine and cosine of half the angle between them on the
/// circle, and the derivative of the angle along the boundary.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Angle {
    pub sin: f64,
    pub cos: f64,
    pub slope: f64,
}

impl Angle {
    /// Takes the distance `t` from the corner along the boundary, negative before the corner, at most 1.
    #[inline(always)]
    pub(super) fn from_corner(t: f64) -> Self {
        let [sn, cn, dn] = jacobi(t.abs());
        // 1 + cn and 1 - cn without cancellation.
        let large = 1.0 + cn.abs();
        let small = sn * sn / large;
        let (plus, minus) = if cn > 0.0 { (large, small) } else { (small, large) };
        let cosine = plus / (2.0 * dn);
        let cos = (0.5 * (1.0 + cosine)).sqrt();
        let sin = minus.copysign(t) / (4.0 * dn * cos);
        Self { sin, cos, slope: K * sn / dn }
    }

    /// Sine and cosine of half the angle relative to the corner that lies `corners` further back.
    #[inline(always)]
    pub(super) fn seen_from(self, corners: i32) -> [f64; 2] {
        let [c, s] = eighth_turns(corners);
        [self.sin * c + self.cos * s, self.cos * c - self.sin * s]
    }
}

/// Cosine and sine of `k pi / 4`.
#[inline(always)]
pub(super) fn eighth_turns(k: i32) -> [f64; 2] {
    const R: f64 = FRAC_1_SQRT_2;
    [[1.0, 0.0], [R, R], [0.0, 1.0], [-R, R], [-1.0, 0.0], [-R, -R], [0.0, -1.0], [R, -R]]
        [k.rem_euclid(8) as usize]
}

/// Sine of half the angle between two points of one side, `t` and `t - distance` from the same corner, to
/// full relative accuracy for distances up to a half.
#[inline(always)]
pub(super) fn half_sine(t: f64, distance: f64) -> f64 {
    let [sn, _, dn] = jacobi(0.5 * distance);
    let [s, c, d] = jacobi((t - 0.5 * distance).abs());
    let ratio = c / d;
    let sine = sn * dn * s / d / (1.0 - 0.5 * (ratio * sn) * (ratio * sn));
    let cosine = (1.0 - sine * sine).sqrt();
    // Points of one side are less than a right angle apart.
    sine / (2.0 * (1.0 + cosine)).sqrt()
}

/// Phi(z).
pub(super) fn to_disc(z: Complex) -> Complex {
    let [s, c, d] = jacobi(0.5 * (z.re - z.im));
    let [s1, c1, d1] = jacobi(0.5 * (z.re + z.im));
    let sn = Complex::new(s * d1, c * d * s1 * c1);
    let dn = Complex::new(d * c1 * d1, -0.5 * s * c * s1);
    let sl = (sn * dn.conj()).scaled(FRAC_1_SQRT_2 / dn.norm2());
    sl * Complex::new(FRAC_1_SQRT_2, -FRAC_1_SQRT_2)
}

/// Angle of a corner, counted anticlockwise from the lower right one.
pub(super) fn corner_angle(corner: i32) -> f64 {
    (0.5 * f64::from(corner) - 0.25) * PI
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn jacobi_functions_have_their_known_values_and_squares() {
        let [sn, cn, dn] = jacobi(0.5);
        assert!((sn - 1.0).abs() < 1e-15 && cn.abs() < 1e-15, "{sn} {cn}");
        assert!((dn - FRAC_1_SQRT_2).abs() < 1e-15, "{dn}");
        for k in 0..100 {
            let [sn, cn, dn] = jacobi(0.013 * f64::from(k));
            assert!((sn * sn + cn * cn - 1.0).abs() < 1e-15);
            assert!((dn * dn + 0.5 * sn * sn - 1.0).abs() < 1e-15);
        }
    }

    #[test]
    fn the_border_goes_to_the_circle_and_half_sines_are_differences() {
        for k in 1..20 {
            let t = 0.05 * f64::from(k);
            let angle = Angle::from_corner(t);
            let theta = corner_angle(0) + 2.0 * libm::atan2(angle.sin, angle.cos);
            let image = to_disc(Complex::new(0.5, t - 0.5));
            assert!((image.re - libm::cos(theta)).abs() < 1e-15, "{t}");
            assert!((image.im - libm::sin(theta)).abs() < 1e-15, "{t}");
            for t2 in [0.01, 0.3, 0.9].into_iter().filter(|t2| (t - t2).abs() < 0.5) {
                let other = Angle::from_corner(t2);
                let sine = angle.sin * other.cos - angle.cos * other.sin;
                assert!((half_sine(t, t - t2) - sine).abs() < 4e-15, "{t} {t2}");
                assert!((half_sine(-t, t2 - t) + sine).abs() < 4e-15, "{t} {t2}");
            }
        }
        let small = half_sine(1e-9, 5e-10);
        assert!((small / (K * K * 0.375e-18) - 1.0).abs() < 1e-12, "{small}");
    }
}
