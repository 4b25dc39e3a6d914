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

/// Values around a node, by the kind of its row of the stiffness matrix (5).
enum Neighbours {
    Interior {
        south: f64,
        north: f64,
        east: f64,
        west: f64,
    },
    /// `b` is the number of the boundary node, `along` half the sum of the values of both neighbours on the boundary,
    /// `inward` the value of the neighbour inside.
    Edge {
        b: usize,
        along: f64,
        inward: f64,
    },
    /// A corner has no neighbour inside.
    Corner {
        b: usize,
        along: f64,
    },
}

/// End of [`Plain::iterate`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlainEnd {
    /// Iterations done.
    pub iterations: usize,
    /// True if the stopping rule was met.
    pub met: bool,
    /// Last change of the multiplier, the paper's Delta a.
    pub delta_a: f64,
}

impl Plain<'_> {
    /// Iterates on `pair` until (13) holds or `max_iterations` are done.
    pub fn iterate(
        &self,
        rule: StopRule,
        tolerance: f64,
        max_iterations: usize,
        pair: &mut Pair,
    ) -> PlainEnd {
        let mut delta_a = 0.0;
        for iteration in 1..=max_iterations {
            self.sweep(&mut pair.y, &pair.a);
            delta_a = self.dual_step(&pair.y, &mut pair.a);
            if self.stops(rule, tolerance, delta_a, pair) {
                return PlainEnd { iterations: iteration, met: true, delta_a };
            }
        }
        PlainEnd { iterations: max_iterations, met: false, delta_a }
    }

    /// Minimises M over one component of y after the other, row by row, x fastest: (9)-(11).
    pub fn sweep(&self, y: &mut [f64], a: &[f64]) {
        for k in 0..y.len() {
            y[k] = match self.neighbours(k, y) {
                Neighbours::Interior { south, north, east, west } => {
                    (((south + north) + (east + self.load[k])) + west) / 4.0
                }
                Neighbours::Edge { b, along, inward } => {
                    self.boundary(2.0, along + inward + self.load[k], a[b])
                }
                Neighbours::Corner { b, along } => self.boundary(1.0, along + self.load[k], a[b]),
            };
        }
    }

    /// Returns the minimiser (10), (11) at a boundary node: `sum` is `F_i - sum_j A_ij y_j` over the neighbours j,
    /// `diagonal` is `A_ii`.
    fn boundary(&self, diagonal: f64, sum: f64, a: f64) -> f64 {
        let (h, r) = (self.grid.h(), self.r);
        let psi = sum / diagonal;
        if psi >= a / r { psi } else { (sum + h * a) / (diagonal + h * r) }
    }

    /// Replaces `a` by `(a - r y)^+` (12); returns the largest change of a component, the paper's Delta a.
    pub fn dual_step(&self, y: &[f64], a: &mut [f64]) -> f64 {
        let mut delta_a = 0.0f64;
        for (a, k) in a.iter_mut().zip(self.grid.boundary()) {
            let next = (*a - self.r * y[k]).max(0.0);
            delta_a = delta_a.max((next - *a).abs());
            *a = next;
        }
        delta_a
    }

    /// True if the stopping rule holds: (13), with or without the absolute value, and the same bound for Delta a if the
    /// rule asks for it.
    fn stops(&self, rule: StopRule, tolerance: f64, delta_a: f64, pair: &Pair) -> bool {
        let dual_bound_holds = !rule.asks_dual() || delta_a <= tolerance;
        dual_bound_holds
            && (0..pair.y.len()).all(|k| {
                let gradient = self.gradient(k, pair);
                let measure = if rule.is_printed() { gradient.abs() } else { gradient };
                measure <= tolerance
            })
    }

    /// Returns the derivative (8) of M with respect to the k-th component of y.
    pub fn gradient(&self, k: usize, pair: &Pair) -> f64 {
        let (f, y) = (self.load[k], pair.y[k]);
        match self.neighbours(k, &pair.y) {
            Neighbours::Interior { south, north, east, west } => {
                4.0 * y - (south + north) - (west + east) - f
            }
            Neighbours::Edge { b, along, inward } => {
                2.0 * y - along - inward - f - self.reaction(pair.a[b], y)
            }
            Neighbours::Corner { b, along } => y - along - f - self.reaction(pair.a[b], y),
        }
    }

    /// Returns `h (a - r y)^+`, the term of a boundary node in (8).
    fn reaction(&self, a: f64, y: f64) -> f64 {
        self.grid.h() * (a - self.r * y).max(0.0)
    }

    /// Reads the neighbours in the k-th row of the stiffness matrix (5): 4, -1 inside; 2, -1/2 along an edge, -1 inward;
    /// 1, -1/2 at a corner.
    fn neighbours(&self, k: usize, y: &[f64]) -> Neighbours {
        let (grid, n, side) = (self.grid, self.grid.cells(), self.grid.side());
        let (i, j) = (k % side, k / side);
        // The neighbour inside of a node on the left or right side, and of one on the lower or upper side.
        let beside = if i == 0 { k + 1 } else { k - 1 };
        let across = if j == 0 { k + side } else { k - side };
        match (i == 0 || i == n, j == 0 || j == n) {
            (true, true) => {
                let along = 0.5 * (y[beside] + y[across]);
                Neighbours::Corner { b: grid.boundary_index(i, j), along }
            }
            (false, true) => {
                let along = 0.5 * (y[k - 1] + y[k + 1]);
                Neighbours::Edge { b: grid.boundary_index(i, j), along, inward: y[across] }
            }
            (true, false) => {
                let along = 0.5 * (y[k - side] + y[k + side]);
                Neighbours::Edge { b: grid.boundary_index(i, j), along, inward: y[beside] }
            }
            (false, false) => Neighbours::Interior {
                south: y[k - side],
                north: y[k + side],
                east: y[k + 1],
                west: y[k - 1],
            },
        }
    }
}
