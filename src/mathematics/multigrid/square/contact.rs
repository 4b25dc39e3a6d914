//! The contact set of the finest grid, and how each coarser grid represents it.
//!
//! A coarse grid that only knows whether its own nodes are in contact misplaces the ends of a contact
//! interval by half a cell, and loses short intervals altogether; that is what slows multigrid down
//! for obstacle problems. Here every coarse grid gets *springs* on boundary nodes that put the ends, or
//! the logarithmic capacity of a short interval, where the finest grid has them. Some facts about the
//! five-point stencil on a half-plane with natural boundary condition are used (lengths in cells):
//!
//! - Seen from afar, nodes `..., -1, 0` in contact act like the interval that ends at [`TIP`].
//! - A spring `SPRING t / (1 - t)` on node 1 moves that end on by `t`, for any `0 <= t < 1`.
//! - A single node in contact acts like an interval of half-length [`POINT_ON_EDGE`], and in the
//!   corner of a quadrant like one that reaches [`POINT_IN_CORNER`] along both sides.
//! - A corner node in contact with springs on its two neighbours acts like contact up to `a` along one
//!   side and `b` along the other, and similar things hold for all that is short there: see
//!   `corner_springs`.
//! - If a whole side of a quadrant is in contact, and around the corner one node more, that acts like
//!   contact up to [`CORNER_LEG`]; a spring `CORNER_SPRING t / (1 - t)` on that node instead of contact
//!   like contact up to `CORNER_LEG sqrt(t)`.
//!
//! The first two follow by Wiener and Hopf's factorisation. Without the interior nodes, the boundary has the
//! symbol `2 sqrt((1 - cos t)(3 - cos t)) = S(z) S(1/z) / sqrt(rho)`, `S = sqrt((1 - z)(1 - rho z))`,
//! `rho = 3 - 2 sqrt(2)` (the half-plane mirrored, a spring counts twice). Values that grow like a root and
//! solve all equations but that of node 1 are the coefficients of `U = C z (1 - t (1 - z)) / ((1 - z) S)`: they
//! grow like `sqrt(k - e)` with `e = 1/4 + rho / (2 (1 - rho)) + t = TIP + t`, and in the equation of node 1
//! `t / sqrt(rho)` is left, twice a spring times the value `1 - t` there.
//! The others follow from the potential kernel of the square lattice (Spitzer, *Principles of Random
//! Walk*, section 15) and the map `z^2` of the quadrant. They affect the speed of convergence only,
//! never the solution.

use std::f64::consts::{PI, SQRT_2};

use crate::multigrid::level::Level;

/// Where the interval of contact ends beyond its last node: sqrt(2) / 4.
const TIP: f64 = SQRT_2 / 4.0;
/// Scale of the spring that moves the end of an interval: (1 + sqrt(2)) / 2.
const SPRING: f64 = (1.0 + SQRT_2) / 2.0;
/// Half-length of the interval equivalent to one node of an edge: 2 exp(-gamma - 3/2 ln 2).
const POINT_ON_EDGE: f64 = 0.397_012;
/// Reach along both sides equivalent to a corner node: sqrt(2) exp(-gamma - 3/2 ln 2).
const POINT_IN_CORNER: f64 = 0.280_730;
/// Reach of a corner node and its neighbour along one side, along that side and along the other:
/// `sqrt(POINT_IN_CORNER^2 exp(pi^2 / 4) +- pi / 4)`.
const ONE_LEG: [f64; 2] = [1.309_464, 0.379_343];
/// Reach of a corner node and both its neighbours: `POINT_IN_CORNER exp(pi / 2)`.
const TWO_LEGS: f64 = 1.350_444;
/// Contact around a corner by one node, where the whole other side is in contact: sqrt(4 / (pi g)),
/// g = 2 - 4 / pi the resistance of that node.
const CORNER_LEG: f64 = 1.323_608;
/// Scale of the spring around a corner: 1 / g.
const CORNER_SPRING: f64 = 1.375_969;
/// Springs at least this stiff, in the mirrored stencil, count as contact.
const STIFFEST: f64 = 2e4;
/// Slack when a node lies at the very end of an interval, in cells.
const ROUNDING: f64 = 1e-9;

