//! Formulas in the coordinates of a point, such as `3*x*y - 1.1`: read once, evaluated at many points.
//!
//! A sign before a power is that of the power, as in print: `-x^2` is `-(x^2)`; and `2^3^2` is `2^(3^2)`. Functions are
//! those of the `libm` crate, so that values have the same bits on all machines.

mod read;

use super::error::SourceError;
use super::text::Written;
use crate::machine::extremes::{max_or_nan, min_or_nan};
use serde::{Deserialize, Serialize};
use std::fmt;

/// Formula in x and y, in space also in z; as data its text or, of a number, that.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(into = "NumberOrText", try_from = "NumberOrText")]
pub struct Formula {
    /// Canonical text.
    text: String,
    /// Steps of a stack machine, in postfix order; they leave one number.
    steps: Vec<FormulaStep>,
}

/// Formula as data.
#[derive(Serialize, Deserialize)]
#[serde(untagged)]
enum NumberOrText {
    Number(f64),
    Text(String),
}

impl From<Formula> for NumberOrText {
    fn from(formula: Formula) -> Self {
        formula.number().map_or(Self::Text(formula.text), Self::Number)
    }
}

impl TryFrom<NumberOrText> for Formula {
    type Error = SourceError;

    fn try_from(of: NumberOrText) -> Result<Self, SourceError> {
        match of {
            NumberOrText::Number(number) => Ok(number.into()),
            NumberOrText::Text(text) => Self::read(&text, 3),
        }
    }
}

impl From<f64> for Formula {
    fn from(number: f64) -> Self {
        Self { text: Written(number).to_string(), steps: vec![FormulaStep::Number(number)] }
    }
}

/// Step of the evaluation.
#[derive(Clone, Copy, Debug, PartialEq)]
enum FormulaStep {
    /// Puts a number on the stack.
    Number(f64),
    /// Puts the coordinate along an axis on the stack.
    Coordinate(usize),
    /// Replaces the top of the stack.
    Unary(Unary),
    /// Replaces the two numbers on top of the stack.
    Binary(Binary),
}

/// Function of one number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Unary {
    Minus,
    Sin,
    Cos,
    Tan,
    Exp,
    Ln,
    Sqrt,
    Abs,
}

/// Function of two numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Binary {
    Plus,
    Minus,
    Times,
    Over,
    Power,
    Min,
    Max,
    Atan2,
}

/// Most numbers on the stack.
const DEPTH: usize = 32;
/// Points along each axis at which a formula is checked: among them the centre and both ends.
const CHECKED: [usize; 2] = [129, 33];

impl Formula {
    /// Reads a formula in the first `dimension` coordinates.
    ///
    /// # Errors
    /// [`SourceError::Formula`].
    pub fn read(text: &str, dimension: usize) -> Result<Self, SourceError> {
        read::read(text, dimension)
    }

    /// Reads a number of a law or a formula in its place; one without coordinates is the number that it is.
    ///
    /// # Errors
    /// The fault of the text, with the remedy.
    pub fn in_law(text: &str, dimension: usize) -> Result<Self, String> {
        let read = Self::read(text, dimension).map_err(|e| match e {
            SourceError::Formula { reason, .. } => {
                format!("{reason}; write a number, e.g. 0.3, or a formula, e.g. 0.1*x")
            }
            other => other.to_string(),
        })?;
        let has_any = read.steps.iter().any(|step| matches!(step, FormulaStep::Coordinate(_)));
        // A negative zero is zero.
        Ok(if has_any { read } else { (0.0 + read.at(&[])).into() })
    }

    /// The number, of a formula that is one.
    pub fn number(&self) -> Option<f64> {
        match self.steps[..] {
            [FormulaStep::Number(number)] => Some(number),
            _ => None,
        }
    }

    /// Value at a point, not finite where the formula has none.
    pub fn at(&self, point: &[f64]) -> f64 {
        let (mut stack, mut size) = ([0.0; DEPTH], 0);
        for step in &self.steps {
            match *step {
                FormulaStep::Number(value) => {
                    stack[size] = value;
                    size += 1;
                }
                FormulaStep::Coordinate(axis) => {
                    stack[size] = point[axis];
                    size += 1;
                }
                FormulaStep::Unary(function) => stack[size - 1] = function.value(stack[size - 1]),
                FormulaStep::Binary(function) => {
                    size -= 1;
                    stack[size - 1] = function.value(stack[size - 1], stack[size]);
                }
            }
        }
        stack[0]
    }

