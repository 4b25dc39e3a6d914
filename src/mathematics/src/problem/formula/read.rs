//! The reader of formulas, by recursive descent:
//!
//! ```text
//! sum = product { (+|-) product }      power = atom [ ^ sign ]
//! product = sign { (*|/) sign }        atom = number | name | name(sum, ..) | (sum)
//! sign = { +|- } power
//! ```

use super::{Binary, DEPTH, Formula, FormulaStep, Unary};
use crate::problem::error::SourceError;
use crate::problem::text::Written;
use std::f64::consts;

/// Functions of one number.
pub(super) const UNARY: [(&str, Unary); 7] = [
    ("sin", Unary::Sin),
    ("cos", Unary::Cos),
    ("tan", Unary::Tan),
    ("exp", Unary::Exp),
    ("ln", Unary::Ln),
    ("sqrt", Unary::Sqrt),
    ("abs", Unary::Abs),
];
/// Functions of two numbers.
pub(super) const BINARY: [(&str, Binary); 3] =
    [("min", Binary::Min), ("max", Binary::Max), ("atan2", Binary::Atan2)];
const CONSTANTS: [(&str, f64); 2] = [("pi", consts::PI), ("e", consts::E)];
const COORDINATES: [&str; 3] = ["x", "y", "z"];

