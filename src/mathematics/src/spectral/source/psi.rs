//! The particular solution psi itself, in closed form, with the same constants as its gradient.
//!
//! With z seen from a jump J along an arc from a to b, psi is the sum of
//! `-(J / 4 pi) Im int conj(w - z) (log|w - z| + 1/2) dw`: logarithms for a segment, the dilogarithm for an arc. A
//! polynomial f, the real part of a sum of `c z^j conj(z)^k`, has
//! `psi = -Re sum c z^(j+1) conj(z)^(k+1) / (4 (j + 1) (k + 1))`.

use super::far_field::FarField;
use super::polynomial::Polynomial;
use crate::problem::complex::Complex;
use crate::spectral::complex::ln;
use crate::spectral::source::potential::{Jump, Potential};
use std::f64::consts::TAU;

/// psi with `-Lap psi = f`.
#[derive(Clone)]
pub(in crate::spectral) enum Psi {
    Jumps(Vec<PsiPart>),
    Polynomial(Polynomial),
}

/// Part of psi that belongs to some jumps, seen from a point.
#[derive(Clone)]
pub(in crate::spectral) struct PsiPart {
    pub middle: Complex,
    pub potential: Potential,
    /// psi away from these jumps, if they are those of a small closed shape.
    pub far: Option<FarField>,
}

impl PsiPart {
    /// Part of jumps, seen from a point, with their gradients as those of [`Psi::value`].
    pub(in crate::spectral) fn new(
        middle: Complex,
        mut potential: Potential,
        far: Option<FarField>,
    ) -> Self {
        let mut constant = Complex::default();
        for Jump { arc, size, .. } in &potential.jumps {
            let [a, b] = arc.span;
            let way = match arc.curve.curvature {
                0.0 => arc.curve.tangent.scaled(b - a),
                _ => arc.curve.at(b) - arc.curve.at(a),
            };
            constant = constant + way.turned().scaled(size / (2.0 * TAU));
        }
        potential.constant = constant;
        Self { middle, potential, far }
    }

    /// psi away from the jumps, if a point is there.
    pub(in crate::spectral) fn far_from(&self, z: Complex) -> Option<&FarField> {
        self.far.as_ref().filter(|far| far.holds(z - self.middle))
    }

    pub(in crate::spectral) fn value(&self, z: Complex) -> f64 {
        let seen = z - self.middle;
        if let Some(far) = self.far_from(z) {
            return far.at(seen).0;
        }
        let Potential { vertices, jumps, background, .. } = &self.potential;
        let logs = self.potential.logs(&[seen]);
        let mut sum = -0.25 * background * seen.norm2();
        for jump in jumps {
            sum += jump.value(seen, vertices, &logs);
        }
        sum
    }

    /// Adds gradients at points.
    pub(in crate::spectral) fn add_gradients(&self, points: &[Complex], sums: &mut [Complex]) {
        let (mut seen, mut near) = (Vec::new(), Vec::new());
        for (k, &z) in points.iter().enumerate() {
            match self.far_from(z) {
                Some(far) => sums[k] = sums[k] + far.at(z - self.middle).1,
                None => {
                    seen.push(z - self.middle);
                    near.push(k);
                }
            }
        }
        if !near.is_empty() {
            for (gradient, k) in self.potential.gradients(&seen).into_iter().zip(near) {
                sums[k] = sums[k] + gradient;
            }
        }
    }

    /// f of these jumps, with their background.
    pub(in crate::spectral) fn source(&self, z: Complex) -> f64 {
        let mut f = [self.potential.background];
        if self.far_from(z).is_none() {
            self.potential.add_jumps(&[z - self.middle], 1.0, &mut f);
        }
        f[0]
    }
}

impl Psi {
    /// psi of jumps, from f at some points of the domain, with those of small closed shapes.
    pub(in crate::spectral) fn of_jumps(
        mut potential: Potential,
        small: Vec<PsiPart>,
        points: &[Complex],
        f: impl Fn(Complex) -> f64,
    ) -> Self {
        potential.find_background(points, f);
        let mut parts = vec![PsiPart::new(Complex::default(), potential, None)];
        parts.extend(small);
        Self::Jumps(parts)
    }

    /// This function, with all seen from another point.
    pub(in crate::spectral) fn seen_from(&self, origin: Complex) -> Self {
        let mut seen = self.clone();
        if let Self::Jumps(parts) = &mut seen {
            parts.iter_mut().for_each(|part| part.middle = part.middle - origin);
        }
        seen
    }

    /// Parts of jumps, none of a polynomial.
    pub(in crate::spectral) fn parts(&self) -> &[PsiPart] {
        match self {
            Self::Jumps(parts) => parts,
            Self::Polynomial(_) => &[],
        }
    }

