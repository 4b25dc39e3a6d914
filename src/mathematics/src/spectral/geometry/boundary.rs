//! The boundary as a walk: corners, ends of contact and crossings split it into intervals with one condition each;
//! intervals into panels that get short towards these points.

use super::ring::{PlaneRing, RingContact, TOGETHER};
use crate::problem::complex::Complex;
use crate::problem::law::{BoundaryState, Law};
use std::f64::consts::PI;

impl PlaneRing {
    /// Condition at a distance along the loop: that of its side, or of the contact set where it may move.
    fn state(&self, t: f64, contact: &RingContact) -> State {
        match self.sides[self.place(t).side].law {
            law if law.is_fixed() => State::Held,
            law if law.is_free() => State::Flux(law.lo()),
            law => State::under(law, contact.state(t, self.length())),
        }
    }

    /// Directions of the walk before and after a mark.
    fn tangents_at(&self, mark: &Mark) -> [Complex; 2] {
        let place = self.place(mark.t);
        match mark.joint {
            true => self.tangents(place.side),
            false => [self.sides[place.side].tangent(place.s); 2],
        }
    }
}

/// Condition on an interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum State {
    /// v is the value of the law.
    Held,
    /// dv/dn has this value.
    Flux(f64),
}

impl State {
    /// Condition of a state under a law; v that would leave the value where the law lets it not, leaves it the other
    /// way.
    pub(crate) fn under(law: Law, state: BoundaryState) -> Self {
        match state {
            BoundaryState::Sticks => Self::Held,
            BoundaryState::SlipsDown if law.hi().is_finite() => Self::Flux(law.hi()),
            _ if law.lo().is_finite() => Self::Flux(law.lo()),
            _ => Self::Flux(law.hi()),
        }
    }
}

/// Sign of v less the value of a law that belongs to a flux at an end of it.
pub(crate) fn sign(law: Law, flux: f64) -> f64 {
    if flux == law.hi() { -1.0 } else { 1.0 }
}

/// Point between two intervals.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Split {
    pub ring: usize,
    /// Distance along the loop.
    pub t: f64,
    pub z: Complex,
    /// Directions of the walk before and after it.
    pub tangents: [Complex; 2],
    /// Conditions before and after it.
    pub states: [State; 2],
    /// Formulas of the values of the laws before and after it.
    pub formulas: [Option<usize>; 2],
    /// Lengths of the intervals before and after it.
    pub lengths: [f64; 2],
    /// Inner angle, pi on a smooth side.
    pub angle: f64,
    /// True if a corner.
    pub corner: bool,
    /// True if another law begins here.
    pub joint: bool,
    /// True if f jumps here.
    pub crossing: bool,
    /// Arc of the contact set that begins (0) or ends (1) here, if that may move.
    pub end: Option<(usize, usize)>,
}

/// Corner next to an end of contact.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CornerBeside {
    /// Inner angle.
    pub angle: f64,
    /// True if v is given on one side of the corner and the end together, and not on the other.
    pub is_mixed: bool,
}

/// Part of a side between two splits.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlaneInterval {
    pub ring: usize,
    pub side: usize,
    /// Splits at its ends.
    pub splits: [usize; 2],
    /// Distance of its start from the start of the side.
    pub from: f64,
    pub length: f64,
    pub curvature: f64,
    pub state: State,
    pub law: Law,
    /// f beside it.
    pub f: f64,
    /// Number of its run: intervals beside each other on which dv/dn is given.
    pub run: usize,
}

/// Point of the boundary at which a jump of f ends.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlaneCrossing {
    pub ring: usize,
    /// Distance along the loop.
    pub t: f64,
    /// f after it less f before it, in walking order.
    pub change: f64,
    /// Distance of the end of the jump from it.
    pub gap: f64,
}

/// Crossing that is joined with a split.
#[derive(Clone, Copy, Debug)]
pub(crate) struct JoinedCrossing {
    pub split: usize,
    /// Distance along the loop from the split to the crossing, negative if that comes first.
    pub offset: f64,
    pub crossing: PlaneCrossing,
}

/// All of the boundary for one contact set.
#[cfg_attr(test, derive(Clone))]
pub(crate) struct Walk {
    pub splits: Vec<Split>,
    /// All crossings, in order at each split.
    pub joined: Vec<JoinedCrossing>,
    /// In walking order, loop by loop.
    pub intervals: Vec<PlaneInterval>,
    /// Number of runs.
    pub runs: usize,
}

impl Walk {
    /// Corner next to an end of contact.
    pub(crate) fn corner_beside(&self, k: usize) -> Option<CornerBeside> {
        let split = &self.splits[k];
        split.end?;
        let near = usize::from(split.lengths[1] < split.lengths[0]);
        let beside = self.intervals.iter().find(|own| own.splits[1 - near] == k)?;
        let Split { corner, angle, states, .. } = self.splits[beside.splits[near]];
        let is_held = [states[near], split.states[1 - near]].map(|state| state == State::Held);
        corner.then_some(CornerBeside { angle, is_mixed: is_held[0] != is_held[1] })
    }

