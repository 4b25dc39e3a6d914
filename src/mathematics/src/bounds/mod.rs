//! Guaranteed two-sided bounds of the energy and of the error of a finite element solution: on meshes in
//! [`triangulation`], on the square in [`crate::square::bounds`].
//!
//! # The identity
//! On the square, let the [law](crate::problem::law) keep dv/dn in `[lo, hi]`, and let j(v) be the
//! largest of `-l v` over the l of this interval. Let K be the functions of H^1 where j(v) is finite on the boundary,
//! J(v) = 1/2 |grad v|^2 - (f, v) + the integral of j(v) over the boundary, and sigma a *flux*: `-div sigma = f`
//! inside, `sigma.n` in `[lo, hi]` on the boundary. For w in K integration by parts gives
//!
//! ```text
//! J(w) + 1/2 |sigma|^2 = 1/2 |grad w - sigma|^2 + <j(w) + sigma.n w> =: G(w, sigma),
//! ```
//!
//! where `< >` is the integral over the boundary, nowhere negative under it. Under the paper's law K has the functions
//! that are not negative on the boundary, and j is zero. The identity holds likewise with the solution u in place of w,
//! or its flux `grad u` in place of sigma. So J(u) lies between J(w) - G and J(w), is at most J(0) = 0, and
//! `1/2 |grad (u - v)|^2 <= J(v) - J(u)` for v in K, with equality where v vanishes on the part of the boundary that
//! sticks and has the sign of u on the others. No constant of Poincaré's or of the trace inequality appears, so the
//! bounds do not depend on the problem being only semicoercive. (Prager and Synge 1947; for Signorini's problem
//! Bartels, Gudi and Kaltenbach, arXiv 2407.10912.) Nothing is assumed of v: iteration errors, wrong loads and wrong
//! solutions make the bounds wide, not wrong.

mod accuracy;
pub(crate) mod boundary;
pub mod triangulation;

pub use accuracy::Accuracy;

use crate::problem::text::plain;
use crate::problem::unsolvable::Unsolvable;
use serde::{Deserialize, Serialize};

/// Guaranteed bounds for a finite element solution, up to the quadrature error of an f that is not piecewise constant.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Bounds {
    /// Ends of an interval that contains the energy J(u) of the true solution u.
    pub energy: [f64; 2],
    /// Ends of an interval that contains the energy norm of `u - v`, the root of the integral of `k |grad (u - v)|^2 +
    /// c (u - v)^2`, v piecewise linear: on the square on triangles cut by rising diagonals.
    pub error: [f64; 2],
    /// Lower bound of the energy norm of u; none where it follows from the energy, since all values of laws are 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gradient: Option<f64>,
    /// Upper bound of the L2 norm of `grad (u - w)`, w the recovery of v, which is piecewise quadratic; none on meshes,
    /// which have no recovery.
    pub recovered: Option<f64>,
    /// Size of the energy between the boundary of the mesh and the curve on which it lies, which the bounds leave out:
    /// an estimate; none without a curve, and in space.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub curve: Option<f64>,
}

impl Bounds {
    /// Upper bound of the error relative to the energy norm of u; infinite if the bounds do not exclude that this is 0,
    /// but zero if there is no error.
    pub fn relative(&self) -> f64 {
        ratio(self.error[1], self.size())
    }

    /// Lower bound of the energy norm of u.
    fn size(&self) -> f64 {
        // Its square is -2 J(u) under every law whose value is 0, since j(u) = -(du/dn) u on the boundary.
        self.gradient.unwrap_or_else(|| (-2.0 * self.energy[1]).max(0.0).sqrt())
    }

    /// Bounds that follow from an interval that contains the energy of the true solution u and that of v, where half
    /// the square of the error is at most its width.
    pub(crate) fn of_energy(energy: [f64; 2]) -> Self {
        let width = (energy[1] - energy[0]).max(0.0);
        Self { energy, error: [0.0, (2.0 * width).sqrt()], ..Self::NONE }
    }

    /// Bounds that say nothing.
    pub const NONE: Self = Self {
        energy: [f64::NEG_INFINITY, f64::INFINITY],
        error: [0.0, f64::INFINITY],
        gradient: None,
        recovered: None,
        curve: None,
    };

