//! Lines and circles: the points at which they meet, and the curves that bound a shape.

use crate::machine::extremes::two_sum;
use crate::problem::complex::Complex;
use crate::problem::shape::{Shape, scaled};
use crate::spectral::complex::arg;
use std::f64::consts::TAU;

/// Points closer than this count as one: about 1e-12, but no decimal number, so that a decimal distance is never at
/// the limit.
pub(crate) const SAME: f64 = 1.0 / (1_u64 << 40) as f64;

/// Distance by which points may be off by rounding, of coordinates below 1 and in their use.
pub(crate) const ROUNDING: f64 = 4e-15;

/// A line, or a circle anticlockwise, whose points are known by their distance from the origin along it.
///
/// Centres and radii would lose digits to cancellation where a large circle is nearly straight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Curve {
    /// A point of the curve; of a large circle the one nearest to the square.
    pub origin: Complex,
    /// Unit tangent at the origin.
    pub tangent: Complex,
    /// One over the radius, zero for a line.
    pub curvature: f64,
}

impl Curve {
    pub(crate) const fn line(origin: Complex, tangent: Complex) -> Self {
        Self { origin, tangent, curvature: 0.0 }
    }

    pub(crate) fn at(self, s: f64) -> Complex {
        let half = Complex::unit(0.5 * self.curvature * s);
        let chord = if self.curvature == 0.0 { s } else { 2.0 * half.im / self.curvature };
        self.origin + self.tangent * half.scaled(chord)
    }

    /// Unit tangent at a distance from the origin along the curve.
    pub(crate) fn direction(self, s: f64) -> Complex {
        self.tangent * Complex::unit(self.curvature * s)
    }

    /// Coordinates of a point in the frame of the origin and the tangent there.
    #[inline(always)]
    pub(crate) fn local(self, z: Complex) -> Complex {
        self.tangent.conj() * (z - self.origin)
    }

    /// Position of a point with respect to the centre.
    #[inline(always)]
    pub(crate) fn polar(self, z: Complex) -> Polar {
        let local = self.local(z);
        Polar {
            nu: Complex::new(1.0 - self.curvature * local.im, self.curvature * local.re),
            power: 2.0 * local.im - self.curvature * local.norm2(),
        }
    }

    /// Distance of a point from the curve, negative to its left.
    pub(crate) fn distance(self, z: Complex) -> f64 {
        let Polar { nu, power } = self.polar(z);
        -power / (1.0 + nu.norm())
    }

    /// Length of a circle.
    pub(crate) fn period(self) -> Option<f64> {
        (self.curvature > 0.0).then(|| TAU / self.curvature)
    }

    /// Centre of a circle.
    pub(crate) fn centre(self) -> Option<Complex> {
        let normal = self.tangent.turned();
        (self.curvature > 0.0).then(|| self.origin + normal.scaled(1.0 / self.curvature))
    }

    /// Distance from the origin along the curve to the point nearest to `z`.
    pub(crate) fn place(self, z: Complex) -> f64 {
        let local = self.local(z);
        if self.curvature == 0.0 {
            return local.re;
        }
        arg(self.polar(z).nu) / self.curvature
    }

