//! By how much the f of a solver may differ from that of the statement, where numbers that nearly agree were taken for
//! equal.

use crate::spectral::geometry::curve::{Curve, Overlap};
use std::f64::consts::{PI, TAU};

/// Bounds of the difference g of both f: what is not known of it is bounded where it may be other than zero.
///
/// The field `r(x) = 1 / 2 pi int (y - x) / |x - y|^2 g(y) dy` has the divergence -g.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Changes {
    /// Bound of the integral of |g|.
    pub mass: f64,
    /// Bound of |r|, or of another field of this divergence.
    pub field: f64,
}

/// Largest modulus of points of a domain in its frame, and of more.
const REACH: f64 = 4.0;
/// Two units in the last place of such points, by which all borders of f may be off: an error of the energy that counts
/// along them.
pub(crate) const UNITS: f64 = 4.0 * f64::EPSILON;

impl Changes {
    /// |g| is at most `most` on a set with this area: the field is largest in the middle of a disc.
    pub(crate) fn add_area(&mut self, most: f64, area: f64) {
        self.mass += most * area;
        self.field += most * (area / PI).sqrt();
    }

    /// |g| is at most `most` on a disc of this radius.
    pub(crate) fn add_disc(&mut self, most: f64, radius: f64) {
        self.add_area(most, PI * radius * radius);
    }

    /// |g| is at most `most` on a strip along a line or a part of a circle.
    ///
    /// With s the distance along it from the place next to x, |x - y| is at least `|s| / pi - width / 2`. Where |s| is
    /// less than `2 pi width` the field is at most that of a disc of this area, `2 most width`, elsewhere `2 most width
    /// log(length / (2 pi width))`.
    pub(crate) fn add_strip(&mut self, most: f64, [width, length]: [f64; 2]) {
        self.mass += most * width * length;
        self.field += 2.0 * most * width * (1.0 + libm::log((length / width).max(1.0)));
    }

    /// |g| is at most `most` between a part of this length of a curve and another curve, which are this far apart at
    /// the worst of its ends and its middle, of three equal parts of a circle, or of the points that cut it into eight;
    /// less than [`UNITS`] is rounding.
    ///
    /// Their distance is about a quadratic function on the part, at most 5/4 of that, or, on a circle, a constant with
    /// a sine and a cosine, at most 7/3; seen at the points that cut it into eight it is linear or bends one way, by
    /// its second differences less than six times that.
    pub(crate) fn add_between(&mut self, most: f64, off: f64, length: f64) {
        if off > UNITS {
            self.add_strip(most, [6.0 * off, length]);
        }
    }

    /// A curve counts as another one: |g| is at most `most` between both.
    pub(crate) fn add_moved(&mut self, most: f64, curve: Curve, to: Curve) {
        let (third, length) = match curve.period() {
            Some(turn) if turn < 16.0 * TAU => (turn / 3.0, turn.min(TAU * REACH)),
            _ => (REACH, 2.0 * REACH),
        };
        let off = [-third, 0.0, third].map(|s| to.distance(curve.at(s)).abs());
        self.add_between(most, off.into_iter().fold(0.0, f64::max), length);
    }

    /// Curves that overlap count as touching: |g| is at most `most` on what they share.
    pub(crate) fn add_overlap(&mut self, most: f64, Overlap { width, length }: Overlap) {
        self.add_strip(most, [width, length.min(TAU * REACH)]);
    }

    /// Points that count as one are joined by pieces of these lengths, and g jumps across these pieces alone, by `most`
    /// at most: g vanishes outside of the sets that they enclose, in which |g| is at most the sum of all jumps. By the
    /// isoperimetric inequality the area is largest if all enclose one disc.
    pub(crate) fn add_joined(&mut self, most: f64, lengths: &[f64]) {
        let around: f64 = lengths.iter().sum();
        self.add_area(most * lengths.len() as f64, around * around / (4.0 * PI));
    }

    /// |g| is at most `most` on a disc of this radius round the origin of the field `-x int t g(t x) dt`.
    pub(crate) fn of_disc(most: f64, radius: f64) -> Self {
        Self { mass: most * PI * radius * radius, field: 0.5 * most * radius }
    }

