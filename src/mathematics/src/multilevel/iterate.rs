//! Conjugate gradients on one network, with a set of held nodes that changes.

use super::cycle::Cycle;
use crate::discrete::network::{Network, NodeCondition};

/// Part of the boundary with y >= 0.
pub(super) struct ContactProblem<'a> {
    pub(super) network: &'a Network,
    /// Number of the connected component of each contact node, in the order of the network.
    pub(super) components: &'a [u32],
    /// True for each component that has a fixed node.
    pub(super) has_fixed: &'a [bool],
}

/// Nodal vector on the way to the solution of one network.
pub(super) struct Iterate<'a> {
    problem: &'a ContactProblem<'a>,
    load: &'a [f64],
    pub(super) y: Vec<f64>,
    /// `F - A y`, at all nodes.
    residual: Vec<f64>,
    /// Flag for each node, true if y = 0 is kept there.
    held: Vec<bool>,
    direction: Vec<f64>,
    /// A times the direction.
    image: Vec<f64>,
    /// Product of the residual and its correction in the last step; zero if the held nodes have changed.
    product: f64,
    /// Visits of unknowns.
    pub(super) work: f64,
}

impl<'a> Iterate<'a> {
    /// Takes `y`, relaxes every node once, and holds the nodes in contact.
    pub(super) fn new(problem: &'a ContactProblem<'a>, load: &'a [f64], y: Vec<f64>) -> Self {
        let nodes = y.len();
        let zeros = || vec![0.0; nodes];
        let mut iterate = Self {
            problem,
            load,
            y,
            residual: zeros(),
            held: vec![false; nodes],
            direction: zeros(),
            image: zeros(),
            product: 0.0,
            work: 0.0,
        };
        iterate.relax();
        iterate.lower_into_contact();
        iterate.renew_residual();
        iterate
    }

    /// One projected Gauss-Seidel sweep.
    fn relax(&mut self) {
        let network = self.problem.network;
        for node in 0..self.y.len() {
            let sum = network.row(node).add_to(self.load[node], &self.y);
            self.held[node] = match network.condition(node) {
                NodeCondition::Inner => false,
                NodeCondition::Contact(_) => sum <= 0.0,
                NodeCondition::Fixed => true,
            };
            self.y[node] = if self.held[node] { 0.0 } else { sum / network.diagonal()[node] };
        }
        self.work += self.y.len() as f64;
    }

    /// Subtracts a constant in each component without held nodes, such that the lowest contact node has the value zero,
    /// and holds that node: the solution is zero somewhere on the boundary, since the sum of the load is negative.
    fn lower_into_contact(&mut self) {
        let ContactProblem { network, components, has_fixed } = *self.problem;
        let mut lowest: Vec<Option<(f64, usize)>> = vec![None; has_fixed.len()];
        let mut is_held = has_fixed.to_vec();
        for (contact, &component) in network.contact().iter().zip(components) {
            let (node, component) = (contact.node as usize, component as usize);
            is_held[component] |= self.held[node];
            if lowest[component].is_none_or(|(value, _)| self.y[node] < value) {
                lowest[component] = Some((self.y[node], node));
            }
        }
        for (lowest, is_held) in lowest.into_iter().zip(is_held) {
            if let (Some((value, node)), false) = (lowest, is_held) {
                lower(network, node, value, &mut self.y);
                self.held[node] = true;
            }
        }
    }

    /// Computes the residual from the nodal vector, and forgets the direction.
    pub(super) fn renew_residual(&mut self) {
        let network = self.problem.network;
        network.gradient(&self.y, self.load, &mut self.residual);
        self.residual.iter_mut().for_each(|residual| *residual = -*residual);
        self.product = 0.0;
        self.work += self.y.len() as f64;
    }

    /// Natural residual `max(max |A y - F|, max |min(y, A y - F)|)`, the latter over contact nodes.
    pub(super) fn natural_residual(&self) -> f64 {
        let network = self.problem.network;
        let mut largest = 0.0;
        for (node, &residual) in self.residual.iter().enumerate() {
            let violation = match network.condition(node) {
                NodeCondition::Inner => residual.abs(),
                NodeCondition::Contact(_) => self.y[node].min(-residual).abs(),
                NodeCondition::Fixed => 0.0,
            };
            // The maximum would hide a NaN.
            if violation > largest || violation.is_nan() {
                largest = violation;
            }
        }
        largest
    }