    /// Position with respect to another curve.
    fn relation(self, other: Self) -> Relation {
        /// Distance of centres, in radii of either circle, from which on the angle between circles has all digits.
        const NEARLY_ONE: f64 = 1e-3;
        let sign = 1.0_f64.copysign(self.tangent.dot(other.tangent));
        let (k, l, tangent) = (self.curvature, sign * other.curvature, other.tangent.scaled(sign));
        // In the frame of this curve the other, in the same direction, is l |w|^2 + 2 Re(conj(b) w) + c = 0. Here
        // w = u / (1 - i k u / 2) with u = tan(k s / 2) / (k / 2), and a u^2 + 2 Re(b) u + c = 0.
        let (from, turn) = (other.local(self.origin).scaled(sign), tangent.conj() * self.tangent);
        let b = turn.conj() * Complex::new(l * from.re, l * from.im - 1.0);
        let c = l * from.norm2() - 2.0 * from.im;
        let a = l + k * (b.im + 0.25 * k * c);
        // The difference of the curvatures where curves touch, zero for lines and circles with one centre.
        let bend = (other.origin - self.origin).scaled(k * l)
            + (tangent.scaled(k) - self.tangent.scaled(l)).turned();
        let bend = bend.norm();
        // The discriminant is the square of the sine of the angle between the curves, this 1 less its cosine: without
        // cancellation where they are nearly parallel, and by the triangle of the centres and a common point for
        // circles that are nearly one.
        let versine = match bend < NEARLY_ONE * k.min(l) {
            true => 0.5 * (bend - (k - l).abs()) * (bend + (k - l).abs()) / (k * l),
            false => turn.im * turn.im / (1.0 + turn.re) + l * turn.cross(from) + 0.5 * k * c,
        };
        let concentric = bend < ROUNDING * (k * l).abs();
        Relation { a, b: b.re, c, bend, square: versine * (2.0 - versine), concentric }
    }

    /// Overlap with another curve that it touches, as [`Self::meets`] sees it, by two points of both. By the triangle
    /// of the centres and one of these points they are `2 sqrt(square) / bend` apart, and the width between the curves
    /// is about `square / (2 bend)`.
    pub(crate) fn overlap(self, other: Self) -> Option<Overlap> {
        let Relation { square, bend, .. } = self.relation(other);
        let is_one = self.curvature == 0.0 && other.curvature == 0.0 || self.same(other);
        // By the angle at both points, and the difference of the curvatures.
        (!is_one && square > 0.0 && square < SAME * bend)
            .then(|| Overlap { width: square / bend, length: 4.0 * square.sqrt() / bend })
    }

    /// Points at which the curve meets another one, as distances from the origin along it. Curves that overlap by, or
    /// lack, less than half of [`SAME`] touch, as is frequent with decimal input.
    pub(crate) fn meets(self, other: Self) -> Vec<f64> {
        let Relation { a, b, c, bend, square, concentric } = self.relation(other);
        let straight = self.curvature == 0.0 && other.curvature == 0.0;
        let parallel = straight && square < ROUNDING * ROUNDING;
        if square < -SAME * bend || concentric || parallel {
            return Vec::new();
        }
        let touch = square < SAME * bend;
        let q = -b - if touch { 0.0 } else { square.sqrt().copysign(b) };
        let roots = match touch {
            true if a.abs() > c.abs() => vec![q / a],
            true => vec![c / q],
            false => vec![q / a, c / q],
        };
        roots.into_iter().map(|u| self.length(u)).filter(|s| s.is_finite()).collect()
    }

    /// Distance s from the origin along the curve with `u = tan(k s / 2) / (k / 2)`.
    fn length(self, u: f64) -> f64 {
        let k = self.curvature;
        if k == 0.0 { u } else { 2.0 / k * libm::atan(0.5 * k * u) }
    }

    /// Distance by which points of the curve may be off: on a large circle by the rounding error of its radius.
    pub(crate) fn rounding(self) -> f64 {
        ROUNDING.max(2e-15 * self.period().unwrap_or_default())
    }

    /// True if points lie on the curve, within a distance or [`Self::rounding`].
    pub(crate) fn holds(self, points: [Complex; 3], within: f64) -> bool {
        let within = within.max(self.rounding());
        points.into_iter().all(|z| self.distance(z).abs() < within)
    }

    /// True if both curves are equal. Curves that are a little farther apart than points that count as one would differ
    /// on some of their pieces only.
    pub(crate) fn same(self, other: Self) -> bool {
        let s = 1.0_f64.min(1.0 / self.curvature);
        other.holds([-s, 0.0, s].map(|s| self.at(s)), 4.0 * ROUNDING)
    }
}

