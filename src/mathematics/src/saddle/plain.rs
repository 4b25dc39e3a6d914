//! The paper's method (7)-(13) on any triangulation, node by node as the paper writes it: the definition.
//!
//! It looks for the saddle point of the modified Lagrange functional (7)
//! `M(y, a) = 1/2 <A y, y> - <F, y> + 1 / (2 r) sum_b measure_b (H(a_b - r y_b) - a_b^2)`,
//! with y at all nodes and the multiplier a at the contact nodes b, whose parts of the boundary have these measures
//! (on the square h, as in the paper): a Gauss-Seidel sweep (9)-(11) for y and a step (12) for a, until (13) holds. What
//! else runs this method gives the same numbers to the last bit; the order of additions, that of
//! [`Network`], is therefore part of the definition, and so is the numbering of the nodes.
//!
//! H has the derivative 2 P, where P is the projection onto the interval of the [law](crate::problem::law). The paper's law
//! has `[0, inf)`: there P is `( )^+` and H its square. For friction P cuts off at both ends, and H is twice Huber's
//! function.

use super::{Pair, StopRule};
use crate::discrete::network::{ContactRow, Network, NodeCondition};
use crate::problem::law::{BoundaryRow, Law};

/// The discrete problem with the duality parameter of (7).
pub struct Plain<'a> {
    /// Stiffness matrix (5) and boundary.
    pub network: &'a Network,
    /// Law on the boundary.
    pub law: Law,
    /// Load vector F (6).
    pub load: &'a [f64],
    /// Duality parameter r > 0.
    pub r: f64,
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
            self.sweep(pair);
            delta_a = self.dual_step(pair);
            if self.stops(rule, tolerance, delta_a, pair) {
                return PlainEnd { iterations: iteration, met: true, delta_a };
            }
        }
        PlainEnd { iterations: max_iterations, met: false, delta_a }
    }

    /// Minimises M over one component of y after the other, in the order of the nodes: (9)-(11).
    pub fn sweep(&self, pair: &mut Pair) {
        let Pair { y, a } = pair;
        self.network.sweep(self.load, y, |b, ContactRow { sum, diagonal, measure }| {
            self.law.relax(BoundaryRow { sum, diagonal, measure, a: a[b], r: self.r })
        });
    }

    /// Replaces `a` by `P(a - r y)` (12); returns the largest change of a component, the paper's Delta a.
    pub fn dual_step(&self, pair: &mut Pair) -> f64 {
        let mut delta_a = 0.0f64;
        for (a, contact) in pair.a.iter_mut().zip(self.network.contact()) {
            let next = self.law.project(*a - self.r * pair.y[contact.node]);
            delta_a = delta_a.max((next - *a).abs());
            *a = next;
        }
        delta_a
    }

    /// True if the stopping rule holds: (13), with or without the absolute value, and the same bound for Delta a if the
    /// rule asks for it.
    pub(super) fn stops(&self, rule: StopRule, tolerance: f64, delta_a: f64, pair: &Pair) -> bool {
        let dual_bound_holds = !rule.asks_dual() || delta_a <= tolerance;
        dual_bound_holds
            && (0..pair.y.len()).all(|node| {
                let gradient = self.gradient(node, pair);
                let measure = if rule.is_printed() { gradient.abs() } else { gradient };
                measure <= tolerance
            })
    }

    /// Largest absolute value of the derivative (8); infinite if a value is not finite.
    pub(super) fn largest_gradient(&self, pair: &Pair) -> f64 {
        let mut largest = 0.0;
        for node in 0..pair.y.len() {
            let size = self.gradient(node, pair).abs();
            if size.is_nan() {
                return f64::INFINITY;
            }
            largest = size.max(largest);
        }
        largest
    }

    /// Returns the derivative (8) of M with respect to y at a node; zero at a fixed node.
    pub fn gradient(&self, node: usize, pair: &Pair) -> f64 {
        let gradient = self.network.gradient_at(node, &pair.y, self.load);
        match self.network.condition(node) {
            NodeCondition::Inner => gradient,
            NodeCondition::Fixed => 0.0,
            NodeCondition::Contact(b) => {
                let measure = self.network.contact()[b].measure;
                let flux = self.law.project(pair.a[b] - self.r * pair.y[node]);
                gradient - measure * flux
            }
        }
    }
}
