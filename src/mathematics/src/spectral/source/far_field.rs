//! psi of a small closed shape seen from outside of it, where the terms of its sides would cancel.
//!
//! With f of the shape alone, psi is `-(1 / 2 pi) int f (log|z - w| + 1)` over it. Of a rectangle that is the sum of
//! ten segments with charges, the nodes of a Gauss rule across it, to 2^-60 of it outside, two widths away from its
//! shorter sides. Of other shapes, with moments `M_k = int f w^k`, it is
//! ```text
//! -(1 / 2 pi) (M_0 (log|z| + 1) - Re sum M_k / (k z^k)),
//! ```
//! to 3^-35 of it from three radii on; of a disc that is M_0 alone.

use super::quadratic::Extent;
use crate::problem::complex::Complex;
use crate::spectral::complex::ln;
use crate::spectral::geometry::panels::{GaussNode, gauss};
use crate::spectral::source::potential::{Jump, Potential};
use crate::spectral::source::psi_sizes::PsiSizes;
use std::f64::consts::{PI, TAU};

/// psi outside of a shape, all seen from the middle of its box.
#[derive(Clone, Debug)]
pub(crate) struct FarField {
    pub extent: Extent,
    /// Bound of the integral of |f|, f being that of the shape alone.
    pub mass: f64,
    /// Distance from the box from which on psi is found so.
    clear: f64,
    charges: Charges,
}

#[derive(Clone, Debug)]
enum Charges {
    /// The integral of f across a rectangle, along its middle.
    Segments(f64),
    /// Moments.
    Moments(Vec<Complex>),
}

impl FarField {
    /// psi of jumps that are closed, in a box.
    pub(crate) fn new(potential: &Potential, extent: Extent) -> Self {
        let ([long, across], curve) = (extent.half, potential.jumps[0].arc.curve);
        let f = potential.jumps[0].size;
        match &potential.jumps[..] {
            [_] => {
                let radius = 1.0 / curve.curvature;
                let mass = f * PI * radius * radius;
                let charges = Charges::Moments(vec![Complex::new(mass, 0.0)]);
                Self { extent, mass: mass.abs(), clear: 0.5 * radius, charges }
            }
            all @ [_, _, _, _] if all.iter().all(|jump| is_side(jump, extent.axis)) => {
                let is_left = curve.local(extent.centre).im > 0.0;
                let charges = Charges::Segments(if is_left { f } else { -f } * 2.0 * across);
                Self { extent, mass: 4.0 * f.abs() * long * across, clear: 4.0 * across, charges }
            }
            all => {
                let size: f64 = all.iter().map(|jump| jump.size.abs()).sum();
                let charges = Charges::Moments(moments(potential, 34));
                let clear = 3.0 * (long + across);
                Self { extent, mass: 4.0 * size * long * across, clear, charges }
            }
        }
    }

    /// Distance of a point from all of a shape, or from the shorter sides of a rectangle, beside which psi has no
    /// other singular points.
    fn away(&self, z: Complex) -> f64 {
        let Extent { half: [long, across], .. } = self.extent;
        match self.charges {
            Charges::Moments(_) => self.extent.distance(z),
            Charges::Segments(_) => {
                let [x, y] = self.extent.local(z).map(f64::abs);
                let beyond = (y - across).max(0.0);
                ((x - long) * (x - long) + beyond * beyond).sqrt()
            }
        }
    }

    /// True if psi is found so at a point.
    pub(crate) fn holds(&self, z: Complex) -> bool {
        let is_out = match self.charges {
            Charges::Moments(_) => true,
            Charges::Segments(_) => {
                let [x, y] = self.extent.local(z).map(f64::abs);
                x > self.extent.half[0] || y >= self.extent.half[1] * (1.0 - 4.0 * f64::EPSILON)
            }
        };
        is_out && self.away(z) > self.clear
    }

