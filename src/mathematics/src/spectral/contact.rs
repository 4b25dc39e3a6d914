//! Contact set: from a grid at first, then corrected at the points where a sign is wrong.

use super::arcs::StickArcs;
use super::place::BoundaryPlace;
use super::trace::{Sign, Trace, UNRESOLVED};
use crate::discrete::contact::reach;
use crate::discrete::grid::Grid;
use crate::discrete::load::{Diagonal, LoadRule, load};
use crate::discrete::norms::largest;
use crate::multigrid::{self, Goal, MultigridParams};
use crate::problem::law::Law;
use crate::problem::source::Source;

/// Length below which arcs and gaps are left out.
pub(super) const SHORTEST: f64 = 2e-6;
/// Length below which arcs between v of opposite signs are not resolved: it magnifies the rounding errors of their
/// ends.
const SHORTEST_BETWEEN_SIGNS: f64 = 1e-7;
/// Length below which gaps round corners are left out in the end.
pub(super) const SHORTEST_ROUND_CORNER: f64 = 2.0 * UNRESOLVED;
/// Size of negative multipliers, relative to the largest multiplier, that is tolerated.
pub(super) const MULTIPLIER_TOLERANCE: f64 = 1e-6;
/// Size of negative values, relative to the size of v and psi, that is tolerated.
pub(super) const VALUE_TOLERANCE: f64 = 1e-10;

/// Contact set of a multigrid solution, with which Newton's method begins.
#[derive(Clone, Copy)]
pub(super) struct ContactStart {
    /// Cells per side.
    pub(super) n: usize,
    /// True if multigrid goes on to the rounding floor, and ends of contact little before a corner are moved behind it.
    pub(super) careful: bool,
}

impl ContactStart {
    /// Ends of contact to a cell or so of the grid; `None` if the flux cannot balance the load, or none sticks.
    pub(super) fn arcs(self, f: &Source, law: Law) -> Option<StickArcs> {
        let Self { n, careful } = self;
        let grid = Grid::new(n).expect("not below the least");
        let load = load(grid, f, LoadRule::Exact { diagonal: Diagonal::default() });
        // At the ends of contact single nodes have large residuals, which do not change the discretisation error,
        // unless the integral of f nearly vanishes.
        let quick = Goal::Kkt(0.05 * largest(&load));
        let goal = if careful { Goal::RoundingFloor } else { quick };
        let params = MultigridParams { goal, ..MultigridParams::default() };
        let (y, _) = multigrid::solve_square(n, law.with_load(&load), None, &params).ok()?;
        let values = grid.boundary().map(|node| y[node]).collect();
        let nodes = SettledNodes::new(values, n);
        let mut places = nodes.changes(n);
        if careful {
            for (j, end) in places.iter_mut().enumerate() {
                *end = behind_corner(j, *end);
            }
        }
        let flux =
            (0..places.len() / 2).map(|gap| flux_on(gap, &places, &nodes.values, law)).collect();
        Some(StickArcs { places, flux })
    }
}

/// Flux on the gap after an arc, from the value of largest size at the nodes in it.
fn flux_on(gap: usize, places: &[BoundaryPlace], values: &[f64], law: Law) -> f64 {
    let [from, to] = [2 * gap + 1, 2 * gap + 2].map(|j| places[j % places.len()]);
    let length = to.after(from).rem_euclid(4.0);
    let cells = values.len() as f64 / 4.0;
    let mut largest = 0.0f64;
    for (b, &value) in values.iter().enumerate() {
        let node = BoundaryPlace::new(3, b as f64 / cells);
        if node.after(from).rem_euclid(4.0) < length && value.abs() > largest.abs() {
            largest = value;
        }
    }
    if largest < 0.0 || law.lo().is_infinite() { law.hi() } else { law.lo() }
}

/// True for the boundary nodes that are free, anticlockwise, with the corners settled.
fn free_nodes(values: &[f64], n: usize) -> Vec<bool> {
    let many = values.len();
    let found: Vec<bool> = values.iter().map(|&v| v != 0.0).collect();
    // A corner with f > 0 may be free so near to it that one node says nothing; and a corner alone in
    // contact need not be.
    let mut free = found.clone();
    for corner in [0, n, 2 * n, 3 * n] {
        let state = free[corner];
        let [before, after] = [many - 1, 1].map(|step| alike(&free, corner, step));
        if before + after < if state { 1 } else { 2 } {
            for b in corner + many - before..=corner + many + after {
                free[b % many] = !state;
            }
        }
    }
    if free.contains(&false) { free } else { found }
}