    /// Value of another kind than a number, from those of numbers, of the coordinates along the axes, and of functions.
    ///
    /// # Errors
    /// Reason for which a function has none.
    pub(crate) fn evaluated<V, E>(
        &self,
        number: impl Fn(f64) -> V,
        coordinate: impl Fn(usize) -> V,
        unary: impl Fn(Unary, V) -> Result<V, E>,
        binary: impl Fn(Binary, V, V) -> Result<V, E>,
    ) -> Result<V, E> {
        const SHORT: &str = "the reader puts as many values on the stack as functions take";
        let mut stack = Vec::new();
        for step in &self.steps {
            let value = match *step {
                FormulaStep::Number(value) => number(value),
                FormulaStep::Coordinate(axis) => coordinate(axis),
                FormulaStep::Unary(function) => unary(function, stack.pop().expect(SHORT))?,
                FormulaStep::Binary(function) => {
                    let second = stack.pop().expect(SHORT);
                    binary(function, stack.pop().expect(SHORT), second)?
                }
            };
            stack.push(value);
        }
        Ok(stack.pop().expect(SHORT))
    }

    /// Absolute value of this formula.
    pub fn absolute(&self) -> Self {
        let mut steps = self.steps.clone();
        steps.push(FormulaStep::Unary(Unary::Abs));
        Self { text: format!("abs({})", self.text), steps }
    }

    /// Checks the values on a lattice of points of the square or the cube.
    ///
    /// # Errors
    /// [`SourceError::NoValue`] with the first point where the value is not finite.
    pub fn check_on_unit_domain(&self, dimension: usize) -> Result<(), SourceError> {
        let side = CHECKED[dimension - 2];
        let mut point = [0.0; 3];
        for number in 0..side.pow(dimension as u32) {
            let mut rest = number;
            for coordinate in &mut point[..dimension] {
                *coordinate = (rest % side) as f64 / (side - 1) as f64 - 0.5;
                rest /= side;
            }
            self.check_at(&point[..dimension])?;
        }
        Ok(())
    }

    /// Checks the value at a point.
    fn check_at(&self, point: &[f64]) -> Result<(), SourceError> {
        SourceError::check_value(self.at(point), point)
    }
}

/// The canonical text.
impl fmt::Display for Formula {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(&self.text)
    }
}

impl Unary {
    /// Name in formulas.
    pub(crate) fn name(self) -> &'static str {
        read::name(&read::UNARY, self).unwrap_or("-")
    }

    /// Bound of the modulus of the derivative at numbers no farther than `off` from x; infinite or no number where
    /// there is none.
    pub(crate) fn slope(self, x: f64, off: f64) -> f64 {
        match self {
            Self::Minus | Self::Sin | Self::Cos | Self::Abs => 1.0,
            // The slope changes by less than twofold within a small part of its inverse.
            Self::Tan => match 1.0 + libm::tan(x) * libm::tan(x) {
                slope if slope * off < 0.1 => 2.0 * slope,
                _ => f64::INFINITY,
            },
            Self::Exp => libm::exp(x + off),
            Self::Ln => 1.0 / (x - off).max(0.0),
            Self::Sqrt => 0.5 / (x - off).sqrt(),
        }
    }

    pub(crate) fn value(self, x: f64) -> f64 {
        match self {
            Self::Minus => -x,
            Self::Sin => libm::sin(x),
            Self::Cos => libm::cos(x),
            Self::Tan => libm::tan(x),
            Self::Exp => libm::exp(x),
            Self::Ln => libm::log(x),
            Self::Sqrt => x.sqrt(),
            Self::Abs => x.abs(),
        }
    }
}