    /// Bound of the integral of |r|^2 over a domain in a disc of this radius: `|r|` times the integral of |r|, which is
    /// the mass times that of `1 / 2 pi |x|` over a disc at most.
    pub(crate) fn square(self, radius: f64) -> f64 {
        self.field * self.mass * radius
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problem::complex::Complex;

    #[test]
    fn fields_of_strips_and_discs_are_below_their_bounds() {
        // 3 / 2 pi times the integral of 1 / |x - y|, x in the middle: over a rectangle, its corners seen from there.
        for [width, length] in [[1e-3, 1e-3], [1e-3, 0.1], [1e-9, 2.0]] {
            let mut changes = Changes::default();
            changes.add_strip(3.0, [width, length]);
            let [half, thick] = [0.5 * length, 0.5 * width];
            let parts = half * libm::asinh(thick / half) + thick * libm::asinh(half / thick);
            let field = 3.0 / TAU * 4.0 * parts;
            assert!(field < changes.field && changes.field < 8.0 * field, "{width} {length}");
            assert_eq!(changes.mass, 3.0 * width * length);
        }
        let mut changes = Changes::default();
        changes.add_disc(3.0, 0.2);
        assert!((changes.field - 3.0 * 0.2).abs() < 1e-15 && changes.mass >= 3.0 * 0.125);
        // The middle of a disc: |r| is 1.5 |x| inside and 0.06 / |x| outside.
        let square = PI * 0.2f64.powi(4) * 1.125 + TAU * 0.06 * 0.06 * 5f64.ln();
        assert!(square < changes.square(1.0), "{square}");
    }

    #[test]
    fn pieces_between_points_that_count_as_one_enclose_no_more_than_a_disc() {
        let mut changes = Changes::default();
        changes.add_joined(3.0, &[PI, PI]);
        let mut disc = Changes::default();
        disc.add_disc(6.0, 1.0);
        assert!((changes.mass / disc.mass - 1.0).abs() < 1e-15);
        assert!((changes.field / disc.field - 1.0).abs() < 1e-15);
        changes.add_joined(3.0, &[]);
        assert!((changes.mass / disc.mass - 1.0).abs() < 1e-15);
    }

    #[test]
    fn a_piece_counts_as_outside_with_all_that_lies_between_it_and_a_side() {
        // Distances that are linear or quadratic, at the ends and in the middle of the eight parts.
        for [b, c] in [[1.0, 0.0], [0.0, 1.0], [1.0, -1.0], [0.0, -4.0], [2.0, -3.0]] {
            let at = |k: i32| (b * f64::from(k) / 16.0 + c * f64::from(k * k) / 256.0).abs();
            let off = (1..8).map(|k| at(2 * k)).fold(0.0, f64::max);
            let between = (0..=16).map(at).fold(0.0, f64::max);
            let mut changes = Changes::default();
            changes.add_between(1.0, off, 1.0);
            assert!(between <= changes.mass, "{b} {c}: {between} {changes:?}");
        }
    }

    #[test]
    fn what_lies_between_two_curves_is_bounded() {
        for (curvature, shift, turn, bend) in [
            (0.0, 2e-14, 0.0, 0.0),
            (0.0, 0.0, 5e-15, 0.0),
            (2.0, 1e-14, 0.0, 0.0),
            (0.5, 0.0, 0.0, 3e-15),
        ] {
            let (origin, tangent) = (Complex::new(0.1, 0.2), Complex::unit(0.3));
            let curve = Curve { origin, tangent, curvature };
            let origin = origin + tangent.turned().scaled(shift);
            let other =
                Curve { origin, tangent: Complex::unit(0.3 + turn), curvature: curvature + bend };
            let mut changes = Changes::default();
            changes.add_moved(1.0, curve, other);
            let length = curve.period().unwrap_or(2.0 * REACH);
            let at =
                |k: i32| other.distance(curve.at(length * (f64::from(k) / 1000.0 - 0.5))).abs();
            let between = (0..1000).map(at).sum::<f64>() * length / 1000.0;
            assert!(between > 0.0 && between < changes.mass, "{curvature}: {between} {changes:?}");
        }
        let mut none = Changes::default();
        let curve = Curve::line(Complex::new(0.1, 0.2), Complex::unit(0.3));
        none.add_moved(1.0, curve, Curve::line(curve.at(0.7), -curve.tangent));
        assert_eq!(none, Changes::default());
    }

    #[test]
    fn curves_that_touch_by_a_tolerance_share_no_more_than_is_bounded() {
        let [line, circle] = [0.0, 1.6].map(|curvature| {
            let [origin, tangent] = [Complex::new(0.0, 0.0), Complex::new(1.0, 0.0)];
            Curve { origin, tangent, curvature }
        });
        for depth in [1e-13, 3e-14] {
            let raised = Curve { origin: Complex::new(0.0, depth), ..line };
            let Overlap { width, length } = circle.overlap(raised).expect("they overlap");
            let chord = 2.0 * (2.0 * depth / 1.6f64).sqrt();
            assert!(width >= depth && width < 4.0 * depth, "{width}");
            assert!(length >= chord && length < 4.0 * chord, "{length}");
            let lowered = Curve { origin: Complex::new(0.0, -depth), ..line };
            assert!(circle.overlap(lowered).is_none());
        }
    }
}
