//! The contact set: from a grid at first, then corrected where a sign is wrong.

use super::panels::{Ends, Place};
use super::sources::Rules;
use super::trace::{Point, Trace, UNRESOLVED};
use crate::discrete::contact::reach;
use crate::discrete::grid::Grid;

/// Arcs and gaps shorter than this are left out.
pub(super) const SHORTEST: f64 = 2e-6;
/// Gaps round corners shorter than this are left out in the end.
pub(super) const SHORTEST_ROUND_CORNER: f64 = 2.0 * UNRESOLVED;
/// Negative multipliers and values that count, relative to the largest.
pub(super) const TOLERANCE: [f64; 2] = [1e-6, 1e-10];

/// The ends of contact of nodal values `y` on a grid: beginnings and ends in turn, none where all of the
/// border is in contact.
pub(super) fn from_grid(grid: Grid, y: &[f64]) -> Vec<Place> {
    let values: Vec<f64> = grid.boundary().map(|node| y[node]).collect();
    let (n, many) = (grid.cells(), values.len());
    let at = |b: usize| values[b % many];
    // A corner with f > 0 may be free so near to it that one node says nothing; and a corner alone in
    // contact need not be.
    let mut free: Vec<bool> = values.iter().map(|&v| v > 0.0).collect();
    for (state, most) in [(true, 1), (false, 2)] {
        let before = free.clone();
        for run in runs(&before, state) {
            let corner = run.clone().any(|b| b % n == 0);
            if corner && run.len() <= most {
                run.for_each(|b| free[b % many] = !state);
            }
        }
        if free.iter().all(|&free| free) {
            free = before;
        }
    }
    let mut places = Vec::new();
    for run in runs(&free, false) {
        for (node, step) in [(run.start, many - 1), (run.end - 1, 1)] {
            let corner = (0..=2).any(|k| (node + k * step) % n == 0);
            let fraction = if corner {
                0.5
            } else {
                reach([1, 2].map(|k| at(node + k * step))).clamp(-0.3, 0.9)
            };
            let fraction = fraction * grid.h();
            let t = if step == 1 { fraction } else { -fraction };
            places.push(Place::new(3, (node % many) as f64 * grid.h() + t));
        }
    }
    in_order(places)
}

/// Maximal runs of entries equal to `state` in a cyclic list, as positions that may pass its length; none
/// if all are equal.
fn runs(list: &[bool], state: bool) -> Vec<std::ops::Range<usize>> {
    let many = list.len();
    let Some(start) = list.iter().position(|&entry| entry != state) else { return Vec::new() };
    let mut runs: Vec<std::ops::Range<usize>> = Vec::new();
    for b in start..start + many {
        if list[b % many] == state {
            match runs.last_mut() {
                Some(run) if run.end == b => run.end = b + 1,
                _ => runs.push(b..b + 1),
            }
        }
    }
    runs
}

/// The same places with corners counted on from the first.
fn in_order(mut places: Vec<Place>) -> Vec<Place> {
    if let Some(first) = places.first_mut() {
        first.corner = first.corner.rem_euclid(4);
        let first = *first;
        places.iter_mut().skip(1).for_each(|place| *place = place.following(first));
    }
    places
}

/// What the signs of a solution for given ends say about its contact set.
pub(super) enum Signs {
    /// All are right.
    Right,
    /// Some are wrong, and this set is better.
    Better(Vec<Place>),
    /// So many are wrong that no contact is left.
    NothingLeft,
}

/// A better contact set where the multiplier is negative in contact or v elsewhere.
pub(super) fn corrected(trace: &Trace, ends: &Ends, rules: &Rules) -> Signs {
    let points = &trace.points;
    let many = points.len();
    let wrong = wrong(trace, rules);
    if !wrong.contains(&true) {
        return Signs::Right;
    }
    if !wrong.contains(&false) {
        return Signs::NothingLeft;
    }
    let contact = |i: usize| trace.in_contact(i);
    let place = |i: usize| {
        let Place { corner, t } = points[i % many].place;
        Place { corner: corner + if i >= many { 4 } else { 0 }, t }
    };
    // Where contact begins and ends, as places on a line around the border.
    let mut changes: Vec<Place> = ends.places.clone();
    let mut added: Vec<[Place; 2]> = Vec::new();
    for run in runs(&wrong, true) {
        // A run may hold both kinds of wrong points; each kind is treated by itself.
        let mut first = run.start;
        while first < run.end {
            let kind = contact(first);
            let arc = trace.panels[points[first % many].panel].arcs;
            let same =
                |i: usize| contact(i) == kind && trace.panels[points[i % many].panel].arcs == arc;
            let last =
                (first..run.end).take_while(|&i| same(i)).last().expect("the first is the same");
            let touches = [!same(first + many - 1), !same(last + 1)];
            let [from, to] = [place(first), place(last)];
            if ends.arcs() > 0 && touches.contains(&true) {
                let begins = if kind { 2 * (arc - 1) } else { 2 * arc - 1 };
                let finishes = (begins + 1) % changes.len();
                match touches {
                    // Closed by bringing its ends together.
                    [true, true] => changes[finishes] = changes[begins],
                    [true, false] => changes[begins] = to,
                    _ => changes[finishes] = from,
                }
            } else {
                let to_right = [from.after(place(first + many - 1)), place(last + 1).after(to)];
                let to_right = to_right.map(|distance| distance.rem_euclid(4.0));
                added.push(if kind { widened(from, to, to_right) } else { halved(from, to) });
            }
            first = last + 1;
        }
    }
    let changed = in_turn(changes, added, ends.arcs() == 0);
    without_short(changed, SHORTEST_ROUND_CORNER).map_or(Signs::NothingLeft, Signs::Better)
}

