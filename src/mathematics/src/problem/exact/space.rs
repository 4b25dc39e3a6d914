//! Signorini problems on the cube with known solutions.
//!
//! All satisfy `v >= 0`, `dv/dn >= 0`, `v dv/dn = 0` on the boundary exactly. Where contact ends, `v`
//! behaves like the distance to the power 3/2, the generic singularity of the problem. As on the square
//! ([`Exact`](super::Exact)), the numbers are the same on all machines.

use super::segment;
use crate::problem::choices::choices;
use crate::problem::field::{Field, Sample, bump, falling, hill, product};
use std::f64::consts::PI;

/// The problems with known solutions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CubeExact {
    /// Contact on the whole boundary: `v = -cos(pi x) cos(pi y) cos(pi z)`.
    FullContact,
    /// Free on -0.23 < x < 0.19 of the face y = -1/2, in contact elsewhere.
    FreeStrip,
    /// Free on a disc of the face y = -1/2, in contact elsewhere.
    FreeDisc,
}

choices!(CubeExact, 3: FullContact = "full-contact", FreeStrip = "free-strip", FreeDisc = "free-disc");

impl CubeExact {
    /// The solution at a point of the closed cube.
    pub fn at(self, point: [f64; 3]) -> Sample<3> {
        self.field(point).into()
    }

    /// `f = -Laplacian v` alone.
    pub fn source(self, point: [f64; 3]) -> f64 {
        -self.field(point).laplacian
    }

    /// Always inlined, so that what is not asked for is not computed.
    #[inline(always)]
    fn field(self, point: [f64; 3]) -> Field<3> {
        match self {
            Self::FullContact => full_contact(point),
            Self::FreeStrip => free_strip(point),
            Self::FreeDisc => free_disc(point),
        }
    }
}

/// `v = -cos(pi x) cos(pi y) cos(pi z)`.
#[inline(always)]
fn full_contact(point: [f64; 3]) -> Field<3> {
    let cosines = point.map(|at| {
        let (sin, cos) = libm::sincos(PI * at);
        (cos, -PI * sin, -PI * PI * cos)
    });
    product(cosines).scaled(-1.0)
}

/// `v = p(x) ((1 - t^2) p(z)^2 psi(x, t) - A p(z) t^2 (1 - t))`, `p(s) = 1 - 4 s^2`, `t = y + 1/2`,
/// with the harmonic function `psi` of the free segment on the square.
#[inline(always)]
fn free_strip([x, y, z]: [f64; 3]) -> Field<3> {
    const AMPLITUDE: f64 = 4.0;
    let t = y + 0.5;
    let Field { value, gradient: [along, inward], laplacian } = segment(x, t);
    let psi = Field { value, gradient: [along, inward, 0.0], laplacian };
    let (p, slope, curvature) = hill(z);
    let squared = (p * p, 2.0 * p * slope, 2.0 * (slope * slope + p * curvature));
    let load = product([hill(x), bump(t), hill(z)]).scaled(AMPLITUDE);
    product([hill(x), falling(t), squared]).times(psi).minus(load)
}

