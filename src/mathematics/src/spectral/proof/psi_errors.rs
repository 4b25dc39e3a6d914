//! Rounding errors of psi and of its gradient at points: some units in the last place of the moduli of all terms.
//!
//! The position of a point seen from a curve is off by two units of its distance D from the origin of the curve, a
//! fifth of which stands beside the factors that are small next to the curve, so that 16 units cover both.

use crate::machine::simd::vectorised;
use crate::problem::complex::Complex;
use crate::spectral::geometry::curve::{Arc, Polar};
use crate::spectral::source::potential::{Jump, Potential};
use crate::spectral::source::psi::Psi;
use crate::spectral::source::psi_sizes::PsiSizes;
use std::f64::consts::TAU;

/// Units of a term.
const UNITS: f64 = 16.0;
/// Least distance from the centre of a circle, in radii, by which is divided.
const CENTRE: f64 = 0.01;

impl Psi {
    /// Bounds at points.
    pub(super) fn errors(&self, points: &[Complex]) -> Vec<PsiSizes> {
        match self {
            Self::Jumps(parts) => {
                let mut sums = vec![PsiSizes::default(); points.len()];
                for part in parts {
                    part.add(
                        points,
                        &mut sums,
                        |far, z| far.sizes(z).rounded(UNITS),
                        Potential::errors,
                    );
                }
                sums
            }
            Self::Smooth(own) => {
                let moduli = points.iter().map(|&z| own.psi.moduli(z, 0.0));
                let errors = moduli.map(|[value, slope]| PsiSizes { value, slope, bend: 0.0 });
                errors.map(|error| error.rounded(own.units()[0])).collect()
            }
        }
    }
}

impl Potential {
    /// Bounds at points.
    fn errors(&self, points: &[Complex]) -> Vec<PsiSizes> {
        let logs = vectorised(
            #[inline(always)]
            || self.logs(points),
        );
        // One more for each addition.
        let units = UNITS + self.jumps.len() as f64;
        // The background is off by no more than two units of the jumps from which it is found.
        let background = 0.5 * (self.background.abs() + 2.0 / UNITS * self.rounded);
        let mut errors = Vec::with_capacity(points.len());
        for z in points {
            let slope = background * z.norm();
            errors.push(PsiSizes {
                value: 0.5 * slope * z.norm(),
                slope: slope + self.constant.norm(),
                bend: background,
            });
        }
        for jump in &self.jumps {
            let factor = jump.size.abs() / (2.0 * TAU);
            let ends = jump.arc.ends;
            let ends = ends.map(|end| end.map(|v| (self.vertices[v], &logs[v * points.len()..])));
            vectorised(
                #[inline(always)]
                || {
                    for (i, (sum, &z)) in errors.iter_mut().zip(points).enumerate() {
                        let ends = ends.map(|end| end.map(|(v, logs)| [v - z, logs[i]]));
                        let PsiSizes { value, slope, bend } = jump.sizes(z, ends);
                        sum.value += factor * value;
                        sum.slope += factor * slope;
                        sum.bend += factor * bend;
                    }
                },
            );
        }
        errors.into_iter().map(|own| own.rounded(units)).collect()
    }
}

