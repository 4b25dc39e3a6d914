//! Bounds of psi and of its derivatives at a point.

use std::ops::Add;

/// Bounds at a point: of psi, of its gradient, and of the change of that over the change of the point, of jumps alone;
/// or of their rounding errors.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct PsiSizes {
    pub value: f64,
    pub slope: f64,
    pub bend: f64,
}

impl PsiSizes {
    /// Rounding errors of numbers with these sizes.
    pub(crate) fn rounded(self, units: f64) -> Self {
        let units = units * f64::EPSILON;
        Self { value: units * self.value, slope: units * self.slope, ..self }
    }
}

impl Add for PsiSizes {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        let Self { value, slope, bend } = other;
        Self { value: self.value + value, slope: self.slope + slope, bend: self.bend + bend }
    }
}