/// Where the multiplier is negative in contact or v elsewhere, point by point.
fn wrong(trace: &Trace, rules: &Rules) -> Vec<bool> {
    let points = &trace.points;
    let many = points.len();
    let largest = trace.largest();
    let is_wrong = |(i, p): (usize, &Point)| {
        if trace.in_contact(i) {
            trace.judged(i, rules).is_some_and(|l| l < -TOLERANCE[0] * largest[0])
        } else {
            p.value < -TOLERANCE[1] * largest[1]
        }
    };
    let mut wrong: Vec<bool> = points.iter().enumerate().map(is_wrong).collect();
    if !wrong.contains(&true) {
        return wrong;
    }
    // What is negative so near to a corner belongs to a gap found further away.
    for i in (0..many).chain((0..many).rev()) {
        let beside = wrong[(i + 1) % many] || wrong[(i + many - 1) % many];
        let p = &points[i];
        let near = p.place.t.abs() <= UNRESOLVED;
        wrong[i] |= beside && trace.in_contact(i) && p.multiplier < 0.0 && near;
    }
    wrong
}

/// The ends of contact with pairs of new ones, in their order around the border.
fn in_turn(mut changes: Vec<Place>, added: Vec<[Place; 2]>, everywhere: bool) -> Vec<Place> {
    let start = changes.first().copied().unwrap_or(Place { corner: 0, t: 0.0 });
    for pair in added {
        let pair = pair.map(|place| place.following(start));
        // With contact everywhere the first gap is what lies outside of the arc.
        changes.extend(if everywhere { [pair[1], pair[0]] } else { pair });
    }
    if !everywhere {
        changes.sort_by(|a, b| a.after(start).total_cmp(&b.after(start)));
    } else {
        let first = changes[0];
        changes.iter_mut().for_each(|p| *p = p.following(first));
        changes[1..].sort_by(|a, b| a.after(first).total_cmp(&b.after(first)));
    }
    changes
}

/// Leaves out arcs and gaps that are too short, and gaps round corners that are shorter than `round_corner`;
/// `None` if no arc is left.
pub(super) fn without_short(mut places: Vec<Place>, round_corner: f64) -> Option<Vec<Place>> {
    let contact_everywhere = places.is_empty();
    loop {
        let many = places.len();
        let short = (0..many).find(|&j| {
            let next = places[(j + 1) % many];
            let length = next.after(places[j]);
            let length = if j + 1 == many { length + 4.0 } else { length };
            let corner_gap = j % 2 == 1 && places[j].t < 0.0 && next.t > 0.0;
            length < if corner_gap { round_corner } else { SHORTEST }
        });
        match short {
            None => break,
            Some(j) if many == 2 => {
                // Without a gap there is contact everywhere; without an arc nothing is left.
                return (j == 1).then(Vec::new);
            }
            Some(j) if j + 1 == many => {
                // The gap across the start: the list begins at the next arc instead.
                places.remove(j);
                places.remove(0);
                let end = places.remove(0);
                places.push(Place { corner: end.corner + 4, t: end.t });
            }
            Some(j) => {
                places.drain(j..j + 2);
            }
        }
    }
    (contact_everywhere || !places.is_empty()).then(|| in_order(places))
}

/// A gap around the points where the multiplier is negative, up to half the distances `to_right` from points
/// where it is not. Next to a corner, where it is `a s - b s log(1/s)`, it vanishes at 1/sqrt2 times the length
/// of the gap.
fn widened(from: Place, to: Place, to_right: [f64; 2]) -> [Place; 2] {
    let [a, b] = [from, to].map(|place| Place::new(place.corner, place.t));
    let factor = std::f64::consts::SQRT_2;
    let corner =
        if b.t > 0.0 && b.distance_from(b.corner) - a.distance_from(b.corner) > b.t - 1e-3 * b.t {
            Some(b.corner)
        } else if a.t < 0.0 && b.distance_from(a.corner) > 1e-3 * a.t {
            Some(a.corner)
        } else {
            None
        };
    match corner {
        Some(corner) => {
            let (before, after) = (-a.distance_from(corner), b.distance_from(corner));
            let least = (0.5 * before.max(after)).max(UNRESOLVED);
            [
                Place::new(corner, -factor * before.max(least)),
                Place::new(corner, factor * after.max(least)),
            ]
        }
        None => {
            let [before, after] = to_right.map(|distance| 0.5 * distance);
            [Place::new(a.corner, a.t - before), Place::new(b.corner, b.t + after)]
        }
    }
}

/// The middle half of a range.
fn halved(from: Place, to: Place) -> [Place; 2] {
    let quarter = 0.25 * to.after(from);
    [Place::new(from.corner, from.t + quarter), Place::new(to.corner, to.t - quarter)]
}
