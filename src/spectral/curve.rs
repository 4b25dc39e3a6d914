//! Lines and circles: where they meet, and those that bound a region.

use super::complex::Complex;
use crate::problem::region::Region;
use std::f64::consts::TAU;

/// Points closer than this count as one: about 1e-12, but no decimal number, so that a decimal distance is never at
/// the limit.
pub(super) const SAME: f64 = 1.0 / (1_u64 << 40) as f64;

/// A line or circle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Curve {
    /// The points z with Re(conj(normal) z) = offset, by distance along the normal turned left.
    Line { normal: Complex, offset: f64 },
    /// By angle, anticlockwise.
    Circle { centre: Complex, radius: f64 },
}

impl Curve {
    pub(super) fn at(self, s: f64) -> Complex {
        match self {
            Self::Line { normal, offset } => normal.scaled(offset) + normal.turned().scaled(s),
            Self::Circle { centre, radius } => centre + Complex::unit(s).scaled(radius),
        }
    }

    /// The unit normal to the right of the curve.
    pub(super) fn normal(self, s: f64) -> Complex {
        match self {
            Self::Line { normal, .. } => normal,
            Self::Circle { .. } => Complex::unit(s),
        }
    }

    /// Length per parameter.
    pub(super) fn speed(self) -> f64 {
        match self {
            Self::Line { .. } => 1.0,
            Self::Circle { radius, .. } => radius,
        }
    }

    /// Parameters at which it meets another curve.
    pub(super) fn meets(self, other: Self) -> Vec<f64> {
        match (self, other) {
            (Self::Line { normal, offset }, Self::Line { normal: n, offset: o }) => {
                let slope = n.dot(normal.turned());
                if slope.abs() < 1e-9 {
                    Vec::new()
                } else {
                    vec![(o - offset * n.dot(normal)) / slope]
                }
            }
            (Self::Line { normal, offset }, Self::Circle { centre, radius }) => {
                let (foot, off) = (normal.turned().dot(centre), offset - normal.dot(centre));
                half_chord(radius, off, radius).map_or(Vec::new(), |h| vec![foot - h, foot + h])
            }
            (Self::Circle { centre, radius }, Self::Line { normal, offset }) => {
                self.cut(normal, offset - normal.dot(centre), [radius; 2])
            }
            (Self::Circle { centre, radius }, Self::Circle { centre: c, radius: r }) => {
                let to = c - centre;
                let distance = to.norm();
                if distance < SAME {
                    return Vec::new();
                }
                let along = 0.5 * (distance + (radius - r) * (radius + r) / distance);
                self.cut(to.scaled(1.0 / distance), along, [radius, r])
            }
        }
    }

    /// Angles at which a circle meets the line at `along` from its centre in a direction; `radii` are its own and
    /// that of the circle it meets there.
    fn cut(self, direction: Complex, along: f64, [radius, other]: [f64; 2]) -> Vec<f64> {
        let Some(half) = half_chord(radius, along, radius.min(other)) else { return Vec::new() };
        let (middle, spread) = (direction.arg(), libm::atan2(half, along));
        [middle - spread, middle + spread].map(|s| s - TAU * (s / TAU).floor()).to_vec()
    }

    /// How far its points may be off: those of a large circle by rounding errors of its radius.
    pub(super) fn rounding(self) -> f64 {
        SAME.max(1e-14 * self.speed())
    }

    /// Whether a point lies on it.
    pub(super) fn holds(self, z: Complex) -> bool {
        let distance = match self {
            Self::Line { normal, offset } => normal.dot(z) - offset,
            Self::Circle { centre, radius } => (z - centre).norm() - radius,
        };
        distance.abs() < self.rounding()
    }

    pub(super) fn same(self, other: Self) -> bool {
        match (self, other) {
            (Self::Line { normal, offset }, Self::Line { normal: n, offset: o }) => {
                (normal - n).norm() < SAME && (offset - o).abs() < SAME
            }
            (Self::Circle { centre, radius }, Self::Circle { centre: c, radius: r }) => {
                (centre - c).norm() < SAME && (radius - r).abs() < SAME
            }
            _ => false,
        }
    }
}

/// Half a chord `along` from the centre, zero if it cuts off, or lacks, less than [`SAME`] of the smallest circle
/// there: a tangency, frequent with decimal input. None without points in common.
fn half_chord(radius: f64, along: f64, smallest: f64) -> Option<f64> {
    let (square, tangent) = (radius * radius - along * along, smallest * SAME);
    (square > -tangent).then(|| if square < tangent { 0.0 } else { square.sqrt() })
}

/// The lines of the sides.
pub(super) const SIDES: [Curve; 4] = [
    Curve::Line { normal: Complex::new(1.0, 0.0), offset: -0.5 },
    Curve::Line { normal: Complex::new(1.0, 0.0), offset: 0.5 },
    Curve::Line { normal: Complex::new(0.0, 1.0), offset: -0.5 },
    Curve::Line { normal: Complex::new(0.0, 1.0), offset: 0.5 },
];

/// The parameters of the points of a line in the closed square, if it meets the inside.
pub(super) fn in_square(line: Curve) -> Option<[f64; 2]> {
    let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
    let (origin, tangent) = (line.at(0.0), line.normal(0.0).turned());
    for (o, t) in [(origin.re, tangent.re), (origin.im, tangent.im)] {
        if t.abs() < 1e-15 {
            if o.abs() >= 0.5 - SAME {
                return None;
            }
            continue;
        }
        let (a, b) = ((-0.5 - o) / t, (0.5 - o) / t);
        (low, high) = (low.max(a.min(b)), high.min(a.max(b)));
    }
    (high - low > SAME).then_some([low, high])
}

/// The curves that bound a region.
pub(super) fn borders(region: &Region) -> Vec<Curve> {
    if let Region::Disc { centre: [x, y], radius } = *region {
        return vec![Curve::Circle { centre: Complex::new(x, y), radius }];
    }
    let line = |[a, b, c]: [f64; 3]| {
        // One orientation for each line, so that common borders are found to be one.
        let flip = if a < 0.0 || (a == 0.0 && b < 0.0) { -1.0 } else { 1.0 };
        let scale = flip / (a * a + b * b).sqrt();
        Curve::Line { normal: Complex::new(a, b).scaled(scale), offset: c * scale }
    };
    region.half_planes().into_iter().map(line).collect()
}
