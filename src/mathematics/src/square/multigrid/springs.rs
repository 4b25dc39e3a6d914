//! The contact set of the finest grid, and its representation on each coarser grid.
//!
//! If a coarse grid only knows whether its own nodes are in contact, it misplaces the ends of a contact interval by
//! half a cell, and loses short intervals altogether; that makes multigrid slow for obstacle problems. Here every
//! coarse grid gets *springs* on boundary nodes. They put the ends of an interval, or the logarithmic capacity of a
//! short one, to where the finest grid has them.
//!
//! # Algorithm
//! 1. Find the runs of nodes in contact on the finest grid, and the interval that each run is equivalent to.
//! 2. For each coarser grid, scale the intervals to its cells.
//! 3. Represent each interval by nodes in contact and a spring beyond each end (`add_springs`, the central function),
//!    at corners by the formulas of `corner_springs` and `Leg::around_corner`.
//!
//! # Facts
//! Lengths are in cells, for the five-point stencil on a half-plane with natural boundary condition:
//! - From afar, nodes `..., -1, 0` in contact act like an interval that ends at [`TIP`].
//! - A spring `SPRING t / (1 - t)` on node 1 moves that end on by `t`, for any `0 <= t < 1`.
//! - A single node in contact acts like an interval of half-length [`POINT_ON_EDGE`]. In the corner of a quadrant it
//!   acts like an interval that reaches [`POINT_IN_CORNER`] along both sides.
//! - A corner node in contact with springs on its two neighbours acts like contact up to `a` along one side and `b`
//!   along the other. `corner_springs` has the formulas for all short intervals there.
//! - If a whole side of a quadrant is in contact, and one node more around the corner, that acts like contact up to
//!   [`CORNER_LEG`]. With a spring `CORNER_SPRING t / (1 - t)` on that node instead, it acts like contact up to
//!   `CORNER_LEG sqrt(t)`.
//!
//! The first two follow by Wiener and Hopf's factorisation. Without the interior nodes, the boundary has the
//! symbol `2 sqrt((1 - cos t)(3 - cos t)) = S(z) S(1/z) / sqrt(rho)`, `S = sqrt((1 - z)(1 - rho z))`,
//! `rho = 3 - 2 sqrt(2)` (the half-plane mirrored, a spring counts twice). Values that grow like a root and
//! solve all equations but that of node 1 are the coefficients of `U = C z (1 - t (1 - z)) / ((1 - z) S)`: they
//! grow like `sqrt(k - e)` with `e = 1/4 + rho / (2 (1 - rho)) + t = TIP + t`, and in the equation of node 1
//! `t / sqrt(rho)` is left, twice a spring times the value `1 - t` there.
//! The others follow from the potential kernel of the square lattice (Spitzer, *Principles of Random
//! Walk*, section 15) and the map `z^2` of the quadrant.
//!
//! The springs affect the rate of convergence only, never the solution.

use std::f64::consts::{PI, SQRT_2};

use super::level::MultigridLevel;
use super::rows::boundary_number;
use crate::discrete::grid::Grid;

/// Distance from the last node in contact to the end of the equivalent interval: sqrt(2) / 4.
const TIP: f64 = SQRT_2 / 4.0;
/// Scale of the spring that moves the end of an interval: (1 + sqrt(2)) / 2.
const SPRING: f64 = f64::midpoint(1.0, SQRT_2);
/// Half-length of the interval equivalent to one node of an edge: 2 exp(-gamma - 3/2 ln 2).
const POINT_ON_EDGE: f64 = 0.397_012;
/// Reach along both sides equivalent to a corner node: sqrt(2) exp(-gamma - 3/2 ln 2).
const POINT_IN_CORNER: f64 = 0.280_730;
/// Reach of a corner node and its neighbour along one side, along that side and along the other:
/// `sqrt(POINT_IN_CORNER^2 exp(pi^2 / 4) +- pi / 4)`.
const ONE_LEG: [f64; 2] = [1.309_464, 0.379_343];
/// Reach of a corner node and both its neighbours: `POINT_IN_CORNER exp(pi / 2)`.
const TWO_LEGS: f64 = 1.350_444;
/// Reach of one node in contact around a corner, if the whole other side is in contact: sqrt(4 / (pi g)),
/// g = 2 - 4 / pi the resistance of that node.
const CORNER_LEG: f64 = 1.323_608;
/// Scale of the spring around a corner: 1 / g.
const CORNER_SPRING: f64 = 1.375_969;
/// Stiffness, in the mirrored stencil, from which on a spring counts as contact.
const STIFFEST: f64 = 2e4;
/// Tolerance for a node at the very end of an interval, in cells.
const ROUNDING: f64 = 1e-9;

/// Interval equivalent to a run of contact nodes, in cells of the finest grid along the perimeter,
/// counter-clockwise from the corner (0, 0); `end` may exceed the perimeter.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Interval {
    start: f64,
    end: f64,
}