/// Position of a point with respect to a curve.
pub(crate) struct Polar {
    /// `1 + i k zeta`, with the curvature k and zeta of [`Curve::local`]: the position relative to the centre, turned
    /// and in radii; 1 for a line.
    pub nu: Complex,
    /// `(1 - |nu|^2) / k`: positive to the left of the curve, and near to it twice the distance.
    pub power: f64,
}

/// Points on the left and on the right of a point of a curve with this normal to the left, `most` from it, and no
/// farther than half of these distances of others.
pub(crate) fn beside(
    [z, normal]: [Complex; 2],
    most: f64,
    others: impl Iterator<Item = f64>,
) -> [Complex; 2] {
    let step = normal.scaled(others.fold(most, |step, away| step.min(0.5 * away)));
    [z + step, z - step]
}

/// Bounds of the width and the length of what two curves share.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Overlap {
    pub width: f64,
    pub length: f64,
}

/// Position of two curves with respect to each other. They meet at the distances s along the first, of curvature k, for
/// which `u = tan(k s / 2) / (k / 2)` is a root of `a u^2 + 2 b u + c`.
struct Relation {
    a: f64,
    b: f64,
    c: f64,
    /// Discriminant, the square of the sine of the angle between them.
    square: f64,
    /// Distance of the centres times both curvatures: the difference of the curvatures if the curves touch.
    bend: f64,
    /// True if the centres are equal.
    concentric: bool,
}

/// Part of a curve.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Arc {
    pub curve: Curve,
    /// Start and end, as distances from the origin along the curve; the end may come first.
    pub span: [f64; 2],
    /// Vertices at its ends, if any.
    pub ends: [Option<usize>; 2],
}

impl Arc {
    pub(crate) fn reversed(self) -> Self {
        let ([a, b], [first, last]) = (self.span, self.ends);
        Self { span: [b, a], ends: [last, first], ..self }
    }
}

/// Lines farther from the centre than this bound nothing in the square, and their points may overflow.
const FARTHEST: f64 = 10.0;

/// Curves that bound a shape; none for a disc that is hardly wider than a point.
pub(crate) fn borders(shape: &Shape<2>) -> Vec<Curve> {
    match *shape {
        Shape::Ball { radius, .. } if radius < 2.0 * SAME => Vec::new(),
        Shape::Ball { centre: [x, y], radius } => {
            let (centre, small, large) =
                (Complex::new(x, y), x.abs().min(y.abs()), x.abs().max(y.abs()));
            let away = centre.norm();
            let nearest = less_square([large, small], radius) / (away + radius);
            let (normal, origin) = if away > 0.5 * radius {
                (centre.scaled(1.0 / away), centre.scaled(nearest / away))
            } else {
                (Complex::new(1.0, 0.0), Complex::new(x - radius, y))
            };
            vec![Curve { origin, tangent: -normal.turned(), curvature: 1.0 / radius }]
        }
        Shape::Box(_) | Shape::HalfSpace { .. } => {
            let lines = shape.half_planes().into_iter().map(line);
            lines.filter(|line| line.origin.norm() < FARTHEST).collect()
        }
    }
}

/// `large^2 + small^2 - radius^2`, with the digits that are left where that nearly vanishes.
fn less_square([large, small]: [f64; 2], radius: f64) -> f64 {
    let [difference, rest] = two_sum(large, -radius);
    let [sum, remainder] = two_sum(large, radius);
    let (product, square) = (difference * sum, small * small);
    let [total, last] = two_sum(product, square);
    let of_products = libm::fma(difference, sum, -product) + libm::fma(small, small, -square);
    total + (last + of_products + difference * remainder + rest * sum)
}

/// Line `a x + b y = c`.
fn line([a, b, c]: [f64; 3]) -> Curve {
    let ([a, b], c) = scaled([a, b], c);
    let normal = Complex::new(a, b);
    let scale = 1.0 / normal.norm();
    Curve::line(normal.scaled(c * scale * scale), normal.turned().scaled(scale))
}

/// Part of a curve.
pub(crate) struct CurvePart<T> {
    pub span: [f64; 2],
    pub value: T,
}