/// Number of nodes beside a node, at most two, that are free like it or in contact like it.
fn alike(free: &[bool], node: usize, step: usize) -> usize {
    (1..=2).take_while(|k| free[(node + k * step) % free.len()] == free[node]).count()
}

/// Boundary nodes of a grid, anticlockwise, each of which sticks or is free.
struct SettledNodes {
    /// Values of v, zero where a node sticks.
    values: Vec<f64>,
    /// True for the nodes that are free, and for those between two of them of opposite signs.
    free: Vec<bool>,
    /// Change of the sign after each node.
    crossings: Vec<Option<Crossing>>,
}

impl SettledNodes {
    fn new(mut values: Vec<f64>, n: usize) -> Self {
        let mut free = free_nodes(&values, n);
        for (value, free) in values.iter_mut().zip(&free) {
            // A crossing is between free nodes, so that it takes the place of no end of contact.
            if !free {
                *value = 0.0;
            }
        }
        let many = values.len();
        let crossings: Vec<_> = (0..many).map(|b| crossing(&values, &free, b)).collect();
        for (b, crossing) in crossings.iter().enumerate() {
            let cells = crossing.as_ref().map_or(1, |crossing| crossing.cells);
            (1..cells).for_each(|k| free[(b + k) % many] = true);
        }
        Self { values, free, crossings }
    }

    /// Ends of contact between the free nodes and the others, beginnings first: two for each crossing, and as many ends
    /// as beginnings.
    fn changes(&self, n: usize) -> Vec<BoundaryPlace> {
        let Self { values, free, crossings } = self;
        let mut places = Vec::new();
        for (b, crossing) in crossings.iter().enumerate() {
            if let Some(crossing) = crossing {
                places.extend(arc_between(b, crossing, n));
            } else if free[b] != free[(b + 1) % free.len()] {
                places.push(end_after(b, values, free, n));
            }
        }
        if !free[0] && !places.is_empty() {
            places.rotate_left(1);
        }
        places
    }
}

/// End of contact between a boundary node and the next one, by extrapolation from the free nodes.
fn end_after(b: usize, values: &[f64], free: &[bool], n: usize) -> BoundaryPlace {
    let many = values.len();
    let (node, step) = if free[b] { (b + 1, many - 1) } else { (b, 1) };
    let next = [1, 2].map(|k| (node + k * step) % many);
    let corner = [node, next[0], next[1]].iter().any(|b| b % n == 0);
    let part = if corner { 0.5 } else { reach(next.map(|b| values[b])).clamp(-0.3, 0.9) };
    BoundaryPlace::new(3, (node as f64 + if free[b] { -part } else { part }) / n as f64)
}

/// Change of the sign of v after a boundary node.
struct Crossing {
    /// Number of cells to the node where v has the other sign.
    cells: usize,
    /// Distance from the node to the zero of the line through the values, in cells.
    zero: f64,
}

/// Change of the sign of v between a boundary node and the next one where v is not zero, if at most one node between
/// sticks: an arc there is shorter than two cells.
fn crossing(values: &[f64], free: &[bool], b: usize) -> Option<Crossing> {
    /// Cells to the next node at most: a corner that was settled as free has up to three nodes with it where v is zero.
    const MOST: usize = 5;
    let many = values.len();
    let value = |cells: usize| values[(b + cells) % many];
    let cells = (1..=MOST).find(|&cells| value(cells) != 0.0)?;
    let sticking = (1..cells).filter(|k| !free[(b + k) % many]).count();
    let is_opposite = value(0) * value(cells) < 0.0;
    let zero = cells as f64 * value(0) / (value(0) - value(cells));
    (is_opposite && sticking <= 1).then_some(Crossing { cells, zero })
}

