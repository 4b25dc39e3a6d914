//! Rules for the load vector (6) of the square.

use crate::problem::choices::choices;
use crate::problem::source::Tie;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;

/// Quadrature of the load vector.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", tag = "rule", deny_unknown_fields)]
#[serde(expecting = "a table such as { rule = \"exact\" }")]
// Braces without fields: serde then refuses fields that mean nothing.
pub enum LoadRule {
    /// `F_i = f(M_i)` times the integral of the i-th hat function; a tie rule decides on jumps.
    ///
    /// The integral is `h^2` inside, `h^2 / 2` on edges, and at a corner `h^2 / 6` for each triangle
    /// there. Without a diagonal it is replaced by the trapezoidal weight `h^2 / 4` at all corners.
    Nodal {
        /// Side from which f is taken at a node on a jump.
        #[serde(default)]
        tie: Tie,
        /// Diagonals that cut the squares into triangles; the usual one unless it is named, as in options.
        #[serde(default = "usual_diagonal", with = "diagonal_or_none")]
        diagonal: Option<Diagonal>,
    },
    /// The integral itself: exact for constant pieces, degree 5 quadrature for smooth f.
    Exact {
        /// Diagonals that cut the squares into triangles.
        #[serde(default)]
        diagonal: Diagonal,
    },
    /// The integral of f times the hat function that is bilinear on squares, which those on triangles
    /// cut by either diagonal only approximate: exact for constant pieces, degree 5 quadrature for
    /// smooth f. The bounds of [`crate::bounds`] are sharpest for it.
    Bilinear {},
}

/// The diagonal that cuts each square of the grid into two triangles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Diagonal {
    /// From lower left to upper right.
    #[default]
    Rising,
    /// From upper left to lower right.
    Falling,
}

impl Default for LoadRule {
    fn default() -> Self {
        Self::Nodal { tie: Tie::default(), diagonal: Some(Diagonal::default()) }
    }
}

impl LoadRule {
    /// All rules, with the usual sides and diagonals.
    pub const ALL: [Self; 3] = [
        Self::Nodal { tie: Tie::LowerLeft, diagonal: Some(Diagonal::Rising) },
        Self::Exact { diagonal: Diagonal::Rising },
        Self::Bilinear {},
    ];

    /// Name, without sides and diagonals.
    pub fn name(self) -> &'static str {
        match self {
            Self::Nodal { .. } => "nodal",
            Self::Exact { .. } => "exact",
            Self::Bilinear {} => "bilinear",
        }
    }

    /// Description in the help.
    pub fn description(self) -> &'static str {
        match self {
            Self::Nodal { .. } => "f at the nodes; on a jump from the left and below",
            Self::Exact { .. } => "Integrals of f times the hat functions",
            Self::Bilinear {} => {
                "Integrals of f times bilinear hat functions: bounds are closer than with exact"
            }
        }
    }
}

/// Writes the name and, where they are not the usual ones, the side of a tie and the diagonal.
impl fmt::Display for LoadRule {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(self.name())?;
        if Self::ALL.contains(self) {
            return Ok(());
        }
        match *self {
            Self::Nodal { tie, diagonal } => {
                let diagonal = diagonal.map_or(NO_DIAGONAL, Diagonal::name);
                write!(out, ",{},{diagonal}", tie.name())
            }
            Self::Exact { diagonal } => write!(out, ",{}", diagonal.name()),
            Self::Bilinear {} => Ok(()),
        }
    }
}

/// Word for a nodal rule that cuts no squares.
const NO_DIAGONAL: &str = "none";

/// The diagonal of a nodal rule that names none.
#[expect(clippy::unnecessary_wraps, reason = "the field has an option")]
fn usual_diagonal() -> Option<Diagonal> {
    Some(Diagonal::default())
}

/// A diagonal by its name, or [`NO_DIAGONAL`].
mod diagonal_or_none {
    use super::{Diagonal, NO_DIAGONAL};
    use serde::{Deserialize, Deserializer, Serializer, de};

    #[expect(clippy::ref_option, clippy::trivially_copy_pass_by_ref, reason = "serde asks for it")]
    pub(super) fn serialize<S: Serializer>(
        diagonal: &Option<Diagonal>,
        serializer: S,
    ) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(diagonal.map_or(NO_DIAGONAL, Diagonal::name))
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(
        deserializer: D,
    ) -> Result<Option<Diagonal>, D::Error> {
        let name = String::deserialize(deserializer)?;
        match Diagonal::named(&name) {
            None if name == NO_DIAGONAL => Ok(None),
            None => Err(de::Error::custom(format!(
                "unknown diagonal `{name}`; write rising, falling or {NO_DIAGONAL}"
            ))),
            known => Ok(known),
        }
    }
}

impl FromStr for LoadRule {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let words: Vec<_> = text.split(',').map(str::trim).collect();
        let usual = Self::ALL.into_iter().find(|rule| rule.name() == words[0]);
        let rule = match (usual, &words[1..]) {
            (Some(rule), []) => Some(rule),
            (Some(Self::Nodal { .. }), &[tie, NO_DIAGONAL]) => {
                Tie::named(tie).map(|tie| Self::Nodal { tie, diagonal: None })
            }
            (Some(Self::Nodal { .. }), &[tie, diagonal]) => Tie::named(tie)
                .zip(Diagonal::named(diagonal))
                .map(|(tie, diagonal)| Self::Nodal { tie, diagonal: Some(diagonal) }),
            (Some(Self::Exact { .. }), &[diagonal]) => {
                Diagonal::named(diagonal).map(|diagonal| Self::Exact { diagonal })
            }
            _ => None,
        };
        rule.ok_or_else(|| {
            format!(
                "`{text}` is no load; write nodal, exact or bilinear, or with side and diagonal as nodal,\
                 upper-left,falling and exact,falling"
            )
        })
    }
}

choices!(Diagonal, 2: Rising = "rising", Falling = "falling");
