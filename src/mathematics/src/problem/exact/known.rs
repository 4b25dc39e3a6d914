//! The problems with known solutions of both dimensions, as texts name them.

use super::Exact;
use super::space::CubeExact;

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

    /// `f = -Laplacian v` at a point; NaN at one of another dimension.
    pub fn f(self, point: &[f64]) -> f64 {
        match (self, point) {
            (Self::Square(exact), &[x, y]) => exact.source(x, y),
            (Self::Cube(exact), &[x, y, z]) => exact.at([x, y, z]).f,
            _ => f64::NAN,
        }
    }
}
