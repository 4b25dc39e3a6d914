//! Right-hand sides f: piecewise constants written as `rect(x0,x1,y0,y1)=v; else=v`, a named exact problem, or a
//! `formula(3*x*y - 1.1)`.
//!
//! What is not constant on pieces is smooth: all that computes with f takes the values at points, by [`Source::at`].

use crate::problem::choices::choices;
use crate::problem::error::{SCALE, SourceError};
use crate::problem::exact::{CubeExact, Exact, Known};
use crate::problem::formula::Formula;
use crate::problem::shape::{Shape, VAST};
use crate::problem::text::{Written, number};
use std::fmt;
use std::str::FromStr;

/// A right-hand side f of (1), in the plane or, D = 3, in space.
#[derive(Clone, Debug, PartialEq)]
pub enum Source<const D: usize = 2> {
    /// Constant pieces painted over a background; the last piece that covers a point wins.
    Pieces {
        /// Value where no piece is.
        background: f64,
        /// Shapes with their values, in painting order.
        pieces: Vec<(Shape<D>, f64)>,
    },
    /// The right-hand side that belongs to a known solution.
    Exact(Known),
    /// A formula in the coordinates.
    Formula(Formula),
}

/// Side from which f is taken at a point that lies on a jump: a limit along that diagonal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Tie {
    /// From the left and from below: the pieces own their right and upper borders.
    #[default]
    LowerLeft,
    /// From the right and from below.
    LowerRight,
    /// From the left and from above.
    UpperLeft,
    /// From the right and from above.
    UpperRight,
}

choices!(Tie, 4:
    LowerLeft = "lower-left", LowerRight = "lower-right",
    UpperLeft = "upper-left", UpperRight = "upper-right",
);

/// Distance by which a sample steps off a jump; any jump closer than this to a node counts as through it.
pub(super) const STEP_OFF: f64 = 1e-9;

impl<const D: usize> Source<D> {
    /// f = `value` everywhere.
    pub fn constant(value: f64) -> Self {
        Self::Pieces { background: value, pieces: Vec::new() }
    }

    /// Reads f for a domain whose largest coordinate has this size.
    ///
    /// # Errors
    /// Any [`SourceError`] but those of values.
    pub fn read(text: &str, size: f64) -> Result<Self, SourceError> {
        if let Some(name) = text.trim().strip_prefix("exact(").and_then(|t| t.strip_suffix(')')) {
            return exact(name.trim(), D).map(Self::Exact);
        }
        if let Some(rest) = text.trim().strip_prefix("formula(") {
            let [opened, closed] = ['(', ')'].map(|parenthesis| rest.matches(parenthesis).count());
            let formula = match rest.strip_suffix(')') {
                Some(formula) => Formula::read(formula, D),
                None if opened < closed => return Err(SourceError::NotAlone),
                // With the parenthesis that is not closed.
                None => Formula::read(&format!("({rest}"), D),
            };
            return formula.map(Self::Formula);
        }
        let (mut background, mut pieces) = (None, Vec::new());
        for item in text.split([';', '\n']).map(str::trim).filter(|item| !item.is_empty()) {
            let syntax = || SourceError::Syntax { text: item.into(), example: Shape::<D>::EXAMPLE };
            let (left, value) = item.split_once('=').ok_or_else(syntax)?;
            let value = number(value).ok_or_else(|| SourceError::not_finite(value))?;
            if left.trim() == "else" {
                if background.replace(value).is_some() {
                    return Err(syntax());
                }
            } else {
                pieces.push((shape(left.trim(), size).ok_or_else(syntax)??, value));
            }
        }
        let shapes: Vec<Shape<D>> = pieces.iter().map(|(shape, _)| *shape).collect();
        match background {
            Some(background) => Ok(Self::Pieces { background, pieces }),
            None if Shape::cover(&shapes) => Ok(Self::Pieces { background: 0.0, pieces }),
            None => Err(SourceError::NoElse { text: one_line(text), example: Shape::<D>::EXAMPLE }),
        }
    }

