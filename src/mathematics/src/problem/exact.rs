//! Signorini problems with known solutions.
//!
//! All live on [-1/2, 1/2]^2 and satisfy `v >= 0`, `dv/dn >= 0`, `v dv/dn = 0` on the boundary exactly.
//! At the ends of contact `v` behaves like `Im z^(3/2)`, the generic singularity of the problem. Only
//! arithmetic, square roots and functions of the `libm` crate are used, so that the numbers are the
//! same on all machines.

mod known;
mod space;
mod torsion;

pub use known::Known;
pub use space::CubeExact;

use super::choices::choices;
use super::complex::Complex;
use super::field::{Field, bump, falling, hill, product};
use crate::machine::simd::vectorised;
use std::f64::consts::PI;

/// The problems with known solutions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Exact {
    /// Contact on the whole boundary: `v = -cos(pi x) cos(pi y)`.
    FullContact,
    /// Contact on the whole boundary under a constant load `f = -1`: minus the torsion function.
    Torsion,
    /// Free on (-0.23, 0.19) of the bottom side, in contact elsewhere.
    FreeSegment,
    /// Free around the corner (-1/2, -1/2): on 0.41 of the bottom side and 0.27 of the left one.
    FreeCorner,
}

/// The solution at a point.
pub use super::field::Sample;

choices!(Exact, 4:
    FullContact = "full-contact", Torsion = "torsion",
    FreeSegment = "free-segment", FreeCorner = "free-corner",
);

impl Exact {
    /// v as LaTeX.
    pub fn latex(self) -> &'static str {
        match self {
            Self::FullContact => r"v = -\cos \pi x \, \cos \pi y",
            Self::Torsion => r"-v = \text{the torsion function of the square}",
            Self::FreeSegment => {
                concat!(
                    r"v = -(1 - 4 x^2) \left\{ (1 - t^2) \, \operatorname{Im} [(z - a)(z - b)]^{3/2}",
                    r" + 4 t^2 (1 - t) \right\}, \; t = y + \tfrac12, \; z = x + i t"
                )
            }
            Self::FreeCorner => {
                concat!(
                    r"v = -(1 - X^2)(1 - Y^2) \operatorname{Im} [(\zeta + b^2)(\zeta - a^2)]^{3/2}",
                    r" - 60 X^2 (1 - X) Y^2 (1 - Y), \; \zeta = (X + i Y)^2"
                )
            }
        }
    }

    /// The solution at a point of the closed square.
    pub fn at(self, x: f64, y: f64) -> Sample {
        let mut sample = None;
        self.in_row(&[self.along(x)], self.along(y), |_, at| sample = Some(at));
        sample.expect("a point")
    }

    /// Function of one coordinate on which the solution depends.
    pub(crate) fn along(self, at: f64) -> Coordinate {
        let (sin, cos) = match self {
            Self::FullContact | Self::Torsion => libm::sincos(PI * at),
            Self::FreeSegment | Self::FreeCorner => (f64::NAN, f64::NAN),
        };
        let decay = match self {
            Self::Torsion => [libm::exp(PI * (at - 0.5)), libm::exp(PI * (-at - 0.5))],
            _ => [f64::NAN; 2],
        };
        Coordinate { at, sin, cos, decay }
    }

    /// Notes the solution at points with the same y, with the place of each in `x`.
    ///
    /// Always inlined, so that the caller decides for which instructions it is compiled.
    #[inline(always)]
    pub(crate) fn in_row(
        self,
        x: &[Coordinate],
        y: Coordinate,
        mut note: impl FnMut(usize, Sample),
    ) {
        match self {
            Self::FullContact => {
                for (i, x) in x.iter().enumerate() {
                    note(i, full_contact(x, &y));
                }
            }
            Self::Torsion => torsion::in_row(x, &y, note),
            Self::FreeSegment => {
                for (i, x) in x.iter().enumerate() {
                    note(i, free_segment(x.at, y.at));
                }
            }
            Self::FreeCorner => {
                for (i, x) in x.iter().enumerate() {
                    note(i, free_corner(x.at, y.at));
                }
            }
        }
    }

    /// `f = -Laplacian v` alone, which for the torsion function needs no series.
    pub fn source(self, x: f64, y: f64) -> f64 {
        match self {
            Self::Torsion => -1.0,
            _ => self.at(x, y).f,
        }
    }

    /// Writes [`Exact::source`] at points with the same y.
    pub(super) fn sources_in_row(self, x: &[f64], y: f64, values: &mut [f64]) {
        if self == Self::Torsion {
            values.fill(-1.0);
            return;
        }
        let x: Vec<_> = x.iter().map(|&x| self.along(x)).collect();
        vectorised(
            #[inline(always)]
            || self.in_row(&x, self.along(y), |i, sample| values[i] = sample.f),
        );
    }

    /// Multiplier `dv/dn` on the side whose outer normal is `normal`, at a point of it.
    pub fn multiplier(self, [x, y]: [f64; 2], normal: [f64; 2]) -> f64 {
        let [gx, gy] = self.at(x, y).gradient;
        gx * normal[0] + gy * normal[1]
    }
}

/// A coordinate of a point, and the functions of it from which some solutions are made; NaN in the others.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Coordinate {
    at: f64,
    sin: f64,
    cos: f64,
    /// `exp(pi (s - 1/2))` and `exp(pi (-s - 1/2))`.
    decay: [f64; 2],
}

#[inline(always)]
fn full_contact(x: &Coordinate, y: &Coordinate) -> Sample {
    let value = -x.cos * y.cos;
    let gradient = [PI * x.sin * y.cos, PI * x.cos * y.sin];
    Sample { value, gradient, f: 2.0 * PI * PI * value }
}

