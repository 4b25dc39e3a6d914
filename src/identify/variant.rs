//! Readings of the method: every choice the paper leaves open and the tables may decide.

use crate::discrete::load::{Diagonal, LoadRule};
use crate::discrete::transfer::Prolongation;
use crate::problem::source::Tie;
use crate::saddle::batch;
pub use crate::saddle::batch::Order;
use serde::{Deserialize, Serialize};
use std::fmt;

/// Corner of the square from which the sweep starts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Start {
    /// x and y increase.
    #[default]
    LowerLeft,
    /// x decreases, y increases.
    LowerRight,
    /// x increases, y decreases.
    UpperLeft,
    /// x and y decrease.
    UpperRight,
}

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
    pub(super) fn in_lanes(self) -> batch::Measure {
        match self {
            Self::Signed => batch::Measure::Signed,
            Self::Printed => batch::Measure::Printed,
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
    /// Corner where the sweep starts.
    pub start: Start,
    /// Prolongation of y; it differs from rule to rule at cell centres only.
    pub prolongation: Prolongation,
    /// Whether each grid but the first starts from the multiplier of the one before, or from zero.
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
            start: Start::default(),
            prolongation: Prolongation::default(),
            prolong_multiplier: true,
            measure: Measure::default(),
            residual: ResidualTime::default(),
            uncounted: 0,
        }
    }
}

impl Variant {
    /// The default and every variant that differs from it in one choice, each once.
    ///
    /// Starting corners are left out: for a space closed under the symmetries of the square they
    /// only turn the picture, together with the side of the ties and the diagonal.
    pub fn neighbours() -> Vec<Self> {
        let base = Self::default();
        let tie = Tie::LowerLeft;
        let nodal = |tie, diagonal| LoadRule::Nodal { tie, diagonal };
        let loads = [
            nodal(tie, Some(Diagonal::Falling)),
            nodal(tie, None),
            nodal(Tie::LowerRight, Some(Diagonal::Rising)),
            nodal(Tie::UpperLeft, Some(Diagonal::Rising)),
            nodal(Tie::UpperRight, Some(Diagonal::Rising)),
            LoadRule::LumpedAverage,
            LoadRule::Exact { diagonal: Diagonal::Rising },
            LoadRule::Exact { diagonal: Diagonal::Falling },
        ];
        let mut all = vec![base];
        all.extend(loads.map(|load| Self { load, ..base }));
        all.extend(
            [DualWeight::Half, DualWeight::Double].map(|w| Self { corner_multiplier: w, ..base }),
        );
        all.extend(
            [Order::BoundaryFirst, Order::InteriorFirst].map(|order| Self { order, ..base }),
        );
        all.extend(
            [Prolongation::RisingDiagonal, Prolongation::FallingDiagonal]
                .map(|prolongation| Self { prolongation, ..base }),
        );
        all.push(Self { prolong_multiplier: false, ..base });
        all.push(Self { measure: Measure::Printed, ..base });
        all.push(Self { residual: ResidualTime::BeforeDual, ..base });
        all.push(Self { uncounted: 1, ..base });
        all
    }

    /// Whether the sweep runs against x, and against y.
    pub(super) fn mirrored(&self) -> (bool, bool) {
        match self.start {
            Start::LowerLeft => (false, false),
            Start::LowerRight => (true, false),
            Start::UpperLeft => (false, true),
            Start::UpperRight => (true, true),
        }
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
        let base = Self::default();
        let mut parts = Vec::new();
        if self.load != base.load {
            parts.push(match self.load {
                LoadRule::Nodal { tie, diagonal } => {
                    let side = match tie {
                        Tie::LowerLeft => "lower left",
                        Tie::LowerRight => "lower right",
                        Tie::UpperLeft => "upper left",
                        Tie::UpperRight => "upper right",
                    };
                    let corners = match diagonal {
                        Some(Diagonal::Rising) => "rising diagonal",
                        Some(Diagonal::Falling) => "falling diagonal",
                        None => "quarter weight at all corners",
                    };
                    format!("nodal load, ties to the {side}, {corners}")
                }
                LoadRule::Exact { diagonal: Diagonal::Rising } => "exact load".into(),
                LoadRule::Exact { diagonal: Diagonal::Falling } => {
                    "exact load, falling diagonal".into()
                }
                LoadRule::LumpedAverage => "load averaged on the jumps".into(),
            });
        }
        let mut note = |differs: bool, text: &str| {
            if differs {
                parts.push(text.into());
            }
        };
        note(self.corner_multiplier == DualWeight::Half, "half multiplier weight at corners");
        note(self.corner_multiplier == DualWeight::Double, "double multiplier weight at corners");
        note(self.order == Order::BoundaryFirst, "boundary swept first");
        note(self.order == Order::InteriorFirst, "interior swept first");
        note(self.start == Start::LowerRight, "sweep from the lower right");
        note(self.start == Start::UpperLeft, "sweep from the upper left");
        note(self.start == Start::UpperRight, "sweep from the upper right");
        let diagonal = |rule| self.prolongation == rule;
        note(diagonal(Prolongation::RisingDiagonal), "y prolonged along rising diagonals");
        note(diagonal(Prolongation::FallingDiagonal), "y prolonged along falling diagonals");
        note(!self.prolong_multiplier, "multiplier restarted from zero");
        note(self.measure == Measure::Printed, "absolute value in (13), as printed");
        note(self.residual == ResidualTime::BeforeDual, "gradient before the dual step");
        if self.uncounted == 1 {
            parts.push("first sweep on each grid not counted".into());
        } else if self.uncounted > 1 {
            parts.push(format!("{} sweeps not counted", self.uncounted));
        }
        if parts.is_empty() {
            return out.write_str("as selected");
        }
        out.write_str(&parts.join("; "))
    }
}
