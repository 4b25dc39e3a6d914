//! Stopping rules: criterion (13) as printed, without its absolute value as in the tables, and each with a dual bound;
//! and the rounding errors below which no rule is met.

use crate::discrete::grid::Grid;
use crate::discrete::network::Network;
use crate::discrete::norms::{largest, worst};
use crate::problem::choices::choices;
use serde::{Deserialize, Serialize};
use std::fmt;

/// Measure of the gradient (8), evaluated at (y^(n), a^(n)), that must fall below the tolerance.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum StopRule {
    /// `max_i dM/dy_i`, without absolute value: the rule that reproduces the published counts.
    #[default]
    Signed,
    /// `max_i |dM/dy_i|`: (13) as printed.
    Printed,
    /// The signed rule, and `max_i |a_i^(n) - a_i^(n-1)|` below the tolerance as well.
    SignedDual,
    /// The printed rule, and the change of the multiplier below the tolerance as well.
    PrintedDual,
}

choices!(StopRule, 4:
    Signed = "signed", Printed = "printed",
    SignedDual = "signed-dual", PrintedDual = "printed-dual",
);

impl StopRule {
    /// Measure that a rule compares with the tolerance.
    pub(super) fn measure(self) -> GradientMeasure {
        match self {
            Self::Signed | Self::SignedDual => GradientMeasure::Signed,
            Self::Printed | Self::PrintedDual => GradientMeasure::Printed,
        }
    }

    /// True if the change of the multiplier is compared with the tolerance as well.
    pub(super) fn asks_dual(self) -> bool {
        matches!(self, Self::SignedDual | Self::PrintedDual)
    }
}

impl fmt::Display for StopRule {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(self.name())
    }
}

/// Measure at a node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum GradientMeasure {
    /// Component of the gradient (8).
    Signed,
    /// Absolute value of this component.
    Printed,
    /// Absolute value of the component of the inner problem's gradient, which has the proximal term.
    Inner,
    /// `|A y - F|` inside, the law's natural residual on the boundary.
    Kkt,
}

impl GradientMeasure {
    /// All measures.
    pub(crate) const ALL: [Self; 4] = [Self::Signed, Self::Printed, Self::Inner, Self::Kkt];

    /// Measure of a component of the gradient.
    #[inline(always)]
    pub(super) fn of(self, component: f64) -> f64 {
        if self == Self::Signed { component } else { component.abs() }
    }
}

/// Sweeps of Uzawa's method after which the rounding errors of the gradient are estimated again.
pub(super) const SWEEPS_TO_FLOOR: usize = 64;

/// Sizes of the terms of a gradient (8), from which its rounding errors follow.
#[derive(Clone, Copy, Debug)]
pub(super) struct GradientTerms {
    /// Twice the largest diagonal entry of the matrix, with the proximal term and r times the measure of the boundary
    /// at a node: factor of the largest |y|.
    pub(super) matrix: f64,
    /// Largest measure of the boundary at a node, factor of the largest multiplier.
    pub(super) most_measure: f64,
    /// Least measure of the boundary at a node.
    pub(super) least_measure: f64,
}

/// Bounds below which the measures of a stopping rule are rounding errors; zero until they are estimated.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct RoundingFloor {
    /// Bound of the components of the gradient.
    pub(super) gradient: f64,
    /// Bound of the changes of the multiplier.
    pub(super) dual: f64,
}

impl GradientTerms {
    /// Terms on the square, for the proximal term's share of an interior node.
    pub(super) fn on_square(grid: Grid, shift: f64, r: f64) -> Self {
        let h = grid.h();
        Self { matrix: 8.0 + shift + h * r, most_measure: h, least_measure: h }
    }

    /// Terms on a network, whose matrix has the proximal term.
    pub(super) fn on_network(network: &Network, r: f64) -> Self {
        let measures = || network.contact().iter().map(|contact| contact.measure);
        let most_measure = measures().fold(0.0, f64::max);
        Self {
            matrix: 2.0 * largest(network.diagonal()) + most_measure * r,
            most_measure,
            least_measure: measures().fold(f64::INFINITY, f64::min),
        }
    }

    /// Rounding errors where the entries of the load vector, of y and of a have these sizes.
    ///
    /// Sweeps do not end in a pair without gradient, but go round among pairs that differ in their last bits.
    pub(super) fn floor(&self, [load, y, a]: [f64; 3]) -> RoundingFloor {
        /// Roundings of an entry, each at most half of `EPSILON`.
        const ROUNDINGS: f64 = 4.0;
        let terms = self.matrix * y + load + self.most_measure * a;
        let gradient = ROUNDINGS * f64::EPSILON * terms;
        RoundingFloor { gradient, dual: gradient / self.least_measure }
    }
}

/// Largest absolute value of an entry, NaN if one is.
pub(super) fn size(vector: &[f64]) -> f64 {
    worst(vector.iter().copied())
}
