//! Right-hand sides on the cube: constant pieces written as `box(...)=v; ball(...)=v; else=v`, or a named
//! exact problem.

use std::fmt;
use std::str::FromStr;

use super::Exact;
use crate::discrete::cube::{Grid, load};

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
        "cannot read `{0}` in f; write e.g. 'box(-0.25,0.25,-0.25,0.25,-0.25,0.25)=3; ball(0,0,0.3,0.1)=2; else=-1'"
    )]
    Syntax(String),
    /// Nothing is said about the rest of the cube.
    #[error("`{0}` says nothing of the rest of the cube; add `else=value`")]
    NoElse(String),
    /// A name that is no known exact problem.
    #[error("`{0}` is no exact problem of the cube; choose one of {names}", names = Exact::names())]
    UnknownExact(String),
}

/// A closed body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Body {
    /// `box(x0,x1,y0,y1,z0,z1)`.
    Box([[f64; 2]; 3]),
    /// `ball(x,y,z,radius)`.
    Ball { centre: [f64; 3], radius: f64 },
}

impl Source {
    /// The exact problem that f belongs to, if its solution is known.
    pub fn exact(&self) -> Option<Exact> {
        match self {
            Self::Exact(exact) => Some(*exact),
            Self::Pieces { .. } => None,
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

    /// The load vector: f at the nodes, or for constant pieces its mean over eight points around each
    /// node that lie inside the cube, which settles jumps through nodes.
    pub fn load(&self, grid: Grid) -> Vec<f64> {
        let step = 0.25 * grid.h();
        load(grid, |point| match self {
            Self::Exact(_) => self.at(point),
            Self::Pieces { .. } => {
                let shifted = (0..8).map(|number| {
                    let side = |axis: usize| if number >> axis & 1 == 0 { -step } else { step };
                    [0, 1, 2].map(|axis| point[axis] + side(axis))
                });
                let inside: Vec<_> =
                    shifted.filter(|point| point.iter().all(|s| s.abs() < 0.5)).collect();
                inside.iter().map(|&point| self.at(point)).sum::<f64>() / inside.len() as f64
            }
        })
    }
}

impl Body {
    /// Whether the closed body holds a point.
    pub fn contains(&self, point: [f64; 3]) -> bool {
        match *self {
            Self::Box(sides) => {
                (0..3).all(|axis| sides[axis][0] <= point[axis] && point[axis] <= sides[axis][1])
            }
            Self::Ball { centre, radius } => {
                let square = |axis: usize| (point[axis] - centre[axis]).powi(2);
                (0..3).map(square).sum::<f64>() <= radius * radius
            }
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
        _ => None,
    }
}

impl fmt::Display for Source {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Exact(exact) => write!(out, "exact({})", exact.name()),
            Self::Pieces { background, pieces } => {
                for (body, value) in pieces {
                    match body {
                        Body::Box([[x0, x1], [y0, y1], [z0, z1]]) => {
                            write!(out, "box({x0},{x1},{y0},{y1},{z0},{z1})={value}; ")?;
                        }
                        Body::Ball { centre: [x, y, z], radius } => {
                            write!(out, "ball({x},{y},{z},{radius})={value}; ")?;
                        }
                    }
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

    #[test]
    fn means_settle_jumps_through_nodes() {
        let half: Source = "box(-0.5,0,-0.5,0.5,-0.5,0.5)=4; else=0".parse().unwrap();
        let load = half.load(Grid::new(4).unwrap());
        assert_eq!(load[2 * 25 + 2 * 5 + 2], 2.0 / 64.0);
        assert!((load.iter().sum::<f64>() - 2.0).abs() < 1e-14);
    }
}
