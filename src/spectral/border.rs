//! psi on the border, interpolated: its gradient is wanted at thousands of points, each a sum of logarithms
//! and, for psi itself, of dilogarithms.

use super::complex::Complex;
use super::jumps::Jumps;
use super::panels::{Place, distance, tangent};
use super::potential::Potential;
use std::f64::consts::PI;

/// Terms of a series. No piece is longer than its distance from a singular point, so that the terms fall like
/// `(2 + sqrt 5)^-k` at least: to rounding.
const TERMS: usize = 24;

/// Chebyshev series on pieces of the sides between corners, jumps of f, and where singular points are near.
#[derive(Clone)]
pub(super) struct Border {
    /// Side by side, each in order.
    sides: [Vec<Piece>; 4],
}

#[derive(Clone)]
struct Piece {
    /// Ends as distances from the corner at which the side begins.
    from: f64,
    to: f64,
    /// Series of psi and of its gradient.
    value: [f64; TERMS],
    gradient: [[f64; 2]; TERMS],
}

impl Border {
    pub(super) fn new(psi: &Potential, jumps: &Jumps, crossings: &[Place]) -> Self {
        // cos(k pi / (2 TERMS)).
        let cosines: Vec<f64> =
            (0..4 * TERMS).map(|k| libm::cos(k as f64 * PI / (2 * TERMS) as f64)).collect();
        let sides = [0, 1, 2, 3].map(|side| {
            let point = |t: f64| Place { corner: side, t }.point();
            let mut breaks = vec![0.0, 1.0];
            let places = crossings.iter().map(|&place| on_side(place));
            breaks.extend(places.filter(|&(of, _)| of == side as usize).map(|(_, t)| t));
            breaks.sort_by(f64::total_cmp);
            // What is left to cut, the first on top.
            let mut left: Vec<[f64; 2]> =
                breaks.windows(2).rev().map(|ends| [ends[0], ends[1]]).collect();
            let mut pieces = Vec::new();
            // psi at the start of the piece; along the side it is an integral of its gradient.
            let (tangent, mut before) = (tangent(side, 1.0), psi.value_and_gradient(point(0.0)).0);
            while let Some([from, to]) = left.pop() {
                let (length, middle) = (to - from, 0.5 * (from + to));
                let segment = [point(from), point(to)];
                if length > SHORTEST
                    && jumps.singular(point(middle)).any(|v| length > distance(segment, v))
                {
                    left.extend([[middle, to], [from, middle]]);
                } else if length > 0.0 {
                    let gradient = |t: f64| psi.gradient(point(t));
                    let piece = Piece::new([from, to], &cosines, tangent, before, gradient);
                    // At 1 all polynomials are 1.
                    before = piece.value.iter().sum();
                    pieces.push(piece);
                }
            }
            pieces
        });
        Self { sides }
    }

    /// The gradient of psi.
    pub(super) fn gradient(&self, place: Place) -> Complex {
        let (piece, x) = self.piece(place);
        let mut sums = [[0.0; 2]; 2];
        for c in piece.gradient[1..].iter().rev() {
            let next = [0, 1].map(|k| c[k] + 2.0 * x * sums[0][k] - sums[1][k]);
            sums = [next, sums[0]];
        }
        let [re, im] = [0, 1].map(|k| piece.gradient[0][k] + x * sums[0][k] - sums[1][k]);
        Complex::new(re, im)
    }

    /// psi.
    pub(super) fn value(&self, place: Place) -> f64 {
        let (piece, x) = self.piece(place);
        let mut sums = [0.0; 2];
        for c in piece.value[1..].iter().rev() {
            sums = [c + 2.0 * x * sums[0] - sums[1], sums[0]];
        }
        piece.value[0] + x * sums[0] - sums[1]
    }

    /// The piece with a place, and where that is on it, from -1 to 1.
    fn piece(&self, place: Place) -> (&Piece, f64) {
        let (side, t) = on_side(place);
        let pieces = &self.sides[side];
        let piece = &pieces[pieces.partition_point(|piece| piece.to < t).min(pieces.len() - 1)];
        (piece, (2.0 * t - piece.from - piece.to) / (piece.to - piece.from))
    }
}

/// Pieces shorter than this are not cut further.
const SHORTEST: f64 = 1e-6;

/// The side of a place, and the distance from the corner at which it begins.
fn on_side(Place { corner, t }: Place) -> (usize, f64) {
    let (side, t) = if t < 0.0 { (corner - 1, 1.0 + t) } else { (corner, t) };
    (side.rem_euclid(4) as usize, t)
}

impl Piece {
    fn new(
        [from, to]: [f64; 2],
        cosines: &[f64],
        tangent: Complex,
        before: f64,
        at: impl Fn(f64) -> Complex,
    ) -> Self {
        let mut gradient = [[0.0; 2]; TERMS];
        for node in 0..TERMS {
            let x = cosines[2 * node + 1];
            let Complex { re, im } = at(0.5 * (from + to) + 0.5 * (to - from) * x);
            for (k, sum) in gradient.iter_mut().enumerate() {
                let share = if k == 0 { 1.0 } else { 2.0 } / TERMS as f64;
                let weight = share * cosines[k * (2 * node + 1) % (4 * TERMS)];
                sum[0] += weight * re;
                sum[1] += weight * im;
            }
        }
        let slope = |k: usize| {
            let [x, y] = gradient.get(k).copied().unwrap_or_default();
            let along = tangent.dot(Complex::new(x, y));
            if k == 0 { 2.0 * along } else { along }
        };
        let mut value = [0.0; TERMS];
        for k in 1..TERMS {
            value[k] = (to - from) * (slope(k - 1) - slope(k + 1)) / (4 * k) as f64;
            value[0] += if k % 2 == 1 { value[k] } else { -value[k] };
        }
        value[0] += before;
        Self { from, to, value, gradient }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spectral::potential::CORNERS;

    #[test]
    fn the_series_are_psi_to_rounding() {
        for text in [
            "quadrant(ll)=3; else=-1.1",
            "rect(-0.7,0.493,-0.2,0.1)=-5; disc(0.3,0.45,0.049)=4; halfplane(1,0.3,0.2)=2; else=-2",
            "disc(0.5,0.5,0.3)=4; disc(-0.1,0.4,0.099)=-3; else=-1",
        ] {
            let jumps = Jumps::of(&text.parse().unwrap());
            let psi = Potential::new(&jumps);
            let crossings: Vec<Place> = jumps.crossings.iter().map(|&z| Place::of(z)).collect();
            let border = Border::new(&psi, &jumps, &crossings);
            let corners = CORNERS.map(|z| psi.value_and_gradient(z).0.abs());
            let size = corners.into_iter().fold(1.0, f64::max);
            for k in 0..4000 {
                let place = Place::new(k % 4, 0.997 * f64::from(k) / 4000.0 - 0.5);
                let (value, gradient) = psi.value_and_gradient(place.point());
                let error = (border.value(place) - value).abs();
                assert!(error < 2e-15 * size, "{text}, {place:?}: {error}");
                let error = (border.gradient(place) - gradient).norm();
                assert!(error < 2e-14 * size, "{text}, {place:?}: {error}");
            }
        }
    }
}