/// Ends of the arc that sticks where v changes its sign after a boundary node.
fn arc_between(b: usize, crossing: &Crossing, n: usize) -> [BoundaryPlace; 2] {
    /// Half of its length in cells: at a longer one, more nodes would stick.
    const HALF: f64 = 0.1;
    let middle = crossing.zero.clamp(2.0 * HALF, crossing.cells as f64 - 2.0 * HALF);
    [-HALF, HALF].map(|part| BoundaryPlace::new(3, (b as f64 + middle + part) / n as f64))
}

/// Moves an end of contact that lies little before a corner, seen from its arc, as far behind it: near to a corner the
/// angle on the circle grows with the square of the distance, so that Newton's method crosses it from behind only.
fn behind_corner(j: usize, end: BoundaryPlace) -> BoundaryPlace {
    /// Accuracy of the ends of long arcs with little force on a coarse grid.
    const NEAR: f64 = 0.125;
    let before = if j.is_multiple_of(2) { end.t } else { -end.t };
    if (0.0..NEAR).contains(&before) { BoundaryPlace { t: -end.t, ..end } } else { end }
}

/// Contact set of a solution without the points at which the multiplier leaves the law, and with the points at which v
/// has the wrong sign: the same ends if all signs are right, `None` if no contact is left, or none between v of both
/// signs.
pub(super) fn corrected(trace: &Trace, law: Law) -> Option<StickArcs> {
    let wrong = wrong_points(&trace.signs(law));
    if !wrong.contains(&true) {
        return Some(trace.ends.arcs_and_flux());
    }
    let many = wrong.len();
    let was: Vec<bool> = (0..many).map(|i| trace.in_contact(i)).collect();
    let is: Vec<bool> = was.iter().zip(&wrong).map(|(was, wrong)| was != wrong).collect();
    if !is.contains(&true) {
        return None;
    }
    // dv/dn where v is not zero.
    let mut slips = Vec::with_capacity(many);
    for (i, point) in trace.points.iter().enumerate() {
        let [above_lo, below_hi] = law.room(point.multiplier);
        slips.push((!is[i]).then_some(if above_lo < below_hi { law.lo() } else { law.hi() }));
    }
    let (mut places, mut flux) = (Vec::new(), Vec::new());
    let mut known = trace.ends.places.iter();
    for i in 0..many {
        let last = (i + many - 1) % many;
        let end = if was[last] == was[i] { None } else { known.next() };
        if let (Some(before), Some(after)) = (slips[last], slips[i])
            && before != after
        {
            return None;
        }
        if is[last] != is[i] {
            flux.extend(slips[i]);
            let [from, to] = [last, i].map(|i| trace.points[i].place);
            places.push(match end {
                Some(end) if !wrong[last] && !wrong[i] => *end,
                _ => BoundaryPlace::new(from.corner, from.t + 0.5 * to.after(from).rem_euclid(4.0)),
            });
        }
    }
    if is[0] && is[many - 1] && !places.is_empty() {
        // Beginnings of contact come first.
        places.rotate_left(1);
        flux.rotate_left(1);
    }
    widen_round_corners(&mut places);
    Some(StickArcs { places, flux })
}

/// True for the points at which a sign is wrong. Points that are too near to a corner to be judged go with those beside
/// them.
fn wrong_points(signs: &[Sign]) -> Vec<bool> {
    let many = signs.len();
    let mut wrong = Vec::with_capacity(many);
    for sign in signs {
        let tolerance = if sign.contact { MULTIPLIER_TOLERANCE } else { VALUE_TOLERANCE };
        wrong.push(sign.value.is_some_and(|value| value < -tolerance));
    }
    if wrong.contains(&true) {
        for i in (0..many).chain((0..many).rev()) {
            let beside = wrong[(i + 1) % many] || wrong[(i + many - 1) % many];
            wrong[i] |= signs[i].value.is_none() && beside;
        }
    }
    wrong
}

/// Lets gaps at a corner go round it.
fn widen_round_corners(places: &mut [BoundaryPlace]) {
    for gap in 0..places.len() / 2 {
        let (end, begin) = (2 * gap + 1, (2 * gap + 2) % places.len());
        let [from, to] = [places[end], places[begin]];
        let [before, after] = [from.t.abs(), to.t.abs()];
        if (from.corner - to.corner) % 4 == 0 {
            if before <= UNRESOLVED {
                places[end].t = -UNRESOLVED.max(0.5 * after);
            }
            if after <= UNRESOLVED {
                places[begin].t = UNRESOLVED.max(0.5 * before);
            }
        }
    }
}

