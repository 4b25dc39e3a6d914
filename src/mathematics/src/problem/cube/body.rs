//! Bodies on which f is constant; all are convex.

use super::exact::Exact;
use crate::problem::region::Region;
use crate::problem::shape::{
    Convex, INSIDE, List, Shape, SourceError, VAST, half_line, misses, numbers, plain, run, scaled,
};
use std::fmt;
use std::ops::Range;

/// A closed convex body.
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(missing_docs, reason = "fields are the arguments of the notation")]
pub enum Body {
    /// `box(x0,x1,y0,y1,z0,z1)`.
    Box([[f64; 2]; 3]),
    /// `ball(x,y,z,radius)`.
    Ball { centre: [f64; 3], radius: f64 },
    /// `halfspace(a,b,c,d)`: all points with `a x + b y + c z <= d`.
    HalfSpace { normal: [f64; 3], d: f64 },
}

impl Body {
    /// The body at height z, which must not be that of a face; nothing if it does not reach there.
    pub fn slice(&self, z: f64) -> Option<Region> {
        match *self {
            Self::Box([x, y, [bottom, top]]) => {
                (bottom < z && z < top).then_some(Region::Rect { x, y })
            }
            Self::Ball { centre: [x, y, height], radius } => {
                let square = (radius - (z - height)) * (radius + (z - height));
                (square > 0.0).then(|| Region::Disc { centre: [x, y], radius: square.sqrt() })
            }
            Self::HalfSpace { normal: [a, b, c], d } if a == 0.0 && b == 0.0 => (c * z < d)
                .then_some(Region::Rect {
                    x: [f64::NEG_INFINITY, f64::INFINITY],
                    y: [f64::NEG_INFINITY, f64::INFINITY],
                }),
            Self::HalfSpace { normal, d } => {
                let ([a, b, c], d) = plain(normal, d);
                Some(Region::HalfPlane { a, b, c: d - c * z })
            }
        }
    }
}

impl Shape for Body {
    type Point = [f64; 3];
    type Exact = Exact;
    const DIMENSION: usize = 3;
    const EXAMPLE: &'static str = "box(-0.25,0.25,-0.25,0.25,-0.25,0.25)=3; ball(0,0,0.3,0.1)=2; halfspace(1,1,1,-0.5)=1; else=-1";

    fn contains(&self, point: [f64; 3]) -> bool {
        match *self {
            Self::Box(sides) => {
                (0..3).all(|axis| sides[axis][0] <= point[axis] && point[axis] <= sides[axis][1])
            }
            Self::Ball { centre, radius } => {
                let square = |axis: usize| (point[axis] - centre[axis]).powi(2);
                (0..3).map(square).sum::<f64>() <= radius * radius
            }
            Self::HalfSpace { normal, d } => {
                let ([a, b, c], d) = plain(normal, d);
                a * point[0] + b * point[1] + c * point[2] <= d
            }
        }
    }

    fn read(name: &str, text: &str) -> Option<Result<Self, SourceError>> {
        const BOX: [&str; 3] =
            ["box", "x0,x1,y0,y1,z0,z1", "box(-0.25,0.25,-0.25,0.25,-0.25,0.25)"];
        const HALFSPACE: [&str; 3] =
            ["halfspace", "a,b,c,d of a x + b y + c z <= d", "halfspace(1,1,1,-0.5)"];
        Some(match name {
            "box" => numbers(text, BOX)
                .map(|[x0, x1, y0, y1, z0, z1]| Self::Box([[x0, x1], [y0, y1], [z0, z1]])),
            "ball" => numbers(text, ["ball", "x,y,z,radius", "ball(0,0,0.3,0.1)"])
                .map(|[x, y, z, radius]| Self::Ball { centre: [x, y, z], radius }),
            "halfspace" => numbers(text, HALFSPACE)
                .map(|[a, b, c, d]| Self::HalfSpace { normal: [a, b, c], d }),
            _ => return None,
        })
    }

