//! Readings of the method: every choice the paper leaves open and the tables may decide.

use crate::discrete::load::{Diagonal, LoadRule};
use crate::discrete::transfer::Prolongation;
use crate::problem::source::Tie;
use crate::saddle::GradientMeasure;
pub use crate::saddle::batch::Order;
use serde::{Deserialize, Serialize};
use std::fmt;

/// Number compared with the tolerance in (13).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Measure {
    /// `max_i dM/dy_i`, no absolute value.
    #[default]
    Signed,
    /// `max_i |dM/dy_i|`, as printed.
    Printed,
}

impl Measure {
    pub(super) fn in_lanes(self) -> GradientMeasure {
        match self {
            Self::Signed => GradientMeasure::Signed,
            Self::Printed => GradientMeasure::Printed,
        }
    }
}

/// Multiplier at which the gradient in (13) is evaluated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ResidualTime {
    /// `a^(n)`, after the dual step (12), as printed.
    #[default]
    AfterDual,
    /// `a^(n-1)`, the one the sweep used.
    BeforeDual,
}

/// Weight of the multiplier terms in (7) at the four corners, in units of h; elsewhere it is h.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum DualWeight {
    /// h, as printed.
    #[default]
    Full,
    /// h / 2.
    Half,
    /// 2 h, as if each side of the square counted its own ends.
    Double,
}

/// One reading of the method. The default is the one both tables select.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields, default)]
pub struct Variant {
    /// Rule for the load vector, with the side from which f is taken on a jump.
    pub load: LoadRule,
    /// Weight of the multiplier at the corners.
    pub corner_multiplier: DualWeight,
    /// Order of the sweep.
    pub order: Order,
    /// Prolongation of y; it differs from rule to rule at cell centres only.
    pub prolongation: Prolongation,
    /// True if each grid but the first starts from the multiplier of the one before; else from zero.
    pub prolong_multiplier: bool,
    /// Number compared with the tolerance.
    pub measure: Measure,
    /// When the gradient is evaluated.
    pub residual: ResidualTime,
    /// Sweeps made on each grid before counting begins: 0 if the published n counts them all.
    pub uncounted: usize,
}

impl Default for Variant {
    fn default() -> Self {
        Self {
            load: LoadRule::Nodal { tie: Tie::LowerLeft, diagonal: Some(Diagonal::Rising) },
            corner_multiplier: DualWeight::default(),
            order: Order::default(),
            prolongation: Prolongation::default(),
            prolong_multiplier: true,
            measure: Measure::default(),
            residual: ResidualTime::default(),
            uncounted: 0,
        }
    }
}

const fn nodal(tie: Tie, diagonal: Option<Diagonal>) -> LoadRule {
    LoadRule::Nodal { tie, diagonal }
}

/// A choice that the default does not make, in words.
type Choice = (fn(&mut Variant), &'static str);

/// Every single choice. Where the sweep starts is none: for a space closed under the symmetries of the square another
/// corner only turns the picture, together with the side of the ties and the diagonal.
const CHOICES: [Choice; 17] = [
    (
        |v| v.load = nodal(Tie::LowerLeft, Some(Diagonal::Falling)),
        "nodal load, ties to the lower left, falling diagonal",
    ),
    (
        |v| v.load = nodal(Tie::LowerLeft, None),
        "nodal load, ties to the lower left, quarter weight at all corners",
    ),
    (
        |v| v.load = nodal(Tie::LowerRight, Some(Diagonal::Rising)),
        "nodal load, ties to the lower right, rising diagonal",
    ),
    (
        |v| v.load = nodal(Tie::UpperLeft, Some(Diagonal::Rising)),
        "nodal load, ties to the upper left, rising diagonal",
    ),
    (
        |v| v.load = nodal(Tie::UpperRight, Some(Diagonal::Rising)),
        "nodal load, ties to the upper right, rising diagonal",
    ),
    (|v| v.load = LoadRule::Exact { diagonal: Diagonal::Rising }, "exact load"),
    (|v| v.load = LoadRule::Exact { diagonal: Diagonal::Falling }, "exact load, falling diagonal"),
    (|v| v.corner_multiplier = DualWeight::Half, "half multiplier weight at corners"),
    (|v| v.corner_multiplier = DualWeight::Double, "double multiplier weight at corners"),
    (|v| v.order = Order::BoundaryFirst, "boundary swept first"),
    (|v| v.order = Order::InteriorFirst, "interior swept first"),
    (|v| v.prolongation = Prolongation::RisingDiagonal, "y prolonged along rising diagonals"),
    (|v| v.prolongation = Prolongation::FallingDiagonal, "y prolonged along falling diagonals"),
    (|v| v.prolong_multiplier = false, "multiplier restarted from zero"),
    (|v| v.measure = Measure::Printed, "absolute value in (13), as printed"),
    (|v| v.residual = ResidualTime::BeforeDual, "gradient before the dual step"),
    (|v| v.uncounted = 1, "first sweep on each grid not counted"),
];

impl Variant {
    /// The default and every variant that differs from it in one choice, each once.
    pub fn neighbours() -> Vec<Self> {
        let chosen = CHOICES.iter().map(|(choose, _)| Self::default().with(*choose));
        std::iter::once(Self::default()).chain(chosen).collect()
    }

    fn with(mut self, choose: fn(&mut Self)) -> Self {
        choose(&mut self);
        self
    }

    /// Multiplier weight at a corner in units of h.
    pub(super) fn corner_weight(&self) -> f64 {
        match self.corner_multiplier {
            DualWeight::Full => 1.0,
            DualWeight::Half => 0.5,
            DualWeight::Double => 2.0,
        }
    }
}

/// The choices in which the variant differs from the default, or "as selected".
impl fmt::Display for Variant {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (mut words, mut rest) = (Vec::new(), Self::default());
        for (choose, text) in CHOICES.into_iter().filter(|(choose, _)| self.with(*choose) == *self)
        {
            words.push(text);
            choose(&mut rest);
        }
        if rest != *self {
            words.push("a choice without a name");
        }
        out.write_str(&if words.is_empty() { "as selected".into() } else { words.join("; ") })
    }
}
