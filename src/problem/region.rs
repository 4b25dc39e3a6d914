//! Regions of the plane on which f is constant; all are convex.

use std::f64::consts::PI;
use std::f64::{INFINITY, NEG_INFINITY};
use std::fmt;
use std::ops::Range;

/// A closed convex region of the plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Region {
    /// `rect(x0,x1,y0,y1)`.
    Rect { x: [f64; 2], y: [f64; 2] },
    /// `quadrant(ll|lr|ul|ur)`: a quarter of the plane, axes through the centre of the square.
    Quadrant { right: bool, upper: bool },
    /// `halfplane(a,b,c)`: all points with `a x + b y <= c`.
    HalfPlane { a: f64, b: f64, c: f64 },
    /// `disc(x,y,radius)`.
    Disc { centre: [f64; 2], radius: f64 },
}

impl Region {
    /// A quadrant as an unbounded rectangle, any other region as it is.
    fn plain(self) -> Self {
        let half = |plus: bool| if plus { [0.0, INFINITY] } else { [NEG_INFINITY, 0.0] };
        match self {
            Self::Quadrant { right, upper } => Self::Rect { x: half(right), y: half(upper) },
            other => other,
        }
    }

    /// Whether the closed region holds (x, y).
    pub fn contains(&self, x: f64, y: f64) -> bool {
        match self.plain() {
            Self::Rect { x: [left, right], y: [bottom, top] } => {
                left <= x && x <= right && bottom <= y && y <= top
            }
            Self::HalfPlane { a, b, c } => a * x + b * y <= c,
            Self::Disc { centre: [cx, cy], radius } => {
                let (dx, dy) = (x - cx, y - cy);
                dx * dx + dy * dy <= radius * radius
            }
            Self::Quadrant { .. } => unreachable!("a plain region is no quadrant"),
        }
    }

    /// Which of the increasing abscissas `xs` the region holds at height y, as [`contains`](Self::contains)
    /// has it to the last bit: rounded arithmetic is monotone, so that bisection finds the ends.
    pub fn along(&self, xs: &[f64], y: f64) -> Range<usize> {
        let inside = |&x: &f64| self.contains(x, y);
        // Up to here the region is entered, from here on it is left.
        let turn = match self.plain() {
            Self::Rect { x, .. } => xs.partition_point(|&s| s < x[0]),
            Self::HalfPlane { a, .. } => if a < 0.0 { xs.len() } else { 0 },
            Self::Disc { centre, .. } => xs.partition_point(|&s| s < centre[0]),
            Self::Quadrant { .. } => unreachable!("a plain region is no quadrant"),
        };
        let start = xs[..turn].partition_point(|x| !inside(x));
        let end = turn + xs[turn..].partition_point(inside);
        start..end.max(start)
    }

    /// Least and greatest x of the region in the strip `y[0] <= y <= y[1]`; nothing if it is empty there.
    pub fn extent(&self, y: [f64; 2]) -> Option<[f64; 2]> {
        match self.plain() {
            Self::Rect { x, y: [bottom, top] } => (bottom <= y[1] && y[0] <= top).then_some(x),
            Self::HalfPlane { a, b, c } => {
                let scale = a.abs().max(b.abs());
                let (a, b, c) = (a / scale, b / scale, c / scale);
                let room = c - (b * y[0]).min(b * y[1]);
                match a {
                    0.0 => (room >= 0.0).then_some([NEG_INFINITY, INFINITY]),
                    a if a > 0.0 => Some([NEG_INFINITY, room / a]),
                    a => Some([room / a, INFINITY]),
                }
            }
            Self::Disc { centre: [cx, cy], radius } => {
                let away = (y[0] - cy).max(cy - y[1]).max(0.0);
                let half = ((radius - away) * (radius + away)).sqrt();
                (away <= radius).then_some([cx - half, cx + half])
            }
            Self::Quadrant { .. } => unreachable!("a plain region is no quadrant"),
        }
    }

    /// The region as an intersection of half-planes `a x + b y <= c`, `[a, b, c]` each, to draw it: a disc
    /// becomes the regular polygon of the same area with 360 sides, within 2e-5 radii of the circle.
    pub fn half_planes(&self) -> Vec<[f64; 3]> {
        match *self {
            Self::Rect { x, y } => {
                vec![[-1.0, 0.0, -x[0]], [1.0, 0.0, x[1]], [0.0, -1.0, -y[0]], [0.0, 1.0, y[1]]]
            }
            Self::Quadrant { right, upper } => {
                let side = |plus: bool| if plus { -1.0 } else { 1.0 };
                vec![[side(right), 0.0, 0.0], [0.0, side(upper), 0.0]]
            }
            Self::HalfPlane { a, b, c } => vec![[a, b, c]],
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

    /// The same region in the coordinates `(p - origin) / unit`.
    pub fn seen_from(&self, origin: [f64; 2], unit: f64) -> Self {
        let [ox, oy] = origin;
        match self.plain() {
            Self::Rect { x, y } => Self::Rect {
                x: x.map(|x| (x - ox) / unit),
                y: y.map(|y| (y - oy) / unit),
            },
            Self::HalfPlane { a, b, c } => {
                let scale = a.abs().max(b.abs());
                let (a, b, c) = (a / scale, b / scale, c / scale);
                Self::HalfPlane { a, b, c: (c - a * ox - b * oy) / unit }
            }
            Self::Disc { centre: [cx, cy], radius } => Self::Disc {
                centre: [(cx - ox) / unit, (cy - oy) / unit],
                radius: radius / unit,
            },
            Self::Quadrant { .. } => unreachable!("a plain region is no quadrant"),
        }
    }
}

impl fmt::Display for Region {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Rect { x, y } => write!(out, "rect({},{},{},{})", x[0], x[1], y[0], y[1]),
            Self::Quadrant { right, upper } => {
                let name = match (upper, right) {
                    (false, false) => "ll",
                    (false, true) => "lr",
                    (true, false) => "ul",
                    (true, true) => "ur",
                };
                write!(out, "quadrant({name})")
            }
            Self::HalfPlane { a, b, c } => write!(out, "halfplane({a},{b},{c})"),
            Self::Disc { centre, radius } => {
                write!(out, "disc({},{},{radius})", centre[0], centre[1])
            }
        }
    }
}
