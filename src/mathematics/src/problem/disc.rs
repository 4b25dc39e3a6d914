//! Problems on the unit disc with known solutions: f = c1 r^k cos(k t) - c0 in polar coordinates r, t.
//!
//! The trace of v and its multiplier on the rim follow from the solution of a Riemann-Hilbert problem: with
//! A = c0 / 2, B = c1 / (4 (k + 1)) and s = cos(k t / 2) in each of k equal sectors. For 2 B <= A all of the rim is in
//! contact; else a part around each of the k maxima of f is free.

use super::complex::Complex;
use std::f64::consts::{FRAC_PI_2, PI};

/// Problem on the unit disc with the whole rim in contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct DiscProblem {
    /// c0 > 0.
    pub c0: f64,
    /// c1 >= 0.
    pub c1: f64,
    /// k >= 1.
    pub k: u32,
}

/// Points of the midpoint rule on the rim, which converges exponentially after the substitution.
const POINTS: u32 = 2000;

impl DiscProblem {
    /// f at a point.
    pub(crate) fn f(&self, [x, y]: [f64; 2]) -> f64 {
        // (x + i y)^k.
        let (mut real, mut imaginary) = (1.0, 0.0);
        for _ in 0..self.k {
            (real, imaginary) = (real * x - imaginary * y, real * y + imaginary * x);
        }
        self.c1 * real - self.c0
    }

    fn coefficients(&self) -> [f64; 2] {
        [0.5 * self.c0, self.c1 / (4.0 * f64::from(self.k + 1))]
    }

    /// Angle k t at which the free part of each sector ends; zero if all of the rim is in contact.
    pub(crate) fn free_angle(&self) -> f64 {
        let [a, b] = self.coefficients();
        if 2.0 * b <= a { 0.0 } else { libm::acos(a / b - 1.0) }
    }

    /// v on the rim at the polar angle t.
    pub(crate) fn rim(&self, t: f64) -> f64 {
        let [_, b] = self.coefficients();
        let alpha = self.free_angle();
        let [s, s0] = [self.sector(t), alpha].map(|angle| libm::cos(0.5 * angle));
        if alpha == 0.0 || s <= s0 {
            return 0.0;
        }
        let grows = s * ((s - s0) * (s + s0)).sqrt() - s0 * s0 * libm::acosh(s / s0);
        4.0 * b / f64::from(self.k) * grows
    }

    /// Multiplier dv/dn on the rim at the polar angle t.
    pub(crate) fn multiplier(&self, t: f64) -> f64 {
        let [a, b] = self.coefficients();
        let (alpha, angle) = (self.free_angle(), self.sector(t));
        if alpha == 0.0 {
            return a - 2.0 * b * libm::cos(angle);
        }
        let root = 2.0 * libm::cos(alpha) - 2.0 * libm::cos(angle);
        2.0 * b * libm::sin(0.5 * angle.abs()) * root.max(0.0).sqrt()
    }

    /// Cosine of [`Self::free_angle`]; none if all of the rim is in contact.
    pub(crate) fn free_cosine(&self) -> Option<f64> {
        let alpha = self.free_angle();
        (alpha != 0.0).then(|| libm::cos(alpha))
    }

    /// Gradient of v at a point, from [`Self::free_cosine`], which is the same at all points.
    ///
    /// With the particular solution `P = c0 r^2 / 4 - B r^(k + 2) cos(k t)`, `z (v_x - i v_y)` on the rim is
    /// `B (1 - 1/s) sqrt(s^2 - 2 s cos(alpha) + 1)`, s = z^k: real in contact, imaginary where the rim is free. Less
    /// the same of P, that is analytic in the disc, and so holds inside for v less P.
    pub(crate) fn gradient(&self, free_cosine: Option<f64>, point: [f64; 2]) -> [f64; 2] {
        let [a, b] = self.coefficients();
        let (k, [x, y]) = (f64::from(self.k), point);
        let z = Complex::new(x, y);
        let before = (1..self.k).fold(Complex::new(1.0, 0.0), |power, _| power * z);
        let s = z * before;
        let harmonic = if let Some(cosine) = free_cosine {
            // The root and the quotient q = (2 cos(alpha) - s) / (1 + root), written such that s divides out.
            let root = (s * s + s.scaled(-2.0 * cosine)).shifted(1.0).sqrt();
            let q = (-s).shifted(2.0 * cosine) / root.shifted(1.0);
            let rest = q.scaled(cosine).shifted(-1.0) / root.shifted(1.0);
            (-q).shifted(k + 1.0) + rest
        } else {
            Complex::new(k, 0.0)
        };
        // Of P.
        let along = z.conj().scaled(a - 2.0 * b * s.re);
        let of_power = before.scaled(-b * k * (x * x + y * y));
        let slope = (harmonic * before).scaled(b) + along + of_power;
        [slope.re, -slope.im]
    }

