//! Newton's method on the ends of contact: one division each.
//!
//! Near an end `v = K r^(1/2) + K1 r^(3/2)` at a distance r from it on the side that does not stick. K does not depend
//! on the other ends to first order where all K vanish, since the derivative of v by an end is K times a singular
//! function; so to move each end by `-K / (1.5 K1)` towards the free side is Newton's method.

use crate::spectral::fit::{Effort, Fit};
use crate::spectral::geometry::boundary::{State, sign};
use crate::spectral::geometry::ring::RingContact;
use crate::spectral::setup::{Level, Setup};
use std::collections::HashMap;
use std::ops::Range;

/// Step of an end: along the loop, and that of Newton's method before it was cut.
#[derive(Clone, Copy, Debug)]
struct EndStep {
    ring: usize,
    arc: usize,
    /// 0 for the beginning of the arc, 1 for its end.
    which: usize,
    step: f64,
    cut: bool,
    /// Distance to the next split.
    near: f64,
}

/// Most steps on a level.
const MOST: usize = 25;
/// Largest part of an arc or a gap by which an end moves.
const PART: f64 = 0.4;
/// Largest part of the distance to the next split by which an end at rest moves.
const AT_REST: f64 = 0.1;
/// Step of an end, in perimeters, that leaves it where it is.
pub(super) const NOWHERE: f64 = 1e-7;

/// Lengths of arcs and gaps, in perimeters, that may be right although they shrink: gaps at corners can be short.
const ON_TRIAL: Range<f64> = 1e-7..1e-5;

/// Moves the ends of a contact set until none moves any more; returns the fit, or none if that does not happen.
pub(crate) fn settle(
    setup: &Setup,
    contact: &mut [RingContact],
    level: &Level,
    effort: &mut Effort,
) -> Option<Fit> {
    let mut last = f64::INFINITY;
    let mut shrunk = 0;
    let mut passed = HashMap::new();
    for _ in 0..MOST {
        if effort.is_spent() {
            return None;
        }
        let fit = Fit::new(setup, contact, level);
        effort.add(&fit);
        let mut moves = end_steps(setup, contact, &fit);
        let largest = moves.iter().fold(0.0f64, |most, m| most.max(m.step.abs())) / setup.perimeter;
        let cut = moves.iter().any(|m| m.cut);
        let is_still =
            moves.iter().all(|m| m.step.abs() < (AT_REST * m.near).max(NOWHERE * setup.perimeter));
        let is_noise = largest < level.noise && largest > last / 3.0;
        if !cut && is_still && (largest < level.found || is_noise) {
            if largest < level.noise {
                moves.iter().for_each(|m| contact[m.ring].arcs[m.arc][m.which] += m.step);
            }
            return Some(fit);
        }
        if !largest.is_finite() {
            return None;
        }
        last = largest;
        moves.iter_mut().for_each(|m| m.keep_between(contact, &mut passed));
        let mut short = shrinking(setup, contact, &moves);
        short.retain(|own| !ON_TRIAL.contains(&(own.length / setup.perimeter)));
        shrunk = if short.is_empty() { 0 } else { shrunk + 1 };
        for m in &moves {
            contact[m.ring].arcs[m.arc][m.which] += m.step;
        }
        if shrunk >= 3 {
            drop_short(setup, contact, short);
            (shrunk, passed) = (0, HashMap::new());
        }
        keep_off_corners(setup, contact);
    }
    None
}

/// Places that an end passed.
struct Passed {
    /// The last from which it moved on, and from which it moved back.
    between: [f64; 2],
    /// True if its last step was halved between them, and if that step was one back.
    is_halved: bool,
    is_back: bool,
}

impl EndStep {
    /// True if the step makes the arc shorter, and not the gap beside it.
    fn shortens_arc(&self) -> bool {
        (self.step < 0.0) == (self.which == 1)
    }

    /// Halves the way between places from which the end moved on and back where Newton's step leads out of them: next
    /// to a corner the derivative is not that of the method.
    fn keep_between(&mut self, contact: &[RingContact], passed: &mut HashMap<[usize; 3], Passed>) {
        const NONE: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];
        let t = contact[self.ring].arcs[self.arc][self.which];
        let own = passed.entry([self.ring, self.arc, self.which]).or_insert(Passed {
            between: NONE,
            is_halved: false,
            is_back: false,
        });
        let is_back = self.step < 0.0;
        let [from, to] = own.between;
        // Other ends have moved: what was passed says nothing any more.
        if !(from..=to).contains(&t) || own.is_halved && own.is_back == is_back {
            own.between = NONE;
        }
        own.between[usize::from(is_back)] = t;
        let [from, to] = own.between;
        own.is_halved = !(from..=to).contains(&(t + self.step));
        own.is_back = is_back;
        if own.is_halved {
            self.step = 0.5 * (from + to) - t;
        }
    }
}

