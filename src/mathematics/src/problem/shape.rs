//! Shapes on which f is constant, and how the cells of a grid see them; all are convex.

mod notation;

use crate::machine::extremes::two_sum;
use std::f64::consts::PI;
use std::ops::Range;

/// A closed convex shape of the plane, D = 2, or of space, D = 3, with its notation in texts.
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(missing_docs, reason = "fields are the arguments of the notation")]
pub enum Shape<const D: usize> {
    /// Least and greatest coordinate along each axis: `rect(x0,x1,y0,y1)`, without bounds towards two sides one of the
    /// [`QUADRANTS`]; in space `box(x0,x1,y0,y1,z0,z1)`.
    Box([[f64; 2]; D]),
    /// `disc(x,y,radius)`, in space `ball(x,y,z,radius)`.
    Ball { centre: [f64; D], radius: f64 },
    /// `halfplane(a,b,d)`, all points with `a x + b y <= d`; in space `halfspace(a,b,c,d)`, all points with
    /// `a x + b y + c z <= d`.
    HalfSpace { normal: [f64; D], d: f64 },
}

/// The quarters of the plane, axes through the centre of the square, as the sides of [`Shape::Box`], each with its
/// name: lower or upper, left or right.
pub const QUADRANTS: [(&str, [[f64; 2]; 2]); 4] = [
    ("ll", [NEGATIVE, NEGATIVE]),
    ("lr", [POSITIVE, NEGATIVE]),
    ("ul", [NEGATIVE, POSITIVE]),
    ("ur", [POSITIVE, POSITIVE]),
];
const NEGATIVE: [f64; 2] = [f64::NEG_INFINITY, 0.0];
const POSITIVE: [f64; 2] = [0.0, f64::INFINITY];

/// Coordinates of points that are in the square or the cube by more than rounding.
const INSIDE: [f64; 2] = [-0.5 + 1e-9, 0.5 - 1e-9];

/// The largest coordinate of a centre, and radius, over the coordinates of the domain: the border of a disc or ball is
/// then known to 1e-13.
pub(super) const VAST: f64 = 1e3;

impl<const D: usize> Shape<D> {
    /// True if the shape holds a point.
    pub fn contains(&self, point: [f64; D]) -> bool {
        match *self {
            Self::Box(sides) => {
                (0..D).all(|axis| sides[axis][0] <= point[axis] && point[axis] <= sides[axis][1])
            }
            Self::Ball { centre, radius } => {
                let way: [f64; D] = std::array::from_fn(|axis| point[axis] - centre[axis]);
                dot(way, way) <= radius * radius
            }
            Self::HalfSpace { normal, d } => {
                let (normal, d) = plain(normal, d);
                dot(normal, point) <= d
            }
        }
    }

    /// True if the shape has no interior.
    pub fn is_empty(&self) -> bool {
        match *self {
            Self::Box(sides) => sides.iter().any(|[low, high]| low >= high),
            Self::Ball { radius, .. } => radius <= 0.0,
            Self::HalfSpace { normal, .. } => normal == [0.0; D],
        }
    }

    /// True if the shape is round and so large, or so far away, that where its border crosses a domain with coordinates
    /// of this size is lost to rounding.
    pub fn is_vast(&self, size: f64) -> bool {
        match *self {
            Self::Ball { centre, radius } => {
                centre.iter().chain([&radius]).any(|s| s.abs() > VAST * size)
            }
            Self::Box(_) | Self::HalfSpace { .. } => false,
        }
    }

    /// True if the shape does not reach into the square or the cube.
    pub fn is_outside(&self) -> bool {
        self.extent([INSIDE; D])
            .is_none_or(|[least, greatest]| greatest < INSIDE[0] || INSIDE[1] < least)
    }

    /// True if shapes cover the plane, as the four quadrants do. No other shapes without a gap are found.
    pub fn cover(shapes: &[Self]) -> bool {
        QUADRANTS.iter().all(|(_, quadrant)| shapes.iter().any(|shape| shape.has_sides(quadrant)))
    }

    /// True for the box with these sides.
    fn has_sides(&self, sides: &[[f64; 2]]) -> bool {
        matches!(self, Self::Box(own) if own[..] == *sides)
    }

