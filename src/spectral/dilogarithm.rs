//! The dilogarithm in the unit disc.

use super::complex::Complex;
use std::f64::consts::PI;

/// B_{2k} / (2 k + 1)!, k = 1 to 12, B the Bernoulli numbers.
const COEFFICIENTS: [f64; 12] = {
    let bernoulli = [
        1.0 / 6.0,
        -1.0 / 30.0,
        1.0 / 42.0,
        -1.0 / 30.0,
        5.0 / 66.0,
        -691.0 / 2730.0,
        7.0 / 6.0,
        -3617.0 / 510.0,
        43867.0 / 798.0,
        -174_611.0 / 330.0,
        854_513.0 / 138.0,
        -236_364_091.0 / 2730.0,
    ];
    let mut coefficients = [0.0; 12];
    let (mut factorial, mut k) = (1.0, 0);
    while k < 12 {
        let n = 2.0 * (k as f64 + 1.0);
        factorial *= n * (n + 1.0);
        coefficients[k] = bernoulli[k] / factorial;
        k += 1;
    }
    coefficients
};

/// Li2(1 - rest), `|1 - rest| <= 1`, by a series in -log rest, after reflection where that is large.
///
/// What it differs from Li2(1) by is right to rounding of itself.
pub(super) fn dilogarithm(rest: Complex) -> Complex {
    let y = Complex::new(1.0, 0.0) - rest;
    if y.re <= 0.5 {
        return series(-rest.ln());
    }
    let at_one = Complex::new(PI * PI / 6.0, 0.0);
    if rest == Complex::default() {
        return at_one;
    }
    let ln = Complex::new(0.5 * libm::log1p(rest.norm2() - 2.0 * rest.re), y.arg());
    at_one - ln * rest.ln() - series(-ln)
}

/// Li2(1 - exp(-u)).
fn series(u: Complex) -> Complex {
    let square = u * u;
    // Horner's scheme for real coefficients, modulo the polynomial with the roots u^2 and its conjugate.
    let (sum, size) = (2.0 * square.re, square.norm2());
    let [first, rest] = COEFFICIENTS
        .iter()
        .rev()
        .fold([0.0; 2], |[first, rest], &c| [c + sum * first - size * rest, first]);
    let series = Complex::new(first, 0.0) - square.conj().scaled(rest);
    u - square.scaled(0.25) + series * square * u
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_power_series_and_known_values_agree() {
        for y in [Complex::new(0.3, 0.2), Complex::new(-0.4, 0.3), Complex::new(0.55, -0.1)] {
            let (mut sum, mut power) = (Complex::default(), y);
            for k in 1..200 {
                sum = sum + power.scaled(1.0 / f64::from(k * k));
                power = power * y;
            }
            let found = dilogarithm(Complex::new(1.0, 0.0) - y);
            assert!((found - sum).norm() < 1e-15, "{y:?}");
        }
        let at = |re: f64, im: f64| dilogarithm(Complex::new(1.0 - re, -im));
        assert!((at(-1.0, 0.0).re + PI * PI / 12.0).abs() < 1e-15);
        // Catalan's constant.
        assert!((at(0.0, 1.0).im - 0.915_965_594_177_219).abs() < 1e-15);
    }
}