/// Steps of all ends that may move.
fn end_steps(setup: &Setup, contact: &[RingContact], fit: &Fit) -> Vec<EndStep> {
    let mut steps = Vec::new();
    for end in fit.ends() {
        let (split, [k, k1]) = (&fit.walk.splits[end.split], end.coefficients);
        let (arc, which) = (end.arc, end.which);
        let line = &setup.domain.rings[split.ring];
        let law = line.sides[line.place(split.t).side].law;
        let mut fluxes = split.states.iter();
        let flux =
            fluxes.find_map(|state| if let State::Flux(q) = state { Some(*q) } else { None });
        let sign = flux.map_or(1.0, |q| sign(law, q));
        let ring = &contact[split.ring];
        let turn = line.length();
        let [arc_length, gap] = around(ring, arc, which, turn);
        // Towards the free side.
        let wanted = match k1 * sign > 0.0 {
            true => end.step(),
            false => -(k * sign).signum() * f64::INFINITY,
        };
        let near = split.lengths[0].min(split.lengths[1]);
        let beyond = if fit.walk.has_other_flux_after(end.split, which) {
            split.lengths[which]
        } else {
            f64::INFINITY
        };
        // What grows, grows no more than threefold.
        let room = match wanted > 0.0 {
            // The expansion holds up to the next split only.
            _ if wanted.is_infinite() => PART * near,
            true => (PART * gap.min(beyond)).min(2.0 * arc_length),
            false => (PART * arc_length).min(2.0 * gap),
        };
        let step = wanted.clamp(-room, room);
        let along = if which == 0 { -step } else { step };
        steps.push(EndStep {
            ring: split.ring,
            arc,
            which,
            step: along,
            cut: step != wanted,
            near,
        });
    }
    steps
}

/// Lengths of an arc and of the gap at its beginning (0) or end (1).
fn around(ring: &RingContact, arc: usize, which: usize, turn: f64) -> [f64; 2] {
    let many = ring.arcs.len();
    let [from, to] = ring.arcs[arc];
    let gap = match which {
        0 => (from - ring.arcs[(arc + many - 1) % many][1]).rem_euclid(turn),
        _ => (ring.arcs[(arc + 1) % many][0] - to).rem_euclid(turn),
    };
    [to - from, gap]
}

/// Arcs one of whose ends is to move by more than a step may, and gaps both of whose ends are, so that they get
/// shorter; not an arc between v > 0 and v < 0, which may be as short as it likes but is there.
fn shrinking(setup: &Setup, contact: &[RingContact], moves: &[EndStep]) -> Vec<Shrinking> {
    let mut found = Vec::new();
    for m in moves.iter().filter(|m| m.cut) {
        let (own, is_gap) = (&contact[m.ring], !m.shortens_arc());
        let many = own.arcs.len();
        // The arc, or the one before the gap.
        let number = if is_gap && m.which == 0 { (m.arc + many - 1) % many } else { m.arc };
        let is_left_out = if is_gap {
            let ends = [(number, 1), ((number + 1) % many, 0)];
            let mut ends =
                moves.iter().filter(|o| o.ring == m.ring && ends.contains(&(o.arc, o.which)));
            ends.all(|end| end.cut && !end.shortens_arc())
        } else {
            own.gaps[(number + many - 1) % many] == own.gaps[number]
        };
        if is_left_out {
            let lengths = around(own, m.arc, m.which, setup.domain.rings[m.ring].length());
            let length = lengths[usize::from(is_gap)];
            let [from, to] = own.arcs[number];
            let middle = if is_gap { to + 0.5 * length } else { 0.5 * (from + to) };
            found.push(Shrinking { ring: m.ring, middle, length, is_gap });
        }
    }
    found
}

/// Leaves out the shortest of arcs and gaps that shrink, and those that are not much longer.
fn drop_short(setup: &Setup, contact: &mut [RingContact], shrinking: Vec<Shrinking>) {
    /// Longest that is left out, in perimeters, and over the shortest.
    const SHORT: [f64; 2] = [0.05, 10.0];
    let shortest = shrinking.iter().fold(f64::INFINITY, |least, own| least.min(own.length));
    let longest = (SHORT[0] * setup.perimeter).min(SHORT[1] * shortest);
    for Shrinking { ring, middle, is_gap, .. } in
        shrinking.into_iter().filter(|own| own.length < longest)
    {
        let (own, turn) = (&mut contact[ring], setup.domain.rings[ring].length());
        let many = own.arcs.len();
        let number = (0..many).find(|&k| {
            let [from, to] = own.arcs[k];
            let [from, to] = if is_gap { [to, own.arcs[(k + 1) % many][0]] } else { [from, to] };
            (middle - from).rem_euclid(turn) < (to - from).rem_euclid(turn)
        });
        if let Some(number) = number {
            remove(own, number, is_gap, turn);
        }
    }
}

/// Arc or gap that shrinks.
struct Shrinking {
    ring: usize,
    /// Distance along the loop of its middle.
    middle: f64,
    length: f64,
    is_gap: bool,
}

