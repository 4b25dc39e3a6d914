//! Right-hand sides on the cube: constant pieces written as `box(...)=v; ball(...)=v; else=v`, or a named
//! exact problem.

use std::fmt;
use std::str::FromStr;

use super::{Body, Exact};

/// A right-hand side f on the cube (-1/2, 1/2)^3.
#[derive(Clone, Debug, PartialEq)]
pub enum Source {
    /// Constant pieces over a background; the last piece that covers a point wins.
    Pieces {
        /// Value where no piece is.
        background: f64,
        /// Bodies with their values.
        pieces: Vec<(Body, f64)>,
    },
    /// The right-hand side that belongs to a known solution.
    Exact(Exact),
}

/// Why a text is no right-hand side.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SourceError {
    /// Not of the grammar, or with a number that is not finite, or an empty body.
    #[error(
        "cannot read `{0}` in f; write e.g. 'box(-0.25,0.25,-0.25,0.25,-0.25,0.25)=3; ball(0,0,0.3,0.1)=2; halfspace(1,1,1,-0.5)=1; else=-1'"
    )]
    Syntax(String),
    /// Nothing is said about the rest of the cube.
    #[error("`{0}` says nothing of the rest of the cube; add `else=value`")]
    NoElse(String),
    /// A name that is no known exact problem.
    #[error("`{0}` is no exact problem of the cube; choose one of {names}", names = Exact::names())]
    UnknownExact(String),
}

impl Source {
    /// The exact problem that f belongs to, if its solution is known.
    pub fn exact(&self) -> Option<Exact> {
        match self {
            Self::Exact(exact) => Some(*exact),
            Self::Pieces { .. } => None,
        }
    }

    /// |f| for constant pieces; a named problem, whose integral is far from zero, is left as it is.
    pub fn absolute(&self) -> Self {
        match self {
            Self::Pieces { background, pieces } => Self::Pieces {
                background: background.abs(),
                pieces: pieces.iter().map(|(body, value)| (*body, value.abs())).collect(),
            },
            Self::Exact(_) => self.clone(),
        }
    }

    /// Value at a point.
    pub fn at(&self, point: [f64; 3]) -> f64 {
        match self {
            Self::Pieces { background, pieces } => pieces
                .iter()
                .rev()
                .find(|(body, _)| body.contains(point))
                .map_or(*background, |&(_, value)| value),
            Self::Exact(exact) => exact.at(point).f,
        }
    }
}

impl FromStr for Source {
    type Err = SourceError;

    fn from_str(text: &str) -> Result<Self, SourceError> {
        let text = text.trim();
        if let Some(name) = text.strip_prefix("exact(").and_then(|rest| rest.strip_suffix(')')) {
            let exact = Exact::named(name.trim());
            return exact.map(Self::Exact).ok_or_else(|| SourceError::UnknownExact(name.into()));
        }
        let (mut background, mut pieces) = (None, Vec::new());
        for item in text.split(';').map(str::trim).filter(|item| !item.is_empty()) {
            let syntax = || SourceError::Syntax(item.into());
            let (left, value) = item.split_once('=').ok_or_else(syntax)?;
            let value = number(value).ok_or_else(syntax)?;
            match left.trim() {
                "else" if background.is_none() => background = Some(value),
                left => pieces.push((body(left).ok_or_else(syntax)?, value)),
            }
        }
        let background = background.ok_or_else(|| SourceError::NoElse(text.into()))?;
        Ok(Self::Pieces { background, pieces })
    }
}

/// A finite number.
fn number(text: &str) -> Option<f64> {
    text.trim().parse().ok().filter(|value: &f64| value.is_finite())
}

/// A body that is not empty.
fn body(text: &str) -> Option<Body> {
    let (name, arguments) = text.strip_suffix(')')?.split_once('(')?;
    let numbers = arguments.split(',').map(number).collect::<Option<Vec<_>>>()?;
    match (name.trim(), &numbers[..]) {
        ("box", &[x0, x1, y0, y1, z0, z1]) if x0 < x1 && y0 < y1 && z0 < z1 => {
            Some(Body::Box([[x0, x1], [y0, y1], [z0, z1]]))
        }
        ("ball", &[x, y, z, radius]) if radius > 0.0 => {
            Some(Body::Ball { centre: [x, y, z], radius })
        }
        ("halfspace", &[a, b, c, d]) if [a, b, c] != [0.0; 3] => {
            Some(Body::HalfSpace { normal: [a, b, c], d })
        }
        _ => None,
    }
}

impl fmt::Display for Source {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Exact(exact) => write!(out, "exact({})", exact.name()),
            Self::Pieces { background, pieces } => {
                for (body, value) in pieces {
                    write!(out, "{body}={value}; ")?;
                }
                write!(out, "else={background}")
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_are_read_and_written() {
        for text in [
            "else=-1",
            "ball(0,0.1,0,0.25)=2; else=-1",
            "box(-0.5,0,-0.5,0,-0.5,0)=1.5; ball(0,0,0,0.1)=-3; else=-1",
            "exact(free-disc)",
        ] {
            assert_eq!(text.parse::<Source>().unwrap().to_string(), text);
        }
        for wrong in
            ["", "box(0,1)=1; else=0", "ball(0,0,0,0)=1; else=0", "else=nan", "exact(x)", "ball=1"]
        {
            assert!(wrong.parse::<Source>().is_err(), "{wrong}");
        }
    }
}
