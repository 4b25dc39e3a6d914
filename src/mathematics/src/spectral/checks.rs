//! Checks of a solution.

use super::contact::{MULTIPLIER_TOLERANCE, VALUE_TOLERANCE};
use crate::problem::text::plain;
use std::fmt;

/// Conditions that must hold of a solution and were not used to find it.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Checks {
    /// Least multiplier in contact over the largest; gaps of less than 1e-4 round corners are left out.
    pub least_multiplier: f64,
    /// Least v on the boundary elsewhere over the size of v and psi.
    pub least_value: f64,
    /// Green's identity: the total force plus the integral of f, over the latter.
    pub green: f64,
    /// Energy by Rellich's identity less the energy, over the latter.
    pub rellich: f64,
    /// Largest difference of moments of f by the potential or by the jumps from those in closed form: times
    /// the size of v, over the energy. A change df of f changes the energy by the integral of -df v, to first order.
    pub moments: f64,
    /// Energy at the resolution before less the energy, over the latter; none at the first resolution.
    pub resolution: Option<f64>,
}

impl Checks {
    /// True if signs hold up to what is left out, f is represented to eleven digits, and what else is to be zero is to
    /// eight.
    pub(super) fn pass(&self) -> bool {
        /// Bound of the moments: the energy has twelve digits, mostly fourteen, and so have moments in closed form.
        const MOMENTS: f64 = 1e-11;
        self.least_multiplier >= -MULTIPLIER_TOLERANCE
            && self.least_value >= -VALUE_TOLERANCE
            && self.moments < MOMENTS
            && [self.green, self.rellich, self.resolution.unwrap_or(0.0)]
                .iter()
                .all(|zero| zero.abs() < 1e-8)
    }
}

impl fmt::Display for Checks {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { least_multiplier, least_value, green, rellich, moments, resolution } = self;
        write!(
            out,
            "least multiplier {}, least value {}, Green {green:.1e}, Rellich {rellich:.1e}, moments {moments:.1e}",
            plain(*least_multiplier, 2),
            plain(*least_value, 2)
        )?;
        resolution.map_or(Ok(()), |resolution| write!(out, ", two resolutions {resolution:.1e}"))
    }
}
