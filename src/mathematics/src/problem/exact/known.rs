//! The problems with known solutions of both dimensions, as texts name them.

use super::Exact;
use super::space::CubeExact;
use crate::problem::field::Sample;

/// Problem with a known solution.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Known {
    /// On the square.
    Square(Exact),
    /// On the cube.
    Cube(CubeExact),
}

impl Known {
    /// All problems in this dimension.
    pub fn all(dimension: usize) -> Vec<Self> {
        match dimension {
            2 => Exact::ALL.map(Self::Square).into(),
            _ => CubeExact::ALL.map(Self::Cube).into(),
        }
    }

    /// The name used in `exact(name)`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Square(exact) => exact.name(),
            Self::Cube(exact) => exact.name(),
        }
    }

    /// The solution at a point of the closed square or cube; not a number at one of another dimension.
    pub fn sample<const D: usize>(self, point: [f64; D]) -> Sample<D> {
        let (value, gradient, f) = match (self, &point[..]) {
            (Self::Square(exact), &[x, y]) => {
                let Sample { value, gradient: [along, up], f } = exact.at(x, y);
                (value, [along, up, 0.0], f)
            }
            (Self::Cube(exact), &[x, y, z]) => {
                let Sample { value, gradient, f } = exact.at([x, y, z]);
                (value, gradient, f)
            }
            _ => (f64::NAN, [f64::NAN; 3], f64::NAN),
        };
        Sample { value, gradient: std::array::from_fn(|axis| gradient[axis]), f }
    }

    /// `f = -Laplacian v` at a point; NaN at one of another dimension.
    pub fn f(self, point: &[f64]) -> f64 {
        match (self, point) {
            (Self::Square(exact), &[x, y]) => exact.source(x, y),
            (Self::Cube(exact), &[x, y, z]) => exact.source([x, y, z]),
            _ => f64::NAN,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::array::from_fn;

    /// Compares gradients and f with differences of values.
    fn derivatives_match<const D: usize>(digits: f64) {
        const STEP: f64 = 1e-3;
        let points = 7_i32.pow(D as u32);
        for (known, number) in
            Known::all(D).into_iter().flat_map(|of| (0..points).map(move |k| (of, k)))
        {
            // Inside, away from the ends of contact, where the fourth derivatives stay moderate.
            let place = [number % 7, number / 7 % 7, number / 49];
            let shifts = [0.49, 0.48, 0.51];
            let point: [f64; D] = from_fn(|axis| f64::from(1 + place[axis]) / 8.0 - shifts[axis]);
            let Sample { value, gradient, f } = known.sample(point);
            assert_eq!(known.f(&point), f);
            let mut laplacian = 0.0;
            for axis in 0..D {
                let [after, before] = [STEP, -STEP].map(|step| {
                    let mut moved = point;
                    moved[axis] += step;
                    known.sample(moved).value
                });
                laplacian += (after + before - 2.0 * value) / (STEP * STEP);
                let slope = (after - before) / (2.0 * STEP);
                assert!((gradient[axis] - slope).abs() < 1e-3, "{known:?} {point:?} {slope}");
            }
            let apart = (f + laplacian).abs();
            assert!(apart < digits * (1.0 + f.abs()), "{known:?} {point:?} {f} {laplacian}");
        }
    }

    #[test]
    fn derivatives_are_limits_of_differences() {
        derivatives_match::<2>(2e-3);
        derivatives_match::<3>(5e-3);
    }
}