/// A run of contact nodes as it looks from afar, in cells of the finest grid along the perimeter,
/// counter-clockwise from the corner (0, 0); `end` may exceed the perimeter.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Interval {
    start: f64,
    end: f64,
}

/// Sets `1 / (4 + spring)` on all `levels`, for a contact set of a finer grid with `n` cells per side; both
/// by the numbers of boundary nodes. Returns the work in visits of unknowns.
pub(super) fn set_springs(n: usize, in_contact: &[bool], levels: &mut [Level]) -> f64 {
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
    // Without a free node there are no ends.
    let all_held = intervals.is_empty() && around[0];
    springs.fill(if all_held { f64::INFINITY } else { 0.0 });
    let cells = springs.len() / 4;
    let cell = n as f64 / cells as f64;
    for interval in intervals {
        add_springs(interval.scaled(1.0 / cell), cells, springs);
    }
}

/// Number of the boundary node that is the `p`-th counter-clockwise from the corner (0, 0).
fn number(n: usize, p: usize) -> usize {
    if p <= n {
        p
    } else if p < 2 * n {
        2 * p - n
    } else if p <= 3 * n {
        6 * n - 1 - p
    } else {
        9 * n - 1 - 2 * p
    }
}

/// Runs of nodes in contact; none if there is no free node between them.
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
                intervals.push(Interval::of_nodes(n, start, p - 1));
                first = None;
            }
            _ => {}
        }
    }
    intervals
}

impl Interval {
    fn of_nodes(n: usize, first: usize, last: usize) -> Self {
        let (before, after) = ((n - first % n) % n, last % n);
        let (start, end) = match (last - first, before, after) {
            (0, 0, _) => (POINT_IN_CORNER, POINT_IN_CORNER),
            (0, ..) => (POINT_ON_EDGE, POINT_ON_EDGE),
            (1, 0, _) => (ONE_LEG[1], ONE_LEG[0] - 1.0),
            (1, 1, 0) => (ONE_LEG[0] - 1.0, ONE_LEG[1]),
            (2, 1, 1) => (TWO_LEGS - 1.0, TWO_LEGS - 1.0),
            _ => {
                let reach = |beyond_corner: usize| match beyond_corner {
                    0 => 0.0,
                    1 => CORNER_LEG - 1.0,
                    _ => TIP,
                };
                (reach(before), reach(after))
            }
        };
        Self { start: first as f64 - start, end: last as f64 + end }
    }

    fn scaled(self, factor: f64) -> Self {
        Self { start: factor * self.start, end: factor * self.end }
    }

    /// The first and the last node in contact, if neither end is in a corner; in the wrong order if none is.
    fn holds(self) -> [f64; 2] {
        [(self.start + TIP - ROUNDING).ceil(), (self.end - TIP + ROUNDING).floor()]
    }

    /// Whether it lies about a cell around a corner or less, and holds no node but that at most.
    fn is_short_at(self, corner: f64) -> bool {
        let (start, end) = (self.start - corner, self.end - corner);
        let [first, last] = self.holds();
        if start <= 0.0 && end >= 0.0 {
            end.max(-start) < CORNER_LEG
        } else {
            first > last && (start + end).abs() < 2.0
        }
    }

    /// The corners it holds, and how far it reaches beyond the first and the last of them.
    fn corners(self, n: usize) -> Option<Corners> {
        let side = n as f64;
        let first = (self.start / side).ceil() * side;
        let last = (self.end / side).floor() * side;
        let (before, after) = (first - self.start, self.end - last);
        (first <= last).then_some(Corners { first, last, before, after })
    }
}

struct Corners {
    first: f64,
    last: f64,
    before: f64,
    after: f64,
}

