//! Regions of the plane on which f is constant; all are convex.

use std::f64::consts::PI;
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

/// A closed convex set, as the cells of a grid see it; `N` is the dimension less one.
pub trait Convex<const N: usize>: Copy {
    /// Which of the increasing abscissas `xs` the set holds where the other coordinates are `at`: bisection
    /// finds the ends as [`contains`](Region::contains) has them to the last bit, since rounding is monotone.
    fn along(&self, xs: &[f64], at: [f64; N]) -> Range<usize>;

    /// Least and greatest x of the set where the other coordinates are within `strip`; nothing if it is empty there.
    fn extent(&self, strip: [[f64; 2]; N]) -> Option<[f64; 2]>;

    /// The same set in coordinates with their origin at (`x`, `at`) and this unit.
    fn seen_from(&self, x: f64, at: [f64; N], unit: f64) -> Self;
}

/// Bisects for the run of abscissas with a property that none loses before, or gains from, `turn` on.
pub(super) fn run(xs: &[f64], turn: usize, inside: impl Fn(f64) -> bool) -> Range<usize> {
    let start = xs[..turn].partition_point(|&x| !inside(x));
    let end = turn + xs[turn..].partition_point(|&x| inside(x));
    start..end.max(start)
}

impl Region {
    /// A quadrant as an unbounded rectangle, any other region as it is.
    fn plain(self) -> Self {
        let half = |plus: bool| if plus { [0.0, f64::INFINITY] } else { [f64::NEG_INFINITY, 0.0] };
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
}

/// A half-plane with a normal whose greatest component is 1 in size.
fn scaled(a: f64, b: f64, c: f64) -> (f64, f64, f64) {
    let scale = a.abs().max(b.abs());
    (a / scale, b / scale, c / scale)
}

impl Convex<1> for Region {
    fn along(&self, xs: &[f64], [y]: [f64; 1]) -> Range<usize> {
        let turn = match self.plain() {
            Self::Rect { x, .. } => xs.partition_point(|&s| s < x[0]),
            Self::HalfPlane { a, .. } if a < 0.0 => xs.len(),
            Self::Disc { centre, .. } => xs.partition_point(|&s| s < centre[0]),
            _ => 0,
        };
        run(xs, turn, |x| self.contains(x, y))
    }

    fn extent(&self, [y]: [[f64; 2]; 1]) -> Option<[f64; 2]> {
        match self.plain() {
            Self::Rect { x, y: [bottom, top] } => (bottom <= y[1] && y[0] <= top).then_some(x),
            Self::HalfPlane { a, b, c } => {
                let (a, b, c) = scaled(a, b, c);
                let room = c - (b * y[0]).min(b * y[1]);
                match a {
                    0.0 => (room >= 0.0).then_some([f64::NEG_INFINITY, f64::INFINITY]),
                    a if a > 0.0 => Some([f64::NEG_INFINITY, room / a]),
                    a => Some([room / a, f64::INFINITY]),
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

    fn seen_from(&self, x: f64, [y]: [f64; 1], unit: f64) -> Self {
        match self.plain() {
            Self::Rect { x: [left, right], y: [bottom, top] } => Self::Rect {
                x: [(left - x) / unit, (right - x) / unit],
                y: [(bottom - y) / unit, (top - y) / unit],
            },
            Self::HalfPlane { a, b, c } => {
                let (a, b, c) = scaled(a, b, c);
                Self::HalfPlane { a, b, c: (c - a * x - b * y) / unit }
            }
            Self::Disc { centre: [cx, cy], radius } => {
                Self::Disc { centre: [(cx - x) / unit, (cy - y) / unit], radius: radius / unit }
            }
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
