//! Problems on the unit disc with known solutions: f = c1 r^k cos(k t) - c0 in polar coordinates r, t.
//!
//! The trace of v and its multiplier on the rim follow from the solution of a Riemann-Hilbert problem: with
//! A = c0 / 2, B = c1 / (4 (k + 1)) and s = cos(k t / 2) in each of k equal sectors. For 2 B <= A all of the rim is in
//! contact; else a part around each of the k maxima of f is free.

use std::f64::consts::{FRAC_PI_2, PI};

/// Problem on the unit disc with the whole rim in contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DiscProblem {
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
    pub fn f(&self, [x, y]: [f64; 2]) -> f64 {
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
    pub fn free_angle(&self) -> f64 {
        let [a, b] = self.coefficients();
        if 2.0 * b <= a { 0.0 } else { libm::acos(a / b - 1.0) }
    }

    /// v on the rim at the polar angle t.
    pub fn rim(&self, t: f64) -> f64 {
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
    pub fn multiplier(&self, t: f64) -> f64 {
        let [a, b] = self.coefficients();
        let (alpha, angle) = (self.free_angle(), self.sector(t));
        if alpha == 0.0 {
            return a - 2.0 * b * libm::cos(angle);
        }
        let root = 2.0 * libm::cos(alpha) - 2.0 * libm::cos(angle);
        2.0 * b * libm::sin(0.5 * angle.abs()) * root.max(0.0).sqrt()
    }

    /// The angle k t moved to (-pi, pi].
    fn sector(&self, t: f64) -> f64 {
        let turns = f64::from(self.k) * t / (2.0 * PI);
        2.0 * PI * (turns - turns.round())
    }

    /// Energy of the solution.
    pub fn energy(&self) -> f64 {
        let ([a, b], k) = (self.coefficients(), f64::from(self.k));
        let waves = (1.0 / (2.0 * k + 2.0) - 1.0 / (2.0 * k + 4.0)) / (4.0 * (k + 1.0));
        let full = -0.5 * (PI * self.c0 * self.c0 / 8.0 + PI * self.c1 * self.c1 * waves);
        full + 0.5 * self.over_rim(|angle| a - 2.0 * b * libm::cos(angle))
    }

    /// v at the centre.
    pub fn centre(&self) -> f64 {
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