    /// True if f is not constant on pieces, so that its integrals are by quadrature.
    pub fn is_smooth(&self) -> bool {
        !matches!(self, Self::Pieces { .. })
    }

    /// Sentences on the pieces that lie outside the unit square or cube, where they change nothing.
    pub fn outside(&self) -> Vec<String> {
        let Self::Pieces { pieces, .. } = self else { return Vec::new() };
        let outside = pieces.iter().filter(|(shape, _)| shape.is_outside());
        outside
            .map(|(shape, _)| format!("{shape} of f lies outside [-0.5,0.5] and changes nothing"))
            .collect()
    }

    /// |f| for constant pieces and formulas; a named problem, whose integral is far from zero, is left as it is.
    pub fn absolute(&self) -> Self {
        match self {
            Self::Pieces { background, pieces } => Self::Pieces {
                background: background.abs(),
                pieces: pieces.iter().map(|(shape, value)| (*shape, value.abs())).collect(),
            },
            Self::Exact(_) => self.clone(),
            Self::Formula(formula) => Self::Formula(formula.absolute()),
        }
    }

    /// Largest absolute value of a piece or of the background; a known solution has an f of ordinary size, 1. `None`
    /// for a formula.
    pub fn largest(&self) -> Option<f64> {
        match self {
            Self::Pieces { background, pieces } => {
                Some(pieces.iter().fold(background.abs(), |most, (_, value)| most.max(value.abs())))
            }
            Self::Exact(_) => Some(1.0),
            Self::Formula(_) => None,
        }
    }

    /// Checks that f, with this integral of |f| or its negative, is of a size that all solvers compute with, [`SCALE`],
    /// and that a formula has values on the square or the cube.
    ///
    /// # Errors
    /// [`SourceError::Scale`], [`SourceError::NoValue`]. f = 0 passes: the condition (2) excludes it.
    pub fn check_scale(&self, integral_of_size: f64) -> Result<(), SourceError> {
        if let Self::Formula(formula) = self {
            formula.check_on_unit_domain(D)?;
        }
        check_sizes(self.largest(), integral_of_size)
    }

    /// Value at a point; on the border of a piece, the piece's.
    pub fn at(&self, point: [f64; D]) -> f64 {
        match self {
            Self::Pieces { background, pieces } => pieces
                .iter()
                .rev()
                .find(|(shape, _)| shape.contains(point))
                .map_or(*background, |&(_, value)| value),
            Self::Exact(exact) => exact.f(&point),
            Self::Formula(formula) => formula.at(&point),
        }
    }
}

/// Checks that the largest value of |f|, where it is known, and the integral of |f| or its negative are of a size that
/// all solvers compute with. f = 0 passes.
///
/// # Errors
/// [`SourceError::Scale`].
pub(crate) fn check_sizes(largest: Option<f64>, integral: f64) -> Result<(), SourceError> {
    let sizes = [
        ("the largest value of |f|", largest.unwrap_or_default()),
        ("the integral of |f|", integral.abs()),
    ];
    match sizes.into_iter().find(|(_, size)| *size > 0.0 && !SCALE.contains(size)) {
        Some((what, size)) => Err(SourceError::Scale { what, size }),
        None => Ok(()),
    }
}

impl Source {
    /// The exact problem that f belongs to, if its solution is known.
    pub fn exact(&self) -> Option<Exact> {
        match self {
            Self::Exact(Known::Square(exact)) => Some(*exact),
            _ => None,
        }
    }

    /// Writes the values at points with the same y.
    pub(crate) fn in_row(&self, x: &[f64], y: f64, values: &mut [f64]) {
        match self.exact() {
            Some(exact) => exact.sources_in_row(x, y, values),
            None => x.iter().zip(values).for_each(|(&x, value)| *value = self.at([x, y])),
        }
    }
}

impl From<Exact> for Source {
    fn from(exact: Exact) -> Self {
        Self::Exact(Known::Square(exact))
    }
}

impl From<CubeExact> for Source<3> {
    fn from(exact: CubeExact) -> Self {
        Self::Exact(Known::Cube(exact))
    }
}