    /// psi with its gradient.
    pub(crate) fn at(&self, z: Complex) -> (f64, Complex) {
        match &self.charges {
            Charges::Segments(density) => {
                let Extent { centre, axis, half: [half, across] } = self.extent;
                let seen = axis.conj() * (z - centre);
                let (mut value, mut slope) = (0.0, Complex::default());
                for &GaussNode { x, weight } in gauss(10) {
                    let charge = -weight * density / TAU;
                    let [own, rate] =
                        segment(seen - Complex::new(0.0, across * (2.0 * x - 1.0)), half);
                    value += charge * own.re;
                    slope = slope + rate.scaled(charge);
                }
                (value, axis * slope.conj())
            }
            Charges::Moments(moments) => {
                let inverse = Complex::new(1.0, 0.0) / z;
                let mut power = inverse;
                let mut value = moments[0].re * (ln(z).re + 1.0);
                let mut slope = moments[0] * inverse;
                for (k, &moment) in moments.iter().enumerate().skip(1) {
                    value -= (moment * power).re / k as f64;
                    power = power * inverse;
                    slope = slope + moment * power;
                }
                (-value / TAU, slope.conj().scaled(-1.0 / TAU))
            }
        }
    }

    /// Bounds of the moduli of all terms at a point where psi is found so.
    pub(crate) fn sizes(&self, z: Complex) -> PsiSizes {
        let (least, half) = (self.away(z), self.extent.half[0]);
        let most = z.norm() + 2.0 * half;
        let log = libm::log(least).abs().max(libm::log(most).abs());
        let size = self.mass / TAU;
        // Of the logarithm that a segment has, over its length.
        let part = if least > 2.0 * half { 2.0 / least } else { (2.0 * log + PI) / (2.0 * half) };
        PsiSizes {
            value: size * (2.0 + log + most * part),
            slope: size * part,
            bend: size * part / least,
        }
    }
}

/// True if a jump is straight, and parallel or perpendicular to an axis.
fn is_side(Jump { arc, .. }: &Jump, axis: Complex) -> bool {
    let turned = axis.conj() * arc.curve.tangent;
    arc.curve.curvature == 0.0 && (turned.re == 0.0 || turned.im == 0.0)
}

/// Integral of `log(z - t)` and its derivative over t from `-half` to `half`, plus the length.
fn segment(z: Complex, half: f64) -> [Complex; 2] {
    let [to, from] = [half, -half].map(|t| z.shifted(t));
    let ratio = Complex::new(2.0 * half, 0.0) / from;
    let [above, below] = [to, from].map(ln);
    // log(1 + ratio), without cancellation where it is small.
    let log = match ratio.norm2() < 0.25 {
        true => Complex::new(
            0.5 * libm::log1p(2.0 * ratio.re + ratio.norm2()),
            libm::atan2(ratio.im, 1.0 + ratio.re),
        ),
        false => above - below,
    };
    [z * log + (above + below).scaled(half), log]
}

/// Integrals of f times the powers up to the `most`-th, by those of `conj(w) w^k / 2i` along the jumps.
fn moments(potential: &Potential, most: usize) -> Vec<Complex> {
    /// Parts of an arc, so that a Gauss rule has all digits.
    const PARTS: usize = 8;
    let rule = gauss(24);
    let mut moments = vec![Complex::default(); most + 1];
    for jump in &potential.jumps {
        let [from, to] = jump.arc.span;
        let step = (to - from) / PARTS as f64;
        for part in 0..PARTS {
            for node in rule {
                let s = from + step * (part as f64 + node.x);
                let (w, way) = (jump.arc.curve.at(s), jump.arc.curve.direction(s));
                let mut term = w.conj() * way.scaled(0.5 * jump.size * step * node.weight);
                for moment in &mut moments {
                    // Divided by i.
                    *moment = *moment + Complex::new(term.im, -term.re);
                    term = term * w;
                }
            }
        }
    }
    moments
}
