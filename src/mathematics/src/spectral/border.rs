//! psi on the border, interpolated: its gradient, a sum of logarithms, is wanted at thousands of points.

use super::complex::{Complex, distance};
use super::jumps::Jumps;
use super::panels::LANES;
use super::place::{BorderPlace, tangent};
use super::rule::halved;
use std::f64::consts::PI;

/// Terms of a series. No piece is longer than its distance from a singular point, so that the terms fall like
/// `(2 + sqrt 5)^-k` at least: to rounding.
const TERMS: usize = 24;

/// Chebyshev series on pieces of the sides between corners, jumps of f, and where singular points are near.
#[derive(Clone)]
pub(super) struct SquareBorder {
    /// Side by side, each in order.
    sides: [Vec<Piece>; 4],
}

#[derive(Clone)]
struct Piece {
    /// Ends as distances from the corner at which the side begins.
    from: f64,
    to: f64,
    /// One over the length.
    scale: f64,
    /// Coefficients of psi, psi_x and psi_y.
    series: [[f64; 3]; TERMS],
}

impl SquareBorder {
    pub(super) fn new(jumps: &Jumps) -> Self {
        let psi = &jumps.psi;
        // Of the Chebyshev polynomials at their nodes, node by node.
        let circle: [f64; 4 * TERMS] =
            std::array::from_fn(|k| libm::cos(k as f64 * PI / (2 * TERMS) as f64));
        let cosines: [[f64; TERMS]; TERMS] = std::array::from_fn(|node| {
            std::array::from_fn(|k| circle[k * (2 * node + 1) % (4 * TERMS)])
        });
        // psi at the start of the piece; along the border it is an integral of its gradient.
        let mut before = 0.0;
        let sides = [0, 1, 2, 3].map(|side| {
            let point = |t: f64| BorderPlace { corner: side, t }.point();
            let mut breaks: Vec<f64> = jumps.crossings_on(side).chain([0.0, 1.0]).collect();
            breaks.sort_by(f64::total_cmp);
            let too_long = |span @ [from, to]: [f64; 2]| {
                let (length, middle) = (to - from, 0.5 * (from + to));
                let segment = span.map(point);
                let mut singular = psi.singular([from, middle, to].map(point));
                length > SHORTEST && singular.any(|v| length > distance(segment, v))
            };
            let spans: Vec<[f64; 2]> = breaks
                .windows(2)
                .filter(|ends| ends[0] < ends[1])
                .flat_map(|ends| halved([ends[0], ends[1]], too_long))
                .collect();
            let node = |[from, to]: [f64; 2], x: f64| point(0.5 * ((from + to) + (to - from) * x));
            let nodes: Vec<Complex> = spans
                .iter()
                .flat_map(|&span| cosines.iter().map(move |cosines| node(span, cosines[1])))
                .collect();
            let gradients = psi.gradients(&nodes);
            let piece = |(&span, gradients): (&[f64; 2], &[Complex])| {
                let piece = Piece::new(side, span, &cosines, before, gradients);
                // At 1 all polynomials are 1.
                before = piece.series.iter().map(|c| c[0]).sum();
                piece
            };
            spans.iter().zip(gradients.chunks_exact(TERMS)).map(piece).collect()
        });
        Self { sides }
    }

    /// psi at a place.
    pub(super) fn value(&self, place: BorderPlace) -> f64 {
        let [psi] = self.at(place.corner, &[place.t; LANES], [0]);
        psi[0]
    }

    /// psi (0), psi_x (1) or psi_y (2), as `wanted`, at places of one side seen from the same corner.
    #[inline(always)]
    pub(super) fn at<const MANY: usize>(
        &self,
        corner: i32,
        t: &[f64; LANES],
        wanted: [usize; MANY],
    ) -> [[f64; LANES]; MANY] {
        let (mut found, mut known) = ([[0.0; LANES]; MANY], 0);
        while known < LANES {
            let piece = self.piece(BorderPlace { corner, t: t[known] });
            let x = t.map(|t| piece.local(BorderPlace { corner, t }));
            let sums = piece.sums(&x, wanted);
            // Places of a panel are in the order of the border, or against it.
            let first = known;
            while known < LANES && (known == first || x[known].abs() <= 1.0) {
                for (found, sums) in found.iter_mut().zip(&sums) {
                    found[known] = sums[known];
                }
                known += 1;
            }
        }
        found
    }