    fn is_empty(&self) -> bool {
        match *self {
            Self::Box(sides) => sides.iter().any(|[low, high]| low >= high),
            Self::Ball { radius, .. } => radius <= 0.0,
            Self::HalfSpace { normal, .. } => normal == [0.0; 3],
        }
    }

    fn is_vast(&self, size: f64) -> bool {
        match *self {
            Self::Ball { centre: [x, y, z], radius } => {
                [x, y, z, radius].iter().any(|s| s.abs() > VAST * size)
            }
            _ => false,
        }
    }

    fn is_outside(&self) -> bool {
        misses(self.extent([INSIDE; 2]))
    }
}

impl Convex<2> for Body {
    fn along(&self, xs: &[f64], [y, z]: [f64; 2]) -> Range<usize> {
        let turn = match *self {
            Self::Box([x, ..]) => xs.partition_point(|&s| s < x[0]),
            Self::Ball { centre, .. } => xs.partition_point(|&s| s < centre[0]),
            Self::HalfSpace { normal, .. } if normal[0] < 0.0 => xs.len(),
            Self::HalfSpace { .. } => 0,
        };
        run(xs, turn, |x| self.contains([x, y, z]))
    }

    fn extent(&self, strip: [[f64; 2]; 2]) -> Option<[f64; 2]> {
        match *self {
            Self::Box([x, y, z]) => {
                let meets = |(s, t): (&[f64; 2], &[f64; 2])| s[0] <= t[1] && t[0] <= s[1];
                [y, z].iter().zip(&strip).all(meets).then_some(x)
            }
            Self::Ball { centre: [x, y, z], radius } => {
                let away = |[low, high]: [f64; 2], c: f64| (low - c).max(c - high).max(0.0);
                let (dy, dz) = (away(strip[0], y), away(strip[1], z));
                let away = (dy * dy + dz * dz).sqrt();
                let half = ((radius - away) * (radius + away)).sqrt();
                (away <= radius).then_some([x - half, x + half])
            }
            Self::HalfSpace { normal, d } => {
                let ([a, b, c], d) = scaled(normal, d);
                let least = |s: f64, [low, high]: [f64; 2]| (s * low).min(s * high);
                half_line(a, d - least(b, strip[0]) - least(c, strip[1]))
            }
        }
    }

    fn seen_from(&self, x: f64, [y, z]: [f64; 2], unit: f64) -> Self {
        let origin = [x, y, z];
        match *self {
            Self::Box(sides) => Self::Box(std::array::from_fn(|axis| {
                sides[axis].map(|s| (s - origin[axis]) / unit)
            })),
            Self::Ball { centre, radius } => Self::Ball {
                centre: std::array::from_fn(|axis| (centre[axis] - origin[axis]) / unit),
                radius: radius / unit,
            },
            Self::HalfSpace { normal, d } => {
                let (normal, d) = scaled(normal, d);
                let height = normal[0] * x + normal[1] * y + normal[2] * z;
                Self::HalfSpace { normal, d: (d - height) / unit }
            }
        }
    }
}

impl fmt::Display for Body {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Box(sides) => write!(out, "box({})", List(sides.as_flattened())),
            Self::Ball { centre: [x, y, z], radius } => {
                write!(out, "ball({})", List(&[*x, *y, *z, *radius]))
            }
            Self::HalfSpace { normal: [a, b, c], d } => {
                write!(out, "halfspace({})", List(&[*a, *b, *c, *d]))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problem::source::Source;

    #[test]
    fn texts_are_read_and_written() {
        for text in [
            "else=-1",
            "ball(0,0.1,0,0.25)=2; else=-1",
            "box(-0.5,0,-0.5,0,-0.5,0)=1.5; ball(0,0,0,0.1)=-3; else=-1",
            "exact(free-disc)",
        ] {
            assert_eq!(text.parse::<Source<Body>>().unwrap().to_string(), text);
        }
        for wrong in
            ["", "box(0,1)=1; else=0", "ball(0,0,0,0)=1; else=0", "else=nan", "exact(x)", "ball=1"]
        {
            assert!(wrong.parse::<Source<Body>>().is_err(), "{wrong}");
        }
    }
}