/// Sets `1 / (4 + spring)` on all `levels`, for the contact set of a finer grid with `n` cells per side; both
/// are indexed by the numbers of boundary nodes. Returns the work in visits of unknowns.
pub(super) fn set_springs(n: usize, in_contact: &[bool], levels: &mut [MultigridLevel]) -> f64 {
    let around: Vec<_> = (0..4 * n).map(|p| in_contact[number(n, p)]).collect();
    let intervals = intervals(n, &around);
    let (mut work, mut springs) = (in_contact.len() as f64, vec![0.0; 4 * n]);
    for level in levels {
        let cells = level.n;
        let springs = &mut springs[..4 * cells];
        find_springs(n, &around, &intervals, springs);
        level.inverse_diagonal.fill(0.25);
        for (p, &spring) in springs.iter().enumerate().filter(|(_, spring)| **spring != 0.0) {
            let inverse = if spring < STIFFEST { 1.0 / (4.0 + spring) } else { 0.0 };
            level.inverse_diagonal[number(cells, p)] = inverse;
        }
        work += springs.len() as f64;
    }
    work
}

/// Finds the springs of the mirrored stencil on the boundary nodes of a coarser grid, counter-clockwise.
fn find_springs(n: usize, around: &[bool], intervals: &[Interval], springs: &mut [f64]) {
    // Without a free node the contact has no ends.
    let all_held = intervals.is_empty() && around[0];
    springs.fill(if all_held { f64::INFINITY } else { 0.0 });
    let cells = springs.len() / 4;
    let cell = n as f64 / cells as f64;
    for interval in intervals {
        add_springs(interval.scaled(1.0 / cell), cells, springs);
    }
}

/// Number of the boundary node that is the `p`-th in the order of [`Grid::boundary`].
fn number(n: usize, p: usize) -> usize {
    let (i, j) = Grid::new(n).expect("two cells at least").boundary_node(p);
    boundary_number(n, [i, j])
}

/// Intervals equivalent to the runs of nodes in contact; empty if no node is free.
fn intervals(n: usize, in_contact: &[bool]) -> Vec<Interval> {
    let Some(free) = in_contact.iter().position(|contact| !contact) else {
        return Vec::new();
    };
    let mut intervals = Vec::new();
    let mut first = None;
    let onwards = in_contact[free + 1..].iter().chain(&in_contact[..=free]);
    for (p, &contact) in (free + 1..).zip(onwards) {
        match (first, contact) {
            (None, true) => first = Some(p),
            (Some(start), false) => {
                intervals.push(Interval::from_nodes(n, start, p - 1));
                first = None;
            }
            _ => {}
        }
    }
    intervals
}

/// Distance from the last node of a long run to the end of the interval, if the node lies `beyond_corner` cells beyond
/// the last corner.
fn reach(beyond_corner: usize) -> f64 {
    match beyond_corner {
        0 => 0.0,
        1 => CORNER_LEG - 1.0,
        _ => TIP,
    }
}

impl Interval {
    fn from_nodes(n: usize, first: usize, last: usize) -> Self {
        let (before, after) = ((n - first % n) % n, last % n);
        let (start, end) = match (last - first, before, after) {
            (0, 0, _) => (POINT_IN_CORNER, POINT_IN_CORNER),
            (0, ..) => (POINT_ON_EDGE, POINT_ON_EDGE),
            (1, 0, _) => (ONE_LEG[1], ONE_LEG[0] - 1.0),
            (1, 1, 0) => (ONE_LEG[0] - 1.0, ONE_LEG[1]),
            (2, 1, 1) => (TWO_LEGS - 1.0, TWO_LEGS - 1.0),
            _ => (reach(before), reach(after)),
        };
        Self { start: first as f64 - start, end: last as f64 + end }
    }

    fn scaled(self, factor: f64) -> Self {
        Self { start: factor * self.start, end: factor * self.end }
    }

    /// First and last node in contact, if neither end is in a corner; `first > last` if there is none.
    fn held_nodes(self) -> [f64; 2] {
        [(self.start + TIP - ROUNDING).ceil(), (self.end - TIP + ROUNDING).floor()]
    }

    /// True if the interval lies within about a cell around a corner and contains no other node than the corner.
    fn is_short_at(self, corner: f64) -> bool {
        let (start, end) = (self.start - corner, self.end - corner);
        let [first, last] = self.held_nodes();
        if start <= 0.0 && end >= 0.0 {
            end.max(-start) < CORNER_LEG
        } else {
            first > last && (start + end).abs() < 2.0
        }
    }

    /// Nodes in contact that represent an interval which is not short at a corner, and the springs beside them, on a
    /// grid with `n` cells per side.
    fn held(self, n: usize) -> HeldRun {
        let side = n as f64;
        let first_corner = (self.start / side).ceil() * side;
        let last_corner = (self.end / side).floor() * side;
        if first_corner <= last_corner {
            let before = Leg::around_corner(first_corner - self.start);
            let after = Leg::around_corner(self.end - last_corner);
            HeldRun {
                first: first_corner - before.nodes,
                last: last_corner + after.nodes,
                spring_before: before.spring,
                spring_after: after.spring,
            }
        } else {
            let [first, last] = self.held_nodes();
            HeldRun {
                first,
                last,
                spring_before: end_spring(first - TIP - self.start),
                spring_after: end_spring(self.end - TIP - last),
            }
        }
    }
}

