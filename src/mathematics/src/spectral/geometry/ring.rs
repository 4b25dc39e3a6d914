//! Closed loops of sides, and the arcs of a loop that stick, by distances along it.

use super::side::{PlaneSide, SidePlace};
use crate::problem::complex::Complex;
use crate::problem::law::BoundaryState;

/// Distance from another split, in perimeters, below which an end of contact or a crossing is joined with it. What f is
/// between both counts in the integrals all the same: see `BoundedEnergy::add_joined`.
pub(super) const TOGETHER: f64 = 1e-10;

/// Closed loop of sides with the distances along it.
#[derive(Clone, Debug)]
pub(crate) struct PlaneRing {
    pub(crate) sides: Vec<PlaneSide>,
    /// Distance of the start of each side along the loop, and its length at last.
    pub(crate) starts: Vec<f64>,
}

impl PlaneRing {
    pub(crate) fn new(sides: Vec<PlaneSide>) -> Self {
        let mut starts = vec![0.0];
        for side in &sides {
            starts.push(starts[starts.len() - 1] + side.length());
        }
        Self { sides, starts }
    }

    pub(crate) fn length(&self) -> f64 {
        self.starts[self.sides.len()]
    }

    /// Side before another one.
    pub(crate) fn before(&self, k: usize) -> &PlaneSide {
        &self.sides[(k + self.sides.len() - 1) % self.sides.len()]
    }

    /// Directions of the walk before and after the start of a side.
    pub(crate) fn tangents(&self, k: usize) -> [Complex; 2] {
        let before = self.before(k);
        [before.tangent(before.length()), self.sides[k].tangent(0.0)]
    }

    /// True if a side goes on from the side before, smoothly or after a bend, with the same law and curvature.
    pub(crate) fn is_smooth(&self, k: usize) -> bool {
        let (side, before, [prior, after]) = (&self.sides[k], self.before(k), self.tangents(k));
        (prior.cross(after).abs() < 1e-12 || side.is_after_bend)
            && prior.dot(after) > 0.0
            && side.has_law_of(before)
            && (side.curvature() - before.curvature()).abs() < 1e-12
    }

    /// Distances along the loop at which corners lie.
    pub(crate) fn corners(&self) -> impl Iterator<Item = f64> {
        let corners = (0..self.sides.len()).filter(|&k| !self.is_smooth(k));
        corners.map(|k| self.starts[k])
    }

    /// Distance along the loop.
    pub(crate) fn along(&self, SidePlace { side, s }: SidePlace) -> f64 {
        self.starts[side] + s
    }

    /// Place at a distance along the loop, in a turn.
    pub(crate) fn place(&self, t: f64) -> SidePlace {
        let t = t.rem_euclid(self.length());
        let side = self.starts.partition_point(|&start| start <= t).clamp(1, self.sides.len()) - 1;
        SidePlace { side, s: (t - self.starts[side]).clamp(0.0, self.sides[side].length()) }
    }

    /// Place at the beginning of an arc: in a corner, the start of a side.
    pub(crate) fn place_from(&self, t: f64) -> SidePlace {
        let place = self.place(t);
        let is_at_end = self.sides[place.side].length() - place.s < TOGETHER * self.length();
        let next = SidePlace { side: (place.side + 1) % self.sides.len(), s: 0.0 };
        if is_at_end { next } else { place }
    }

    /// Place at the end of an arc: in a corner, the end of a side.
    pub(crate) fn place_to(&self, t: f64) -> SidePlace {
        let place = self.place(t);
        if place.s >= TOGETHER * self.length() {
            return place;
        }
        let side = (place.side + self.sides.len() - 1) % self.sides.len();
        SidePlace { side, s: self.sides[side].length() }
    }

    /// Number of the side that is nearest to a point, and its distance.
    pub(crate) fn nearest(&self, z: Complex) -> (usize, f64) {
        let distances = self.sides.iter().map(|side| (side.point(side.nearest(z)) - z).norm());
        let nearest = distances.enumerate().min_by(|one, other| one.1.total_cmp(&other.1));
        nearest.expect("a loop has sides")
    }
}

/// Arcs of a loop that stick, by distances along it: each from its first to its second, which may be beyond a turn.
#[derive(Clone, Debug, Default)]
pub(crate) struct RingContact {
    pub arcs: Vec<[f64; 2]>,
    /// State of the gap after each arc. Without arcs: none if all sticks, one if nothing does.
    pub gaps: Vec<BoundaryState>,
}

/// Place on a loop at which the state changes.
pub(crate) struct StateChange {
    /// Distance along the loop.
    pub at: f64,
    /// State from there on.
    pub state: BoundaryState,
}

impl RingContact {
    /// Contact set of a loop of this length that sticks and slips in turn from these places on, in walking order; all
    /// of which has one state if there are none.
    pub(crate) fn of_changes(turn: f64, changes: &[StateChange], all: BoundaryState) -> Self {
        let mut found = Self::default();
        if changes.is_empty() && all != BoundaryState::Sticks {
            found.gaps.push(all);
        }
        for (k, StateChange { at: from, state }) in changes.iter().enumerate() {
            let next = &changes[(k + 1) % changes.len()];
            if *state == BoundaryState::Sticks {
                found.arcs.push([*from, from + (next.at - from).rem_euclid(turn)]);
                found.gaps.push(next.state);
            }
        }
        found
    }

    /// State at a distance along the loop.
    pub(crate) fn state(&self, t: f64, turn: f64) -> BoundaryState {
        let alone = self.gaps.first().filter(|_| self.arcs.is_empty());
        let mut nearest = (f64::INFINITY, alone.copied().unwrap_or(BoundaryState::Sticks));
        for (k, [from, to]) in self.arcs.iter().enumerate() {
            let after = (t - from).rem_euclid(turn);
            if after <= to - from {
                return BoundaryState::Sticks;
            }
            let beyond = after - (to - from);
            if beyond < nearest.0 {
                nearest = (beyond, self.gaps[k]);
            }
        }
        nearest.1
    }
}
