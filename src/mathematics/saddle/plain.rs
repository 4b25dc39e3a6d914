//! The paper's method (7)-(13), node by node as the paper writes it: the definition.
//!
//! It looks for the saddle point of the modified Lagrange functional (7)
//! `M(y, a) = 1/2 <A y, y> - <F, y> + h / (2 r) sum_b (((a_b - r y_b)^+)^2 - a_b^2)`,
//! with y at all nodes and the multiplier `a >= 0` at the boundary nodes b: a Gauss-Seidel sweep (9)-(11)
//! for y and a step (12) for a, until (13) holds. What else runs this method gives the same numbers to
//! the last bit; the order of additions is therefore part of the definition.

use super::{Pair, StopRule};
use crate::discrete::grid::Grid;

/// The discrete problem on one grid, with the duality parameter of (7).
pub struct Plain<'a> {
    /// The grid, of width h.
    pub grid: Grid,
    /// Load vector F.
    pub load: &'a [f64],
    /// Duality parameter r > 0.
    pub r: f64,
}

/// Where a node lies, and the values around it.
enum Node {
    Interior {
        south: f64,
        north: f64,
        east: f64,
        west: f64,
    },
    /// `b` counts counter-clockwise from the lower left corner; `along` is half the sum of the neighbours.
    Edge {
        b: usize,
        along: f64,
        inward: f64,
    },
    /// As on an edge, without the neighbour inside.
    Corner {
        b: usize,
        along: f64,
    },
}

impl Plain<'_> {
    /// Iterates on `pair` until (13) or `max_iterations`: the iterations, whether (13) holds, and the last Delta a.
    pub fn iterate(
        &self,
        rule: StopRule,
        tolerance: f64,
        max_iterations: usize,
        pair: &mut Pair,
    ) -> (usize, bool, f64) {
        let mut delta_a = 0.0;
        for iteration in 1..=max_iterations {
            self.sweep(&mut pair.y, &pair.a);
            delta_a = self.dual_step(&pair.y, &mut pair.a);
            if self.stops(rule, tolerance, delta_a, pair) {
                return (iteration, true, delta_a);
            }
        }
        (max_iterations, false, delta_a)
    }

    /// (9)-(11): minimises M over one component of y after the other, row by row, x fastest.
    pub fn sweep(&self, y: &mut [f64], a: &[f64]) {
        for k in 0..y.len() {
            y[k] = match self.node(k, y) {
                Node::Interior { south, north, east, west } => {
                    (((south + north) + (east + self.load[k])) + west) / 4.0
                }
                Node::Edge { b, along, inward } => {
                    self.boundary(2.0, along + inward + self.load[k], a[b])
                }
                Node::Corner { b, along } => self.boundary(1.0, along + self.load[k], a[b]),
            };
        }
    }

    /// (10) and (11): `sum` is `F_i - sum_j A_ij y_j` over the neighbours j, `diagonal` is `A_ii`.
    fn boundary(&self, diagonal: f64, sum: f64, a: f64) -> f64 {
        let (h, r) = (self.grid.h(), self.r);
        let psi = sum / diagonal;
        if psi >= a / r { psi } else { (sum + h * a) / (diagonal + h * r) }
    }

    /// (12): `a <- (a - r y)^+`; the largest change of a component, the paper's Delta a.
    pub fn dual_step(&self, y: &[f64], a: &mut [f64]) -> f64 {
        let mut delta_a = 0.0f64;
        for (a, k) in a.iter_mut().zip(self.grid.boundary()) {
            let next = (*a - self.r * y[k]).max(0.0);
            delta_a = delta_a.max((next - *a).abs());
            *a = next;
        }
        delta_a
    }

    /// (13), with or without the absolute value, and where the rule asks for it the same bound for Delta a.
    fn stops(&self, rule: StopRule, tolerance: f64, delta_a: f64, pair: &Pair) -> bool {
        let measure = |k: usize| {
            let gradient = self.gradient(k, pair);
            if rule.is_printed() { gradient.abs() } else { gradient }
        };
        (!rule.asks_dual() || delta_a <= tolerance)
            && (0..pair.y.len()).all(|k| measure(k) <= tolerance)
    }

    /// (8): the derivative of M with respect to the k-th component of y.
    pub fn gradient(&self, k: usize, pair: &Pair) -> f64 {
        let (h, f, y) = (self.grid.h(), self.load[k], pair.y[k]);
        let pull = |b: usize| h * (pair.a[b] - self.r * y).max(0.0);
        match self.node(k, &pair.y) {
            Node::Interior { south, north, east, west } => {
                4.0 * y - (south + north) - (west + east) - f
            }
            Node::Edge { b, along, inward } => 2.0 * y - along - inward - f - pull(b),
            Node::Corner { b, along } => y - along - f - pull(b),
        }
    }

    /// The k-th row of the stiffness matrix (5): 4, -1 inside; 2, -1/2 along an edge, -1 inward; 1, -1/2 at a corner.
    fn node(&self, k: usize, y: &[f64]) -> Node {
        let (n, side) = (self.grid.cells(), self.grid.side());
        let (i, j) = (k % side, k / side);
        let beside = |i: usize| y[j * side + i];
        let across = |j: usize| y[j * side + i];
        let inner = |i: usize| if i == 0 { 1 } else { n - 1 };
        match (i == 0 || i == n, j == 0 || j == n) {
            (true, true) => {
                let b = if j == 0 { i } else { 3 * n - i };
                Node::Corner { b, along: 0.5 * (beside(inner(i)) + across(inner(j))) }
            }
            (false, true) => {
                let b = if j == 0 { i } else { 3 * n - i };
                let along = 0.5 * (beside(i - 1) + beside(i + 1));
                Node::Edge { b, along, inward: across(inner(j)) }
            }
            (true, false) => {
                let b = if i == n { n + j } else { 4 * n - j };
                let along = 0.5 * (across(j - 1) + across(j + 1));
                Node::Edge { b, along, inward: beside(inner(i)) }
            }
            (false, false) => Node::Interior {
                south: across(j - 1),
                north: across(j + 1),
                east: beside(i + 1),
                west: beside(i - 1),
            },
        }
    }
}