    /// Gradients at points.
    pub(in crate::spectral) fn gradients(&self, points: &[Complex]) -> Vec<Complex> {
        match self {
            Self::Jumps(parts) => {
                let mut sums = vec![Complex::default(); points.len()];
                parts.iter().for_each(|part| part.add_gradients(points, &mut sums));
                sums
            }
            Self::Polynomial(f) => points.iter().map(|&z| f.psi_gradient(z)).collect(),
        }
    }

    /// psi at a point.
    pub(in crate::spectral) fn value(&self, z: Complex) -> f64 {
        match self {
            Self::Polynomial(f) => f.psi(z),
            Self::Jumps(parts) => parts.iter().map(|part| part.value(z)).sum(),
        }
    }

    /// f at a point, where psi belongs to jumps off them.
    pub(in crate::spectral) fn source(&self, z: Complex) -> f64 {
        match self {
            Self::Polynomial(f) => f.value(z),
            Self::Jumps(parts) => parts.iter().map(|part| part.source(z)).sum(),
        }
    }
}

impl Jump {
    /// Part of psi at a point z, with the vertices and the logarithms of their distances from it.
    fn value(&self, z: Complex, vertices: &[Complex], logs: &[Complex]) -> f64 {
        let mut ratio = [Complex::default()];
        self.log_ratios(logs, &mut ratio);
        let power = self.arc.curve.polar(z).power;
        let angle = self.logarithm(ratio[0], power).im;
        let part = match self.arc.curve.centre() {
            None => self.line_value(z, vertices, logs, angle),
            Some(centre) => {
                let ends = self.arc.ends.map(|end| end.map(|v| [vertices[v] - centre, logs[v]]));
                self.circle_value(z - centre, ends, [power, angle])
            }
        };
        self.size / (2.0 * TAU) * part
    }

    /// With the angle under which the segment is seen.
    fn line_value(&self, z: Complex, vertices: &[Complex], logs: &[Complex], angle: f64) -> f64 {
        let local = self.arc.curve.local(z);
        let mut sum = local.im * angle;
        for (end, sign) in self.arc.ends.into_iter().zip([-1.0, 1.0]) {
            let Some(v) = end else { continue };
            let along = self.arc.curve.tangent.dot(vertices[v] - z);
            sum += sign * along * (logs[v].re - 0.5);
        }
        -local.im * sum
    }

    /// With z seen from the centre, and the ends seen from there with the logarithms of their distances from z.
    fn circle_value(
        &self,
        z: Complex,
        ends: [Option<[Complex; 2]>; 2],
        [power, angle]: [f64; 2],
    ) -> f64 {
        let radius = 1.0 / self.arc.curve.curvature;
        let sweep = (self.arc.span[1] - self.arc.span[0]) * self.arc.curve.curvature;
        let square = radius * radius;
        let inside = z.norm2() <= square;
        // Im L less the sweep inside.
        let turn = if inside { angle + sweep } else { angle };
        let mut mixed = 0.0;
        let log = ln(z).re;
        let mut lambda = sweep * if inside { ln(Complex::new(radius, 0.0)).re } else { log };
        for (end, sign) in ends.into_iter().zip([-1.0, 1.0]) {
            let Some([u, log]) = end else { continue };
            mixed += sign * z.cross(u) * log.re;
            lambda += sign * if inside { dilogarithm(z / u) } else { -dilogarithm(u / z) };
        }
        mixed + 0.5 * radius * power * turn - square * (lambda + sweep)
    }
}

/// Imaginary part of the dilogarithm for |y| <= 1.
fn dilogarithm(y: Complex) -> f64 {
    /// Bernoulli numbers of even order over factorials, B_2k / (2k + 1)!.
    const SERIES: [f64; 12] = [
        1.0 / 36.0,
        -1.0 / 3600.0,
        4.724111866969009e-6,
        -9.185773074661964e-8,
        1.8978869988971e-9,
        -4.064761645144226e-11,
        8.921691020456452e-13,
        -1.993929586072108e-14,
        4.518980029619918e-16,
        -1.035651761218125e-17,
        2.395218621026187e-19,
        -5.581785874325009e-21,
    ];
    let rest = (-y).shifted(1.0);
    if y.re > 0.5 {
        return -(ln(y) * ln(rest)).im - dilogarithm(rest);
    }
    let u = -ln(rest);
    let square = u * u;
    let mut sum = Complex::default();
    for c in SERIES.into_iter().rev() {
        sum = (sum * square).shifted(c);
    }
    (u - square.scaled(0.25) + sum * square * u).im
}

#[cfg(test)]
mod tests;
