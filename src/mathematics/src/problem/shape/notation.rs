//! Shapes as texts name them.

use super::{QUADRANTS, Shape};
use crate::problem::error::SourceError;
use crate::problem::text::{List, Written, number};
use std::fmt;

/// Name of a kind of shape, and its arguments.
struct Notation {
    name: &'static str,
    /// Arguments, in words.
    arguments: &'static str,
    example: &'static str,
}

/// Names of the shapes in one dimension.
struct ShapeNames {
    with_sides: Notation,
    ball: Notation,
    half_space: Notation,
    /// A right-hand side, for messages.
    example: &'static str,
}

const IN_PLANE: ShapeNames = ShapeNames {
    with_sides: Notation {
        name: "rect",
        arguments: "x0,x1,y0,y1",
        example: "rect(-0.25,0.25,-0.25,0.25)",
    },
    ball: Notation { name: "disc", arguments: "x,y,radius", example: "disc(0,0,0.25)" },
    half_space: Notation {
        name: "halfplane",
        arguments: "a,b,c of a x + b y <= c",
        example: "halfplane(1,1,0)",
    },
    example: "rect(-0.25,0.25,-0.25,0.25)=1.5; else=-1",
};

const IN_SPACE: ShapeNames = ShapeNames {
    with_sides: Notation {
        name: "box",
        arguments: "x0,x1,y0,y1,z0,z1",
        example: "box(-0.25,0.25,-0.25,0.25,-0.25,0.25)",
    },
    ball: Notation { name: "ball", arguments: "x,y,z,radius", example: "ball(0,0,0.3,0.1)" },
    half_space: Notation {
        name: "halfspace",
        arguments: "a,b,c,d of a x + b y + c z <= d",
        example: "halfspace(1,1,1,-0.5)",
    },
    example: "box(-0.25,0.25,-0.25,0.25,-0.25,0.25)=3; ball(0,0,0.3,0.1)=2; halfspace(1,1,1,-0.5)=1; else=-1",
};

impl Notation {
    /// Reads this number of arguments.
    fn read(&self, text: &str, count: usize) -> Result<Vec<f64>, SourceError> {
        let read = |text: &str| number(text).ok_or_else(|| SourceError::not_finite(text));
        let numbers = text.split(',').map(read).collect::<Result<Vec<_>, _>>()?;
        if numbers.len() == count {
            return Ok(numbers);
        }
        let Self { name, arguments, example } = *self;
        Err(SourceError::Arguments { name, want: arguments, example })
    }
}

impl<const D: usize> Shape<D> {
    const NAMES: &'static ShapeNames = if D == 2 { &IN_PLANE } else { &IN_SPACE };

    /// A right-hand side with these shapes, for messages.
    pub const EXAMPLE: &'static str = Self::NAMES.example;

    /// The shape of this name; `None` if there is none. It may be [empty](Self::is_empty).
    pub fn read(name: &str, text: &str) -> Option<Result<Self, SourceError>> {
        let ShapeNames { with_sides, ball, half_space, .. } = Self::NAMES;
        if name == with_sides.name {
            let pair = |numbers: &[f64], axis: usize| [numbers[2 * axis], numbers[2 * axis + 1]];
            let numbers = with_sides.read(text, 2 * D);
            return Some(numbers.map(|n| Self::Box(std::array::from_fn(|axis| pair(&n, axis)))));
        }
        // The coordinates of a vector, and one more number.
        let split = |n: Vec<f64>| (std::array::from_fn(|axis| n[axis]), n[D]);
        if name == ball.name {
            let numbers = ball.read(text, D + 1).map(split);
            return Some(numbers.map(|(centre, radius)| Self::Ball { centre, radius }));
        }
        if name == half_space.name {
            let numbers = half_space.read(text, D + 1).map(split);
            return Some(numbers.map(|(normal, d)| Self::HalfSpace { normal, d }));
        }
        (D == 2 && name == "quadrant").then(|| quadrant(text.trim()))
    }
}

/// The quadrant of this name; none in space.
fn quadrant<const D: usize>(name: &str) -> Result<Shape<D>, SourceError> {
    let found = QUADRANTS.iter().find(|(other, _)| *other == name);
    let sides = found.and_then(|(_, sides)| sides[..].try_into().ok());
    sides.map(Shape::Box).ok_or(SourceError::Arguments {
        name: "quadrant",
        want: "one of ll, lr, ul, ur",
        example: "quadrant(ll)",
    })
}

impl<const D: usize> fmt::Display for Shape<D> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ShapeNames { with_sides, ball, half_space, .. } = Self::NAMES;
        if let Some((name, _)) = QUADRANTS.iter().find(|(_, sides)| self.has_sides(sides)) {
            return write!(out, "quadrant({name})");
        }
        match self {
            Self::Box(sides) => write!(out, "{}({})", with_sides.name, List(sides.as_flattened())),
            Self::Ball { centre, radius } => {
                write!(out, "{}({},{})", ball.name, List(centre), Written(*radius))
            }
            Self::HalfSpace { normal, d } => {
                write!(out, "{}({},{})", half_space.name, List(normal), Written(*d))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::problem::source::Source;

    fn check<const D: usize>(right: &[&str], wrong: &[&str]) {
        for text in right {
            let f: Source<D> = text.parse().unwrap();
            assert_eq!(f.to_string(), *text);
            assert_eq!(f.to_string().parse(), Ok(f));
        }
        for text in wrong {
            assert!(text.parse::<Source<D>>().is_err(), "{D} {text}");
        }
    }

    #[test]
    fn texts_of_both_dimensions_are_read_and_written() {
        check::<2>(
            &[
                "else=-1",
                "rect(-0.5,0,-0.5,1e-7)=1.5; disc(0,-0.1,0.25)=-3; halfplane(1,-1,0)=2; else=-1",
                "quadrant(ll)=1; quadrant(lr)=2; quadrant(ul)=3; quadrant(ur)=4; else=0",
                "exact(full-contact)",
                "exact(free-corner)",
                "formula(x*y - 1)",
            ],
            &[
                "",
                "rect(0,1)=1; else=0",
                "box(0,1,0,1,0,1)=1; else=0",
                "ball(0,0,0,1)=1; else=0",
                "halfspace(1,0,0,0)=1; else=0",
                "disc(0,0,0)=1; else=0",
                "quadrant(xx)=1; else=0",
                "exact(free-disc)",
                "formula(z)",
            ],
        );
        check::<3>(
            &[
                "else=-1",
                "ball(0,0.1,0,0.25)=2; else=-1",
                "box(-0.5,0,-0.5,0,-0.5,0)=1.5; ball(0,0,0,0.1)=-3; else=-1",
                "halfspace(1,-1,0,0.5)=2; else=-1",
                "exact(full-contact)",
                "exact(free-disc)",
                "formula(x*y*z - 1)",
            ],
            &[
                "",
                "box(0,1)=1; else=0",
                "ball(0,0,0,0)=1; else=0",
                "ball=1",
                "rect(0,1,0,1)=1; else=0",
                "disc(0,0,1)=1; else=0",
                "halfplane(1,0,0)=1; else=0",
                "quadrant(ll)=1; else=0",
                "else=nan",
                "exact(torsion)",
            ],
        );
    }
}
