//! Panels of intervals, which get short towards corners, ends of contact and crossings, and points on them.
//!
//! A point is known by the next of these splits and its offset from there, so that distances from it have all digits.

use super::boundary::{Split, Walk};
use crate::problem::complex::Complex;
use crate::spectral::geometry::rule::{GaussNode, halved};

/// Point of an interval.
#[derive(Clone, Copy, Debug)]
pub(in crate::spectral) struct Spot {
    pub interval: usize,
    /// Split next to it, and its position from there.
    pub split: usize,
    pub delta: Complex,
    pub z: Complex,
    /// Direction of the walk.
    pub tangent: Complex,
    /// Distance from that split along the boundary.
    pub offset: f64,
    /// Distance from the start of the interval.
    pub s: f64,
    /// Quadrature weight with respect to length.
    pub weight: f64,
}

impl Spot {
    /// Spot away from the boundary.
    pub(in crate::spectral) fn inside(z: Complex) -> Self {
        let (delta, tangent) = (Complex::default(), Complex::new(1.0, 0.0));
        Self {
            interval: usize::MAX,
            split: usize::MAX,
            delta,
            z,
            tangent,
            offset: 0.0,
            s: 0.0,
            weight: 0.0,
        }
    }
}

/// Part of an interval.
#[derive(Clone, Copy, Debug)]
pub(in crate::spectral) struct PlanePanel {
    pub interval: usize,
    /// 0 if its points are seen from the start of the interval, 1 from the end.
    pub side: usize,
    /// Least and greatest offset from that end.
    pub span: [f64; 2],
}

impl Walk {
    /// Spot by its offset from the start (0) or the end (1) of an interval.
    pub(in crate::spectral) fn spot(
        &self,
        interval: usize,
        side: usize,
        offset: f64,
        weight: f64,
    ) -> Spot {
        let own = &self.intervals[interval];
        let split = own.splits[side];
        let Split { z, tangents, .. } = self.splits[split];
        let tangent = tangents[1 - side];
        let signed = if side == 0 { offset } else { -offset };
        let (delta, direction) = if own.curvature == 0.0 {
            (tangent.scaled(signed), tangent)
        } else {
            let half = Complex::unit(0.5 * own.curvature * signed);
            (tangent * half.scaled(2.0 * half.im / own.curvature), tangent * half * half)
        };
        let s = if side == 0 { offset } else { own.length - offset };
        Spot { interval, split, delta, z: z + delta, tangent: direction, offset, s, weight }
    }

    /// Spots of a Gauss rule on a panel, in walking order. On a panel at a split the offset is the fifth power.
    pub(in crate::spectral) fn spots(
        &self,
        panel: PlanePanel,
        rule: &[GaussNode],
        into: &mut Vec<Spot>,
    ) {
        let [from, to] = panel.span;
        let first = into.len();
        let graded = self.splits[self.intervals[panel.interval].splits[panel.side]].depth() < 1.0;
        for node in rule {
            let (offset, weight) = match from == 0.0 && graded {
                true => {
                    let square = node.x * node.x;
                    (to * square * square * node.x, 5.0 * to * square * square * node.weight)
                }
                false => (from + (to - from) * node.x, (to - from) * node.weight),
            };
            into.push(self.spot(panel.interval, panel.side, offset, weight));
        }
        if panel.side == 1 {
            into[first..].reverse();
        }
    }

    /// Panels in walking order, halved where `too_long` says so of the middle and the length.
    pub(in crate::spectral) fn panels(
        &self,
        least: f64,
        too_long: impl Fn(Complex, f64) -> bool,
    ) -> Vec<PlanePanel> {
        /// Ratio of neighbours.
        const RATIO: f64 = 4.0;
        /// Longest panel, in halves of the interval: in the middle the functions of all splits are seen.
        const LONGEST: f64 = 0.4;
        /// Longest panel of a circle, as an angle.
        const WIDEST: f64 = 0.35;
        let mut panels = Vec::new();
        for (k, interval) in self.intervals.iter().enumerate() {
            let half = 0.5 * interval.length;
            for side in [0, 1] {
                let from = panels.len();
                let shortest = half * self.splits[interval.splits[side]].depth().max(least);
                let mut to = half;
                while to > 0.0 {
                    let below = if to / RATIO > shortest { to / RATIO } else { 0.0 };
                    let parts = halved([below, to], |[a, b]| {
                        let middle = self.spot(k, side, 0.5 * (a + b), 0.0);
                        b - a > 1e-14
                            && (b - a > LONGEST * half
                                || (b - a) * interval.curvature.abs() > WIDEST
                                || too_long(middle.z, b - a))
                    });
                    panels.extend(parts.into_iter().rev().map(|span| PlanePanel {
                        interval: k,
                        side,
                        span,
                    }));
                    to = below;
                }
                // From the split inwards on the first half.
                if side == 0 {
                    panels[from..].reverse();
                }
            }
        }
        panels
    }
}
