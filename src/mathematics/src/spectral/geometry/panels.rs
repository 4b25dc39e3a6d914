//! Panels of intervals, which get short towards corners, ends of contact and crossings, and points on them.
//!
//! The points are those of Gauss rules. A point is known by the next of these splits and its offset from there, so that
//! distances from it have all digits.

use super::boundary::{Split, Walk};
use crate::problem::complex::Complex;
use std::f64::consts::PI;
use std::sync::OnceLock;

/// Point of an interval.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Spot {
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
    pub(crate) fn inside(z: Complex) -> Self {
        Self { interval: usize::MAX, split: usize::MAX, z, ..Self::default() }
    }
}

/// Part of an interval.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlanePanel {
    pub interval: usize,
    /// 0 if its points are seen from the start of the interval, 1 from the end.
    pub side: usize,
    /// Least and greatest offset from that end.
    pub span: [f64; 2],
}

impl Walk {
    /// Spot by its offset from the start (0) or the end (1) of an interval.
    pub(crate) fn spot(&self, interval: usize, side: usize, offset: f64, weight: f64) -> Spot {
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
    pub(crate) fn spots(&self, panel: PlanePanel, rule: &[GaussNode], into: &mut Vec<Spot>) {
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
    pub(crate) fn panels(
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

/// Node of a Gauss rule on (0, 1).
#[derive(Clone, Copy)]
pub(crate) struct GaussNode {
    pub x: f64,
    pub weight: f64,
}

/// Most nodes of a rule.
const MOST: usize = 48;

/// Nodes and weights of the Gauss-Legendre rule with `n` nodes on (0, 1), 48 at most, ascending.
pub(crate) fn gauss(n: usize) -> &'static [GaussNode] {
    static RULES: [OnceLock<Vec<GaussNode>>; MOST + 1] = [const { OnceLock::new() }; MOST + 1];
    RULES[n].get_or_init(|| found(n))
}

/// Finds a rule.
fn found(n: usize) -> Vec<GaussNode> {
    let mut rule = vec![GaussNode { x: 0.5, weight: 1.0 }; n];
    for i in 0..n.div_ceil(2) {
        let mut x = libm::cos(PI * (i as f64 + 0.75) / (n as f64 + 0.5));
        let mut slope = 1.0;
        // The first guess has two digits at least, and each step doubles them; the slope is that before it.
        for _ in 0..5 {
            let values = legendre(n, x);
            let (p, q) = (values[n], values[n - 1]);
            slope = n as f64 * (x * p - q) / (x * x - 1.0);
            x -= p / slope;
        }
        let weight = 1.0 / ((1.0 - x * x) * slope * slope);
        rule[i] = GaussNode { x: 0.5 * (1.0 - x), weight };
        rule[n - 1 - i] = GaussNode { x: 0.5 * (1.0 + x), weight };
    }
    rule
}

/// Legendre polynomials of degrees 0 to `n` at `x`.
pub(crate) fn legendre(n: usize, x: f64) -> Vec<f64> {
    let mut values = Vec::with_capacity(n + 1);
    values.extend([1.0, x]);
    for k in 1..n {
        let part = k as f64 / (k as f64 + 1.0);
        let lifted = x * values[k];
        values.push(lifted + part * (lifted - values[k - 1]));
    }
    values
}

/// Parts of a range, in order: each part for which `at` returns a point between its ends is cut there.
pub(crate) fn cut(range: [f64; 2], at: impl Fn([f64; 2]) -> Option<f64>) -> Vec<[f64; 2]> {
    let (mut left, mut parts) = (vec![range], Vec::new());
    while let Some(part @ [from, to]) = left.pop() {
        // No number lies between neighbours.
        match at(part).filter(|&middle| from < middle && middle < to) {
            Some(middle) => left.extend([[middle, to], [from, middle]]),
            None => parts.push(part),
        }
    }
    parts
}

/// Parts of a range, in order, halved until none is too long.
pub(crate) fn halved(range: [f64; 2], too_long: impl Fn([f64; 2]) -> bool) -> Vec<[f64; 2]> {
    cut(range, |part| too_long(part).then_some(0.5 * (part[0] + part[1])))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn power(x: f64, k: i32) -> f64 {
        (0..k).fold(1.0, |p, _| p * x)
    }

    #[test]
    fn ranges_are_cut_until_no_number_lies_between() {
        let range = [0.3, 0.3 + 3.0 * f64::EPSILON];
        let parts = halved(range, |_| true);
        assert_eq!((parts[0][0], parts[parts.len() - 1][1]), (range[0], range[1]));
        assert!(parts.iter().all(|&[from, to]| to.to_bits() == from.to_bits() + 1), "{parts:?}");
    }

    #[test]
    fn polynomials_are_integrated_exactly() {
        let rule = gauss(9);
        let integral: f64 = rule.iter().map(|node| node.weight * power(node.x, 17)).sum();
        assert!((integral - 1.0 / 18.0).abs() < 1e-16);
    }
}
