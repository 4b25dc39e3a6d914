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