/// A run of nodes in contact with a spring on the node before and on the node after it; `first > last` if no node is
/// in contact.
struct HeldRun {
    first: f64,
    last: f64,
    spring_before: f64,
    spring_after: f64,
}

/// The part of an interval beyond a corner that it contains.
struct Leg {
    /// Number of nodes in contact.
    nodes: f64,
    /// Spring on the next node.
    spring: f64,
}

impl Leg {
    /// Represents contact up to `length` beyond a corner, where the whole side before the corner is in contact.
    fn around_corner(length: f64) -> Self {
        if length < CORNER_LEG {
            let t = length * length / (CORNER_LEG * CORNER_LEG);
            Self { nodes: 0.0, spring: CORNER_SPRING * t / (1.0 - t) }
        } else {
            let nodes = (length - TIP + ROUNDING).floor().max(1.0);
            Self { nodes, spring: end_spring(length - TIP - nodes) }
        }
    }
}

/// Index in `springs` of a node on the perimeter.
fn place(springs: &[f64], node: f64) -> usize {
    (node as i64).rem_euclid(springs.len() as i64) as usize
}

/// Adds a spring of the half-plane to a node. It counts twice in the mirrored stencil.
fn add_spring(springs: &mut [f64], node: f64, spring: f64) {
    springs[place(springs, node)] += 2.0 * spring;
}

/// Adds the springs that represent one interval, given in cells of a grid with `n` cells per side, to those of the
/// nodes of that grid. This is the central function of the representation of contact.
fn add_springs(interval: Interval, n: usize, springs: &mut [f64]) {
    let Interval { start, end } = interval;
    let middle = 0.5 * (start + end);
    let corner = (middle / n as f64).round() * n as f64;
    if interval.is_short_at(corner) {
        let [before, own, after] = corner_springs(start - corner, end - corner);
        add_spring(springs, corner - 1.0, before);
        add_spring(springs, corner, 2.0 * own);
        add_spring(springs, corner + 1.0, after);
        return;
    }
    let HeldRun { first, last, spring_before, spring_after } = interval.held(n);
    if first <= last {
        add_spring(springs, first - 1.0, spring_before);
        add_spring(springs, last + 1.0, spring_after);
        let held = (last - first) as usize + 1;
        let (around, onwards) = springs.split_at_mut(place(springs, first));
        onwards.iter_mut().chain(around).take(held).for_each(|spring| *spring = f64::INFINITY);
        return;
    }
    // Too short to hold a node of this grid: two nodes share the current, such that capacity and centre are kept; the
    // formula is derived as in `corner_springs`.
    let c = 2.0 / PI * libm::log((end - start) / (2.0 * POINT_ON_EDGE));
    let right = (middle - middle.floor()).clamp(c.max(0.0), 1.0 - c.max(0.0));
    for (node, share) in [(middle.floor(), 1.0 - right), (middle.floor() + 1.0, right)] {
        add_spring(springs, node, conductance((1.0 - share - c) / (2.0 * share)));
    }
}

/// Springs on a corner node (over a quarter of its couplings in the whole lattice) and on the nodes before
/// and after it, for contact from `start` to `end`, at most about a cell from the corner.
///
/// Mirrored at both sides, the quadrant becomes the whole lattice, and `z^2` maps the contact to a slit. The length of
/// the slit gives the capacity, `c` in units of the resistance between neighbours, its middle the quadrupole moment
/// `m` of the current. On the lattice the corner node draws `1 - x - y` of the current and its neighbours, in pairs,
/// `x` and `y`, where `x - y = m`. The potential kernel is 0, 1, 4 / pi and 4 - 8 / pi at the distances that occur, so
/// the potentials of all three nodes follow, and from these the springs.
fn corner_springs(start: f64, end: f64) -> [f64; 3] {
    let [first, last] = [start, end].map(|s| s * s.abs());
    let c = libm::log((last - first) / (2.0 * POINT_IN_CORNER * POINT_IN_CORNER)) / PI;
    // Springs draw current one way only.
    let m = (0.5 * (first + last)).clamp(-1.0, 1.0);
    // x + y: the current left to the neighbours if the corner node is in contact, or the current of the moment.
    let together = c.max(m.abs());
    let [before, after] =
        [-m, m].map(|m| conductance((1.0 - c - (4.0 / PI - 1.0) * m) / (0.5 * (together + m))));
    [before, conductance((together - c) / (1.0 - together)), after]
}

/// Spring that moves the end of an interval on by `t` cells.
fn end_spring(t: f64) -> f64 {
    let t = t.max(0.0);
    SPRING * t / (1.0 - t)
}

/// One over a resistance, limited to [`STIFFEST`].
fn conductance(resistance: f64) -> f64 {
    if resistance > 1.0 / STIFFEST { 1.0 / resistance } else { STIFFEST }
}

#[cfg(test)]
mod tests;