    /// True if the interval before (0) or after (1) a split ends where another law begins, with a flux that is not
    /// zero: an end of contact may lie as near to that as it likes, but not beyond.
    pub(crate) fn has_other_flux_after(&self, k: usize, side: usize) -> bool {
        let mut intervals = self.intervals.iter();
        let Some(own) = intervals.find(|own| own.splits[1 - side] == k) else { return false };
        let last = &self.splits[own.splits[side]];
        let has_flux = |state: State| matches!(state, State::Flux(q) if q != 0.0);
        last.joint && has_flux(last.states[side])
    }

    pub(crate) fn new(
        rings: &[PlaneRing],
        contact: &[RingContact],
        crossings: &[PlaneCrossing],
    ) -> Self {
        let (splits, intervals) = (Vec::new(), Vec::new());
        let mut walk = Self { splits, joined: Vec::new(), intervals, runs: 0 };
        for (r, ring) in rings.iter().enumerate() {
            walk.add_ring(r, ring, &contact[r], crossings);
        }
        walk
    }

    /// Adds a loop: a split at each mark, and an interval from each split to the next.
    fn add_ring(
        &mut self,
        number: usize,
        ring: &PlaneRing,
        contact: &RingContact,
        crossings: &[PlaneCrossing],
    ) {
        let marks = marks(number, ring, contact, crossings);
        let (first, many) = (self.splits.len(), marks.len());
        let mut lengths = Vec::with_capacity(many);
        let mut states = Vec::with_capacity(many);
        for (k, mark) in marks.iter().enumerate() {
            let next = if k + 1 < many { marks[k + 1].t } else { ring.length() + marks[0].t };
            lengths.push(next - mark.t);
            // Nothing changes between two marks.
            states.push(ring.state(0.5 * (mark.t + next), contact));
        }
        for (k, mark) in marks.iter().enumerate() {
            let before = (k + many - 1) % many;
            let place = ring.place(mark.t);
            let side = &ring.sides[place.side];
            let tangents = ring.tangents_at(mark);
            self.splits.push(Split {
                ring: number,
                t: mark.t,
                z: side.point(place.s),
                tangents,
                states: [states[before], states[k]],
                formulas: match mark.joint {
                    true => [ring.before(place.side).formula, side.formula],
                    false => [side.formula; 2],
                },
                lengths: [lengths[before], lengths[k]],
                angle: if mark.corner { inner_angle(tangents) } else { PI },
                corner: mark.corner,
                joint: mark.joint && !ring.before(place.side).has_law_of(side),
                crossing: mark.crossing,
                end: mark.end.filter(|_| !mark.corner && states[before] != states[k]),
            });
            self.intervals.push(PlaneInterval {
                ring: number,
                side: place.side,
                splits: [first + k, first + (k + 1) % many],
                from: place.s,
                length: lengths[k],
                curvature: side.curvature(),
                state: states[k],
                law: side.law,
                f: 0.0,
                run: usize::MAX,
            });
        }
        self.join(number, ring, crossings);
        self.number_runs(first);
    }

    /// Numbers the runs of the last loop, from its first interval on, which becomes one where v is given if there is
    /// one: so no run goes on from the last interval to the first.
    fn number_runs(&mut self, first: usize) {
        let own = &mut self.intervals[first..];
        let held = own.iter().position(|interval| interval.state == State::Held).unwrap_or(0);
        own.rotate_left(held);
        let mut goes_on = false;
        for interval in own {
            let is_free = interval.state != State::Held;
            if is_free {
                self.runs += usize::from(!goes_on);
                interval.run = self.runs - 1;
            }
            goes_on = is_free;
        }
    }

    /// Joins the crossings of a loop with the splits next to them.
    fn join(&mut self, r: usize, ring: &PlaneRing, crossings: &[PlaneCrossing]) {
        let turn = ring.length();
        let mut joined = Vec::new();
        for &crossing in crossings.iter().filter(|crossing| crossing.ring == r) {
            let offset =
                |split: &Split| (crossing.t - split.t + 0.5 * turn).rem_euclid(turn) - 0.5 * turn;
            let own = self.splits.iter().enumerate().filter(|(_, split)| split.ring == r);
            let nearest = own
                .map(|(split, own)| JoinedCrossing { split, offset: offset(own), crossing })
                .min_by(|one, other| one.offset.abs().total_cmp(&other.offset.abs()));
            joined.extend(nearest);
        }
        joined.sort_by(|one, other| {
            one.split.cmp(&other.split).then(one.offset.total_cmp(&other.offset))
        });
        self.joined.extend(joined);
    }