    /// Residual that one rounding of the largest value makes.
    pub(super) fn rounding(&self) -> f64 {
        let diagonal = self.problem.network.diagonal();
        let largest =
            self.y.iter().zip(diagonal).fold(0.0f64, |most, (y, d)| most.max((y * d).abs()));
        f64::EPSILON * largest
    }

    /// Energy `1/2 <A y, y> - <F, y>`.
    pub(super) fn energy(&self) -> f64 {
        let terms = self.y.iter().zip(self.load).zip(&self.residual);
        -0.5 * terms.map(|((y, load), residual)| y * (load + residual)).sum::<f64>()
    }

    /// Applies one step, and adapts the held nodes; returns by how much the step lowered the energy.
    pub(super) fn step(&mut self, cycle: &mut Cycle<'_>, level: usize) -> f64 {
        let network = self.problem.network;
        if self.product == 0.0 {
            self.work += cycle.hold(level, &self.held);
        }
        let correction = cycle.apply(level, &self.residual);
        let product = dot(&self.residual, correction);
        let turn = if self.product == 0.0 { 0.0 } else { product / self.product };
        for (direction, correction) in self.direction.iter_mut().zip(correction) {
            *direction = correction + turn * *direction;
        }
        for (node, image) in self.image.iter_mut().enumerate() {
            *image = network.diagonal()[node] * self.direction[node]
                - network.row(node).add_to(0.0, &self.direction);
        }
        self.work += cycle.work(level) + self.y.len() as f64;
        let curvature = dot(&self.direction, &self.image);
        // Neither is positive where nothing is left to correct.
        if !(product > 0.0 && curvature > 0.0) {
            self.product = 0.0;
            return 0.0;
        }
        let length = product / curvature;
        for (y, direction) in self.y.iter_mut().zip(&self.direction) {
            *y += length * direction;
        }
        for (residual, image) in self.residual.iter_mut().zip(&self.image) {
            *residual -= length * image;
        }
        self.product = product;
        if self.adapt() {
            self.product = 0.0;
        }
        0.5 * length * product
    }

    /// Holds the contact nodes with negative values and releases those with a negative multiplier; true if there are any.
    fn adapt(&mut self) -> bool {
        let network = self.problem.network;
        let mut changed = false;
        for contact in network.contact() {
            let node = contact.node as usize;
            if !self.held[node] && self.y[node] < 0.0 {
                self.held[node] = true;
                self.change(node, -self.y[node]);
                self.y[node] = 0.0;
                changed = true;
            }
        }
        for contact in network.contact() {
            let node = contact.node as usize;
            if self.held[node] && self.residual[node] > 0.0 {
                self.held[node] = false;
                self.change(node, self.residual[node] / network.diagonal()[node]);
                changed = true;
            }
        }
        if changed {
            self.lower_if_nothing_is_held();
        }
        changed
    }

    /// Lowers the components without held nodes into contact again.
    fn lower_if_nothing_is_held(&mut self) {
        let before = self.held.iter().filter(|held| **held).count();
        self.lower_into_contact();
        if self.held.iter().filter(|held| **held).count() > before {
            self.renew_residual();
        }
    }

    /// Adds to the value of one node, and corrects the residuals around it.
    fn change(&mut self, node: usize, by: f64) {
        let network = self.problem.network;
        self.y[node] += by;
        self.residual[node] -= network.diagonal()[node] * by;
        let row = network.row(node);
        for (&other, weight) in row.others.iter().zip(row.weights) {
            self.residual[other as usize] += weight * by;
        }
    }
}

/// Subtracts a value at all nodes of the component of one node.
fn lower(network: &Network, node: usize, value: f64, y: &mut [f64]) {
    let mut seen = vec![false; y.len()];
    let mut next = vec![node];
    seen[node] = true;
    while let Some(node) = next.pop() {
        y[node] -= value;
        for &other in network.row(node).others {
            if !std::mem::replace(&mut seen[other as usize], true) {
                next.push(other as usize);
            }
        }
    }
}

/// Product of two nodal vectors.
pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