impl Binary {
    /// Name in formulas, of those that have one.
    pub(crate) fn name(self) -> &'static str {
        read::name(&read::BINARY, self).unwrap_or("a sign")
    }

    pub(crate) fn value(self, a: f64, b: f64) -> f64 {
        match self {
            Self::Plus => a + b,
            Self::Minus => a - b,
            Self::Times => a * b,
            Self::Over => a / b,
            Self::Power => power(a, b),
            Self::Min => min_or_nan(a, b),
            Self::Max => max_or_nan(a, b),
            Self::Atan2 => libm::atan2(a, b),
        }
    }
}

/// Largest exponent for which a power is a product.
const PRODUCT: f64 = 8.0;

fn power(base: f64, exponent: f64) -> f64 {
    if (1.0..=PRODUCT).contains(&exponent) && exponent.fract() == 0.0 {
        return (1..exponent as u32).fold(base, |product, _| product * base);
    }
    libm::pow(base, exponent)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problem::source::Source;
    use proptest::prelude::*;

    fn formula(text: &str) -> Formula {
        Formula::read(text, 2).unwrap_or_else(|why| panic!("{why}"))
    }

    #[test]
    fn signs_powers_and_functions_are_those_of_print() {
        let (x, y) = (0.3, -0.2);
        for (text, value) in [
            ("3*x*y - 1.1", 3.0 * x * y - 1.1),
            ("-x^2", -(x * x)),
            ("2^3^2", 512.0),
            ("2^-1", 0.5),
            ("x--y", x + y),
            ("x-y-1", x - y - 1.0),
            ("1/4/2", 0.125),
            ("1e-3*2.5E+2", 0.25),
            ("max(1, min(x, 5))", 1.0),
            ("max(max(x,y), min(1,5)) * 2", 2.0),
            ("abs(y) + sqrt(4)", 2.2),
            ("(-8)^3", -512.0),
            ("exp(-x^2)", libm::exp(-x * x)),
            ("sin(pi*x)*cos(y)", libm::sin(std::f64::consts::PI * x) * libm::cos(y)),
            ("atan2(y,x) + tan(x) - ln(e)", libm::atan2(y, x) + libm::tan(x) - 1.0),
            ("x^0.5", libm::pow(x, 0.5)),
            ("x^12", libm::pow(x, 12.0)),
        ] {
            assert_eq!(formula(text).at(&[x, y]), value, "{text}");
        }
    }

    #[test]
    fn texts_have_one_spelling_which_reads_back() {
        for (text, canonical) in [
            (" 3*x * y-1.10 ", "3*x*y - 1.1"),
            ("+x", "x"),
            ("max( x,y )^-2/1e300", "max(x, y)^-2/1e300"),
            ("((x))", "((x))"),
        ] {
            assert_eq!(formula(text).to_string(), canonical);
            assert_eq!(formula(canonical), formula(text));
        }
        assert_eq!(formula("x - 1").absolute(), formula("abs(x - 1)"));
        let f: Source = "formula(3*x*y-1.1)".parse().unwrap();
        assert_eq!(f.to_string(), "formula(3*x*y - 1.1)");
        assert_eq!(f.at([0.5, 0.5]), 3.0 * 0.25 - 1.1);
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]
        #[test]
        fn any_text_is_a_formula_that_reads_back_or_an_error(
            parts in prop::collection::vec(
                prop::sample::select(vec![
                    "x", "y", "z", "1", "2.5", "1e-3", ".", "e", "pi", "+", "-", "*", "/", "^", "(", ")", ",", " ",
                    "sin(", "max(", "sqrt", "\u{e9}", "{", "\n", "=", ";", "0", "1e", "1e308",
                ]),
                0..20,
            ),
            any in "\\PC{0,12}",
        ) {
            for text in [parts.concat(), any] {
                for dimension in [2, 3] {
                    let Ok(read) = Formula::read(&text, dimension) else { continue };
                    let again = Formula::read(&read.to_string(), dimension);
                    prop_assert_eq!(&again, &Ok(read.clone()));
                    prop_assert_eq!(
                        read.at(&[0.1, 0.2, 0.3]).to_bits(),
                        again.unwrap().at(&[0.1, 0.2, 0.3]).to_bits()
                    );
                }
            }
        }
    }
}
