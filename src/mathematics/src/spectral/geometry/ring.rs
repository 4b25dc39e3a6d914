//! Closed loops of sides, and the arcs of a loop that stick, by distances along it.

use super::side::{PlaneSide, SidePlace};
use crate::problem::complex::Complex;

/// Closed loop of sides with the distances along it.
#[derive(Clone, Debug)]
pub(crate) struct PlaneRing {
    pub(in crate::spectral) sides: Vec<PlaneSide>,
    /// Distance of the start of each side along the loop, and its length at last.
    pub(in crate::spectral) starts: Vec<f64>,
}

impl PlaneRing {
    pub(in crate::spectral) fn new(sides: Vec<PlaneSide>) -> Self {
        let mut starts = vec![0.0];
        for side in &sides {
            starts.push(starts[starts.len() - 1] + side.length());
        }
        Self { sides, starts }
    }

    pub(in crate::spectral) fn length(&self) -> f64 {
        self.starts[self.sides.len()]
    }

    /// Side before another one.
    pub(in crate::spectral) fn before(&self, k: usize) -> &PlaneSide {
        &self.sides[(k + self.sides.len() - 1) % self.sides.len()]
    }

    /// Directions of the walk before and after the start of a side.
    pub(in crate::spectral) fn tangents(&self, k: usize) -> [Complex; 2] {
        let before = self.before(k);
        [before.tangent(before.length()), self.sides[k].tangent(0.0)]
    }

    /// True if a side goes on from the side before, smoothly or after a bend, with the same condition and curvature.
    pub(in crate::spectral) fn is_smooth(&self, k: usize) -> bool {
        let (side, before, [prior, after]) = (&self.sides[k], self.before(k), self.tangents(k));
        (prior.cross(after).abs() < 1e-12 || side.is_after_bend)
            && prior.dot(after) > 0.0
            && side.law == before.law
            && (side.curvature() - before.curvature()).abs() < 1e-12
    }

    /// Distances along the loop at which corners lie.
    pub(in crate::spectral) fn corners(&self) -> impl Iterator<Item = f64> {
        let corners = (0..self.sides.len()).filter(|&k| !self.is_smooth(k));
        corners.map(|k| self.starts[k])
    }

    /// Distance along the loop.
    pub(in crate::spectral) fn along(&self, SidePlace { side, s }: SidePlace) -> f64 {
        self.starts[side] + s
    }

    /// Place at a distance along the loop, in a turn.
    pub(in crate::spectral) fn place(&self, t: f64) -> SidePlace {
        let t = t.rem_euclid(self.length());
        let side = self.starts.partition_point(|&start| start <= t).clamp(1, self.sides.len()) - 1;
        SidePlace { side, s: (t - self.starts[side]).clamp(0.0, self.sides[side].length()) }
    }

    /// Number of the side that is nearest to a point, and its distance.
    pub(in crate::spectral) fn nearest(&self, z: Complex) -> (usize, f64) {
        let distances = self.sides.iter().map(|side| (side.point(side.nearest(z)) - z).norm());
        let nearest = distances.enumerate().min_by(|one, other| one.1.total_cmp(&other.1));
        nearest.expect("a loop has sides")
    }
}

/// Arcs of a loop that stick, by distances along it: each from its first to its second, which may be beyond a turn.
#[derive(Clone, Debug, Default)]
pub(in crate::spectral) struct RingContact {
    pub arcs: Vec<[f64; 2]>,
    /// Flux on the gap after each arc. Without arcs: none if all sticks, one if nothing does.
    pub gaps: Vec<f64>,
}

/// Place on a loop at which the state changes.
pub(in crate::spectral) struct StateChange {
    /// Distance along the loop.
    pub at: f64,
    /// Flux from there on where the loop slips; none where it sticks.
    pub flux: Option<f64>,
}

impl RingContact {
    /// Contact set of a loop of this length that sticks and slips in turn from these places on, in walking order; all
    /// of which slips with a flux, or sticks, if there are none.
    pub(in crate::spectral) fn of_changes(
        turn: f64,
        changes: &[StateChange],
        all: Option<f64>,
    ) -> Self {
        if changes.is_empty() {
            return Self { arcs: Vec::new(), gaps: all.into_iter().collect() };
        }
        let mut found = Self::default();
        for (k, StateChange { at: from, flux }) in changes.iter().enumerate() {
            let next = &changes[(k + 1) % changes.len()];
            if flux.is_none() {
                found.arcs.push([*from, from + (next.at - from).rem_euclid(turn)]);
                found.gaps.push(next.flux.expect("a gap follows"));
            }
        }
        found
    }

    /// Flux at a distance along the loop; none where it sticks.
    pub(in crate::spectral) fn flux(&self, t: f64, turn: f64) -> Option<f64> {
        if self.arcs.is_empty() {
            return self.gaps.first().copied();
        }
        let mut nearest = (f64::INFINITY, None);
        for (k, [from, to]) in self.arcs.iter().enumerate() {
            let after = (t - from).rem_euclid(turn);
            if after <= to - from {
                return None;
            }
            let beyond = after - (to - from);
            if beyond < nearest.0 {
                nearest = (beyond, Some(self.gaps[k]));
            }
        }
        nearest.1
    }
}