/// Removes an arc, or the gap after it.
pub(crate) fn remove(ring: &mut RingContact, number: usize, is_gap: bool, turn: f64) {
    let many = ring.arcs.len();
    if is_gap {
        if many == 1 {
            *ring = RingContact::default();
            return;
        }
        let next = (number + 1) % many;
        let to = ring.arcs[next][1];
        let from = ring.arcs[number][0];
        ring.arcs[number][1] = from + (to - from).rem_euclid(turn);
        ring.gaps[number] = ring.gaps[next];
        ring.arcs.remove(next);
        ring.gaps.remove(next);
    } else {
        let gap = ring.gaps[number];
        ring.arcs.remove(number);
        ring.gaps.remove(number);
        if ring.arcs.is_empty() {
            ring.gaps = vec![gap];
        }
    }
}

/// Moves ends that lie in a corner, but for little, out of it; into it if another law begins there. An arc round a
/// corner that is shorter than both moves stays.
fn keep_off_corners(setup: &Setup, contact: &mut [RingContact]) {
    for (own, ring) in contact.iter_mut().zip(&setup.domain.rings) {
        let least = NOWHERE * setup.perimeter;
        let turn = ring.length();
        let arcs = own.arcs.iter_mut().filter(|[from, to]| to - from > 2.0 * least);
        for (which, t) in arcs.flat_map(|arc| arc.iter_mut().enumerate()) {
            for corner in ring.corners() {
                let after = (*t - corner + 0.5 * turn).rem_euclid(turn) - 0.5 * turn;
                if after.abs() >= least || ring.sides.len() == 1 {
                    continue;
                }
                let side = ring.place(corner).side;
                let [before, beyond] = [ring.before(side), &ring.sides[side]];
                let [own, other] = if which == 1 { [before, beyond] } else { [beyond, before] };
                *t += match which {
                    _ if !other.law.may_move() || own.law.may_move() && !own.has_law_of(other) => {
                        -after
                    }
                    // Contact leaves the corner free.
                    0 => least - after,
                    _ => -least - after,
                };
            }
        }
        for arc in &mut own.arcs {
            let turns = (arc[0] / turn).floor() * turn;
            *arc = arc.map(|t| t - turns);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problem::law::BoundaryState::{SlipsDown, SlipsUp};
    use crate::problem::law::Law;
    use crate::spectral::geometry::polygons::square;
    use crate::spectral::problem::PlaneProblem;
    use crate::spectral::source::{PlaneSource, Regions};

    /// Unit square in contact, with friction and f = -1.
    fn square_with_friction() -> Setup {
        let domain = square().with_law(Law::friction(1.0).unwrap());
        let source = PlaneSource::Pieces(Regions::all("else=-1".parse().unwrap()));
        Setup::new(&PlaneProblem { domain, source }).unwrap()
    }

    #[test]
    fn ends_leave_corners_and_arcs_keep_their_direction() {
        let setup = square_with_friction();
        let least = 1e-7 * setup.perimeter;
        for (arc, moved) in [
            ([0.2, 1.0 - 0.1 * least], [0.2, 1.0 - least]),
            ([1.0 + 0.1 * least, 1.4], [1.0 + least, 1.4]),
            ([1.0 - 0.5 * least, 1.0 + 0.6 * least], [1.0 - 0.5 * least, 1.0 + 0.6 * least]),
        ] {
            let mut contact =
                [RingContact { arcs: vec![arc, [2.2, 2.4]], gaps: vec![SlipsDown, SlipsUp] }];
            keep_off_corners(&setup, &mut contact);
            let own = contact[0].arcs[0];
            assert!((0..2).all(|k| (own[k] - moved[k]).abs() < 1e-15), "{arc:?} {own:?}");
        }
    }

    #[test]
    fn what_shrinks_is_left_out_but_for_arcs_between_both_signs_and_gaps_with_an_end_at_rest() {
        let setup = square_with_friction();
        let moved = |arc, which, step, cut| EndStep { ring: 0, arc, which, step, cut, near: 0.1 };
        let both = [moved(0, 0, 0.1, true), moved(0, 1, -0.1, true)];
        for (gaps, many) in [([SlipsDown; 2], 2), ([SlipsUp, SlipsDown], 0)] {
            let contact = [RingContact { arcs: vec![[0.2, 0.4], [1.2, 2.4]], gaps: gaps.to_vec() }];
            let short = shrinking(&setup, &contact, &both);
            assert_eq!(short.len(), many);
            assert!(short.iter().all(|own| !own.is_gap && (own.length - 0.2).abs() < 1e-12));
            for (rests, many) in [(false, 2), (true, 0)] {
                let gap = [moved(0, 1, 0.1, true), moved(1, 0, -0.1, !rests)];
                let short = shrinking(&setup, &contact, &gap);
                assert_eq!(short.len(), many);
                assert!(short.iter().all(|own| own.is_gap && (own.middle - 0.8).abs() < 1e-12));
            }
        }
    }
}
