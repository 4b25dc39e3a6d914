//! The paper's method (7)-(13) on any triangulation, node by node as the paper writes it: the definition.
//!
//! It looks for the saddle point of the modified Lagrange functional (7)
//! `M(y, a) = 1/2 <A y, y> - <F, y> + 1 / (2 r) sum_b measure_b (H(a_b - r y_b) - a_b^2)`,
//! (y_b less the value `at` of the law, 0 in the paper),
//! with y at all nodes and the multiplier a at the contact nodes b, whose parts of the boundary have these measures
//! (on the square h, as in the paper): [a Gauss-Seidel sweep](Plain::sweep) (9)-(11) for y and
//! [a step](Plain::dual_step) (12) for a, until (13) holds for [the gradient](Plain::gradient) (8). The loop is
//! [`run`](super::engine::run). Every other engine of this loop gives the same numbers to the last bit; the order of
//! additions, that of [`Network`], is therefore part of the definition, and so is the numbering of the nodes.
//!
//! H has the derivative 2 P, where P is the projection onto the interval of the [law](crate::problem::law). The paper's
//! law has `[0, inf)`: there P is `( )^+` and H its square. For friction P cuts off at both ends, and H is twice
//! Huber's function.

use super::Pair;
use crate::discrete::network::{ContactRow, Network};
use crate::problem::law::{BoundaryRow, ContactNode};

/// The discrete problem with the duality parameter of (7).
#[derive(Clone, Copy)]
pub struct Plain<'a> {
    /// Stiffness matrix (5), and the boundary with its laws.
    pub network: &'a Network,
    /// Load vector F (6).
    pub load: &'a [f64],
    /// Duality parameter r > 0.
    pub r: f64,
}

impl Plain<'_> {
    /// Minimises M over one component of y after the other, in the order of the nodes: (9)-(11).
    pub fn sweep(&self, pair: &mut Pair) {
        let Pair { y, a } = pair;
        self.network.sweep(self.load, y, |b, ContactRow { sum, diagonal, measure, law }| {
            let relaxed = |&a| law.relax(BoundaryRow { sum, diagonal, measure, a, r: self.r });
            // A fixed node has no multiplier.
            a.get(b).map_or(law.at(), relaxed)
        });
    }

    /// Replaces `a` by `P(a - r y)` (12), y less the value `at` of the law; returns the largest change of a component,
    /// the paper's Delta a, NaN if a value is no longer finite.
    pub fn dual_step(&self, pair: &mut Pair) -> f64 {
        let (mut delta_a, mut finite) = (0.0f64, true);
        for (a, contact) in pair.a.iter_mut().zip(self.network.contact()) {
            let next = *a - self.r * (pair.y[contact.node] - contact.law.at());
            // The projection would hide a NaN.
            finite &= next.is_finite();
            let next = contact.law.project(next);
            delta_a = delta_a.max((next - *a).abs());
            *a = next;
        }
        if finite { delta_a } else { f64::NAN }
    }

    /// Returns the derivative (8) of M with respect to y at a node; zero at a fixed node.
    pub fn gradient(&self, node: usize, pair: &Pair) -> f64 {
        let gradient = self.network.gradient_at(node, &pair.y, self.load);
        match self.network.contact_at(node) {
            Some((b, ContactNode { measure, law, .. })) => {
                let from = pair.y[node] - law.at();
                gradient - measure * law.project(pair.a[b] - self.r * from)
            }
            None if self.network.place(node).is_some() => 0.0,
            None => gradient,
        }
    }

    /// Returns the residual of the conditions of the solution at a node: `|A y - F|` inside, the law's natural
    /// residual at a node with a law.
    pub fn residual(&self, node: usize, y: &[f64]) -> f64 {
        let ContactNode { measure, law, .. } = self.network.at(node);
        law.residual(y[node], self.network.gradient_at(node, y, self.load), measure)
    }
}
