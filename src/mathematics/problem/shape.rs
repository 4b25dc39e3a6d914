//! Shapes on which f is constant, as texts name them and as the cells of a grid see them.

use std::fmt;
use std::ops::Range;

/// A closed convex set on which f may be constant.
pub trait Shape: Copy + fmt::Debug + fmt::Display + PartialEq {
    /// A point of the square or the cube.
    type Point: Copy;
    /// The problems there whose solutions are known.
    type Exact: Known<Self::Point>;
    /// A right-hand side, for messages.
    const EXAMPLE: &'static str;

    /// Whether the set holds a point.
    fn contains(&self, point: Self::Point) -> bool;

    /// The shape of this name; `None` if there is none. It may be [empty](Self::is_empty).
    fn read(name: &str, arguments: &str) -> Option<Result<Self, SourceError>>;

    /// Whether it has no interior.
    fn is_empty(&self) -> bool;

    /// Whether it is round and so large, or so far away, that where its border crosses the domain is lost to rounding.
    fn is_vast(&self) -> bool;

    /// Whether it does not reach into the domain.
    fn is_outside(&self) -> bool;

    /// Whether shapes cover everything between them, as far as their kinds show it.
    fn cover(_shapes: &[Self]) -> bool {
        false
    }
}

/// A problem with a known solution.
pub trait Known<Point>: Copy + fmt::Debug + PartialEq + 'static {
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

    /// The same set in coordinates with their origin at (`x`, `at`) and this unit.
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

/// The same half-plane or half-space with a normal whose products with coordinates are normal numbers: scaled by a power
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

/// Whether a set misses the domain, whose least and greatest x there are these, if it has any.
pub(super) fn misses(extent: Option<[f64; 2]>) -> bool {
    extent.is_none_or(|[least, greatest]| greatest < INSIDE[0] || INSIDE[1] < least)
}

/// Why a text is no right-hand side.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SourceError {
    /// Not of the grammar.
    #[error("cannot read `{text}` in f; write e.g. '{example}'")]
    Syntax {
        /// What is not.
        text: String,
        /// What would be.
        example: &'static str,
    },
    /// Nothing is said about the rest of the domain.
    #[error(
        "`{text}` in f stands without `else=value` for where no piece is; write e.g. '{example}'"
    )]
    NoElse {
        /// What f is.
        text: String,
        /// What would be right.
        example: &'static str,
    },
    /// A shape with a wrong number of arguments.
    #[error("`{name}` takes {want}, e.g. {example}")]
    Arguments {
        /// Shape named.
        name: &'static str,
        /// What it takes.
        want: &'static str,
        /// A correct use.
        example: &'static str,
    },
    /// NaN or an infinity, or no number at all.
    #[error("`{0}` in f is not a finite number; give a decimal such as -1.5")]
    NotFinite(String),
    /// A shape without an interior, or without a border.
    #[error(
        "`{0}` in f is no region; order its bounds, and give a size or a normal that is not zero"
    )]
    Empty(String),
    /// A disc or ball too large or too far away.
    #[error(
        "`{0}` in f: the centre and the radius of what is round are at most {VAST}; write a straight border as a half-plane or half-space"
    )]
    Vast(String),
    /// A name that is no known exact problem.
    #[error("`{name}` is no exact problem; choose one of {names}")]
    UnknownExact {
        /// What was asked for.
        name: String,
        /// What there is.
        names: String,
    },
}

/// The largest coordinate of a centre, and radius: the border of a disc or ball is then known to 1e-13.
pub(super) const VAST: f64 = 1e3;

/// A finite number.
pub(super) fn number(text: &str) -> Result<f64, SourceError> {
    let value: Option<f64> = text.trim().parse().ok();
    value
        .filter(|value| value.is_finite())
        .ok_or_else(|| SourceError::NotFinite(text.trim().into()))
}

/// The `N` numbers that shape `name` takes.
pub(super) fn numbers<const N: usize>(
    text: &str,
    [name, want, example]: [&'static str; 3],
) -> Result<[f64; N], SourceError> {
    let numbers = text.split(',').map(number).collect::<Result<Vec<_>, _>>()?;
    numbers.try_into().map_err(|_| SourceError::Arguments { name, want, example })
}