impl Tie {
    /// Signs of the step off a jump along both axes.
    pub(super) fn signs(self) -> [f64; 2] {
        match self {
            Self::LowerLeft => [-1.0, -1.0],
            Self::LowerRight => [1.0, -1.0],
            Self::UpperLeft => [-1.0, 1.0],
            Self::UpperRight => [1.0, 1.0],
        }
    }

    /// The coordinate `t` along axis 0 or 1, moved off any jump there to the side that this rule takes,
    /// or to the other one if that lies outside the square.
    pub fn step_off(self, t: f64, axis: usize) -> f64 {
        let step = STEP_OFF * self.signs()[axis];
        let moved = t + step;
        if moved.abs() <= 0.5 { moved } else { t - step }
    }
}

/// The canonical text: what [`FromStr`] reads, one spelling per right-hand side.
impl<const D: usize> fmt::Display for Source<D> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Pieces { background, pieces } => {
                for (shape, value) in pieces {
                    write!(out, "{shape}={}; ", Written(*value))?;
                }
                write!(out, "else={}", Written(*background))
            }
            Self::Exact(exact) => write!(out, "exact({})", exact.name()),
            Self::Formula(formula) => write!(out, "formula({formula})"),
        }
    }
}

/// As its text.
impl<const D: usize> serde::Serialize for Source<D> {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

impl<'de, const D: usize> serde::Deserialize<'de> for Source<D> {
    fn deserialize<T: serde::Deserializer<'de>>(deserializer: T) -> Result<Self, T::Error> {
        String::deserialize(deserializer)?.parse().map_err(serde::de::Error::custom)
    }
}

impl<const D: usize> FromStr for Source<D> {
    type Err = SourceError;

    /// Reads f for the square or the cube.
    fn from_str(text: &str) -> Result<Self, SourceError> {
        Self::read(text, 1.0)
    }
}

/// The problem of this name with a known solution.
fn exact(name: &str, dimension: usize) -> Result<Known, SourceError> {
    let all = Known::all(dimension);
    all.iter().find(|known| known.name() == name).copied().ok_or_else(|| {
        let names: Vec<_> = all.iter().map(|known| known.name()).collect();
        SourceError::UnknownExact { name: one_line(name), names: names.join(", ") }
    })
}

