//! psi on the boundary, interpolated: its gradient, a sum of logarithms, is wanted at thousands of points.

use super::complex::distance;
use super::jumps::Jumps;
use super::panels::LANES;
use super::place::{BoundaryPlace, on_side, tangent};
use super::potential::Potential;
use super::rule::halved;
use crate::problem::complex::Complex;
use std::f64::consts::PI;

/// Number of terms of a series. No piece is longer than its distance from a singular point, so that the terms fall like
/// `(2 + sqrt 5)^-k` at least: to rounding.
const TERMS: usize = 24;

/// Chebyshev series of psi and its gradient on pieces of the sides between corners, jumps of f, and where singular
/// points are near.
#[derive(Clone)]
pub(super) struct BoundaryPotential {
    /// Pieces, side by side, each in order.
    sides: [Vec<SeriesPiece>; 4],
}

#[derive(Clone)]
struct SeriesPiece {
    /// Start as a distance from the corner at which the side begins.
    from: f64,
    /// End as a distance from that corner.
    to: f64,
    /// One over the length.
    scale: f64,
    /// Coefficients of psi, psi_x and psi_y.
    series: [[f64; 3]; TERMS],
}

impl BoundaryPotential {
    pub(super) fn new(jumps: &Jumps) -> Self {
        let cosines = cosines();
        // psi at the start of the piece; along the boundary it is an integral of its gradient.
        let mut start = 0.0;
        let sides = [0, 1, 2, 3].map(|side| {
            let spans = spans(jumps, side);
            let mut nodes = Vec::with_capacity(spans.len() * TERMS);
            for [from, to] in &spans {
                for cosines in &cosines {
                    nodes.push(point(side, 0.5 * ((from + to) + (to - from) * cosines[1])));
                }
            }
            let gradients = jumps.psi.gradients(&nodes);
            let mut pieces = Vec::with_capacity(spans.len());
            for (span, gradients) in spans.into_iter().zip(gradients.chunks_exact(TERMS)) {
                let piece = SeriesPiece::new(side, span, &cosines, start, gradients);
                // At 1 all polynomials are 1.
                start = piece.series.iter().map(|c| c[0]).sum();
                pieces.push(piece);
            }
            pieces
        });
        Self { sides }
    }

    /// psi at a place.
    pub(super) fn value(&self, place: BoundaryPlace) -> f64 {
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
            let piece = self.piece(BoundaryPlace { corner, t: t[known] });
            let x = t.map(|t| piece.local(BoundaryPlace { corner, t }));
            let sums = piece.sums(&x, wanted);
            // Places of a panel are in the order of the boundary, or against it.
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

    /// Piece that holds a place.
    fn piece(&self, place: BoundaryPlace) -> &SeriesPiece {
        let (side, t) = place.on_side();
        let pieces = &self.sides[side as usize];
        &pieces[pieces.partition_point(|piece| piece.to < t).min(pieces.len() - 1)]
    }
}

/// Pieces shorter than this are not cut further.
const SHORTEST: f64 = 1e-6;

/// Chebyshev polynomials at the nodes of a series, node by node.
fn cosines() -> [[f64; TERMS]; TERMS] {
    let circle: [f64; 4 * TERMS] =
        std::array::from_fn(|k| libm::cos(k as f64 * PI / (2 * TERMS) as f64));
    std::array::from_fn(|node| std::array::from_fn(|k| circle[k * (2 * node + 1) % (4 * TERMS)]))
}

/// Point of a side, by its distance from the corner at which the side begins.
fn point(side: i32, t: f64) -> Complex {
    BoundaryPlace { corner: side, t }.point()
}

/// Ends of the pieces of a side, as distances from the corner at which it begins.
fn spans(jumps: &Jumps, side: i32) -> Vec<[f64; 2]> {
    let mut breaks: Vec<f64> = on_side(&jumps.crossings, side).chain([0.0, 1.0]).collect();
    breaks.sort_by(f64::total_cmp);
    let mut spans = Vec::new();
    for ends in breaks.windows(2) {
        if ends[0] < ends[1] {
            spans.extend(halved([ends[0], ends[1]], |span| is_too_long(&jumps.psi, side, span)));
        }
    }
    spans
}

/// True if a piece of a side is longer than its distance from a singular point of psi.
fn is_too_long(psi: &Potential, side: i32, [from, to]: [f64; 2]) -> bool {
    let (length, middle) = (to - from, 0.5 * (from + to));
    let along = [from, middle, to].map(|t| point(side, t));
    let mut singular = psi.singular(along);
    length > SHORTEST && singular.any(|v| length > distance([along[0], along[2]], v))
}

impl SeriesPiece {
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
        // Coefficients of the derivative along the side, the first one doubled.
        let mut slopes = [0.0; TERMS + 1];
        for (slope, [_, x, y]) in slopes.iter_mut().zip(series) {
            *slope = tangent(side, 1.0).dot(Complex::new(x, y));
        }
        slopes[0] *= 2.0;
        let psi: [f64; TERMS] = std::array::from_fn(|k| match k {
            0 => before,
            _ => (to - from) * (slopes[k - 1] - slopes[k + 1]) / (4 * k) as f64,
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
    fn local(&self, place: BoundaryPlace) -> f64 {
        let (_, t) = place.on_side();
        ((t - self.from) - (self.to - t)) * self.scale
    }

    /// Sums of the series, by Clenshaw's recurrence.
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
            let SpectralProblem { jumps, boundary_psi, .. } =
                SpectralProblem::new(&text.parse().unwrap());
            let end = boundary_psi.sides[3].last().unwrap();
            let around: f64 = end.series.iter().map(|c| c[0]).sum();
            assert!(around.abs() < 4e-15, "{text}: once around the boundary {around}");
            for k in 0..4000 {
                let place =
                    BoundaryPlace::new(k / 1000, 0.997 * f64::from(k % 1000) / 1000.0 - 0.5);
                let [x, y] = boundary_psi.at(place.corner, &[place.t; LANES], [1, 2]).map(|s| s[0]);
                let slope = jumps.psi.gradients(&[place.point()])[0];
                let error = (Complex::new(x, y) - slope).norm();
                assert!(error < 2e-14, "{text}, {place:?}: {error}");
            }
        }
    }
}
