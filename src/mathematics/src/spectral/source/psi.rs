//! The particular solution psi itself, in closed form, with the same constants as its gradient.
//!
//! With z seen from a jump J along an arc from a to b, psi is the sum of
//! `-(J / 4 pi) Im int conj(w - z) (log|w - z| + 1/2) dw`: logarithms for a segment, the dilogarithm for an arc. A
//! smooth f ([`smooth`](super::smooth)) has for `Re c z^j conj(z)^k` the term
//! `-Re c z^(j+1) conj(z)^(k+1) / (4 (j + 1) (k + 1))`, and for `Re c exp(a z + b conj(z))` itself over `-4 a b`.

use super::far_field::FarField;
use super::smooth::SmoothSource;
use crate::machine::simd::vectorised;
use crate::problem::complex::Complex;
use crate::spectral::complex::ln;
use crate::spectral::source::potential::{Jump, Potential};
use std::f64::consts::TAU;
use std::ops::Add;

/// psi with `-Lap psi = f`.
#[derive(Clone)]
pub(crate) enum Psi {
    Jumps(Vec<PsiPart>),
    Smooth(SmoothSource),
}

/// Part of psi that belongs to some jumps, seen from a point.
#[derive(Clone)]
pub(crate) struct PsiPart {
    pub middle: Complex,
    pub potential: Potential,
    /// psi away from these jumps, if they are those of a small closed shape.
    pub far: Option<FarField>,
}

impl PsiPart {
    /// Part of jumps, seen from a point, with their gradients as those of [`Psi::value`].
    pub(crate) fn new(middle: Complex, mut potential: Potential, far: Option<FarField>) -> Self {
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
    pub(crate) fn far_from(&self, z: Complex) -> Option<&FarField> {
        self.far.as_ref().filter(|far| far.holds(z - self.middle))
    }

    /// Adds a quantity at points: where psi is found from far away by `far`, elsewhere by `near`.
    pub(crate) fn add<T: Copy + Add<Output = T>>(
        &self,
        points: &[Complex],
        sums: &mut [T],
        far: impl Fn(&FarField, Complex) -> T,
        near: impl Fn(&Potential, &[Complex]) -> Vec<T>,
    ) {
        let (mut seen, mut numbers) = (Vec::new(), Vec::new());
        for (k, &z) in points.iter().enumerate() {
            match self.far_from(z) {
                Some(own) => sums[k] = sums[k] + far(own, z - self.middle),
                None => {
                    seen.push(z - self.middle);
                    numbers.push(k);
                }
            }
        }
        if !seen.is_empty() {
            for (own, k) in near(&self.potential, &seen).into_iter().zip(numbers) {
                sums[k] = sums[k] + own;
            }
        }
    }

    /// Adds values at points.
    fn add_values(&self, points: &[Complex], sums: &mut [f64]) {
        self.add(points, sums, |far, z| far.at(z).0, Potential::values);
    }

    /// Adds gradients at points.
    fn add_gradients(&self, points: &[Complex], sums: &mut [Complex]) {
        self.add(points, sums, |far, z| far.at(z).1, Potential::gradients);
    }

    /// f of these jumps, with their background.
    pub(crate) fn source(&self, z: Complex) -> f64 {
        let mut f = [self.potential.background];
        if self.far_from(z).is_none() {
            self.potential.add_jumps(&[z - self.middle], 1.0, &mut f);
        }
        f[0]
    }
}

impl Psi {
    /// psi of jumps, from f at some points of the domain, with those of small closed shapes.
    pub(crate) fn of_jumps(
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
    pub(crate) fn seen_from(&self, origin: Complex) -> Self {
        let mut seen = self.clone();
        if let Self::Jumps(parts) = &mut seen {
            parts.iter_mut().for_each(|part| part.middle = part.middle - origin);
        }
        seen
    }

    /// Parts of jumps, none of a smooth f.
    pub(crate) fn parts(&self) -> &[PsiPart] {
        match self {
            Self::Jumps(parts) => parts,
            Self::Smooth(_) => &[],
        }
    }

    /// Gradients at points.
    pub(crate) fn gradients(&self, points: &[Complex]) -> Vec<Complex> {
        match self {
            Self::Jumps(parts) => {
                let mut sums = vec![Complex::default(); points.len()];
                parts.iter().for_each(|part| part.add_gradients(points, &mut sums));
                sums
            }
            Self::Smooth(own) => points.iter().map(|&z| own.psi.gradient(z)).collect(),
        }
    }

    /// Values at points.
    pub(crate) fn values(&self, points: &[Complex]) -> Vec<f64> {
        match self {
            Self::Jumps(parts) => {
                let mut sums = vec![0.0; points.len()];
                parts.iter().for_each(|part| part.add_values(points, &mut sums));
                sums
            }
            Self::Smooth(own) => points.iter().map(|&z| own.psi.value(z)).collect(),
        }
    }

    /// psi at a point.
    pub(crate) fn value(&self, z: Complex) -> f64 {
        self.values(&[z])[0]
    }

    /// f at a point, where psi belongs to jumps off them.
    pub(crate) fn source(&self, z: Complex) -> f64 {
        match self {
            Self::Smooth(own) => own.f.value(z),
            Self::Jumps(parts) => parts.iter().map(|part| part.source(z)).sum(),
        }
    }
}

impl Potential {
    /// psi at points.
    fn values(&self, points: &[Complex]) -> Vec<f64> {
        vectorised(
            #[inline(always)]
            || {
                let mut sums: Vec<f64> =
                    points.iter().map(|z| -0.25 * self.background * z.norm2()).collect();
                let (logs, mut ratios) = (self.logs(points), points.to_vec());
                for jump in &self.jumps {
                    jump.log_ratios(&logs, &mut ratios);
                    jump.add_values(points, [&logs, &ratios], &self.vertices, &mut sums);
                }
                sums
            },
        )
    }
}

impl Jump {
    /// Adds its part of psi at points, with the logarithms of their distances from the vertices, vertex by vertex, and
    /// the differences of those of its ends.
    #[inline(always)]
    fn add_values(
        &self,
        points: &[Complex],
        [logs, ratios]: [&[Complex]; 2],
        vertices: &[Complex],
        sums: &mut [f64],
    ) {
        let (many, factor) = (points.len(), self.size / (2.0 * TAU));
        let ends =
            self.arc.ends.map(|end| end.map(|v| (vertices[v], &logs[v * many..(v + 1) * many])));
        match self.arc.curve.centre() {
            None => {
                for ((sum, &z), &ratio) in sums.iter_mut().zip(points).zip(ratios) {
                    let local = self.arc.curve.local(z);
                    let angle = self.logarithm(ratio, 2.0 * local.im).im;
                    *sum -= factor * local.im * local.im * angle;
                }
                for (end, sign) in ends.into_iter().zip([-1.0, 1.0]) {
                    let Some((vertex, logs)) = end else { continue };
                    for ((sum, &z), log) in sums.iter_mut().zip(points).zip(logs) {
                        let across = sign * factor * self.arc.curve.local(z).im;
                        let along = self.arc.curve.tangent.dot(vertex - z);
                        *sum -= across * along * (log.re - 0.5);
                    }
                }
            }
            Some(centre) => {
                for (i, (sum, &z)) in sums.iter_mut().zip(points).enumerate() {
                    let power = self.arc.curve.polar(z).power;
                    let angle = self.logarithm(ratios[i], power).im;
                    let ends = ends.map(|end| end.map(|(v, logs)| [v - centre, logs[i]]));
                    *sum += factor * self.circle_value(z - centre, ends, [power, angle]);
                }
            }
        }
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