/// A text to be quoted in a message.
fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// `None` if the text is not `name(arguments)` with a known name.
fn shape<const D: usize>(text: &str, size: f64) -> Option<Result<Shape<D>, SourceError>> {
    let (name, rest) = text.split_once('(')?;
    let shape = Shape::<D>::read(name.trim(), rest.strip_suffix(')')?)?;
    Some(shape.and_then(|shape| match (shape.is_empty(), shape.is_vast(size)) {
        (true, _) => Err(SourceError::Empty(text.into())),
        (_, true) => Err(SourceError::Vast { shape: text.into(), most: VAST * size }),
        _ => Ok(shape),
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn last_piece_wins_and_text_round_trips() {
        let text = "halfplane(1,1,0)=2; rect(-0.25,0.25,-0.25,0.25)=1.5; disc(0,0,0.1)=-7; else=-1";
        let f: Source = text.parse().unwrap();
        assert_eq!(f.at([0.0, 0.0]), -7.0);
        assert_eq!(f.at([0.2, 0.2]), 1.5);
        assert_eq!(f.at([-0.4, -0.4]), 2.0);
        assert_eq!(f.at([0.4, 0.4]), -1.0);
        assert_eq!(f.to_string(), text);
    }

    #[test]
    fn half_planes_are_read_with_extreme_coefficients() {
        for (text, inside, outside) in [
            ("halfplane(5e-324,5e-324,0)", [-0.1, -0.2], [0.1, 0.2]),
            ("halfplane(1e-320,2e-320,1e-321)", [0.06, 0.015], [0.08, 0.015]),
            ("halfplane(1e-310,-1e308,0)", [-0.4, 0.1], [-0.4, -0.1]),
            ("halfplane(1.7e308,1.7e308,1.7e308)", [0.5, 0.4], [0.6, 0.5]),
        ] {
            let f: Source = format!("{text}=2; else=-3").parse().unwrap();
            assert_eq!([f.at(inside), f.at(outside)], [2.0, -3.0], "{text}");
            // It stays as it was written.
            assert!(f.to_string().parse::<Source>().unwrap() == f, "{text}");
        }
        let f: Source<3> = "halfspace(5e-324,5e-324,-5e-324,0)=2; else=-3".parse().unwrap();
        assert_eq!([f.at([0.1, 0.1, 0.3]), f.at([0.1, 0.2, 0.2])], [2.0, -3.0]);
    }

    #[test]
    fn ties_choose_the_side_of_a_jump_and_stay_inside_the_square() {
        let f: Source =
            "quadrant(ll)=1; quadrant(lr)=2; quadrant(ul)=3; quadrant(ur)=4".parse().unwrap();
        let sample =
            |f: &Source, [x, y]: [f64; 2], tie: Tie| f.at([tie.step_off(x, 0), tie.step_off(y, 1)]);
        let all = [Tie::LowerLeft, Tie::LowerRight, Tie::UpperLeft, Tie::UpperRight];
        assert_eq!(all.map(|tie| sample(&f, [0.0; 2], tie)), [1.0, 2.0, 3.0, 4.0]);
        let edge: Source = "rect(-0.5,0.5,-0.5,0.5)=1; else=9".parse().unwrap();
        assert_eq!(sample(&edge, [-0.5; 2], Tie::LowerLeft), 1.0);
        assert_eq!(sample(&edge, [0.5; 2], Tie::UpperRight), 1.0);
    }

    #[test]
    fn fractions_are_numbers() {
        let f: Source = "rect(-1/4,1/4,-1/4,1/4)=1/3; else=-1/3".parse().unwrap();
        assert_eq!(f.at([0.0, 0.0]), 1.0 / 3.0);
        assert_eq!(f.at([0.4, 0.4]), -1.0 / 3.0);
        for wrong in
            ["else=1/0", "else=1/2/3", "else=/2", "else=-1/x", "else=-1/inf", "else=-1/1e400"]
        {
            assert!(matches!(wrong.parse::<Source>(), Err(SourceError::NotFinite(_))), "{wrong}");
        }
    }

    #[test]
    fn numbers_are_written_in_few_characters() {
        for (value, text) in [
            (-1e-310, "else=-1e-310"),
            (1e300, "else=1e300"),
            (-1.5e6, "else=-1500000"),
            (0.002, "else=0.002"),
            (2.5e-7, "else=2.5e-7"),
            (1e16, "else=1e16"),
        ] {
            assert_eq!(Source::<2>::constant(value).to_string(), text);
        }
    }

    #[test]
    fn sizes_beyond_the_scale_are_refused() {
        for (text, size, fits) in [
            ("else=-1", 1.0, true),
            ("else=0", 0.0, true),
            ("disc(0,0,0.1)=1e-310; else=-1", 1.0, true),
            ("else=-1e129", 1e129, true),
            ("else=-1e130", 1e130, false),
            ("disc(0,0,0.1)=1e308; else=-1e308", f64::INFINITY, false),
            ("disc(0,0,0.1)=1e308; else=-1e308", f64::NAN, false),
            ("else=-1e-129", 1e-129, true),
            ("else=-1e-131", 1e-131, false),
            // Nothing of f lies in the domain, and a large domain.
            ("disc(3,0,0.1)=1; else=0", 0.0, true),
            ("else=-1e100", 1e160, false),
        ] {
            let f: Source = text.parse().unwrap();
            assert_eq!(f.check_scale(size).is_ok(), fits, "{text}");
        }
        let peak: Source = "formula(1e140*exp(-1e8*(x*x+y*y)) - 1e131)".parse().unwrap();
        let refusal = peak.check_scale(3.24e132).unwrap_err().to_string();
        assert!(refusal.starts_with("the integral of |f| is 3.24e132"), "{refusal}");
    }
}
