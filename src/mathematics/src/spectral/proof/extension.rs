//! Bounds of Dirichlet integrals of extensions: how small `int |grad E|^2` can be for a function E with given values H
//! on the boundary, from the range of H and bounds of its slope.
//!
//! # Method
//! McShane's extension (Bull. AMS 40, 1934) in a metric that is weighted by a density rho of the plane: with d the
//! infimum of `int rho ds` over paths between two points, `E(x) = min H(y) + d(x, y)` over the boundary is H on the
//! boundary if `|H(x) - H(y)| <= d(x, y)` there, and `|grad E| <= rho` almost everywhere. So `int |grad E|^2 <= int
//! rho^2`. Take rho as the largest of constants `rho_p`, each on the points nearer than `delta_p` to a cell p, where
//! delta_p is less than the distance of the cell from all of the boundary but the piece (straight or circular,
//! between two corners, ends of contact or crossings) that it is part of, and than half of the distance from the ends
//! of that piece; and
//! ```text
//! rho_p = max(range of H / delta_p, largest slope of H no farther than delta_p from the cell along the piece).
//! ```
//! A path from a point x of the cell to a point y of the boundary either leaves the circle of radius delta_p round x,
//! and has at least the range of H on its way; or y is in the circle, on the same piece, and `|H(x) - H(y)|` is at most
//! the slope times the distance along the piece, which for circles is up to 1.05 times that in the plane. The points
//! nearer than delta to a curve of length a have an area of no more than `2 delta a + pi delta^2`.
//!
//! Towards a corner or an end delta_p is a share of the distance r from it, so that cells whose variable is log r count
//! once for each doubling of r. Closer than `least`, H is taken as constant by a function h that is added: an
//! interpolation between the values on both sides along circles round the split, whose integral is at most `(4 pi + 128
//! / angle)` times the square of a bound of `sum of the moduli of the terms of h at least`, and ten times that for its
//! descent to zero between `least` and twice that. Two such surroundings are kept apart by rho = range / least within
//! `2 least` of the split.

use super::cells::ProofCell;
use crate::problem::complex::Complex;
use crate::spectral::complex::distance;
use crate::spectral::geometry::boundary::Walk;
use crate::spectral::geometry::panels::halved;
use std::f64::consts::{LN_2, PI};

/// Part of the boundary, as the segment between its ends from which it is no farther than `off`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Chord {
    pub ends: [Complex; 2],
    pub off: f64,
    pub interval: usize,
}

/// Most by which the length of an arc that counts exceeds its chord.
const ARC: f64 = 1.05;

impl Chord {
    fn of(walk: &Walk, interval: usize, [from, to]: [f64; 2]) -> Self {
        let ends = [from, to].map(|s| walk.spot(interval, 0, s, 0.0).z);
        let off = 0.13 * walk.intervals[interval].curvature.abs() * (to - from) * (to - from);
        Self { ends, off, interval }
    }

    /// Chords of a part of an interval.
    fn many(walk: &Walk, interval: usize, range: [f64; 2]) -> Vec<Self> {
        let own = &walk.intervals[interval];
        let parts = halved(range, |[from, to]| {
            let away = from.min(own.length - to).max(1e-5 * own.length);
            own.curvature != 0.0 && (to - from > away || (to - from) * own.curvature.abs() > 0.1)
        });
        parts.into_iter().map(|part| Self::of(walk, interval, part)).collect()
    }

    /// Chords of all of the boundary.
    pub(super) fn all(walk: &Walk) -> Vec<Self> {
        let mut chords = Vec::new();
        for (k, interval) in walk.intervals.iter().enumerate() {
            chords.extend(Self::many(walk, k, [0.0, interval.length]));
        }
        chords
    }

    /// Lower bound of the distance of a point.
    pub(super) fn distance(&self, z: Complex) -> f64 {
        distance(self.ends, z) - self.off
    }

    /// Lower bound of the distance of another part, which does not cross it.
    fn apart(&self, other: &Self) -> f64 {
        let ends = other.ends.map(|end| distance(self.ends, end));
        let own = self.ends.map(|end| distance(other.ends, end));
        ends[0].min(ends[1]).min(own[0]).min(own[1]) - self.off - other.off
    }
}

/// Share of the distance from a split that the boundary keeps clear of other parts.
pub(super) fn share(angle: f64) -> f64 {
    0.4 * libm::sin(angle.min(0.5 * PI))
}

/// Surroundings of the cells in which a function on the boundary may change.
pub(super) struct Room {
    /// For a cell in log r its share; else the distance delta.
    deltas: Vec<f64>,
    /// Cells whose slopes count, and the factors of their slopes.
    beside: Vec<Vec<(usize, f64)>>,
    /// Splits towards which cells get short.
    splits: f64,
    /// Sum over them of the Dirichlet integrals of what is interpolated there, for values of 1.
    near: f64,
}

