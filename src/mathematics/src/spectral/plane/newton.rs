//! Newton's method on the ends of contact: one division each.
//!
//! Near an end `v = K r^(1/2) + K1 r^(3/2)` at a distance r from it on the side that does not stick. K does not depend
//! on the other ends to first order where all K vanish, since the derivative of v by an end is K times a singular
//! function; so to move each end by `-K / (1.5 K1)` towards the free side is Newton's method.

use super::boundary::{RingContact, State};
use super::fit::{Effort, Fit};
use super::setup::{Level, Setup};
use crate::problem::complex::Complex;

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
const NOWHERE: f64 = 1e-7;

/// Moves the ends of a contact set until none moves any more; returns the fit, or none if that does not happen.
pub(super) fn settle(
    setup: &Setup,
    contact: &mut [RingContact],
    level: &Level,
    effort: &mut Effort,
) -> Option<Fit> {
    let mut last = f64::INFINITY;
    let mut shrinking = 0;
    for _ in 0..MOST {
        if effort.is_spent() {
            return None;
        }
        let fit = Fit::new(setup, contact, level);
        effort.add(&fit);
        let moves = end_steps(setup, contact, &fit);
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
        shrinking = if cut { shrinking + 1 } else { 0 };
        for m in &moves {
            contact[m.ring].arcs[m.arc][m.which] += m.step;
        }
        if shrinking >= 3 {
            drop_short(setup, contact, &moves);
            shrinking = 0;
        }
        keep_off_corners(setup, contact);
    }
    None
}

/// Coefficient `K` and `K1` of all ends that may move, and their steps.
fn end_steps(setup: &Setup, contact: &[RingContact], fit: &Fit) -> Vec<EndStep> {
    let mut steps = Vec::new();
    let mut first = 0;
    for family in &fit.functions.families {
        let many = family.powers.len();
        let own = &fit.coefficients[first..first + many * family.lengths.len()];
        first += many * family.lengths.len();
        let Some(split) = family.split.map(|k| &fit.walk.splits[k]) else { continue };
        let Some((arc, which)) = split.end else { continue };
        let (mut b0, mut b1) = (Complex::default(), Complex::default());
        for (c, d) in own.chunks_exact(many).zip(&family.lengths) {
            let root = 1.0 / d.sqrt();
            b0 = b0 + c[0].scaled(root);
            b1 = b1 + (c[2] - c[0].scaled(0.5)).scaled(root / d);
        }
        // On the free side w = f r.
        let f = Complex::new(0.0, if which == 0 { 1.0 } else { -1.0 });
        let root = f.sqrt();
        let (k, k1) = ((root * b0).re, (root * f * b1).re);
        let flux = split
            .states
            .iter()
            .find_map(|state| if let State::Flux(q) = state { Some(*q) } else { None });
        let sign = match flux {
            Some(q) if q == setup.law.hi() => -1.0,
            _ => 1.0,
        };
        let ring = &contact[split.ring];
        let turn = setup.rings[split.ring].length();
        let [arc_length, gap] = around(ring, arc, which, turn);
        // Towards the free side.
        let wanted = match k1 * sign > 0.0 {
            true => -k / (1.5 * k1),
            false => -(k * sign).signum() * f64::INFINITY,
        };
        let near = split.lengths[0].min(split.lengths[1]);
        // What grows, grows no more than threefold.
        let room = match wanted > 0.0 {
            // The expansion holds up to the next split only.
            _ if wanted.is_infinite() => PART * near,
            true => (PART * gap).min(2.0 * arc_length),
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

/// Leaves out arcs and gaps that shrank at a cut step: the shortest, and those that are not much longer.
fn drop_short(setup: &Setup, contact: &mut [RingContact], moves: &[EndStep]) {
    /// Longest that is left out, in perimeters, and over the shortest.
    const SHORT: [f64; 2] = [0.05, 10.0];
    let mut shrinking: Vec<Shrinking> = Vec::new();
    for m in moves.iter().filter(|m| m.cut) {
        let is_gap = (m.step < 0.0) != (m.which == 1);
        let lengths = around(&contact[m.ring], m.arc, m.which, setup.rings[m.ring].length());
        let length = lengths[usize::from(is_gap)];
        let end = contact[m.ring].arcs[m.arc][m.which];
        // An arc lies behind its end, the gap before it.
        let half = if is_gap == (m.which == 1) { 0.5 * length } else { -0.5 * length };
        shrinking.push(Shrinking { ring: m.ring, middle: end + half, length, is_gap });
    }
    let shortest = shrinking.iter().fold(f64::INFINITY, |least, own| least.min(own.length));
    let longest = (SHORT[0] * setup.perimeter).min(SHORT[1] * shortest);
    for Shrinking { ring, middle, is_gap, .. } in
        shrinking.into_iter().filter(|own| own.length < longest)
    {
        let (own, turn) = (&mut contact[ring], setup.rings[ring].length());
        let many = own.arcs.len();
        let number = (0..many).find(|&k| {
            let [from, to] = own.arcs[k];
            let [from, to] = if is_gap { [to, own.arcs[(k + 1) % many][0]] } else { [from, to] };
            // Both ends of what is left out may have been cut.
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
pub(super) fn remove(ring: &mut RingContact, number: usize, is_gap: bool, turn: f64) {
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

/// Moves ends that lie in a corner, but for little, out of it.
fn keep_off_corners(setup: &Setup, contact: &mut [RingContact]) {
    for (own, ring) in contact.iter_mut().zip(&setup.rings) {
        let least = 1e-7 * setup.perimeter;
        let turn = ring.length();
        for (which, t) in own.arcs.iter_mut().flat_map(|arc| arc.iter_mut().enumerate()) {
            for &corner in &ring.starts[..ring.sides.len()] {
                let after = (*t - corner + 0.5 * turn).rem_euclid(turn) - 0.5 * turn;
                if after.abs() < least && ring.sides.len() > 1 {
                    // Contact leaves the corner free.
                    *t += if which == 0 { least - after } else { -least - after };
                }
            }
        }
        for arc in &mut own.arcs {
            let turns = (arc[0] / turn).floor() * turn;
            *arc = arc.map(|t| t - turns);
        }
    }
}
