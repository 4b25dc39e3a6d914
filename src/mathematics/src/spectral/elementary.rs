//! Elementary functions without branches, so that loops over them vectorise; to two units in the last place.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, LN_2, PI, SQRT_2};

/// Coefficients of powers of `-x^2`, of sine over x for `shift` 1 and of cosine for -1: one over factorials.
const fn inverse_factorials(shift: f64) -> [f64; 9] {
    let mut series = [1.0; 9];
    let mut k = 1;
    while k < 9 {
        let n = 2.0 * k as f64;
        series[k] = series[k - 1] / (n * (n + shift));
        k += 1;
    }
    series
}

/// The polynomial with the given coefficients, that of degree zero first. Closures of iterators would not
/// always be inlined where a loop over this is to vectorise.
#[inline(always)]
fn polynomial<const TERMS: usize>(coefficients: &[f64; TERMS], x: f64) -> f64 {
    let mut sum = 0.0;
    let mut k = TERMS;
    while k > 0 {
        k -= 1;
        sum = sum * x + coefficients[k];
    }
    sum
}

/// Sine and cosine of `pi t`.
#[inline(always)]
pub(crate) fn sincos_pi(t: f64) -> [f64; 2] {
    const SINE: [f64; 9] = inverse_factorials(1.0);
    const COSINE: [f64; 9] = inverse_factorials(-1.0);
    let quarters = (2.0 * t + 0.5).floor();
    let half = 0.5 * quarters;
    let x = PI * (t - half);
    let square = -x * x;
    let (sine, cosine) = (x * polynomial(&SINE, square), polynomial(&COSINE, square));
    let turned = half != half.floor();
    let (s, c) = if turned { (cosine, sine) } else { (sine, cosine) };
    // Both change their sign with each half turn, the cosine a quarter earlier.
    [half_turn_sign(half) * s, half_turn_sign(half + 0.5) * c]
}

/// 1 if the number of whole half turns is even, else -1.
#[inline(always)]
fn half_turn_sign(half_turns: f64) -> f64 {
    1.0 - 2.0 * (half_turns.floor() - 2.0 * (0.5 * half_turns).floor())
}

/// Exponent of one, as it is written.
const BIAS: u64 = 1023;
/// From here to twice this the last bits of a number are those of a whole one: conversions that vectorise.
const WHOLE: f64 = (1_u64 << 52) as f64;

/// The natural logarithm of a normal number; finite at zero.
#[inline(always)]
pub(crate) fn ln(x: f64) -> f64 {
    // Of (log((1 + s) / (1 - s)) - 2 s) / s^3, as in fdlibm.
    const SERIES: [f64; 7] = [
        0.666_666_666_666_673_5,
        0.399_999_999_994_094_2,
        0.285_714_287_436_623_9,
        0.222_221_984_321_497_84,
        0.181_835_721_616_180_5,
        0.153_138_376_992_093_73,
        0.147_981_986_051_165_86,
    ];
    const ROOT_HALF: u64 = (0.5 * SQRT_2).to_bits();
    let bits = x.to_bits();
    let biased = bits.wrapping_sub(ROOT_HALF).wrapping_add(BIAS << 52) >> 52;
    let f = f64::from_bits(bits.wrapping_sub(biased.wrapping_sub(BIAS) << 52)) - 1.0;
    let s = f / (2.0 + f);
    let square = s * s;
    let sum = polynomial(&SERIES, square);
    let half = 0.5 * f * f;
    let exponent = f64::from_bits(WHOLE.to_bits() | biased) - (WHOLE + BIAS as f64);
    exponent * LN_2 + (f - (half - s * (half + sum * square)))
}

/// The exponential of a number between -700 and 700.
#[inline(always)]
pub(crate) fn exp(x: f64) -> f64 {
    /// One over factorials.
    const SERIES: [f64; 14] = {
        let (mut series, mut k) = ([1.0; 14], 1);
        while k < 14 {
            series[k] = series[k - 1] / k as f64;
            k += 1;
        }
        series
    };
    /// ln 2 in two parts, the first with few digits.
    const LN_2_HIGH: f64 = 0.693_147_180_369_123_8;
    const LN_2_LOW: f64 = 1.908_214_929_270_587_7e-10;
    let turns = (x / LN_2 + 0.5).floor();
    let rest = (x - turns * LN_2_HIGH) - turns * LN_2_LOW;
    let power = f64::from_bits((turns + (1.5 * WHOLE + BIAS as f64)).to_bits() << 52);
    polynomial(&SERIES, rest) * power
}

/// Angle of the vector `(x, y)`, 0 if the vector is zero.
#[inline(always)]
pub(crate) fn atan2(y: f64, x: f64) -> f64 {
    // Of (t - atan(t)) / t^3 for |t| < 7 / 16, as in fdlibm.
    const SERIES: [f64; 11] = [
        0.333_333_333_333_329_3,
        -0.199_999_999_998_764_83,
        0.142_857_142_725_034_66,
        -0.111_111_104_054_623_56,
        0.090_908_871_334_365_07,
        -0.076_918_762_050_448_3,
        0.066_610_731_373_875_31,
        -0.058_335_701_337_905_735,
        0.049_768_779_946_159_324,
        -0.036_531_572_744_216_916,
        0.016_285_820_115_365_782,
    ];
    let (across, along) = (y.abs(), x.abs());
    let steep = across > along;
    let (small, large) = if steep { (along, across) } else { (across, along) };
    // Above tan(pi / 8) the angle to the diagonal is the smaller one.
    let turned = small > (SQRT_2 - 1.0) * large;
    let (top, bottom) = if turned { (small - large, small + large) } else { (small, large) };
    let t = top / if bottom > 0.0 { bottom } else { 1.0 };
    let square = t * t;
    let sum = polynomial(&SERIES, square);
    let mut angle = t - t * square * sum;
    angle = if turned { FRAC_PI_4 + angle } else { angle };
    angle = if steep { FRAC_PI_2 - angle } else { angle };
    angle = if x < 0.0 { PI - angle } else { angle };
    angle.copysign(y)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn they_agree_with_those_of_libm() {
        for k in -3000..3000 {
            let t = 0.000_731 * f64::from(k);
            let [sin, cos] = sincos_pi(t);
            let known = libm::sincos(PI * t);
            assert!((sin - known.0).abs() < 1e-15 && (cos - known.1).abs() < 1e-15, "{t}");
            let x = libm::exp(20.0 * t);
            assert!((exp(20.0 * t) / x - 1.0).abs() < 5e-16, "{t}");
            assert!((ln(x) - 20.0 * t).abs() < 1e-15 * (1.0 + 40.0 * t.abs()), "{x}");
            assert!((ln(1.0 + 1e-3 * t) - libm::log1p(1e-3 * t)).abs() < 3e-16, "{t}");
            for radius in [1e-9, 1.0, 30.0] {
                let (y, x) = (radius * sin, radius * cos);
                assert!((atan2(y, x) - libm::atan2(y, x)).abs() < 1e-15, "{t}");
            }
        }
        let [sin, _] = sincos_pi(1e-9);
        assert!((sin / (PI * 1e-9) - 1.0).abs() < 4e-16);
        assert_eq!([atan2(0.0, 0.0), atan2(0.0, -1.0), atan2(-0.0, -1.0)], [0.0, PI, -PI]);
        assert!(ln(0.0).is_finite());
    }
}