    /// Bounds that follow from these and others of the same solution.
    pub(crate) fn intersection(&self, other: &Self) -> Self {
        let common = |a: [f64; 2], b: [f64; 2]| [a[0].max(b[0]), a[1].min(b[1])];
        Self {
            energy: common(self.energy, other.energy),
            error: common(self.error, other.error),
            gradient: match (self.gradient, other.gradient) {
                (Some(a), Some(b)) => Some(a.max(b)),
                (a, b) => a.or(b),
            },
            recovered: match (self.recovered, other.recovered) {
                (Some(a), Some(b)) => Some(a.min(b)),
                (a, b) => a.or(b),
            },
            curve: self.curve.or(other.curve),
        }
    }

    /// Bounds widened by an energy between the polygon and the curve, which is half the square of an error there.
    fn with_curve(&self, energy: f64) -> Self {
        let ([low, high], [least, most]) = (self.energy, self.error);
        let error = [least, (most * most + 2.0 * energy).sqrt()];
        let gradient = self.gradient.map(|size| (size - (2.0 * energy).sqrt()).max(0.0));
        Self { energy: [low - energy, high], error, gradient, recovered: None, curve: None }
    }

    /// Width of the bracket of the energy over half the square of the energy norm of u, which is |J(u)| where all
    /// values of laws are 0; infinite if the bounds do not exclude that this is 0, but zero if there is no width.
    pub fn relative_energy(&self) -> f64 {
        let [low, high] = self.energy;
        // J(u) is at most zero without values.
        ratio(high - low, self.gradient.map_or(-high, |size| 0.5 * size * size))
    }

    /// The number of the bracket of the energy that is nearest to the energy of v; on the square mostly the upper end,
    /// which is the energy of the recovery.
    pub fn nearest_energy(&self, of_v: f64) -> f64 {
        of_v.max(self.energy[0]).min(self.energy[1])
    }
}

/// An error over a size, neither of them negative: without error zero, whatever the size.
fn ratio(error: f64, size: f64) -> f64 {
    if error == 0.0 {
        0.0
    } else if size > 0.0 {
        error / size
    } else {
        f64::INFINITY
    }
}

/// Reason for which there are no bounds.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum NoBound {
    /// No flux can balance f.
    #[error(transparent)]
    Unsolvable(#[from] Unsolvable),
    /// Rounding errors exceed the flux that is left to balance f.
    #[error("rounding errors exceed the flux that is left to balance f")]
    NotBalanced,
    /// The points at which f is sampled miss this part of the integral of |f|: the bounds would be those of another f.
    #[error("the points at which f is sampled miss {} of the integral of |f|", plain(*part, 2))]
    Missed {
        /// Part that is missed.
        part: f64,
    },
    /// A step of the proof does not apply to this true solution.
    #[error("what its proof needs was not found: {step}")]
    Unproved {
        /// The step.
        step: &'static str,
    },
    /// A sum overflows, squares underflow, or the vector or f contains a NaN.
    #[error("numbers exceed the range of double precision")]
    NotFinite,
}

/// Least integral of |f|, `sqrt(f64::MIN_POSITIVE / f64::EPSILON)`: below it, squares lose more by underflow than by
/// rounding.
pub(crate) const LEAST_MASS: f64 = 1e-146;

/// An interval that contains J(u), without the numbers above J(0) = 0, where all values of laws are 0.
pub(crate) fn below_zero([low, high]: [f64; 2]) -> [f64; 2] {
    [low, high.min(0.0)]
}

/// Square root, 0 for negative numbers.
pub(crate) fn root(square: f64) -> f64 {
    square.max(0.0).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bounds(energy: [f64; 2], most: f64) -> Bounds {
        Bounds { energy, error: [0.0, most], ..Bounds::NONE }
    }

    #[test]
    fn without_error_an_answer_is_exact_whatever_its_size() {
        let zero = bounds([0.0; 2], 0.0);
        assert_eq!([zero.relative(), zero.relative_energy()], [0.0; 2]);
        let poor = bounds([-1.0, 0.0], 1.0);
        assert_eq!([poor.relative(), poor.relative_energy()], [f64::INFINITY; 2]);
        let good = bounds([-0.5, -0.45], 0.03);
        assert!((good.relative() - 0.0316).abs() < 1e-4, "{}", good.relative());
        assert!((good.relative_energy() - 0.111).abs() < 1e-3, "{}", good.relative_energy());
        assert_eq!([-0.6, -0.47, -0.3].map(|of_v| good.nearest_energy(of_v)), [-0.5, -0.47, -0.45]);
    }
}