/// Name of a function in a list.
pub(super) fn name<F: PartialEq>(list: &[(&'static str, F)], function: F) -> Option<&'static str> {
    list.iter().find(|(_, own)| *own == function).map(|(name, _)| *name)
}

/// Most signs, parentheses and powers within each other.
const NESTED: usize = 64;
/// Most characters of the text that a message quotes.
const QUOTED: usize = 40;

/// Reads a formula in the first `dimension` coordinates.
pub(super) fn read(text: &str, dimension: usize) -> Result<Formula, SourceError> {
    let mut reader = Reader::new(text, &COORDINATES[..dimension]);
    let mut end = reader.sum();
    if end.is_ok() && !reader.rest.is_empty() {
        end = Err(format!("`{}` follows without an operator", quoted(reader.rest)));
    }
    match end {
        Ok(()) => Ok(Formula { text: reader.text, steps: reader.steps }),
        Err(reason) => Err(SourceError::Formula { formula: quoted(text), reason }),
    }
}

/// Beginning of a text, in one line.
fn quoted(text: &str) -> String {
    let line = text.split_whitespace().collect::<Vec<_>>().join(" ");
    match line.char_indices().nth(QUOTED) {
        None => line,
        Some((end, _)) => format!("{}...", &line[..end]),
    }
}

struct Reader<'a> {
    /// Text that is still to be read, without space before it.
    rest: &'a str,
    /// Names of the coordinates.
    coordinates: &'a [&'a str],
    /// Canonical text of what was read.
    text: String,
    steps: Vec<FormulaStep>,
    /// Numbers on the stack after these steps.
    size: usize,
    nested: usize,
}

/// Success, or the reason why the text is no formula.
type Read<T = ()> = Result<T, String>;

impl<'a> Reader<'a> {
    fn new(text: &'a str, coordinates: &'a [&'a str]) -> Self {
        let (written, steps) = (String::new(), Vec::new());
        Self { rest: text.trim_start(), coordinates, text: written, steps, size: 0, nested: 0 }
    }

    fn sum(&mut self) -> Read {
        self.product()?;
        loop {
            let function = match self.next() {
                Some('+') => Binary::Plus,
                Some('-') => Binary::Minus,
                _ => return Ok(()),
            };
            self.take(1, if function == Binary::Plus { " + " } else { " - " });
            self.product()?;
            self.push(FormulaStep::Binary(function))?;
        }
    }

    fn product(&mut self) -> Read {
        self.sign()?;
        loop {
            let function = match self.next() {
                Some('*') => Binary::Times,
                Some('/') => Binary::Over,
                _ => return Ok(()),
            };
            self.take(1, if function == Binary::Times { "*" } else { "/" });
            self.sign()?;
            self.push(FormulaStep::Binary(function))?;
        }
    }

    fn sign(&mut self) -> Read {
        self.nested += 1;
        if self.nested > NESTED {
            return Err(too_deep());
        }
        match self.next() {
            Some('-') => {
                self.take(1, "-");
                self.sign()?;
                self.push(FormulaStep::Unary(Unary::Minus))?;
            }
            Some('+') => {
                self.take(1, "");
                self.sign()?;
            }
            _ => self.power()?,
        }
        self.nested -= 1;
        Ok(())
    }

    fn power(&mut self) -> Read {
        self.atom()?;
        if self.next() != Some('^') {
            return Ok(());
        }
        self.take(1, "^");
        self.sign()?;
        self.push(FormulaStep::Binary(Binary::Power))
    }

    fn atom(&mut self) -> Read {
        match self.next() {
            Some('(') => {
                self.take(1, "(");
                self.sum()?;
                self.close()
            }
            Some(c) if c.is_ascii_digit() || c == '.' => self.number(),
            Some(c) if c.is_ascii_alphabetic() => self.name(),
            Some(_) => Err(format!(
                "`{}` stands where a number, a name or a parenthesis belongs",
                quoted(self.rest)
            )),
            None => Err("the text ends where a number, a name or a parenthesis belongs".to_owned()),
        }
    }

    fn number(&mut self) -> Read {
        let bytes = self.rest.as_bytes();
        let digits = |from: usize| bytes[from..].iter().take_while(|b| b.is_ascii_digit()).count();
        let mut length = bytes.iter().take_while(|b| b.is_ascii_digit() || **b == b'.').count();
        // An e without digits behind it is the constant.
        if bytes.get(length).is_some_and(|b| b"eE".contains(b)) {
            let sign = usize::from(bytes.get(length + 1).is_some_and(|b| b"+-".contains(b)));
            let exponent = digits(length + 1 + sign);
            if exponent > 0 {
                length += 1 + sign + exponent;
            }
        }
        let text = &self.rest[..length];
        let value = text.parse().ok().filter(|value: &f64| value.is_finite());
        let value = value.ok_or_else(|| format!("`{}` is not a finite number", quoted(text)))?;
        self.take(length, &Written(value).to_string());
        self.push(FormulaStep::Number(value))
    }

    fn name(&mut self) -> Read {
        let length = self.rest.bytes().take_while(u8::is_ascii_alphanumeric).count();
        let name = &self.rest[..length];
        if let Some(axis) = self.coordinates.iter().position(|known| *known == name) {
            self.take(length, name);
            return self.push(FormulaStep::Coordinate(axis));
        }
        if let Some(value) = named(&CONSTANTS, name) {
            self.take(length, name);
            return self.push(FormulaStep::Number(value));
        }
        if let Some(function) = named(&UNARY, name) {
            self.arguments(name, 1)?;
            return self.push(FormulaStep::Unary(function));
        }
        if let Some(function) = named(&BINARY, name) {
            self.arguments(name, 2)?;
            return self.push(FormulaStep::Binary(function));
        }
        Err(format!(
            "`{}` is not known; there are {}, the constants pi and e, and sin, cos, tan, exp, ln, sqrt, abs, min, \
             max, atan2",
            quoted(name),
            self.coordinates.join(", ")
        ))
    }

    /// Reads the name of a function and its arguments.
    fn arguments(&mut self, name: &str, count: usize) -> Read {
        let wrong = format!(
            "`{name}` takes {count} argument{} in parentheses",
            if count == 1 { "" } else { "s" }
        );
        self.take(name.len(), name);
        if self.next() != Some('(') {
            return Err(wrong);
        }
        self.take(1, "(");
        for argument in 0..count {
            if argument > 0 {
                if self.next() != Some(',') {
                    return Err(wrong);
                }
                self.take(1, ", ");
            }
            self.sum()?;
        }
        if self.next() == Some(',') { Err(wrong) } else { self.close() }
    }

    fn close(&mut self) -> Read {
        match self.next() {
            Some(')') => {
                self.take(1, ")");
                Ok(())
            }
            Some(_) => Err(format!("`{}` follows without an operator", quoted(self.rest))),
            None => Err("a parenthesis is not closed".to_owned()),
        }
    }

    fn next(&self) -> Option<char> {
        self.rest.chars().next()
    }

    /// Goes on behind `length` bytes, which are written as `canonical`.
    fn take(&mut self, length: usize, canonical: &str) {
        self.rest = self.rest[length..].trim_start();
        self.text += canonical;
    }

    fn push(&mut self, step: FormulaStep) -> Read {
        self.steps.push(step);
        match step {
            FormulaStep::Number(_) | FormulaStep::Coordinate(_) => self.size += 1,
            FormulaStep::Unary(_) => {}
            FormulaStep::Binary(_) => self.size -= 1,
        }
        if self.size > DEPTH { Err(too_deep()) } else { Ok(()) }
    }
}

fn too_deep() -> String {
    "signs or parentheses are nested too deeply".to_owned()
}

fn named<T: Copy>(table: &[(&str, T)], name: &str) -> Option<T> {
    table.iter().find(|(known, _)| *known == name).map(|(_, value)| *value)
}
