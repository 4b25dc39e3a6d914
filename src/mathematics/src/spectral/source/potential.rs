//! A particular solution psi of -Lap psi = f, in closed form and smooth up to the boundary but for its jumps.

use crate::machine::simd::vectorised;
use crate::problem::complex::Complex;
use crate::spectral::complex::{arg, ln};
use crate::spectral::geometry::curve::{Arc, Polar};
use std::f64::consts::{PI, TAU};

/// psi up to a linear function.
///
/// The sum over all jumps J = left f - right f, each along an arc from a to b, of
/// `-(J / 4 pi) Im int conj(w - z) (log|w - z| + 1/2) dw`. Its derivative `psi_x - i psi_y` is
/// `(J / 4 pi i) int conj(w - z) / (w - z) dw` up to constants. With z at
/// `origin + tangent zeta` seen from an arc of length s and curvature k, and `nu = 1 + i k zeta`, the integral is
/// ```text
/// conj(tangent) (s + i (2 Im zeta - k |zeta|^2) log((b - z) / (a - z))) / nu;
/// ```
/// for k = 0 the first term is one of the constants. Nothing cancels where k is small. Inside a circle the logarithm
/// is taken less its value `i k s` at the centre, where nu vanishes.
#[derive(Clone, Default)]
pub(crate) struct Potential {
    /// Ends of jumps.
    pub vertices: Vec<Complex>,
    pub jumps: Vec<Jump>,
    /// Difference of f and the sum of all jumps, a constant.
    pub background: f64,
    /// Sum of the moduli of the jumps whose part in it is rounded.
    pub rounded: f64,
    /// Constant that is subtracted from the gradient.
    pub constant: Complex,
}

/// A jump of f along an arc, whose ends are vertices or at infinity, or that is a whole circle.
#[derive(Clone)]
pub(crate) struct Jump {
    pub arc: Arc,
    /// f on the left less f on the right.
    pub size: f64,
    /// Contribution of ends at infinity to the angle from one end to the other.
    far: f64,
}

impl Potential {
    /// Adds a jump, of the given size.
    pub(crate) fn add(&mut self, arc: Arc, size: f64) {
        let tangent = arc.curve.tangent;
        let far = match arc.ends {
            _ if arc.curve.curvature > 0.0 => 0.0,
            [from, to] => to.map_or(arg(tangent), |_| 0.0) - from.map_or(arg(-tangent), |_| 0.0),
        };
        self.jumps.push(Jump { arc, size, far });
    }

    /// Finds the difference of f and the jumps, from f at some points.
    pub(crate) fn find_background(&mut self, points: &[Complex], f: impl Fn(Complex) -> f64) {
        // The difference is the same at all points but for rounding, and those that are too near to a jump.
        let mut rest: Vec<f64> = points.iter().map(|&z| f(z)).collect();
        self.add_jumps(points, -1.0, &mut rest);
        let mut order: Vec<usize> = (0..points.len()).collect();
        order.sort_by(|&i, &j| rest[i].total_cmp(&rest[j]));
        let middle = order[points.len() / 2];
        self.background = rest[middle];
        let rounded = self.jumps.iter().filter(|jump| !jump.is_circle_beside(points[middle]));
        self.rounded = rounded.map(|jump| jump.size.abs()).sum();
    }

    /// Adds f at points, but for the background, times a sign.
    pub(crate) fn add_jumps(&self, points: &[Complex], sign: f64, sums: &mut [f64]) {
        let (logs, mut ratios) = (self.logs(points), points.to_vec());
        for jump in &self.jumps {
            jump.log_ratios(&logs, &mut ratios);
            for ((sum, &z), &ratio) in sums.iter_mut().zip(points).zip(&ratios) {
                let Polar { power, .. } = jump.arc.curve.polar(z);
                let inside = if power > 0.0 { jump.sweep() } else { 0.0 };
                *sum += sign * (jump.size / TAU * (jump.logarithm(ratio, power).im + inside));
            }
        }
    }

    /// Gradients of psi at points: the central function of this file.
    pub(crate) fn gradients(&self, points: &[Complex]) -> Vec<Complex> {
        vectorised(
            #[inline(always)]
            || {
                let mut sums: Vec<Complex> = points
                    .iter()
                    .map(|&z| z.scaled(-0.5 * self.background) - self.constant)
                    .collect();
                let (logs, mut ratios) = (self.logs(points), points.to_vec());
                for jump in &self.jumps {
                    jump.log_ratios(&logs, &mut ratios);
                    jump.add_gradients(points, &ratios, &mut sums);
                }
                sums
            },
        )
    }

