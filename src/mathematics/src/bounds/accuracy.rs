//! Accuracy that is asked for: the largest value that a guaranteed bound may have.

use super::Bounds;
use crate::problem::text::{Written, percent};
use serde::{Deserialize, Serialize};
use std::fmt;

/// Largest value that a guaranteed bound may have.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Accuracy {
    /// Error in the energy norm, relative to that of the solution.
    #[serde(rename = "accuracy")]
    Error(f64),
    /// Width of the bracket of the energy, relative to the energy.
    #[serde(rename = "accuracy_energy")]
    Energy(f64),
}

impl fmt::Display for Accuracy {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let of = if matches!(self, Self::Energy(_)) { " of the energy" } else { "" };
        write!(out, "accuracy{of} {}", Written(self.wanted()))
    }
}

impl Accuracy {
    /// Largest value.
    pub fn wanted(self) -> f64 {
        let (Self::Error(wanted) | Self::Energy(wanted)) = self;
        wanted
    }

    /// Value of the bound and, on a curved domain, of the estimate of what it leaves out beside the polygon.
    pub fn reached(self, bounds: &Bounds) -> f64 {
        let with_curve = bounds.curve.map(|curve| bounds.with_curve(curve));
        let bounds = with_curve.as_ref().unwrap_or(bounds);
        match self {
            Self::Error(_) => bounds.relative(),
            Self::Energy(_) => bounds.relative_energy(),
        }
    }

    /// Value of the bound, in words.
    pub fn in_words(self, reached: f64) -> String {
        let percent = percent(reached, 3);
        match self {
            _ if !reached.is_finite() => "error not below the solution".into(),
            Self::Error(_) => format!("error at most {percent}"),
            Self::Energy(_) => format!("error of the energy at most {percent}"),
        }
    }

    /// The bound over the largest value.
    pub fn excess(self, bounds: &Bounds) -> f64 {
        self.reached(bounds) / self.wanted()
    }

    /// Square of the error that is allowed over the present one; zero while the bounds do not tell.
    pub(crate) fn square_left(self, bounds: &Bounds) -> f64 {
        let excess = self.excess(bounds);
        match self {
            Self::Error(_) => 1.0 / (excess * excess),
            Self::Energy(_) => 1.0 / excess,
        }
    }

    /// Relative error in the energy norm that is allowed, whose square is that of the energy.
    pub fn error(self) -> f64 {
        match self {
            Self::Error(wanted) => wanted,
            Self::Energy(wanted) => wanted.sqrt(),
        }
    }

    /// Order of the bound on the square: the power of the width of the grid that is proportional to it.
    pub(crate) fn order(self) -> f64 {
        match self {
            Self::Error(_) => 1.0,
            Self::Energy(_) => 3.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_energy_beside_the_polygon_counts_in_both_goals() {
        let polygon = Bounds { energy: [-1.01, -1.0], error: [0.0, 0.1], ..Bounds::NONE };
        let domain = Bounds { curve: Some(0.02), ..polygon.clone() };
        let reached = |bounds: &Bounds| {
            [Accuracy::Energy(1.0), Accuracy::Error(1.0)].map(|goal| goal.reached(bounds))
        };
        let [[energy, error], [energy_on_domain, error_on_domain]] =
            [&polygon, &domain].map(reached);
        assert!((energy - 0.01).abs() < 1e-12 && (error - 0.1 / 2f64.sqrt()).abs() < 1e-12);
        assert!((energy_on_domain - 0.03).abs() < 1e-12);
        assert!((error_on_domain - 0.025f64.sqrt()).abs() < 1e-12);
    }
}