/// `v = p(x) p(z) ((1 - t^2) psi - A t^2 (1 - t))`, `psi = u - t (c + d r^2)`: `u` is harmonic for
/// `t > 0`, `(1 - r^2 / a^2)^(3/2)` on the disc `r < a` of `t = 0`, and zero around it.
///
/// In oblate spheroidal coordinates, `t = a m s` and `r^2 = a^2 (1 + s^2) (1 - m^2)`, it is
/// `3/5 P_1(m) q_1(s) + 2/5 P_3(m) q_3(s)`: on the disc `s = 0` and this is `m^3`. There its slope along
/// `t` is a quadratic in `r`, the `c + d r^2` that `psi` takes away.
#[inline(always)]
fn free_disc([x, y, z]: [f64; 3]) -> Field<3> {
    const CENTRE: [f64; 2] = [0.03, -0.02];
    const RADIUS: f64 = 0.3618;
    const AMPLITUDE: f64 = 14.0;
    // q_1'(0) and q_3'(0).
    const SLOPE_1: f64 = -PI / 2.0;
    const SLOPE_3: f64 = -9.0 * PI / 8.0;
    let (t, x1, z1) = (y + 0.5, x - CENTRE[0], z - CENTRE[1]);
    let (r2, a2) = (x1 * x1 + z1 * z1, RADIUS * RADIUS);

    // s^2 - m^2 and s m, from which s^2 + m^2.
    let (difference, product_sm) = ((r2 + t * t - a2) / a2, t / RADIUS);
    let sum = (difference * difference + 4.0 * product_sm * product_sm).sqrt();
    let larger = (0.5 * (sum + difference.abs())).sqrt();
    let smaller = if larger > 0.0 { product_sm / larger } else { 0.0 };
    let (s, m) = if difference >= 0.0 { (larger, smaller) } else { (smaller, larger) };

    let arccot = libm::atan2(1.0, s);
    let (s2, m2) = (s * s, m * m);
    let (q1, q1_slope) = (1.0 - s * arccot, s / (1.0 + s2) - arccot);
    let q3 = 3.75 * s2 + 1.0 - 0.75 * s * (5.0 * s2 + 3.0) * arccot;
    let q3_slope =
        7.5 * s - 2.25 * (5.0 * s2 + 1.0) * arccot + 0.75 * s * (5.0 * s2 + 3.0) / (1.0 + s2);
    let (p3, p3_slope) = (0.5 * m * (5.0 * m2 - 3.0), 1.5 * (5.0 * m2 - 1.0));
    let u = 0.6 * m * q1 + 0.4 * p3 * q3;
    let along_s = 0.6 * m * q1_slope + 0.4 * p3 * q3_slope;
    let along_m = 0.6 * q1 + 0.4 * p3_slope * q3;
    // On the rim the gradient vanishes like the root of the distance.
    let [outward, inward] = if sum > 0.0 {
        [
            (s * along_s - m * along_m) / (a2 * sum),
            (m * (1.0 + s2) * along_s + s * (1.0 - m2) * along_m) / (RADIUS * sum),
        ]
    } else {
        [0.0, 0.6 * (SLOPE_1 - SLOPE_3) / RADIUS]
    };
    let (c, d) = ((0.6 * SLOPE_1 + 0.4 * SLOPE_3) / RADIUS, -SLOPE_3 / (RADIUS * a2));
    let psi = Field {
        value: u - t * (c + d * r2),
        gradient: [
            x1 * (outward - 2.0 * d * t),
            inward - (c + d * r2),
            z1 * (outward - 2.0 * d * t),
        ],
        laplacian: -4.0 * d * t,
    };
    let load = product([hill(x), bump(t), hill(z)]).scaled(AMPLITUDE);
    product([hill(x), falling(t), hill(z)]).times(psi).minus(load)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rim_of_the_free_disc_is_reached_without_a_jump() {
        // On the rim to the last bit: 0.3918 - 0.03 is the radius.
        let all = |Sample { value, gradient: [gx, gy, gz], f }: Sample<3>| [value, gx, gy, gz, f];
        let beside = all(CubeExact::FreeDisc.at([0.3918 + 1e-10, -0.5 + 1e-10, -0.02]));
        for (here, beside) in
            all(CubeExact::FreeDisc.at([0.3918, -0.5, -0.02])).into_iter().zip(beside)
        {
            assert!((here - beside).abs() < 1e-3 * (1.0 + beside.abs()), "{here} {beside}");
        }
    }

    #[test]
    fn boundary_conditions_hold() {
        const POINTS: u32 = 199;
        for problem in CubeExact::ALL {
            let mut free = 0;
            for number in 0..POINTS * POINTS {
                let along = |digit: u32| (f64::from(digit) + 0.5) / f64::from(POINTS) - 0.5;
                let (a, b) = (along(number % POINTS), along(number / POINTS));
                for axis in 0..3 {
                    for end in [-0.5, 0.5] {
                        let mut point = [a, b, b];
                        point[axis] = end;
                        if axis == 1 {
                            point[0] = a;
                        }
                        if axis == 0 {
                            point[1] = a;
                        }
                        let Sample { value, gradient, .. } = problem.at(point);
                        let slope = gradient[axis] * end.signum();
                        let facts = (problem, point, value, slope);
                        assert!(value >= -1e-12 && slope >= -1e-7, "{facts:?}");
                        assert!(value.min(slope) <= 1e-9, "{facts:?}");
                        free += u32::from(value > 1e-9);
                    }
                }
            }
            let share = f64::from(free) / f64::from(POINTS * POINTS);
            let expected = match problem {
                CubeExact::FullContact => 0.0,
                CubeExact::FreeStrip => 0.42,
                CubeExact::FreeDisc => PI * 0.3618 * 0.3618,
            };
            assert!((share - expected).abs() < 0.01, "{problem:?} {share}");
        }
    }
}