/// Leaves out arcs and gaps that are too short, and gaps round corners that are shorter than `round_corner`;
/// `None` if no arc is left, or not one between gaps of opposite signs. Corners are counted on from the first end to
/// the last, as in [`Ends`](super::panels::Ends).
pub(super) fn without_short(
    StickArcs { mut places, mut flux }: StickArcs,
    round_corner: f64,
) -> Option<StickArcs> {
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
            let least = if corner_gap {
                round_corner
            } else if is_between_signs(j, &flux) {
                SHORTEST_BETWEEN_SIGNS
            } else {
                SHORTEST
            };
            length < least
        });
        match short {
            None => return Some(StickArcs { places, flux }),
            // Without a gap there is contact everywhere; without an arc nothing is left.
            Some(j) if many == 2 => {
                return (j == 1).then(|| StickArcs { places: Vec::new(), flux: Vec::new() });
            }
            Some(j) if j + 1 == many => {
                // The last arc goes on to the end of the first.
                places.pop();
                places.remove(0);
                places.rotate_left(1);
                places[many - 3].corner += TURN;
                flux.pop();
                flux.rotate_left(1);
            }
            Some(j) => {
                // An arc between gaps of opposite signs cannot be left out.
                if is_between_signs(j, &flux) {
                    return None;
                }
                flux.remove(j / 2);
                places.drain(j..j + 2);
            }
        }
    }
}

/// True if the `j`-th end begins an arc between gaps of opposite signs, whose fluxes are given.
fn is_between_signs(j: usize, flux: &[f64]) -> bool {
    let gap = j / 2;
    let before = flux[(gap + flux.len() - 1) % flux.len()];
    j.is_multiple_of(2) && before != flux[gap]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Joins arcs, given by their ends as distances from one corner; the last gap ends a turn after the first end.
    fn joined(ends: &[f64]) -> Option<Vec<f64>> {
        let places = ends.iter().map(|&t| BoundaryPlace::new(0, t)).collect();
        let flux = vec![0.0; ends.len() / 2];
        let left = without_short(StickArcs { places, flux }, SHORTEST)?;
        Some(left.places.iter().map(|place| place.distance_from(0)).collect())
    }

    #[test]
    fn arcs_begin_as_often_as_they_end_whatever_signs_the_nodes_have() {
        const CELLS: usize = 4;
        let mut dice = 1u64;
        for _ in 0..20_000 {
            let mut values = Vec::new();
            for _ in 0..4 * CELLS {
                // The upper bits of a linear congruential generator.
                dice = dice.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                values.push([-1.0, 0.0, 0.0, 0.5][(dice >> 60) as usize % 4]);
            }
            let nodes = SettledNodes::new(values.clone(), CELLS);
            let places = nodes.changes(CELLS);
            assert!(places.len().is_multiple_of(2), "{values:?}");
            for (b, crossing) in nodes.crossings.iter().enumerate() {
                let Some(Crossing { cells, .. }) = crossing else { continue };
                assert!((0..=*cells).all(|k| nodes.free[(b + k) % values.len()]), "{values:?}");
            }
        }
    }

    #[test]
    fn a_short_gap_joins_the_arcs_beside_it() {
        assert_eq!(joined(&[0.25, 1.25, 2.25, 3.25]), Some(vec![0.25, 1.25, 2.25, 3.25]));
        assert_eq!(joined(&[0.25, 1.25, 1.25, 3.25]), Some(vec![0.25, 3.25]));
        assert_eq!(joined(&[0.25, 1.25, 2.25, 4.25]), Some(vec![2.25, 5.25]));
        assert_eq!(joined(&[0.25, 1.25, 2.25, 2.25]), Some(vec![0.25, 1.25]));
        // The whole boundary but a gap of half the least length, one of no length, and one of less.
        for gap in [0.5 * SHORTEST, 0.0, -0.5 * SHORTEST] {
            assert_eq!(joined(&[0.25, 4.25 - gap]), Some(Vec::new()), "{gap}");
            assert_eq!(joined(&[0.25, 0.25 + gap]), None, "{gap}");
        }
    }
}
