//! The contact set: from a grid at first, then corrected where a sign is wrong.

use super::place::Place;
use super::trace::{Trace, UNRESOLVED};
use crate::discrete::contact::reach;
use crate::discrete::grid::Grid;
use crate::discrete::load::{Diagonal, LoadRule, load};
use crate::discrete::norms::largest;
use crate::multigrid::{self, Goal, MultigridParams};
use crate::problem::source::Source;

/// Arcs and gaps shorter than this are left out.
pub(super) const SHORTEST: f64 = 2e-6;
/// Gaps round corners shorter than this are left out in the end.
pub(super) const SHORTEST_ROUND_CORNER: f64 = 2.0 * UNRESOLVED;
/// Negative multipliers and values that count, relative to the largest.
pub(super) const TOLERANCE: [f64; 2] = [1e-6, 1e-10];

/// A start from a grid: what Newton's method is given first.
#[derive(Clone, Copy)]
pub(super) struct Start {
    /// Cells per side.
    pub(super) n: usize,
    /// Multigrid goes on to rounding, and ends of contact little before a corner are moved behind it.
    pub(super) careful: bool,
}

impl Start {
    /// The ends of contact to a cell or so of the grid: beginnings and ends in turn, none where all of the border
    /// is in contact; `None` if the load has no negative sum.
    pub(super) fn ends(self, f: &Source) -> Option<Vec<Place>> {
        let Self { n, careful } = self;
        let grid = Grid::new(n).expect("not below the least");
        let load = load(grid, f, LoadRule::Exact { diagonal: Diagonal::default() });
        // At the ends of contact single nodes have large residuals, which the discretisation error does not feel;
        // unless the integral of f nearly vanishes.
        let quick = Goal::Kkt(0.05 * largest(&load));
        let goal = if careful { Goal::RoundingFloor } else { quick };
        let params = MultigridParams { goal, ..Default::default() };
        let (y, _) = multigrid::solve_square(n, &load, None, &params).ok()?;
        let values: Vec<f64> = grid.boundary().map(|node| y[node]).collect();
        let mut places = changes(&values, &free_nodes(&values, n), n);
        if careful {
            places.iter_mut().enumerate().for_each(|(j, end)| *end = behind_corner(j, *end));
        }
        Some(places)
    }
}

/// Which boundary nodes are free, anticlockwise, with the corners settled.
fn free_nodes(values: &[f64], n: usize) -> Vec<bool> {
    let many = values.len();
    let found: Vec<bool> = values.iter().map(|&v| v > 0.0).collect();
    // A corner with f > 0 may be free so near to it that one node says nothing; and a corner alone in
    // contact need not be.
    let mut free = found.clone();
    for corner in [0, n, 2 * n, 3 * n] {
        let state = free[corner];
        let alike =
            |step: usize| (1..=2).take_while(|k| free[(corner + k * step) % many] == state).count();
        let [before, after] = [many - 1, 1].map(alike);
        if before + after < if state { 1 } else { 2 } {
            (corner + many - before..=corner + many + after).for_each(|b| free[b % many] = !state);
        }
    }
    if free.contains(&false) { free } else { found }
}

/// The ends of contact between the free boundary nodes and the others, beginnings first.
fn changes(values: &[f64], free: &[bool], n: usize) -> Vec<Place> {
    let many = values.len();
    let end = |b: usize| {
        let (node, step) = if free[b] { (b + 1, many - 1) } else { (b, 1) };
        let next = [1, 2].map(|k| (node + k * step) % many);
        let corner = [node, next[0], next[1]].iter().any(|b| b % n == 0);
        let part = if corner { 0.5 } else { reach(next.map(|b| values[b])).clamp(-0.3, 0.9) };
        Place::new(3, (node as f64 + if free[b] { -part } else { part }) / n as f64)
    };
    let changes = (0..many).filter(|&b| free[b] != free[(b + 1) % many]);
    let mut places: Vec<Place> = changes.map(end).collect();
    if !free[0] && !places.is_empty() {
        places.rotate_left(1);
    }
    places
}

/// An end of contact that lies little before a corner, seen from its arc, as far behind it: near to a corner the angle
/// on the circle grows with the square of the distance, so that Newton's method crosses it from behind only.
fn behind_corner(j: usize, end: Place) -> Place {
    /// On a coarse grid ends of long arcs with little force are not known better.
    const NEAR: f64 = 0.125;
    let before = if j.is_multiple_of(2) { end.t } else { -end.t };
    if (0.0..NEAR).contains(&before) { Place { t: -end.t, ..end } } else { end }
}

