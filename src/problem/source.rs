//! Right-hand sides f: piecewise constants written as `rect(x0,x1,y0,y1)=v; else=v`, or a named exact problem.

use crate::problem::exact::Exact;
pub use crate::problem::region::Region;
use std::fmt;
use std::str::FromStr;

/// A right-hand side f of (1) on the square (-1/2, 1/2)^2.
#[derive(Clone, Debug, PartialEq)]
pub enum Source {
    /// Constant pieces painted over a background; the last piece that covers a point wins.
    Pieces {
        /// Value where no piece is.
        background: f64,
        /// Regions with their values, in painting order.
        pieces: Vec<(Region, f64)>,
    },
    /// The right-hand side that belongs to a known solution.
    Exact(Exact),
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

/// Why a text is no right-hand side.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SourceError {
    /// Not of the grammar.
    #[error("cannot read `{0}` in f; write e.g. 'rect(-0.25,0.25,-0.25,0.25)=1.5; else=-1'")]
    Syntax(String),
    /// A region with a wrong number of arguments.
    #[error("`{name}` takes {want}, e.g. {example}")]
    Arguments {
        /// Region named.
        name: &'static str,
        /// What it takes.
        want: &'static str,
        /// A correct use.
        example: &'static str,
    },
    /// NaN or an infinity.
    #[error("`{0}` in f is not a finite number; give a decimal such as -1.5")]
    NotFinite(String),
    /// An empty region.
    #[error("`{0}` in f covers nothing; order its bounds and make sizes positive")]
    EmptyRegion(String),
    /// A name that is no known exact problem.
    #[error("`{0}` is no exact problem; choose one of {names}", names = Exact::names())]
    UnknownExact(String),
}

/// Distance by which a sample steps off a jump; any jump closer than this to a node counts as through it.
const STEP_OFF: f64 = 1e-9;

impl Source {
    /// f = `value` everywhere.
    pub fn constant(value: f64) -> Self {
        Self::Pieces { background: value, pieces: Vec::new() }
    }

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
                pieces: pieces.iter().map(|(region, value)| (*region, value.abs())).collect(),
            },
            Self::Exact(_) => self.clone(),
        }
    }

    /// Value at (x, y); on the border of a piece, the piece's.
    pub fn at(&self, x: f64, y: f64) -> f64 {
        match self {
            Self::Pieces { background, pieces } => pieces
                .iter()
                .rev()
                .find(|(region, _)| region.contains(x, y))
                .map_or(*background, |&(_, value)| value),
            Self::Exact(exact) => exact.source(x, y),
        }
    }

    /// Value at (x, y), which on a jump is the limit from the side `tie` inside the square.
    pub fn sample(&self, x: f64, y: f64, tie: Tie) -> f64 {
        if let Self::Exact(exact) = self {
            return exact.source(x, y);
        }
        self.at(tie.step_off(x, 0), tie.step_off(y, 1))
    }
}

impl Tie {
    /// The coordinate `t` along axis 0 or 1, moved off any jump there to the side that this rule takes,
    /// or to the other one if that lies outside the square.
    pub fn step_off(self, t: f64, axis: usize) -> f64 {
        let upward = match self {
            Self::LowerLeft => [false, false],
            Self::LowerRight => [true, false],
            Self::UpperLeft => [false, true],
            Self::UpperRight => [true, true],
        };
        let step = if upward[axis] { STEP_OFF } else { -STEP_OFF };
        let moved = t + step;
        if moved.abs() <= 0.5 { moved } else { t - step }
    }
}

/// The canonical text: what [`FromStr`] reads, one spelling per right-hand side.
impl fmt::Display for Source {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Pieces { background, pieces } => {
                for (region, value) in pieces {
                    write!(out, "{region}={value}; ")?;
                }
                write!(out, "else={background}")
            }
            Self::Exact(exact) => write!(out, "exact({})", exact.name()),
        }
    }
}

impl FromStr for Source {
    type Err = SourceError;

    fn from_str(text: &str) -> Result<Self, SourceError> {
        if let Some(name) = text.trim().strip_prefix("exact(").and_then(|t| t.strip_suffix(')')) {
            return Exact::named(name.trim())
                .map(Self::Exact)
                .ok_or_else(|| SourceError::UnknownExact(one_line(name)));
        }
        let (mut background, mut pieces) = (None, Vec::new());
        for item in text.split([';', '\n']).map(str::trim).filter(|item| !item.is_empty()) {
            let syntax = || SourceError::Syntax(item.into());
            let (left, value) = item.split_once('=').ok_or_else(syntax)?;
            let value = number(value)?;
            if left.trim() == "else" {
                if background.replace(value).is_some() {
                    return Err(syntax());
                }
            } else {
                pieces.push((region(left.trim()).ok_or_else(syntax)??, value));
            }
        }
        // Quadrants may cover the square between them; anything else must say what lies around it.
        let covered = [(false, false), (false, true), (true, false), (true, true)].into_iter().all(
            |(right, upper)| pieces.iter().any(|(r, _)| *r == Region::Quadrant { right, upper }),
        );
        match background {
            Some(background) => Ok(Self::Pieces { background, pieces }),
            None if covered => Ok(Self::Pieces { background: 0.0, pieces }),
            None => Err(SourceError::Syntax(format!("{}` without `else=value", one_line(text)))),
        }
    }
}