    /// The piece with a place.
    fn piece(&self, place: BorderPlace) -> &Piece {
        let (side, t) = place.on_side();
        let pieces = &self.sides[side as usize];
        &pieces[pieces.partition_point(|piece| piece.to < t).min(pieces.len() - 1)]
    }
}

/// Pieces shorter than this are not cut further.
const SHORTEST: f64 = 1e-6;

impl Piece {
    fn new(
        side: i32,
        [from, to]: [f64; 2],
        cosines: &[[f64; TERMS]; TERMS],
        before: f64,
        gradients: &[Complex],
    ) -> Self {
        let (mut x, mut y) = ([0.0; TERMS], [0.0; TERMS]);
        for (&Complex { re, im }, cosines) in gradients.iter().zip(cosines) {
            for k in 0..TERMS {
                x[k] += cosines[k] * re;
                y[k] += cosines[k] * im;
            }
        }
        let mut series: [[f64; 3]; TERMS] = std::array::from_fn(|k| {
            let share = if k == 0 { 1.0 } else { 2.0 } / TERMS as f64;
            [0.0, share * x[k], share * y[k]]
        });
        let slope = |k: usize| {
            let [_, x, y] = series.get(k).copied().unwrap_or_default();
            let along = tangent(side, 1.0).dot(Complex::new(x, y));
            if k == 0 { 2.0 * along } else { along }
        };
        let psi: [f64; TERMS] = std::array::from_fn(|k| match k {
            0 => before,
            _ => (to - from) * (slope(k - 1) - slope(k + 1)) / (4 * k) as f64,
        });
        for (k, value) in psi.into_iter().enumerate() {
            series[k][0] += value;
            // At -1, where psi is known, polynomials of odd degree are -1.
            if k > 0 {
                series[0][0] += if k % 2 == 1 { value } else { -value };
            }
        }
        Self { from, to, scale: 1.0 / (to - from), series }
    }

    /// Coordinate on the piece of a place on its side, from -1 to 1.
    #[inline(always)]
    fn local(&self, place: BorderPlace) -> f64 {
        let (_, t) = place.on_side();
        ((t - self.from) - (self.to - t)) * self.scale
    }

    /// The sums of series, by Clenshaw's recurrence.
    #[inline(always)]
    fn sums<const MANY: usize>(
        &self,
        x: &[f64; LANES],
        wanted: [usize; MANY],
    ) -> [[f64; LANES]; MANY] {
        let (mut sums, mut before) = ([[0.0; LANES]; MANY], [[0.0; LANES]; MANY]);
        for (k, coefficients) in self.series.iter().enumerate().rev() {
            let factor = if k == 0 { 1.0 } else { 2.0 };
            for ((sum, before), which) in sums.iter_mut().zip(&mut before).zip(wanted) {
                for lane in 0..LANES {
                    let next = coefficients[which] + factor * x[lane] * sum[lane] - before[lane];
                    (before[lane], sum[lane]) = (sum[lane], next);
                }
            }
        }
        sums
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spectral::problem::SpectralProblem;

    #[test]
    fn the_series_are_the_gradient_to_rounding_and_psi_closes_around_the_border() {
        for text in [
            "quadrant(ll)=3; else=-1.1",
            "rect(-0.7,0.493,-0.2,0.1)=-5; disc(0.3,0.45,0.049)=4; halfplane(1,0.3,0.2)=2; else=-2",
            "disc(0.5,0.5,0.3)=4; disc(-0.1,0.4,0.099)=-3; else=-1",
        ] {
            let SpectralProblem { jumps, border, .. } =
                SpectralProblem::new(&text.parse().unwrap());
            let end = border.sides[3].last().unwrap();
            let around: f64 = end.series.iter().map(|c| c[0]).sum();
            assert!(around.abs() < 4e-15, "{text}: once around the border {around}");
            let places = (0..4000)
                .map(|k| BorderPlace::new(k / 1000, 0.997 * f64::from(k % 1000) / 1000.0 - 0.5));
            for place in places {
                let [x, y] = border.at(place.corner, &[place.t; LANES], [1, 2]).map(|s| s[0]);
                let slope = jumps.psi.gradients(&[place.point()])[0];
                let error = (Complex::new(x, y) - slope).norm();
                assert!(error < 2e-14, "{text}, {place:?}: {error}");
            }
        }
    }
}