    /// The angle k t moved to (-pi, pi].
    fn sector(&self, t: f64) -> f64 {
        let turns = f64::from(self.k) * t / (2.0 * PI);
        2.0 * PI * (turns - turns.round())
    }

    /// Energy of the solution.
    pub(crate) fn energy(&self) -> f64 {
        let ([a, b], k) = (self.coefficients(), f64::from(self.k));
        let waves = (1.0 / (2.0 * k + 2.0) - 1.0 / (2.0 * k + 4.0)) / (4.0 * (k + 1.0));
        let full = -0.5 * (PI * self.c0 * self.c0 / 8.0 + PI * self.c1 * self.c1 * waves);
        full + 0.5 * self.over_rim(|angle| a - 2.0 * b * libm::cos(angle))
    }

    /// v at the centre.
    pub(crate) fn centre(&self) -> f64 {
        self.over_rim(|_| 1.0) / (2.0 * PI) - 0.25 * self.c0
    }

    /// Integral over the rim of v times a function of the angle k t.
    fn over_rim(&self, factor: impl Fn(f64) -> f64) -> f64 {
        let alpha = self.free_angle();
        let step = PI / f64::from(POINTS);
        let mut sum = 0.0;
        for point in 0..POINTS {
            // The angle alpha sin(u): v is smooth in u, and even at both ends.
            let u = step * (f64::from(point) + 0.5) - FRAC_PI_2;
            let angle = alpha * libm::sin(u);
            let value = self.rim(angle / f64::from(self.k));
            sum += value * factor(angle) * alpha * libm::cos(u) * step;
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_gradient_belongs_to_f_and_to_the_rim() {
        for problem in [
            DiscProblem { c0: 1.3, c1: 7.0, k: 1 },
            DiscProblem { c0: 1.3, c1: 20.0, k: 3 },
            DiscProblem { c0: 1.0, c1: 1.0, k: 2 },
        ] {
            let (step, free) = (1e-5, problem.free_cosine());
            for t in (0..40).map(|k| 0.05 + 0.157 * f64::from(k)) {
                let (sine, cosine) = libm::sincos(t);
                let along = |d: [f64; 2]| {
                    let [gx, gy] = problem.gradient(free, [cosine, sine]);
                    gx * d[0] + gy * d[1]
                };
                let slope = (problem.rim(t + step) - problem.rim(t - step)) / (2.0 * step);
                let tangential = along([-sine, cosine]);
                assert!((tangential - slope).abs() < 1e-2, "{problem:?} {t}: {tangential} {slope}");
                assert!((along([cosine, sine]) - problem.multiplier(t)).abs() < 1e-6);
                let [x, y] = [0.6 * cosine, 0.6 * sine];
                let [right, left] = [x + step, x - step].map(|x| problem.gradient(free, [x, y]));
                let [above, below] = [y + step, y - step].map(|y| problem.gradient(free, [x, y]));
                let divergence = (right[0] - left[0] + above[1] - below[1]) / (2.0 * step);
                let rotation = (right[1] - left[1] - above[0] + below[0]) / (2.0 * step);
                assert!((divergence + problem.f([x, y])).abs() < 1e-7, "{problem:?} {t}");
                assert!(rotation.abs() < 1e-7, "{problem:?} {t}");
            }
        }
    }

    #[test]
    fn energies_are_those_of_an_independent_computation() {
        for (c1, energy, centre) in [
            (4.0, -0.609_846_369_525_687_9, -0.096_573_590_279_972_65),
            (8.0, -3.510_437_382_293_933_4, 0.556_852_819_440_054_7),
            (0.0, -PI / 16.0, -0.25),
        ] {
            let problem = DiscProblem { c0: 1.0, c1, k: 1 };
            assert!((problem.energy() - energy).abs() < 1e-13, "{}", problem.energy());
            assert!((problem.centre() - centre).abs() < 1e-13, "{}", problem.centre());
        }
    }

    #[test]
    fn the_reactions_balance_f() {
        for problem in
            [DiscProblem { c0: 1.0, c1: 8.0, k: 2 }, DiscProblem { c0: 2.0, c1: 1.0, k: 3 }]
        {
            let points = 1_000_000;
            let step = 2.0 * PI / f64::from(points);
            let angles = (0..points).map(|point| (f64::from(point) + 0.5) * step);
            let force: f64 = angles.map(|t| step * problem.multiplier(t)).sum();
            assert!((force - PI * problem.c0).abs() < 1e-6, "{force}");
        }
    }
}
