//! Saddle-point methods for the modified Lagrange functional (7): one loop, over an engine for the square with one run
//! in each lane and one for networks, and one run over nested grids and networks.

pub mod batch;
mod engine;
mod method;
mod nested;
mod network;
mod plain;
mod solve;
mod stopping;

pub(crate) use engine::{Engine, Goals, RunStart, RunState, run};
pub use method::Method;
pub use nested::{Monitor, NestedRun, solve_nested, solve_nested_together, tolerance};
pub use plain::Plain;
pub use solve::{Iteration, Params, solve};
pub(crate) use stopping::GradientMeasure;
pub use stopping::StopRule;

use crate::discrete::domain::DiscreteDomain;
use crate::discrete::kkt::rounding;
use crate::discrete::norms::largest;

/// The pair (y, a) of (7): values of v at the nodes, and of the multiplier at the boundary nodes where the law holds.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Pair {
    /// Nodal vector.
    pub y: Vec<f64>,
    /// Boundary vector, in the order of the contact nodes. After a step (12) its entries are in the interval of the
    /// law: under the paper's law, non-negative.
    pub a: Vec<f64>,
}

impl Pair {
    /// Returns the zero pair of a grid or network, from which the paper starts on its coarsest grid.
    pub fn zero<'a>(domain: impl Into<DiscreteDomain<'a>>) -> Self {
        let domain = domain.into();
        Self { y: vec![0.0; domain.nodes()], a: vec![0.0; domain.contact().len()] }
    }

    /// Contact at the boundary nodes: where the multiplier is inside the interval of the law or v is zero, up to
    /// rounding errors. Under the paper's law both are zero in a corner without load between nodes in contact.
    pub fn in_contact<'a>(&self, domain: impl Into<DiscreteDomain<'a>>) -> Vec<bool> {
        let domain = domain.into();
        let contact = domain.contact();
        let nodes = || contact.iter().zip(&self.a);
        let mut size = largest(&self.y);
        for (contact, a) in nodes() {
            size = size.max((contact.measure * a).abs());
        }
        let zero = rounding(domain.width(), size);
        let mut in_contact = Vec::with_capacity(self.a.len());
        for (contact, a) in nodes() {
            let is_inside = contact.law.is_inside(*a, zero / contact.measure);
            in_contact.push(is_inside || self.y[contact.node].abs() <= zero);
        }
        in_contact
    }
}