    /// Which of the increasing abscissas `xs` the shape holds where the coordinates but x are those of `at`: bisection
    /// finds the ends as [`Shape::contains`] has them to the last bit, since rounding is monotone.
    pub fn along(&self, xs: &[f64], at: [f64; D]) -> Range<usize> {
        // From here on the shape loses abscissas, and before gains them.
        let turn = match *self {
            Self::Box(sides) => xs.partition_point(|&x| x < sides[0][0]),
            Self::Ball { centre, .. } => xs.partition_point(|&x| x < centre[0]),
            Self::HalfSpace { normal, .. } if normal[0] < 0.0 => xs.len(),
            Self::HalfSpace { .. } => 0,
        };
        let holds = |x: f64| {
            let mut point = at;
            point[0] = x;
            self.contains(point)
        };
        let start = xs[..turn].partition_point(|&x| !holds(x));
        let end = turn + xs[turn..].partition_point(|&x| holds(x));
        start..end.max(start)
    }

    /// Least and greatest x of the shape where the coordinates but x are within `strip`; nothing if it is empty there.
    pub fn extent(&self, strip: [[f64; 2]; D]) -> Option<[f64; 2]> {
        match *self {
            Self::Box(sides) => {
                let meets = |axis: usize| {
                    sides[axis][0] <= strip[axis][1] && strip[axis][0] <= sides[axis][1]
                };
                (1..D).all(meets).then_some(sides[0])
            }
            Self::Ball { centre, radius } => {
                let away = |axis: usize| {
                    let ([low, high], middle) = (strip[axis], centre[axis]);
                    (low - middle).max(middle - high).max(0.0)
                };
                let away = (1..D).map(|axis| away(axis) * away(axis)).sum::<f64>().sqrt();
                let half = ((radius - away) * (radius + away)).sqrt();
                (away <= radius).then_some([centre[0] - half, centre[0] + half])
            }
            Self::HalfSpace { normal, d } => {
                let (normal, d) = scaled(normal, d);
                let least = |axis: usize| {
                    (normal[axis] * strip[axis][0]).min(normal[axis] * strip[axis][1])
                };
                half_line(normal[0], (1..D).fold(d, |room, axis| room - least(axis)))
            }
        }
    }

    /// This shape in coordinates with this origin and unit.
    pub fn seen_from(&self, origin: [f64; D], unit: f64) -> Self {
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
                // The last digit depends on the order of the terms, which is another one in space.
                let left = match D {
                    2 => (0..D).fold(d, |left, axis| left - normal[axis] * origin[axis]),
                    _ => d - dot(normal, origin),
                };
                Self::HalfSpace { normal, d: left / unit }
            }
        }
    }
}

impl Shape<2> {
    /// This shape in coordinates with this origin and unit, a power of two: of a half-plane, all digits of its distance
    /// from the origin, however far that is.
    pub(crate) fn exactly_seen_from(&self, origin: [f64; 2], unit: f64) -> Self {
        let Self::HalfSpace { normal, d } = *self else { return self.seen_from(origin, unit) };
        let (normal, d) = plain(normal, d);
        // Twice the digits: products with their rounding errors, and sums likewise.
        let (mut sum, mut rest) = (d, 0.0);
        for axis in 0..2 {
            let product = -normal[axis] * origin[axis];
            rest += libm::fma(-normal[axis], origin[axis], -product);
            let [total, remainder] = two_sum(sum, product);
            rest += remainder;
            sum = total;
        }
        Self::HalfSpace { normal, d: (sum + rest) / unit }
    }

    /// The shape as an intersection of half-planes `a x + b y <= d`, `[a, b, d]` each, to draw it: a disc becomes the
    /// regular polygon of the same area with 360 sides, within 2e-5 radii of the circle.
    pub fn half_planes(&self) -> Vec<[f64; 3]> {
        match *self {
            Self::Box([x, y]) => {
                // By subtraction, since the negative of zero is another zero.
                let [left, bottom] = [0.0 - x[0], 0.0 - y[0]];
                let sides =
                    [[-1.0, 0.0, left], [1.0, 0.0, x[1]], [0.0, -1.0, bottom], [0.0, 1.0, y[1]]];
                sides.into_iter().filter(|[.., d]| d.is_finite()).collect()
            }
            Self::HalfSpace { normal, d } => {
                let ([a, b], d) = plain(normal, d);
                vec![[a, b, d]]
            }
            Self::Ball { centre: [x, y], radius } => {
                let angle = PI / 360.0;
                let apothem = radius * (angle / libm::tan(angle)).sqrt();
                (0..360)
                    .map(|k| {
                        let (b, a) = libm::sincos(2.0 * angle * f64::from(k));
                        [a, b, a * x + b * y + apothem]
                    })
                    .collect()
            }
        }
    }
}