/// Adds the springs that represent one interval, in cells of the grid, to those of its nodes.
fn add_springs(interval: Interval, n: usize, springs: &mut [f64]) {
    let nodes = springs.len() as i64;
    let mut add = |node: f64, spring: f64| {
        let p = (node as i64).rem_euclid(nodes) as usize;
        // Springs of the half-plane count twice in the mirrored stencil.
        springs[p] += 2.0 * spring;
    };
    let Interval { start, end } = interval;
    let middle = 0.5 * (start + end);
    let corner = (middle / n as f64).round() * n as f64;
    if interval.is_short_at(corner) {
        let [before, own, after] = corner_springs(start - corner, end - corner);
        add(corner - 1.0, before);
        add(corner, 2.0 * own);
        add(corner + 1.0, after);
        return;
    }
    let (first, last, before, after) = match interval.corners(n) {
        Some(Corners { first, last, before, after }) => {
            let (to_first, before) = around_corner(before);
            let (to_last, after) = around_corner(after);
            (first - to_first, last + to_last, before, after)
        }
        None => {
            let [first, last] = interval.holds();
            (first, last, end_spring(first - TIP - start), end_spring(end - TIP - last))
        }
    };
    if first <= last {
        add(first - 1.0, before);
        add(last + 1.0, after);
        let held = (last - first) as usize + 1;
        let start = (first as i64).rem_euclid(nodes) as usize;
        let (around, onwards) = springs.split_at_mut(start);
        onwards.iter_mut().chain(around).take(held).for_each(|spring| *spring = f64::INFINITY);
        return;
    }
    // Too short to hold a node of this grid: the current is shared between two nodes, such that capacity
    // and centre stay as they are; as in `corner_springs`.
    let c = 2.0 / PI * libm::log((end - start) / (2.0 * POINT_ON_EDGE));
    let right = (middle - middle.floor()).clamp(c.max(0.0), 1.0 - c.max(0.0));
    for (node, share) in [(middle.floor(), 1.0 - right), (middle.floor() + 1.0, right)] {
        add(node, conductance((1.0 - share - c) / (2.0 * share)));
    }
}

/// Springs on a corner node (over a quarter of its couplings in the whole lattice) and on the ones before
/// and after it, for contact from `start` to `end`, about a cell from the corner at most.
///
/// Mirrored at both sides, the quadrant becomes the whole lattice, and `z^2` makes a slit of the contact. Its
/// length gives the capacity, `c` in units of the resistance between neighbours, its middle the quadrupole
/// moment `m` of the current. On the lattice the corner node draws `1 - x - y` of the current and its
/// neighbours, in pairs, `x` and `y`, where `x - y = m`; the potential kernel being 0, 1, 4 / pi and
/// 4 - 8 / pi at the distances that occur, the potentials of all follow, and the springs from these.
fn corner_springs(start: f64, end: f64) -> [f64; 3] {
    let [first, last] = [start, end].map(|s| s * s.abs());
    let c = libm::log((last - first) / (2.0 * POINT_IN_CORNER * POINT_IN_CORNER)) / PI;
    // Springs draw current one way only.
    let m = (0.5 * (first + last)).clamp(-1.0, 1.0);
    // x + y: what the corner node leaves its neighbours if it is in contact, or what the moment takes.
    let together = c.max(m.abs());
    let side = |m: f64| conductance((1.0 - c - (4.0 / PI - 1.0) * m) / (0.5 * (together + m)));
    [side(-m), conductance((together - c) / (1.0 - together)), side(m)]
}

/// Number of nodes in contact beyond a corner, and spring on the next one, for contact up to `leg`.
fn around_corner(leg: f64) -> (f64, f64) {
    if leg < CORNER_LEG {
        let t = leg * leg / (CORNER_LEG * CORNER_LEG);
        (0.0, CORNER_SPRING * t / (1.0 - t))
    } else {
        let nodes = (leg - TIP + ROUNDING).floor().max(1.0);
        (nodes, end_spring(leg - TIP - nodes))
    }
}

/// Spring that moves the end of an interval on by `t` cells.
fn end_spring(t: f64) -> f64 {
    let t = t.max(0.0);
    SPRING * t / (1.0 - t)
}

fn conductance(resistance: f64) -> f64 {
    if resistance > 1.0 / STIFFEST { 1.0 / resistance } else { STIFFEST }
}

#[cfg(test)]
mod tests;