    /// Sets f beside the intervals of a loop, from f beside one of them and the changes at the crossings.
    pub(crate) fn set_f(&mut self, ring: usize, known: usize, f: f64) {
        let own: Vec<usize> =
            (0..self.intervals.len()).filter(|&k| self.intervals[k].ring == ring).collect();
        let first = own.iter().position(|&k| k == known).expect("an interval of the loop");
        let mut f = f;
        for step in 0..own.len() {
            let interval = &mut self.intervals[own[(first + step) % own.len()]];
            if step > 0 {
                let start = interval.splits[0];
                let changes = self.joined.iter().filter(|own| own.split == start);
                f += changes.map(|own| own.crossing.change).sum::<f64>();
            }
            interval.f = f;
        }
    }

    /// Pieces of the boundary between crossings and the splits with which they are joined.
    pub(crate) fn joined_pieces(&self) -> Vec<JoinedPiece> {
        let mut pieces = Vec::new();
        for own in self.joined.chunk_by(|one, other| one.split == other.split) {
            let split = own[0].split;
            let beside = [1, 0].map(|end: usize| {
                let mut intervals = self.intervals.iter();
                intervals.find(|interval| interval.splits[end] == split).map_or(0.0, |own| own.f)
            });
            let mut at: Vec<f64> = own.iter().map(|own| own.offset).chain([0.0]).collect();
            at.sort_by(f64::total_cmp);
            for span in at.windows(2).filter(|span| span[0] < span[1]) {
                let before = own.iter().filter(|own| own.offset <= span[0]);
                let f = beside[0] + before.map(|own| own.crossing.change).sum::<f64>();
                let counted = beside[usize::from(span[0] >= 0.0)];
                pieces.push(JoinedPiece { split, span: [span[0], span[1]], f, counted });
            }
        }
        pieces
    }
}

/// Piece of the boundary between a crossing and the split with which it is joined, or between two such crossings.
#[derive(Clone, Copy, Debug)]
pub(crate) struct JoinedPiece {
    pub split: usize,
    /// Distances along the loop from the split.
    pub span: [f64; 2],
    /// f beside it.
    pub f: f64,
    /// f beside the interval of which it is a part.
    pub counted: f64,
}

impl JoinedPiece {
    pub(crate) fn length(&self) -> f64 {
        self.span[1] - self.span[0]
    }
}

/// Inner angle of a corner, between the directions of the walk before and after it.
fn inner_angle([before, after]: [Complex; 2]) -> f64 {
    PI - libm::atan2(before.cross(after), before.dot(after))
}

/// What is at a place of a loop that becomes a split.
#[derive(Clone, Copy, Default)]
struct Mark {
    /// Distance along the loop.
    t: f64,
    /// True where a side begins, at a corner or not.
    joint: bool,
    corner: bool,
    crossing: bool,
    /// Arc of the contact set that begins (0) or ends (1) here.
    end: Option<(usize, usize)>,
}

/// Corners, crossings and ends of contact of a loop, in order: one mark for those that are together.
fn marks(
    number: usize,
    ring: &PlaneRing,
    contact: &RingContact,
    crossings: &[PlaneCrossing],
) -> Vec<Mark> {
    let turn = ring.length();
    let mut marks: Vec<Mark> = Vec::new();
    for k in 0..ring.sides.len() {
        let corner = !ring.is_smooth(k);
        marks.push(Mark { t: ring.starts[k], joint: true, corner, ..Mark::default() });
    }
    for own in crossings.iter().filter(|own| own.ring == number) {
        marks.push(Mark { t: own.t, crossing: true, ..Mark::default() });
    }
    for (k, arc) in contact.arcs.iter().enumerate() {
        for (which, t) in arc.iter().enumerate() {
            let t = t.rem_euclid(turn);
            if ring.sides[ring.place(t).side].law.may_move() {
                marks.push(Mark { t, end: Some((k, which)), ..Mark::default() });
            }
        }
    }
    for mark in &mut marks {
        if mark.t > turn * (1.0 - TOGETHER) {
            mark.t = 0.0;
        }
    }
    marks.sort_by(|a, b| a.t.total_cmp(&b.t));
    marks.dedup_by(|b, a| {
        let same = b.t - a.t < TOGETHER * turn;
        if same {
            if b.joint {
                a.t = b.t;
            }
            a.joint |= b.joint;
            (a.corner, a.crossing, a.end) =
                (a.corner || b.corner, a.crossing || b.crossing, a.end.or(b.end));
        }
        same
    });
    marks
}

impl Split {
    /// Length of the shortest panel at it, in halves of the interval.
    pub(crate) fn depth(&self) -> f64 {
        match () {
            () if self.corner && self.angle > 1.01 * PI => 1e-9,
            () if self.corner => 1e-7,
            () if self.end.is_some() || self.crossing => 1e-5,
            // No more than the start of a loop.
            () => 1.0,
        }
    }

    /// Direction into the domain: that of the bisector.
    pub(crate) fn inwards(&self) -> Complex {
        self.tangents[1] * Complex::unit(0.5 * self.angle)
    }
}