/// Pieces: intervals that go on in each other without a corner, end or crossing have one number.
fn pieces(walk: &Walk) -> Vec<usize> {
    let mut pieces: Vec<usize> = (0..walk.intervals.len()).collect();
    for (k, split) in walk.splits.iter().enumerate() {
        if split.depth() < 1.0 {
            continue;
        }
        let before = walk.intervals.iter().position(|own| own.splits[1] == k);
        let after = walk.intervals.iter().position(|own| own.splits[0] == k);
        if let (Some(before), Some(after)) = (before, after) {
            let [one, other] = [pieces[before], pieces[after]];
            pieces.iter_mut().filter(|piece| **piece == other).for_each(|piece| *piece = one);
        }
    }
    pieces
}

impl Room {
    pub(super) fn new(walk: &Walk, chords: &[Chord], cells: &[ProofCell]) -> Self {
        let pieces = pieces(walk);
        let graded: Vec<_> = walk.splits.iter().filter(|split| split.depth() < 1.0).collect();
        let mut deltas = Vec::with_capacity(cells.len());
        for own in cells {
            let interval = &walk.intervals[own.interval];
            let split = &walk.splits[interval.splits[own.side]];
            if own.cell.is_log {
                deltas.push(share(split.angle));
                continue;
            }
            let mut delta = 0.4 / interval.curvature.abs();
            for chord in Chord::many(walk, own.interval, own.along(walk)) {
                let others = chords.iter().filter(|o| pieces[o.interval] != pieces[own.interval]);
                delta = others.map(|other| chord.apart(other)).fold(delta, f64::min);
                let away = graded.iter().map(|split| 0.5 * chord.distance(split.z));
                delta = away.fold(delta, f64::min);
            }
            // A domain without corners, of straight sides: none.
            deltas.push(if delta.is_finite() { delta } else { 1.0 });
        }
        let middles: Vec<Complex> = cells.iter().map(|own| own.middle(walk)).collect();
        let places = CellPlaces { walk, pieces: &pieces, cells, middles: &middles };
        let beside = (0..cells.len()).map(|p| places.beside(p, deltas[p]));
        let near = graded.iter().map(|split| 22.0 * (4.0 * PI + 128.0 / split.angle)).sum();
        Self { beside: beside.collect(), deltas, splits: graded.len() as f64, near }
    }

    /// Bound of the Dirichlet integral of an extension of a function with this range, and bounds of its slope on each
    /// cell; on cells in log r, of the slope times r.
    /// Next to splits it may change by `near`.
    pub(super) fn integral(
        &self,
        cells: &[ProofCell],
        [range, near]: [f64; 2],
        slopes: &[f64],
    ) -> f64 {
        let range = range + near;
        let mut sum = 4.0 * PI * self.splits * range * range;
        for (p, own) in cells.iter().enumerate() {
            let delta = self.deltas[p];
            let slope = self.beside[p]
                .iter()
                .fold(0.0f64, |most, (q, factor)| most.max(factor * slopes[*q]));
            if delta <= 0.0 {
                return f64::INFINITY;
            }
            let slope = if own.cell.is_log { slope + near } else { slope };
            let density = (range / delta).max(ARC * slope);
            let length = own.cell.length();
            let (many, length) =
                if own.cell.is_log { ((length / LN_2).ceil(), 1.0) } else { (1.0, length) };
            sum += many * density * density * (2.0 * delta * length + PI * delta * delta);
        }
        (sum.sqrt() + near * self.near.sqrt()).powi(2)
    }
}

/// Cells with what says which are beside each other.
struct CellPlaces<'a> {
    walk: &'a Walk,
    /// Numbers of the pieces of intervals.
    pieces: &'a [usize],
    cells: &'a [ProofCell],
    middles: &'a [Complex],
}

impl CellPlaces<'_> {
    /// Cells of a piece that are no farther from a cell than delta, with the factors by which their slopes count.
    fn beside(&self, p: usize, delta: f64) -> Vec<(usize, f64)> {
        let Self { walk, pieces, cells, middles } = self;
        let own = &cells[p];
        let [from, to] = own.cell.span;
        let mut beside = Vec::new();
        for (q, other) in cells.iter().enumerate() {
            if pieces[other.interval] != pieces[own.interval] {
                continue;
            }
            let [start, end] = other.cell.span;
            if own.cell.is_log {
                // In units of r: slopes within 0.6 to 1.4 times the distance, which may be beyond the middle.
                let (same, length) = (other.side == own.side, walk.intervals[own.interval].length);
                let range = if same { [start, end] } else { [length - end, length - start] };
                if other.interval == own.interval && range[0] <= 1.5 * to && range[1] >= 0.6 * from
                {
                    beside.push((
                        q,
                        match (other.cell.is_log, same) {
                            (true, true) => 1.0 / 0.6,
                            (true, false) => 1.5 * to / start.max(0.25 * length),
                            (false, _) => 1.5 * to,
                        },
                    ));
                }
                continue;
            }
            let away = (middles[p] - middles[q]).norm();
            if away > 0.53 * (to - from + end - start) + 1.1 * delta {
                continue;
            }
            // Half of the way to the split remains.
            let factor = if other.cell.is_log { 1.0 / start.max(0.9 * delta) } else { 1.0 };
            beside.push((q, factor));
        }
        beside
    }
}

#[cfg(test)]
mod tests;