impl Shape<3> {
    /// The shape at height z, which must not be that of a face; nothing if it does not reach there.
    pub fn slice(&self, z: f64) -> Option<Shape<2>> {
        match *self {
            Self::Box([x, y, [bottom, top]]) => {
                (bottom < z && z < top).then_some(Shape::Box([x, y]))
            }
            Self::Ball { centre: [x, y, height], radius } => {
                let square = (radius - (z - height)) * (radius + (z - height));
                (square > 0.0).then(|| Shape::Ball { centre: [x, y], radius: square.sqrt() })
            }
            Self::HalfSpace { normal: [a, b, c], d } if a == 0.0 && b == 0.0 => {
                (c * z < d).then_some(Shape::Box([[f64::NEG_INFINITY, f64::INFINITY]; 2]))
            }
            Self::HalfSpace { normal, d } => {
                let ([a, b, c], d) = plain(normal, d);
                Some(Shape::HalfSpace { normal: [a, b], d: d - c * z })
            }
        }
    }
}

/// Product of two vectors.
pub(crate) fn dot<const D: usize>(a: [f64; D], b: [f64; D]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// A half-plane or half-space `normal . p <= d` with a normal whose greatest component is 1 in size.
pub(crate) fn scaled<const D: usize>(normal: [f64; D], d: f64) -> ([f64; D], f64) {
    let scale = normal.iter().fold(0.0f64, |most, s| most.max(s.abs()));
    (normal.map(|s| s / scale), d / scale)
}

/// This half-plane or half-space with a normal whose products with coordinates are normal numbers: scaled by a power
/// of two, which changes no digit, where its components are extremely small or large.
pub(crate) fn plain<const D: usize>(normal: [f64; D], d: f64) -> ([f64; D], f64) {
    let largest = normal.iter().fold(0.0f64, |most, s| most.max(s.abs()));
    // In two steps, since the reciprocal of a subnormal number is infinite.
    let steps = match largest {
        tiny if tiny < 1e-150 => [600, 474],
        huge if huge > 1e150 => [-450, -450],
        _ => return (normal, d),
    };
    let [first, second] = steps.map(|step| libm::ldexp(1.0, step));
    (normal.map(|s| s * first * second), d * first * second)
}

/// Least and greatest x with `a x <= room`; nothing if there is none.
fn half_line(a: f64, room: f64) -> Option<[f64; 2]> {
    match a {
        0.0 => (room >= 0.0).then_some([f64::NEG_INFINITY, f64::INFINITY]),
        a if a > 0.0 => Some([f64::NEG_INFINITY, room / a]),
        a => Some([room / a, f64::INFINITY]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_planes_keep_all_digits_far_from_the_origin() {
        // 0.1 x + 0.3 y <= d by the binary values of the factors: d - 0.1 x - 0.3 y there, by exact fractions.
        for (d, origin, left) in EXACT {
            let shape = Shape::HalfSpace { normal: [0.1, 0.3], d };
            let Shape::HalfSpace { normal, d: seen } = shape.exactly_seen_from(origin, 4.0) else {
                panic!("a half-plane")
            };
            assert_eq!((normal, seen), ([0.1, 0.3], left / 4.0), "{d} {origin:?}");
        }
    }

    /// Distances d, origins, and what is left of the distances.
    const EXACT: [(f64, [f64; 2], f64); 4] = [
        (1549999.44, [500004.0, 5000004.0], -2.160000000003144),
        (0.3, [67108864.0, -22369621.0], 0.19999999937911828),
        (0.001, [0.0, 0.0], 0.001),
        (-7700000.0, [-33554430.0, -16777216.0], 688607.8),
    ];
}
