//! By how much the f of a solver may differ from that of the statement, where numbers that nearly agree were taken for
//! equal.

use super::curve::{Curve, Overlap};
use std::f64::consts::{PI, TAU};

/// Bounds of the difference g of both f: what is not known of it is bounded where it may be other than zero.
///
/// The field `r(x) = 1 / 2 pi int (y - x) / |x - y|^2 g(y) dy` has the divergence -g.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Changes {
    /// Bound of the integral of |g|.
    pub mass: f64,
    /// Bound of |r|, or of another field of this divergence.
    pub field: f64,
}

/// Largest modulus of points of a domain in its frame, and of more.
const REACH: f64 = 4.0;
/// Two units in the last place of such points: an error of v, not one of f.
const UNITS: f64 = 4.0 * f64::EPSILON;

impl Changes {
    /// |g| is at most `most` on a set with this area: the field is largest in the middle of a disc.
    pub(super) fn add_area(&mut self, most: f64, area: f64) {
        self.mass += most * area;
        self.field += most * (area / PI).sqrt();
    }

    /// |g| is at most `most` on a disc of this radius.
    pub(super) fn add_disc(&mut self, most: f64, radius: f64) {
        self.add_area(most, PI * radius * radius);
    }

    /// |g| is at most `most` on a strip along a line or a part of a circle, if that is wider than points are exact.
    ///
    /// With s the distance along it from the place next to x, |x - y| is at least `|s| / pi - width / 2`. Where |s| is
    /// less than `2 pi width` the field is at most that of a disc of this area, `2 most width`, elsewhere `2 most width
    /// log(length / (2 pi width))`.
    pub(super) fn add_strip(&mut self, most: f64, [width, length]: [f64; 2]) {
        if width > UNITS {
            self.mass += most * width * length;
            self.field += 2.0 * most * width * (1.0 + libm::log((length / width).max(1.0)));
        }
    }

    /// A curve counts as another one: |g| is at most `most` between both.
    pub(super) fn add_moved(&mut self, most: f64, curve: Curve, to: Curve) {
        /// Largest over the three points of what three equal steps on a circle show.
        const BETWEEN: f64 = 2.4;
        let (third, length) = match curve.period() {
            Some(turn) if turn < 16.0 * TAU => (turn / 3.0, turn.min(TAU * REACH)),
            _ => (REACH, 2.0 * REACH),
        };
        let off = [-third, 0.0, third].map(|s| to.distance(curve.at(s)).abs());
        self.add_strip(most, [BETWEEN * off.into_iter().fold(0.0, f64::max), length]);
    }

    /// Curves that overlap count as touching: |g| is at most `most` on what they share.
    pub(super) fn add_overlap(&mut self, most: f64, Overlap { width, length }: Overlap) {
        self.add_strip(most, [width, length.min(TAU * REACH)]);
    }

    /// Points at this distance along a curve or a side count as one: |g| is at most `most` next to them.
    pub(super) fn add_joined(&mut self, most: f64, apart: f64) {
        /// Distances on which f may be another one: angles down to about a hundredth.
        const ROUND: f64 = 100.0;
        if apart > UNITS {
            self.add_disc(most, ROUND * apart);
        }
    }

    /// |g| is at most `most` on a disc of this radius round the origin of the field `-x int t g(t x) dt`.
    pub(super) fn of_disc(most: f64, radius: f64) -> Self {
        Self { mass: most * PI * radius * radius, field: 0.5 * most * radius }
    }

    /// Bound of the integral of |r|^2 over a domain in a disc of this radius: `|r|` times the integral of |r|, which is
    /// the mass times that of `1 / 2 pi |x|` over a disc at most.
    pub(super) fn square(self, radius: f64) -> f64 {
        self.field * self.mass * radius
    }
}
