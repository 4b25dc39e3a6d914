//! Shapes on which f is constant, as texts name them and as the cells of a grid see them.

use std::fmt;
use std::ops::Range;

/// A closed convex set on which f may be constant.
pub trait Shape: Copy + fmt::Debug + fmt::Display + PartialEq + Send + Sync {
    /// A point of the square or the cube.
    type Point: Copy + AsRef<[f64]>;
    /// The problems there whose solutions are known.
    type Exact: Known<Self::Point>;
    /// Number of coordinates of a point.
    const DIMENSION: usize;
    /// A right-hand side, for messages.
    const EXAMPLE: &'static str;

    /// True if the set holds a point.
    fn contains(&self, point: Self::Point) -> bool;

    /// The shape of this name; `None` if there is none. It may be [empty](Self::is_empty).
    fn read(name: &str, arguments: &str) -> Option<Result<Self, SourceError>>;

    /// True if it has no interior.
    fn is_empty(&self) -> bool;

    /// True if it is round and so large, or so far away, that where its border crosses a domain with coordinates of this
    /// size is lost to rounding.
    fn is_vast(&self, size: f64) -> bool;

    /// True if it does not reach into the domain.
    fn is_outside(&self) -> bool;

    /// True if shapes cover everything between them, as far as their kinds show it.
    fn cover(_shapes: &[Self]) -> bool {
        false
    }
}

/// A problem with a known solution.
pub trait Known<Point>: Copy + fmt::Debug + PartialEq + Send + Sync + 'static {
    /// All of them.
    const KNOWN: &'static [Self];

    /// The name used in `exact(name)`.
    fn name(self) -> &'static str;

    /// `f = -Laplacian v` at a point.
    fn f(self, point: Point) -> f64;
}

/// A closed convex set, as the cells of a grid see it; `N` is the dimension less one.
pub trait Convex<const N: usize>: Copy {
    /// Which of the increasing abscissas `xs` the set holds where the other coordinates are `at`: bisection
    /// finds the ends as [`contains`](Shape::contains) has them to the last bit, since rounding is monotone.
    fn along(&self, xs: &[f64], at: [f64; N]) -> Range<usize>;

    /// Least and greatest x of the set where the other coordinates are within `strip`; nothing if it is empty there.
    fn extent(&self, strip: [[f64; 2]; N]) -> Option<[f64; 2]>;

    /// This set in coordinates with their origin at (`x`, `at`) and this unit.
    fn seen_from(&self, x: f64, at: [f64; N], unit: f64) -> Self;
}

/// Bisects for the run of abscissas with a property that none loses before, or gains from, `turn` on.
pub(crate) fn run(xs: &[f64], turn: usize, inside: impl Fn(f64) -> bool) -> Range<usize> {
    let start = xs[..turn].partition_point(|&x| !inside(x));
    let end = turn + xs[turn..].partition_point(|&x| inside(x));
    start..end.max(start)
}

/// A half-plane or half-space `normal . p <= d` with a normal whose greatest component is 1 in size.
pub(crate) fn scaled<const D: usize>(normal: [f64; D], d: f64) -> ([f64; D], f64) {
    let scale = normal.iter().fold(0.0f64, |most, s| most.max(s.abs()));
    (normal.map(|s| s / scale), d / scale)
}

/// This half-plane or half-space with a normal whose products with coordinates are normal numbers: scaled by a power
/// of two, which changes no digit, where its components are extremely small or large.
pub(crate) fn plain<const D: usize>(normal: [f64; D], d: f64) -> ([f64; D], f64) {
    let largest = normal.iter().fold(0.0f64, |most, s| most.max(s.abs()));
    // In two steps, since the reciprocal of a subnormal number is infinite.
    let steps = match largest {
        tiny if tiny < 1e-150 => [600, 474],
        huge if huge > 1e150 => [-450, -450],
        _ => return (normal, d),
    };
    let [first, second] = steps.map(|step| libm::ldexp(1.0, step));
    (normal.map(|s| s * first * second), d * first * second)
}

/// Least and greatest x with `a x <= room`; nothing if there is none.
pub(super) fn half_line(a: f64, room: f64) -> Option<[f64; 2]> {
    match a {
        0.0 => (room >= 0.0).then_some([f64::NEG_INFINITY, f64::INFINITY]),
        a if a > 0.0 => Some([f64::NEG_INFINITY, room / a]),
        a => Some([room / a, f64::INFINITY]),
    }
}

/// Coordinates of points that are in the domain by more than rounding.
pub(super) const INSIDE: [f64; 2] = [-0.5 + 1e-9, 0.5 - 1e-9];

/// True if a set misses the domain, whose least and greatest x there are these, if it has any.
pub(super) fn misses(extent: Option<[f64; 2]>) -> bool {
    extent.is_none_or(|[least, greatest]| greatest < INSIDE[0] || INSIDE[1] < least)
}

/// Why a text is no right-hand side.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SourceError {
    /// Not of the grammar.
    #[error("cannot read `{text}` in f; write e.g. '{example}'")]
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
        "`{shape}` in f: the centre and the radius of what is round are at most {}; write a straight border as a half-plane or half-space",
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
    /// A name that is no known exact problem.
    #[error("`{name}` is no exact problem; choose one of {names}")]
    UnknownExact {
        /// Name that was asked for.
        name: String,
        /// Names that there are.
        names: String,
    },
}

/// Sizes of f that all solvers compute with: of the largest value, and of the integral of |f|.
///
/// The energy and the bounds are quadratic in f. Within this range neither the square of a rounding error underflows,
/// `(1e-16 * 1e-130)^2 = 1e-292`, nor does a sum of squares over a grid overflow.
pub const SCALE: Range<f64> = 1e-130..1e130;

/// The largest coordinate of a centre, and radius, over the coordinates of the domain: the border of a disc or ball is then
/// known to 1e-13.
pub(super) const VAST: f64 = 1e3;

/// Reads a finite number, or a fraction of two such as `-1/3`.
pub(super) fn number(text: &str) -> Result<f64, SourceError> {
    let text = text.trim();
    let value = match text.split_once('/') {
        Some((above, below)) => decimal(above).zip(decimal(below)).map(|(p, q)| p / q),
        None => decimal(text),
    };
    value.filter(|value| value.is_finite()).ok_or_else(|| SourceError::NotFinite(text.into()))
}

/// Returns nothing for an infinity too: one over it would pass as the number 0.
fn decimal(text: &str) -> Option<f64> {
    text.trim().parse().ok().filter(|value: &f64| value.is_finite())
}

/// Number as a person writes it, `0.25` or `1e-310`, in the fewest digits that read back to the same bits.
pub struct Written(pub f64);

impl fmt::Display for Written {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(value) = *self;
        if value == 0.0 || (1e-5..1e16).contains(&value.abs()) {
            write!(out, "{value}")
        } else {
            write!(out, "{value:e}")
        }
    }
}

/// Numbers as the arguments of a shape, separated by commas.
pub(super) struct List<'a>(pub(super) &'a [f64]);

impl fmt::Display for List<'_> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (k, value) in self.0.iter().enumerate() {
            let separator = if k > 0 { "," } else { "" };
            write!(out, "{separator}{}", Written(*value))?;
        }
        Ok(())
    }
}

/// The `N` numbers that shape `name` takes.
pub(super) fn numbers<const N: usize>(
    text: &str,
    [name, want, example]: [&'static str; 3],
) -> Result<[f64; N], SourceError> {
    let numbers = text.split(',').map(number).collect::<Result<Vec<_>, _>>()?;
    numbers.try_into().map_err(|_| SourceError::Arguments { name, want, example })
}