/// `v = (1 - 4 x^2) (1 - t^2) psi - A (1 - 4 x^2) t^2 (1 - t)`, `psi = -Im ((z - a) (z - b))^(3/2)`.
#[inline(always)]
fn free_segment(x: f64, y: f64) -> Sample {
    const AMPLITUDE: f64 = 4.0;
    let t = y + 0.5;
    let load = product([hill(x), bump(t)]).scaled(AMPLITUDE);
    product([hill(x), falling(t)]).times(segment(x, t)).minus(load).into()
}

/// The harmonic function `-Im ((z - a) (z - b))^(3/2)`, `z = x + i t`, which on
/// `t = 0` is positive between `a = -0.23` and `b = 0.19`, without slope there, and zero elsewhere.
#[inline(always)]
fn segment(x: f64, t: f64) -> Field<2> {
    const LEFT: f64 = -0.23;
    const RIGHT: f64 = 0.19;
    let z = Complex::new(x, t);
    let (from_left, from_right) = (z.shifted(-LEFT), z.shifted(-RIGHT));
    let root = from_left.sqrt() * from_right.sqrt();
    let derivative = (root * (from_left + from_right)).scaled(1.5);
    harmonic(root.cubed(), derivative)
}

/// `v = (1 - X^2) (1 - Y^2) psi - A X^2 (1 - X) Y^2 (1 - Y)`, with
/// `psi = -Im ((zeta + b^2) (zeta - a^2))^(3/2)`, `zeta = (X + i Y)^2`.
#[inline(always)]
fn free_corner(x: f64, y: f64) -> Sample {
    const ALONG_X: f64 = 0.41;
    const ALONG_Y: f64 = 0.27;
    const AMPLITUDE: f64 = 60.0;
    let (x, y) = (x + 0.5, y + 0.5);
    let z = Complex::new(x, y);
    let zeta = z * z;
    let (from_y, from_x) = (zeta.shifted(ALONG_Y * ALONG_Y), zeta.shifted(-ALONG_X * ALONG_X));
    let root = from_y.sqrt() * from_x.sqrt();
    // d zeta / dz = 2 z.
    let derivative = (root * (from_y + from_x) * z).scaled(3.0);
    let psi = harmonic(root.cubed(), derivative);
    let load = product([bump(x), bump(y)]).scaled(AMPLITUDE);
    product([falling(x), falling(y)]).times(psi).minus(load).into()
}

/// `-Im` of an analytic function.
#[inline(always)]
fn harmonic(analytic: Complex, derivative: Complex) -> Field<2> {
    Field { value: -analytic.im, gradient: [-derivative.im, -derivative.re], laplacian: 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sources_in_a_row_are_those_at_its_points_to_the_last_bit() {
        let x: Vec<f64> = (0..101).map(|i| f64::from(i) / 100.0 - 0.5).collect();
        for (problem, y) in Exact::ALL.into_iter().flat_map(|of| [(of, -0.5), (of, 0.137)]) {
            let mut values = vec![f64::NAN; x.len()];
            problem.sources_in_row(&x, y, &mut values);
            let alone: Vec<_> = x.iter().map(|&x| problem.source(x, y)).collect();
            assert_eq!(values, alone, "{problem:?}");
        }
    }

    #[test]
    fn ends_of_contact_are_reached_without_a_jump() {
        let (corner, segment) = (Exact::FreeCorner, Exact::FreeSegment);
        for (problem, x, y) in [
            (segment, -0.23, -0.5),
            (segment, 0.19, -0.5),
            (corner, -0.09, -0.5),
            (corner, -0.5, -0.23),
        ] {
            let all = |Sample { value, gradient: [gx, gy], f }: Sample| [value, gx, gy, f];
            // The gradient changes like the root of the distance.
            let beside = all(problem.at(x + 1e-10, y + 1e-10));
            for (here, beside) in all(problem.at(x, y)).into_iter().zip(beside) {
                let apart = (here - beside).abs();
                assert!(apart < 1e-3 * (1.0 + beside.abs()), "{problem:?} {here} {beside}");
            }
        }
    }

    #[test]
    fn boundary_conditions_hold() {
        const POINTS: u32 = 2000;
        for problem in Exact::ALL {
            for k in 1..POINTS {
                let s = f64::from(k) / f64::from(POINTS) - 0.5;
                let sides = [
                    (s, -0.5, [0.0, -1.0]),
                    (0.5, s, [1.0, 0.0]),
                    (s, 0.5, [0.0, 1.0]),
                    (-0.5, s, [-1.0, 0.0]),
                ];
                for (x, y, normal) in sides {
                    let (value, slope) =
                        (problem.at(x, y).value, problem.multiplier([x, y], normal));
                    assert!(
                        value >= -1e-12 && slope >= -1e-4,
                        "{problem:?} {x} {y} {value} {slope}"
                    );
                    assert!(value.min(slope) <= 1e-12, "{problem:?} {x} {y} {value} {slope}");
                }
            }
        }
    }

    #[test]
    fn free_parts_are_where_they_are_said_to_be() {
        let free = |problem: Exact, x, y| problem.at(x, y).value > 1e-9;
        let segment = Exact::FreeSegment;
        assert!(free(segment, -0.22, -0.5) && free(segment, 0.18, -0.5));
        assert!(!free(segment, -0.24, -0.5) && !free(segment, 0.20, -0.5));
        let corner = Exact::FreeCorner;
        assert!(free(corner, -0.10, -0.5) && free(corner, -0.5, -0.24) && free(corner, -0.5, -0.5));
        assert!(!free(corner, -0.08, -0.5) && !free(corner, -0.5, -0.22));
    }
}