/// The contact set of a solution without the points where the multiplier is negative, and with those where v is:
/// the same ends if all signs are right, `None` if no contact is left.
pub(super) fn corrected(trace: &Trace) -> Option<Vec<Place>> {
    let signs = trace.signs();
    let mut wrong: Vec<bool> = signs.iter().map(|&(kind, sign)| sign < -TOLERANCE[kind]).collect();
    if !wrong.contains(&true) {
        return Some(trace.ends.places.clone());
    }
    let many = wrong.len();
    // Points that are too near to a corner to be judged go with those beside them.
    for i in (0..many).chain((0..many).rev()) {
        let beside = wrong[(i + 1) % many] || wrong[(i + many - 1) % many];
        wrong[i] |= signs[i].1 == f64::INFINITY && beside;
    }
    let was = |i: usize| trace.in_contact(i);
    let is = |i: usize| was(i) != wrong[i];
    if !(0..many).any(is) {
        return None;
    }
    let (mut places, mut known) = (Vec::new(), trace.ends.places.iter());
    for i in 0..many {
        let last = (i + many - 1) % many;
        let end = if was(last) != was(i) { known.next() } else { None };
        if is(last) != is(i) {
            let [from, to] = [last, i].map(|i| trace.points[i].place);
            places.push(match end {
                Some(end) if !wrong[last] && !wrong[i] => *end,
                _ => Place::new(from.corner, from.t + 0.5 * to.after(from).rem_euclid(4.0)),
            });
        }
    }
    if is(0) && is(many - 1) && !places.is_empty() {
        // Beginnings of contact come first.
        places.rotate_left(1);
    }
    for gap in 0..places.len() / 2 {
        let (end, begin) = (2 * gap + 1, (2 * gap + 2) % places.len());
        let [from, to] = [places[end], places[begin]];
        let [before, after] = [from.t.abs(), to.t.abs()];
        if (from.corner - to.corner) % 4 == 0 {
            // At a corner a gap goes round it.
            let least = |other: f64| UNRESOLVED.max(0.5 * other);
            if before <= UNRESOLVED {
                places[end].t = -least(after);
            }
            if after <= UNRESOLVED {
                places[begin].t = least(before);
            }
        }
    }
    Some(places)
}

/// Leaves out arcs and gaps that are too short, and gaps round corners that are shorter than `round_corner`;
/// `None` if no arc is left. Corners are counted on from the first end to the last, as [`Ends`](super::panels::Ends) does.
pub(super) fn without_short(mut places: Vec<Place>, round_corner: f64) -> Option<Vec<Place>> {
    /// Corners in a turn.
    const TURN: i32 = 4;
    loop {
        let many = places.len();
        let short = (0..many).find(|&j| {
            let (place, next) = (places[j], places[(j + 1) % many]);
            let turn = if j + 1 == many { f64::from(TURN) } else { 0.0 };
            // Negative where ends have changed their order.
            let length = next.after(place) + turn;
            let corner_gap = j % 2 == 1 && place.t < 0.0 && next.t > 0.0;
            length < if corner_gap { round_corner } else { SHORTEST }
        });
        match short {
            None => return Some(places),
            // Without a gap there is contact everywhere; without an arc nothing is left.
            Some(j) if many == 2 => return (j == 1).then(Vec::new),
            Some(j) if j + 1 == many => {
                // The last arc goes on to the end of the first.
                places.pop();
                places.remove(0);
                places.rotate_left(1);
                places[many - 3].corner += TURN;
            }
            Some(j) => {
                places.drain(j..j + 2);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_short_gap_joins_the_arcs_beside_it() {
        // Ends of contact as distances from one corner; the last gap ends a turn after the first.
        let joined = |ends: &[f64]| {
            let places = ends.iter().map(|&t| Place::new(0, t)).collect();
            without_short(places, SHORTEST).map(|left| {
                let ends = left.iter().map(|place| place.distance_from(0));
                ends.collect::<Vec<f64>>()
            })
        };
        assert_eq!(joined(&[0.25, 1.25, 2.25, 3.25]), Some(vec![0.25, 1.25, 2.25, 3.25]));
        assert_eq!(joined(&[0.25, 1.25, 1.25, 3.25]), Some(vec![0.25, 3.25]));
        assert_eq!(joined(&[0.25, 1.25, 2.25, 4.25]), Some(vec![2.25, 5.25]));
        assert_eq!(joined(&[0.25, 1.25, 2.25, 2.25]), Some(vec![0.25, 1.25]));
        // The whole border but a gap of half the least length, one of no length, and one of less.
        for gap in [0.5 * SHORTEST, 0.0, -0.5 * SHORTEST] {
            assert_eq!(joined(&[0.25, 4.25 - gap]), Some(Vec::new()), "{gap}");
            assert_eq!(joined(&[0.25, 0.25 + gap]), None, "{gap}");
        }
    }
}
