//! Regions of the plane on which f is constant; all are convex.

use super::exact::Exact;
use super::shape::{
    Convex, INSIDE, List, Shape, SourceError, VAST, half_line, misses, numbers, plain, run, scaled,
};
use std::f64::consts::PI;
use std::fmt;
use std::ops::Range;

/// A closed convex region of the plane.
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(missing_docs, reason = "fields are the arguments of the notation")]
pub enum Region {
    /// `rect(x0,x1,y0,y1)`; without bounds towards two sides, one of the [`QUADRANTS`].
    Rect { x: [f64; 2], y: [f64; 2] },
    /// `halfplane(a,b,c)`: all points with `a x + b y <= c`.
    HalfPlane { a: f64, b: f64, c: f64 },
    /// `disc(x,y,radius)`.
    Disc { centre: [f64; 2], radius: f64 },
}

impl Region {
    /// The region as an intersection of half-planes `a x + b y <= c`, `[a, b, c]` each, to draw it: a disc
    /// becomes the regular polygon of the same area with 360 sides, within 2e-5 radii of the circle.
    pub fn half_planes(&self) -> Vec<[f64; 3]> {
        match *self {
            Self::Rect { x, y } => {
                // By subtraction, since the negative of zero is another zero.
                let [left, bottom] = [0.0 - x[0], 0.0 - y[0]];
                let sides =
                    [[-1.0, 0.0, left], [1.0, 0.0, x[1]], [0.0, -1.0, bottom], [0.0, 1.0, y[1]]];
                sides.into_iter().filter(|[.., c]| c.is_finite()).collect()
            }
            Self::HalfPlane { a, b, c } => {
                let ([a, b], c) = plain([a, b], c);
                vec![[a, b, c]]
            }
            Self::Disc { centre: [cx, cy], radius } => {
                let angle = PI / 360.0;
                let apothem = radius * (angle / libm::tan(angle)).sqrt();
                (0..360)
                    .map(|k| {
                        let (b, a) = libm::sincos(2.0 * angle * f64::from(k));
                        [a, b, a * cx + b * cy + apothem]
                    })
                    .collect()
            }
        }
    }
}

impl Shape for Region {
    type Point = [f64; 2];
    type Exact = Exact;
    const DIMENSION: usize = 2;
    const EXAMPLE: &'static str = "rect(-0.25,0.25,-0.25,0.25)=1.5; else=-1";

    fn contains(&self, [x, y]: [f64; 2]) -> bool {
        match *self {
            Self::Rect { x: [left, right], y: [bottom, top] } => {
                left <= x && x <= right && bottom <= y && y <= top
            }
            Self::HalfPlane { a, b, c } => {
                let ([a, b], c) = plain([a, b], c);
                a * x + b * y <= c
            }
            Self::Disc { centre: [cx, cy], radius } => {
                let (dx, dy) = (x - cx, y - cy);
                dx * dx + dy * dy <= radius * radius
            }
        }
    }

    fn read(name: &str, text: &str) -> Option<Result<Self, SourceError>> {
        Some(match name {
            "rect" => numbers(text, ["rect", "x0,x1,y0,y1", "rect(-0.25,0.25,-0.25,0.25)"])
                .map(|[x0, x1, y0, y1]| Self::Rect { x: [x0, x1], y: [y0, y1] }),
            "halfplane" => {
                numbers(text, ["halfplane", "a,b,c of a x + b y <= c", "halfplane(1,1,0)"])
                    .map(|[a, b, c]| Self::HalfPlane { a, b, c })
            }
            "disc" => numbers(text, ["disc", "x,y,radius", "disc(0,0,0.25)"])
                .map(|[x, y, radius]| Self::Disc { centre: [x, y], radius }),
            "quadrant" => match QUADRANTS.iter().find(|(name, _)| *name == text.trim()) {
                Some(&(_, quadrant)) => Ok(quadrant),
                None => Err(SourceError::Arguments {
                    name: "quadrant",
                    want: "one of ll, lr, ul, ur",
                    example: "quadrant(ll)",
                }),
            },
            _ => return None,
        })
    }

