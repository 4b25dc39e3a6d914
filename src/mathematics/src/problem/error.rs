//! Errors of right-hand sides.

use super::text::Written;
use std::ops::Range;

/// Sizes of f that all solvers compute with: of the largest value, and of the integral of |f|.
///
/// The energy and the bounds are quadratic in f. Within this range neither the square of a rounding error underflows,
/// `(1e-16 * 1e-130)^2 = 1e-292`, nor does a sum of squares over a grid overflow.
pub const SCALE: Range<f64> = 1e-130..1e130;

/// Why a text is no right-hand side.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SourceError {
    /// Not of the grammar.
    #[error(
        "cannot read `{text}` in f; write a constant as 'else=-1', an expression as 'formula(3*x - 1)', and regions as \
         '{example}'"
    )]
    Syntax {
        /// Text that is not read.
        text: String,
        /// Example of a text that is.
        example: &'static str,
    },
    /// Nothing is said about the rest of the domain.
    #[error(
        "`{text}` in f stands without `else=value` for where no piece is; write e.g. '{example}'"
    )]
    NoElse {
        /// Text of f.
        text: String,
        /// Example of a text that is right.
        example: &'static str,
    },
    /// A shape with a wrong number of arguments.
    #[error("`{name}` takes {want}, e.g. {example}")]
    Arguments {
        /// Shape named.
        name: &'static str,
        /// Arguments that the shape takes.
        want: &'static str,
        /// A correct use.
        example: &'static str,
    },
    /// NaN or an infinity, or no number at all.
    #[error(
        "`{0}` in f is not a finite number; give a decimal such as -1.5, or a fraction such as -1/3"
    )]
    NotFinite(String),
    /// A shape without an interior, or without a border.
    #[error(
        "`{0}` in f is no region; order its bounds, and give a size or a normal that is not zero"
    )]
    Empty(String),
    /// A disc or ball too large or too far away.
    #[error(
        "`{shape}` in f: the centre and the radius of what is round are at most {}; write a straight border as a \
         half-plane or half-space",
        Written(*most)
    )]
    Vast {
        /// Text of the shape.
        shape: String,
        /// Largest coordinate and radius.
        most: f64,
    },
    /// Values too large or too small to compute with.
    #[error("{what} is {}, outside {} to {}; scale f", Written(*size), Written(SCALE.start), Written(SCALE.end))]
    Scale {
        /// Quantity that is out of range.
        what: &'static str,
        /// Size of the quantity.
        size: f64,
    },
    /// A text that is no formula.
    #[error("formula `{formula}`: {reason}; write e.g. 'formula(3*x*y - 1.1)'")]
    Formula {
        /// Text of the formula, or its beginning.
        formula: String,
        /// Fault of the text.
        reason: String,
    },
    /// A formula beside other parts of f.
    #[error("a formula stands alone, as all of f; write e.g. 'formula(3*x*y - 1.1)'")]
    NotAlone,
    /// A point at which f is not finite.
    #[error("f is {value} at ({point}); give a formula with finite values on the whole domain")]
    NoValue {
        /// Value of f.
        value: f64,
        /// Coordinates of the point.
        point: String,
    },
    /// A region without a value, or with a name whose end is not to be told.
    #[error(
        "cannot read `{0}` in f; write region(NAME)=VALUE, a name with = or ; in quotes, as in region(\"a=b\")=-1"
    )]
    Region(String),
    /// A region that the mesh has not.
    #[error(
        "f names the region `{name}`, which the mesh has not; its regions are {regions}; where a converter lost the \
         names, save the mesh with Gmsh"
    )]
    UnknownRegion {
        /// Name asked for.
        name: String,
        /// Names of the regions.
        regions: String,
    },
    /// Two values on the same cells.
    #[error("f has two values on the region `{0}`; give it one")]
    TwoValues(String),
    /// A region without a value where others have one.
    #[error(
        "f has no value on the region `{0}`; give it one as on the others, or add `else=value`"
    )]
    NoValueOn(String),
    /// A name that is no known exact problem.
    #[error("`{name}` is no exact problem; choose one of {names}")]
    UnknownExact {
        /// Name that was asked for.
        name: String,
        /// Names that there are.
        names: String,
    },
}

impl SourceError {
    /// Checks a value of f at a point.
    ///
    /// # Errors
    /// [`SourceError::NoValue`] if the value is not finite.
    pub fn check_value(value: f64, point: &[f64]) -> Result<(), Self> {
        if value.is_finite() { Ok(()) } else { Err(Self::no_value(value, point)) }
    }

    /// The error of a text that is no finite number.
    pub(super) fn not_finite(text: &str) -> Self {
        Self::NotFinite(text.trim().into())
    }

    /// The error of a value at a point that is not finite.
    pub(crate) fn no_value(value: f64, point: &[f64]) -> Self {
        let point: Vec<_> = point.iter().map(|&at| Written(at).to_string()).collect();
        Self::NoValue { value, point: point.join(", ") }
    }
}
