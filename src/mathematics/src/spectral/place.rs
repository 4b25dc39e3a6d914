//! Points of the boundary, relative to the corners.

use crate::problem::complex::Complex;

/// Corners of the square, anticlockwise from the lower right one.
pub(super) const CORNERS: [Complex; 4] = [
    Complex::new(0.5, -0.5),
    Complex::new(0.5, 0.5),
    Complex::new(-0.5, 0.5),
    Complex::new(-0.5, -0.5),
];

/// Point of the boundary: a corner, counted anticlockwise from the lower right one and on after a full
/// turn, and the distance from it, negative before it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct BoundaryPlace {
    pub corner: i32,
    pub t: f64,
}

impl BoundaryPlace {
    /// Returns the point at a distance from a corner, seen from its nearest corner.
    pub(super) fn new(corner: i32, t: f64) -> Self {
        let corners = (t - 0.5).ceil();
        Self { corner: corner + corners as i32, t: t - corners }
    }

    /// Returns the point of the boundary nearest to `z`.
    pub(super) fn nearest(z: Complex) -> Self {
        let corner = (0..4)
            .min_by(|&j, &k| (CORNERS[j] - z).norm2().total_cmp(&(CORNERS[k] - z).norm2()))
            .expect("a square has corners");
        let to = z - CORNERS[corner];
        let (after, before) = (tangent(corner as i32, 1.0), tangent(corner as i32, -1.0));
        let t = [after.dot(to), before.dot(to)];
        Self { corner: corner as i32, t: if t[0] > -t[1] { t[0] } else { t[1] } }
    }

    pub(super) fn distance_from(self, corner: i32) -> f64 {
        self.t + f64::from(self.corner - corner)
    }

    /// Length of the boundary from `other` to here.
    pub(super) fn after(self, other: Self) -> f64 {
        self.distance_from(other.corner) - other.t
    }

    /// Returns this point with its corner counted so that it is less than one turn after `start`.
    pub(super) fn following(self, start: Self) -> Self {
        let turns = (self.after(start) / 4.0).floor() as i32;
        Self { corner: self.corner - 4 * turns, t: self.t }
    }

    /// Side of the point, numbered by the corner at which it begins, and the distance from this corner.
    #[inline(always)]
    pub(super) fn on_side(self) -> (i32, f64) {
        let Self { corner, t } = self;
        let (side, t) = if t < 0.0 { (corner - 1, 1.0 + t) } else { (corner, t) };
        (side.rem_euclid(4), t)
    }

    pub(super) fn point(self) -> Complex {
        CORNERS[self.corner.rem_euclid(4) as usize] + tangent(self.corner, self.t).scaled(self.t)
    }
}

/// Distances from the corner at which a side begins, of those of some points of the boundary that lie on the side.
pub(super) fn on_side(points: &[Complex], side: i32) -> impl Iterator<Item = f64> {
    let places = points.iter().map(|&z| BoundaryPlace::nearest(z).on_side());
    places.filter(move |&(met, _)| met == side).map(|(_, t)| t)
}

/// Direction of the boundary, anticlockwise, after a corner (`t` positive) or before it.
pub(super) fn tangent(corner: i32, t: f64) -> Complex {
    const TANGENTS: [Complex; 4] = [
        Complex::new(0.0, 1.0),
        Complex::new(-1.0, 0.0),
        Complex::new(0.0, -1.0),
        Complex::new(1.0, 0.0),
    ];
    TANGENTS[(corner - i32::from(t < 0.0)).rem_euclid(4) as usize]
}