/// Adds a part of a curve, to the last one if they touch and have the same value.
pub(crate) fn append<T: PartialEq>(parts: &mut Vec<CurvePart<T>>, part: CurvePart<T>) {
    match parts.last_mut() {
        Some(last) if last.value == part.value && part.span[0] - last.span[1] < SAME => {
            last.span[1] = part.span[1];
        }
        _ => parts.push(part),
    }
}

/// Joins the last part of a circle to the first if they touch and have the same value.
pub(crate) fn close<T: PartialEq>(parts: &mut Vec<CurvePart<T>>, period: f64) {
    if let [first, .., last] = &mut parts[..]
        && first.value == last.value
        && first.span[0] + period - last.span[1] < SAME
    {
        first.span[0] = last.span[0] - period;
        parts.pop();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn disc(x: f64, y: f64, radius: f64) -> Shape<2> {
        Shape::Ball { centre: [x, y], radius }
    }

    #[test]
    fn curves_meet_at_points_of_both() {
        let shapes = [
            Shape::HalfSpace { normal: [0.3, 0.7], d: 0.1 },
            Shape::HalfSpace { normal: [-0.7, 0.3], d: 0.05 },
            disc(0.1, -0.2, 0.3),
            disc(-0.1, 0.1, 0.25),
            disc(6e4, -8e4, 1e5),
            disc(0.2, 1e5, 1e5),
        ];
        let curves = shapes.map(|shape| borders(&shape)[0]);
        for (k, l) in (0..36).map(|pair| (pair / 6, pair % 6)).filter(|(k, l)| k != l) {
            let [found, again] = [[k, l], [l, k]].map(|pair| {
                let [a, b] = pair.map(|k| curves[k]);
                let met = a.meets(b);
                assert_eq!(met.len(), if k.max(l) < 2 { 1 } else { 2 }, "{k} {l}");
                // Large circles meet far away, too.
                let points = met.into_iter().map(|s| a.at(s)).filter(|z| z.norm() < 1.0);
                points.collect::<Vec<Complex>>()
            });
            assert!(!found.is_empty() && found.len() == again.len(), "{k} {l}");
            for z in found {
                assert!(curves[l].distance(z).abs() < 1e-15, "{k} {l}: {z:?}");
                assert!(again.iter().any(|&w| (w - z).norm() < 2e-15), "{k} {l}: {z:?}");
            }
        }
        // Discs of one size that touch, seen from their origins in any directions.
        for (x, y) in [(0.3, 0.4), (0.4, -0.3), (-0.5, 0.0), (0.0, 0.5)] {
            let [circle, other] =
                [[0.0, -0.375], [x, y - 0.375]].map(|[x, y]| borders(&disc(x, y, 0.25))[0]);
            let [touch] = circle.meets(other)[..] else { panic!("one point") };
            let middle = Complex::new(0.5 * x, 0.5 * y - 0.375);
            assert!((circle.at(touch) - middle).norm() < 1e-15, "{x} {y}");
        }
        let circle = borders(&disc(0.25, 0.125, 0.25))[0];
        let right = Curve::line(Complex::new(0.5, 0.0), Complex::new(0.0, 1.0));
        let [touch] = circle.meets(right)[..] else { panic!("one point") };
        assert!((circle.at(touch) - Complex::new(0.5, 0.125)).norm() < 1e-15);
    }

    #[test]
    fn large_circles_are_known_to_the_last_digit() {
        // At a right angle, 5 = |(3, 4)|: a quarter less than the distance of the centre from the origin.
        let unit = 16_777_216.0;
        for [x, y] in [[3.0, 4.0], [-4.0, 3.0], [5.0, 0.0]] {
            let [circle] = borders(&disc(x * unit, y * unit, 5.0 * unit - 0.25))[..] else {
                panic!()
            };
            assert!((circle.origin.norm() - 0.25).abs() < 1e-16, "{x} {y}: {:?}", circle.origin);
        }
    }
}