impl Jump {
    /// Sums of the moduli of all terms for a jump of 4 pi, by its ends seen from the point with their logarithms; with
    /// nu, power and logarithm of [`Potential`], whose gradients are 1, 2 nu and at most two over the distance from the
    /// curve, `(1 + nu)` times which bounds the power.
    #[inline(always)]
    fn sizes(&self, z: Complex, ends: [Option<[Complex; 2]>; 2]) -> PsiSizes {
        let Arc { curve, span, .. } = self.arc;
        let Polar { nu, power } = curve.polar(z);
        let (nu, away) = (nu.norm().max(CENTRE), (z - curve.origin).norm());
        // Of a line parallel to an axis the other coordinate does not count.
        let seen = (z - curve.origin).coordinates().map(f64::abs);
        let off = match curve.curvature {
            0.0 => curve.tangent.re.abs() * seen[1] + curve.tangent.im.abs() * seen[0],
            curvature => away * (1.0 + curvature * away),
        };
        let power = power.abs() + 0.2 * off;
        let length = (span[1] - span[0]).abs();
        let sweep = curve.curvature * length;
        let (mut logs, mut moments) = (TAU + sweep, 0.0);
        for [end, log] in ends.into_iter().flatten() {
            logs += 1.0 + log.norm();
            moments += end.norm() * (1.5 + log.norm());
        }
        let slope = power * logs / nu + 2.0 * length;
        let bend = 2.0 * (logs + 1.0 + 1.0 / nu) + curve.curvature * slope / nu;
        let value = match curve.centre() {
            None => 0.5 * power * (0.5 * power * logs + moments),
            Some(centre) => {
                let (radius, far) = (1.0 / curve.curvature, (z - centre).norm());
                let [log, own] = [far.max(CENTRE * radius), radius].map(|r| libm::log(r).abs());
                let dilogarithms = ends.iter().flatten().map(|end| 2.0 + end[1].norm() + own);
                radius * (radius + far) * dilogarithms.sum::<f64>()
                    + radius * radius * sweep * (1.0 + log + own)
                    + 0.5 * radius * power * logs
            }
        };
        PsiSizes { value, slope, bend }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spectral::geometry::curve::Curve;

    /// psi of jumps along an arc between places, one from each to the next.
    fn along(curve: Curve, places: &[f64]) -> Psi {
        let vertices = places.iter().map(|&s| curve.at(s)).collect();
        let mut potential = Potential { vertices, ..Potential::default() };
        for (k, pair) in places.windows(2).enumerate() {
            let arc = Arc { curve, span: [pair[0], pair[1]], ends: [Some(k), Some(k + 1)] };
            potential.add(arc, 3.0);
        }
        Psi::of_jumps(potential, Vec::new(), &[Complex::default()], |_| 0.0)
    }

    #[test]
    fn an_arc_and_its_halves_differ_by_no_more_than_rounding() {
        let (origin, tangent) = (Complex::new(0.3, -0.2), Complex::new(0.8, 0.6));
        for curvature in [0.0, 0.7, 3.0] {
            let curve = Curve { origin, tangent, curvature };
            let [whole, halves] = [&[-0.6, 0.7][..], &[-0.6, 0.1, 0.7]].map(|at| along(curve, at));
            let mut points = Vec::new();
            for k in 0..200 {
                let k = f64::from(k);
                points.push(Complex::unit(k).scaled(0.006 * k));
                // Next to the curve and to a vertex.
                let off = curve.direction(0.1).turned().scaled(libm::exp(-0.1 * k));
                points.push(curve.at(0.001 * k) + off);
            }
            let gradients = [&whole, &halves].map(|psi| psi.gradients(&points));
            let errors = [&whole, &halves].map(|psi| psi.errors(&points));
            for (i, &z) in points.iter().enumerate() {
                let [value, slope] = [0, 1].map(|which: usize| {
                    let of = |own: &PsiSizes| if which == 0 { own.value } else { own.slope };
                    of(&errors[0][i]) + of(&errors[1][i])
                });
                let difference = halves.value(z) - whole.value(z);
                assert!(difference.abs() < value && value < 1e-11, "{z:?}: {difference} {value}");
                let difference = (gradients[1][i] - gradients[0][i]).norm();
                assert!(difference < slope && slope < 1e-11, "{z:?}: {difference} {slope}");
            }
        }
    }

    /// The jumps alone.
    fn without_background(psi: Psi) -> Psi {
        let Psi::Jumps(mut parts) = psi else { panic!("jumps") };
        let own = &mut parts[0].potential;
        (own.background, own.rounded, own.constant) = (0.0, 0.0, Complex::default());
        Psi::Jumps(parts)
    }

    #[test]
    fn far_away_errors_are_those_of_logarithms_times_distances() {
        let (origin, tangent) = (Complex::new(0.3, -0.2), Complex::new(0.8, 0.6));
        for curvature in [0.0, 0.7] {
            let curve = Curve { origin, tangent, curvature };
            let [whole, halves] = [&[-0.6, 0.7][..], &[-0.6, 0.1, 0.7]]
                .map(|at| without_background(along(curve, at)));
            let points: Vec<Complex> =
                (0..300).map(|k| Complex::unit(f64::from(k)).scaled(1e3 + f64::from(k))).collect();
            let gradients = [&whole, &halves].map(|psi| psi.gradients(&points));
            let errors = [&whole, &halves].map(|psi| psi.errors(&points));
            let mut seen = [0.0f64; 2];
            for (i, &z) in points.iter().enumerate() {
                let both = [&errors[0][i], &errors[1][i]];
                let off = (halves.value(z) - whole.value(z)).abs();
                assert!(off < both[0].value + both[1].value, "{z:?}: {off}");
                let turn = (gradients[1][i] - gradients[0][i]).norm();
                assert!(turn < both[0].slope + both[1].slope, "{z:?}: {turn}");
                seen = [seen[0].max(off), seen[1].max(turn)];
            }
            // Far more than the length of the arc would say.
            assert!(seen.iter().all(|&off| off > 100.0 * f64::EPSILON), "{seen:?}");
        }
    }

    #[test]
    fn gradients_change_no_more_than_they_are_said_to() {
        let (origin, tangent) = (Complex::new(0.3, -0.2), Complex::new(0.8, 0.6));
        for curvature in [0.0, 0.7, 3.0] {
            let curve = Curve { origin, tangent, curvature };
            let psi = along(curve, &[-0.6, 0.7]);
            for k in 0..40 {
                // Towards a vertex and beside the curve.
                let away = libm::exp(-0.25 * f64::from(k));
                for z in [
                    curve.at(-0.6 - away),
                    curve.at(0.2) + curve.direction(0.2).turned().scaled(away),
                ] {
                    let step = Complex::new(1e-4 * away, 0.0);
                    let ends = psi.gradients(&[z - step, z + step]);
                    let change = (ends[1] - ends[0]).norm() / (2.0 * step.re);
                    let bend = psi.errors(&[z])[0].bend;
                    assert!(bend >= change * (1.0 - 1e-6), "{curvature} {away}: {bend} {change}");
                }
            }
        }
    }
}