    fn is_empty(&self) -> bool {
        match *self {
            Self::Rect { x, y } => x[0] >= x[1] || y[0] >= y[1],
            Self::HalfPlane { a, b, .. } => a == 0.0 && b == 0.0,
            Self::Disc { radius, .. } => radius <= 0.0,
        }
    }

    fn is_vast(&self, size: f64) -> bool {
        match *self {
            Self::Disc { centre: [x, y], radius } => {
                [x, y, radius].iter().any(|s| s.abs() > VAST * size)
            }
            _ => false,
        }
    }

    fn is_outside(&self) -> bool {
        misses(self.extent([INSIDE]))
    }

    fn cover(regions: &[Self]) -> bool {
        QUADRANTS.iter().all(|(_, quadrant)| regions.contains(quadrant))
    }
}

/// The quarters of the plane, axes through the centre of the square, each with its name: lower or upper, left or right.
pub const QUADRANTS: [(&str, Region); 4] = [
    ("ll", Region::Rect { x: NEGATIVE, y: NEGATIVE }),
    ("lr", Region::Rect { x: POSITIVE, y: NEGATIVE }),
    ("ul", Region::Rect { x: NEGATIVE, y: POSITIVE }),
    ("ur", Region::Rect { x: POSITIVE, y: POSITIVE }),
];
const NEGATIVE: [f64; 2] = [f64::NEG_INFINITY, 0.0];
const POSITIVE: [f64; 2] = [0.0, f64::INFINITY];

impl Convex<1> for Region {
    fn along(&self, xs: &[f64], [y]: [f64; 1]) -> Range<usize> {
        let turn = match *self {
            Self::Rect { x: [left, right], y: [bottom, top] } => {
                let start = xs.partition_point(|&x| x < left);
                let held = bottom <= y && y <= top;
                let end = if held { xs.partition_point(|&x| x <= right) } else { start };
                return start..end.max(start);
            }
            Self::HalfPlane { a, .. } if a < 0.0 => xs.len(),
            Self::Disc { centre, .. } => xs.partition_point(|&s| s < centre[0]),
            Self::HalfPlane { .. } => 0,
        };
        run(xs, turn, |x| self.contains([x, y]))
    }

    fn extent(&self, [y]: [[f64; 2]; 1]) -> Option<[f64; 2]> {
        match *self {
            Self::Rect { x, y: [bottom, top] } => (bottom <= y[1] && y[0] <= top).then_some(x),
            Self::HalfPlane { a, b, c } => {
                let ([a, b], c) = scaled([a, b], c);
                half_line(a, c - (b * y[0]).min(b * y[1]))
            }
            Self::Disc { centre: [cx, cy], radius } => {
                let away = (y[0] - cy).max(cy - y[1]).max(0.0);
                let half = ((radius - away) * (radius + away)).sqrt();
                (away <= radius).then_some([cx - half, cx + half])
            }
        }
    }

    fn seen_from(&self, x: f64, [y]: [f64; 1], unit: f64) -> Self {
        match *self {
            Self::Rect { x: [left, right], y: [bottom, top] } => Self::Rect {
                x: [(left - x) / unit, (right - x) / unit],
                y: [(bottom - y) / unit, (top - y) / unit],
            },
            Self::HalfPlane { a, b, c } => {
                let ([a, b], c) = scaled([a, b], c);
                Self::HalfPlane { a, b, c: (c - a * x - b * y) / unit }
            }
            Self::Disc { centre: [cx, cy], radius } => {
                Self::Disc { centre: [(cx - x) / unit, (cy - y) / unit], radius: radius / unit }
            }
        }
    }
}

impl fmt::Display for Region {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some((name, _)) = QUADRANTS.iter().find(|(_, quadrant)| quadrant == self) {
            return write!(out, "quadrant({name})");
        }
        match self {
            Self::Rect { x: [x0, x1], y: [y0, y1] } => {
                write!(out, "rect({})", List(&[*x0, *x1, *y0, *y1]))
            }
            Self::HalfPlane { a, b, c } => write!(out, "halfplane({})", List(&[*a, *b, *c])),
            Self::Disc { centre, radius } => {
                write!(out, "disc({})", List(&[centre[0], centre[1], *radius]))
            }
        }
    }
}