    /// log(v - z) for the vertices v and the points z, vertex by vertex.
    #[inline(always)]
    pub(crate) fn logs(&self, points: &[Complex]) -> Vec<Complex> {
        let mut logs = vec![Complex::default(); points.len() * self.vertices.len()];
        for (logs, &v) in logs.chunks_exact_mut(points.len()).zip(&self.vertices) {
            // At a vertex, where it is finite here, the factors of the logarithm vanish.
            for (log, &z) in logs.iter_mut().zip(points) {
                *log = ln(v - z);
            }
        }
        logs
    }
}

impl Jump {
    /// True if it is all of a circle that does not hold the point, and no part of f there.
    fn is_circle_beside(&self, z: Complex) -> bool {
        let Arc { curve, ends, .. } = self.arc;
        curve.curvature > 0.0 && ends == [None; 2] && curve.distance(z) > 0.0
    }

    /// Angle by which the tangent turns.
    fn sweep(&self) -> f64 {
        self.arc.curve.curvature * (self.arc.span[1] - self.arc.span[0])
    }

    /// log(b - z) - log(a - z) for the ends a and b and the points z.
    #[inline(always)]
    pub(crate) fn log_ratios(&self, logs: &[Complex], ratios: &mut [Complex]) {
        let many = ratios.len();
        ratios.fill(Complex::new(0.0, self.far));
        for (end, sign) in self.arc.ends.into_iter().zip([-1.0, 1.0]) {
            let Some(v) = end else { continue };
            for (ratio, log) in ratios.iter_mut().zip(&logs[v * many..]) {
                *ratio = *ratio + log.scaled(sign);
            }
        }
    }

    /// log((b - z) / (a - z)), less i times the sweep on the left of the curve, from a value of this logarithm that may
    /// be off by whole turns.
    #[inline(always)]
    pub(crate) fn logarithm(&self, Complex { re, im }: Complex, power: f64) -> Complex {
        let sweep = self.sweep();
        let half = 0.5 * (PI - sweep);
        // No more than a quarter of a turn from the middle of what it can be on this side.
        let (angle, middle) = if power > 0.0 { (im - sweep, half) } else { (im, -half) };
        Complex::new(re, angle - TAU * ((angle - middle) / TAU + 0.5).floor())
    }

    #[inline(always)]
    fn add_gradients(&self, points: &[Complex], ratios: &[Complex], sums: &mut [Complex]) {
        /// Square of the distance from the centre, in radii, below which the logarithm is a difference of near numbers.
        const NEAR: f64 = 1e-4;
        let (Arc { curve, span, .. }, factor) = (self.arc, self.size / (2.0 * TAU));
        for ((sum, &z), &ratio) in sums.iter_mut().zip(points).zip(ratios) {
            let Polar { nu, power } = curve.polar(z);
            let square = nu.norm2();
            let inverse = if square < NEAR { 0.0 } else { power / square };
            let quotient = (self.logarithm(ratio, power) * nu.conj()).scaled(inverse);
            let rest = nu.turned().scaled((span[1] - span[0]) / square.max(1.0));
            *sum = *sum + curve.tangent * (rest + quotient.conj()).scaled(factor);
        }
        if curve.curvature > 0.0 {
            for (sum, &z) in sums.iter_mut().zip(points) {
                let Polar { nu, power } = curve.polar(z);
                if nu.norm2() < NEAR {
                    let quotient = self.quotient_near_centre(nu);
                    *sum = *sum + curve.tangent * quotient.conj().scaled(factor * power);
                }
            }
        }
    }

    /// (log(1 - nu/b) - log(1 - nu/a)) / nu, with nu of the ends in the place of b and a.
    fn quotient_near_centre(&self, nu: Complex) -> Complex {
        let [a, b] = self.arc.span.map(|s| Complex::unit(-self.arc.curve.curvature * s));
        let (mut sum, mut pa, mut pb) = (Complex::default(), a, b);
        for k in 1..=9 {
            sum = sum + (pa - pb).scaled(1.0 / f64::from(k));
            (pa, pb) = (pa * a * nu, pb * b * nu);
        }
        sum
    }
}