/// A text to be quoted in a message.
fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

fn number(text: &str) -> Result<f64, SourceError> {
    let value: f64 = text.trim().parse().map_err(|_| SourceError::Syntax(text.trim().into()))?;
    if value.is_finite() { Ok(value) } else { Err(SourceError::NotFinite(text.trim().into())) }
}

/// `None` if the text is not `name(arguments)` with a known name.
fn region(text: &str) -> Option<Result<Region, SourceError>> {
    let (name, rest) = text.split_once('(')?;
    let inner = rest.strip_suffix(')')?;
    let numbers = || -> Result<Vec<f64>, SourceError> { inner.split(',').map(number).collect() };
    let wrong = |name, want, example| SourceError::Arguments { name, want, example };
    let parsed = match name.trim() {
        "rect" => numbers().and_then(|n| match n[..] {
            [x0, x1, y0, y1] => Ok(Region::Rect { x: [x0, x1], y: [y0, y1] }),
            _ => Err(wrong("rect", "x0,x1,y0,y1", "rect(-0.25,0.25,-0.25,0.25)")),
        }),
        "halfplane" => numbers().and_then(|n| match n[..] {
            [a, b, c] => Ok(Region::HalfPlane { a, b, c }),
            _ => Err(wrong("halfplane", "a,b,c of a x + b y <= c", "halfplane(1,1,0)")),
        }),
        "disc" => numbers().and_then(|n| match n[..] {
            [x, y, radius] => Ok(Region::Disc { centre: [x, y], radius }),
            _ => Err(wrong("disc", "x,y,radius", "disc(0,0,0.25)")),
        }),
        "quadrant" => match inner.trim() {
            "ll" => Ok(Region::Quadrant { right: false, upper: false }),
            "lr" => Ok(Region::Quadrant { right: true, upper: false }),
            "ul" => Ok(Region::Quadrant { right: false, upper: true }),
            "ur" => Ok(Region::Quadrant { right: true, upper: true }),
            _ => Err(wrong("quadrant", "one of ll, lr, ul, ur", "quadrant(ll)")),
        },
        _ => return None,
    };
    Some(parsed.and_then(|region| {
        let empty = match region {
            Region::Rect { x, y } => x[0] >= x[1] || y[0] >= y[1],
            Region::HalfPlane { a, b, .. } => a == 0.0 && b == 0.0,
            Region::Disc { radius, .. } => radius <= 0.0,
            Region::Quadrant { .. } => false,
        };
        if empty { Err(SourceError::EmptyRegion(text.into())) } else { Ok(region) }
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn last_piece_wins_and_text_round_trips() {
        let text = "halfplane(1,1,0)=2; rect(-0.25,0.25,-0.25,0.25)=1.5; disc(0,0,0.1)=-7; else=-1";
        let f: Source = text.parse().unwrap();
        assert_eq!(f.at(0.0, 0.0), -7.0);
        assert_eq!(f.at(0.2, 0.2), 1.5);
        assert_eq!(f.at(-0.4, -0.4), 2.0);
        assert_eq!(f.at(0.4, 0.4), -1.0);
        assert_eq!(f.to_string(), text);
    }

    #[test]
    fn ties_choose_the_side_of_a_jump_and_stay_inside_the_square() {
        let f: Source =
            "quadrant(ll)=1; quadrant(lr)=2; quadrant(ul)=3; quadrant(ur)=4".parse().unwrap();
        assert_eq!(f.sample(0.0, 0.0, Tie::LowerLeft), 1.0);
        assert_eq!(f.sample(0.0, 0.0, Tie::LowerRight), 2.0);
        assert_eq!(f.sample(0.0, 0.0, Tie::UpperLeft), 3.0);
        assert_eq!(f.sample(0.0, 0.0, Tie::UpperRight), 4.0);
        let edge: Source = "rect(-0.5,0.5,-0.5,0.5)=1; else=9".parse().unwrap();
        assert_eq!(edge.sample(-0.5, -0.5, Tie::LowerLeft), 1.0);
        assert_eq!(edge.sample(0.5, 0.5, Tie::UpperRight), 1.0);
    }

    #[test]
    fn bad_texts_are_refused_with_a_remedy() {
        let message = |text: &str| text.parse::<Source>().unwrap_err().to_string();
        assert!(message("rect(0,1)=2; else=1").contains("rect(-0.25,0.25,-0.25,0.25)"));
        assert!(message("rect(1,0,0,1)=2; else=1").contains("covers nothing"));
        assert!(message("rect(0,1,1,1)=2; else=1").contains("covers nothing"));
        assert!(message("disc(0,0,0)=2; else=1").contains("covers nothing"));
        assert!(message("halfplane(0,0,1)=2; else=1").contains("covers nothing"));
        assert!(message("else=nan").contains("not a finite number"));
        assert!(message("rect(0,inf,0,1)=1; else=1").contains("not a finite number"));
        assert!(message("circle(0,0,1)=2; else=1").contains("cannot read"));
        assert!(message("rect(0,1,0,1)=2").contains("without `else"));
        assert!(message("exact(nothing)").contains("choose one of"));
    }
}
