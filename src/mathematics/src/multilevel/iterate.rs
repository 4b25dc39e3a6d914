//! Conjugate gradients on one network, with a set of held nodes that changes.

use super::cycle::Cycle;
use crate::discrete::network::{ContactRow, Network};
use crate::problem::balance::{Balance, ContactValue, place_at_zero};
use crate::problem::descent::{Bend, Slope};
use crate::problem::law::{BoundaryState, Law};

/// Problem under laws `[0, limit]` and `(-inf, 0]`.
pub(super) struct ContactProblem<'a> {
    pub(super) network: &'a Network,
    /// Laws of the nodes with a law, in the order of the network.
    pub(super) laws: Vec<Law>,
    /// Number of the connected component of each contact node, in the order of the network.
    pub(super) components: &'a [u32],
    /// True for each component that bears every load; see [`Network::held_components`].
    pub(super) is_held: &'a [bool],
    /// Flux through the boundary of each component that balances the load.
    pub(super) needed: Vec<f64>,
}

impl ContactProblem<'_> {
    /// True if values may be below those of the laws.
    fn has_limits(&self) -> bool {
        self.laws.iter().any(|law| law.hi().is_finite())
    }

    /// Least and largest flux through the boundary at a contact node.
    fn ends(&self, b: usize) -> [f64; 2] {
        let measure = self.network.contact()[b].measure;
        [measure * self.laws[b].lo(), self.most(b)]
    }

    /// Largest flux through the boundary at a contact node.
    #[inline(always)]
    fn most(&self, b: usize) -> f64 {
        self.network.contact()[b].measure * self.laws[b].hi()
    }
}

/// Relative difference of energies that rounding errors may make.
const ENERGY_ROUNDING: f64 = 1e-12;

/// Part of the energy left at the nodes which are not held that held nodes must be able to gain before they are
/// released (Z. Dostal, SIAM J. Optim. 7 (1997) 871-887, calls such a vector proportional). Otherwise a node may be
/// released and held in turn, and no two steps have conjugate directions: on stretched cells without end.
const RELEASE: f64 = 0.1;
/// Changes of the set of held nodes, from the start on a level, in which all nodes that would gain are released: the
/// set is found sooner.
const EAGER_CHANGES: usize = 4;

/// Nodal vector on the way to the solution of one network.
pub(super) struct Iterate<'a> {
    problem: ContactProblem<'a>,
    load: &'a [f64],
    pub(super) y: Vec<f64>,
    /// `F - A y`, at all nodes; at nodes that slip down with their flux.
    residual: Vec<f64>,
    /// Flag for each node, true if y stays as it is there: the value of the law.
    held: Vec<bool>,
    /// Flag for each contact node, true if it slips down.
    slips_down: Vec<bool>,
    direction: Vec<f64>,
    /// A times the direction.
    image: Vec<f64>,
    /// Product of the residual and its correction in the last step; zero if the held nodes have changed.
    product: f64,
    /// Product of the residual and its correction in the last step: about twice the energy that the nodes which are not
    /// held have still to lose.
    last_product: f64,
    /// Number of steps that have changed the set of held nodes.
    changes: usize,
    /// True if no step may raise the energy: always where values have both signs, under the paper's law from when the
    /// residual has ceased to fall.
    pub(super) is_guarded: bool,
    /// Visits of unknowns.
    pub(super) work: f64,
}

impl<'a> Iterate<'a> {
    /// Takes `y`, relaxes every node once, and holds the nodes in contact.
    pub(super) fn new(problem: ContactProblem<'a>, load: &'a [f64], mut y: Vec<f64>) -> Self {
        let nodes = y.len();
        let moving = problem.network.contact().len();
        for (contact, law) in problem.network.held().iter().zip(&problem.laws[moving..]) {
            y[contact.node] = law.at();
        }
        let zeros = || vec![0.0; nodes];
        let slips_down = vec![false; moving];
        let is_guarded = problem.has_limits();
        let mut iterate = Self {
            problem,
            load,
            y,
            residual: zeros(),
            held: vec![false; nodes],
            slips_down,
            direction: zeros(),
            image: zeros(),
            product: 0.0,
            last_product: 0.0,
            changes: 0,
            is_guarded,
            work: 0.0,
        };
        iterate.relax();
        iterate.shift_into_contact();
        iterate.renew_residual();
        iterate
    }

    /// One Gauss-Seidel sweep: the energy is minimised over one value after the other.
    fn relax(&mut self) {
        let Self { problem: ContactProblem { network, laws, .. }, y, held, slips_down, .. } = self;
        network.sweep(self.load, y, |b, ContactRow { sum, diagonal, measure, .. }| {
            let value = laws[b].settle(sum, diagonal, measure);
            if let Some(slips_down) = slips_down.get_mut(b) {
                *slips_down = value < laws[b].at();
            }
            held[network.boundary()[b].node] = value == laws[b].at();
            value
        });
        self.work += self.y.len() as f64;
    }

    /// Subtracts the constant of least energy in each component that bears no load that cannot balance its load, and
    /// holds the node that the constant [sets to zero](place_at_zero).
    ///
    /// True if there was such a component.
    fn shift_into_contact(&mut self) -> bool {
        let ContactProblem { network, components, is_held, .. } = self.problem;
        let mut balances = vec![Balance::default(); is_held.len()];
        for (b, (contact, &component)) in network.contact().iter().zip(components).enumerate() {
            let state = if self.held[contact.node] {
                BoundaryState::Sticks
            } else if self.slips_down[b] {
                BoundaryState::SlipsDown
            } else {
                BoundaryState::SlipsUp
            };
            balances[component as usize].see(state, self.problem.ends(b));
        }
        let mut is_shifted = false;
        for (component, balance) in balances.iter().enumerate() {
            let needed = self.problem.needed[component];
            if is_held[component] || balance.holds(needed) {
                continue;
            }
            let mut nodes: Vec<ContactValue> = Vec::new();
            for (b, (contact, &other)) in network.contact().iter().zip(components).enumerate() {
                if other as usize == component {
                    let value = self.y[contact.node] - self.problem.laws[b].at();
                    let (number, ends) = (b, self.problem.ends(b));
                    nodes.push(ContactValue { number, ends, value, multiplier: 0.0 });
                }
            }
            if nodes.is_empty() {
                continue;
            }
            let zero = place_at_zero(&mut nodes, needed);
            let ContactValue { number: b, value, .. } = nodes[zero];
            lower(network, network.contact()[b].node, value, &mut self.y);
            for (place, node) in nodes.iter().enumerate() {
                if node.state(place, zero) == BoundaryState::Sticks {
                    self.stick(node.number);
                }
            }
            is_shifted = true;
        }
        if is_shifted && self.problem.has_limits() {
            // Values may be on the other side of those of the laws, or have left them.
            for (b, contact) in network.contact().iter().enumerate() {
                let from = self.y[contact.node] - self.problem.laws[b].at();
                self.slips_down[b] = from < 0.0;
                self.held[contact.node] = from == 0.0;
            }
        }
        is_shifted
    }

    /// Gives a contact node the value of its law, and holds it.
    fn stick(&mut self, b: usize) {
        let node = self.problem.network.contact()[b].node;
        self.y[node] = self.problem.laws[b].at();
        self.held[node] = true;
    }

    /// Computes the residual from the nodal vector, and forgets the direction.
    pub(super) fn renew_residual(&mut self) {
        let network = self.problem.network;
        network.gradient(&self.y, self.load, &mut self.residual);
        self.residual.iter_mut().for_each(|residual| *residual = -*residual);
        for (b, contact) in network.contact().iter().enumerate() {
            self.residual[contact.node] += self.flux(b);
        }
        self.product = 0.0;
        self.work += self.y.len() as f64;
    }

    /// Flux of a contact node that slips down; zero for others.
    #[inline(always)]
    fn flux(&self, b: usize) -> f64 {
        if self.slips_down[b] { self.problem.most(b) } else { 0.0 }
    }

    /// Natural residual, as [`Network::natural_residual`].
    pub(super) fn natural_residual(&self) -> f64 {
        let ContactProblem { network, laws, .. } = &self.problem;
        network.natural_residual(laws, &self.y, |node| {
            let flux = network.contact_at(node).map_or(0.0, |(b, _)| self.flux(b));
            flux - self.residual[node]
        })
    }

    /// Residual that one rounding of the largest value makes.
    pub(super) fn rounding(&self) -> f64 {
        f64::EPSILON * self.problem.network.largest_product(&self.y)
    }

    /// Energy `1/2 <A y, y> - <F, y>` with the law's term.
    pub(super) fn energy(&self) -> f64 {
        let terms = self.y.iter().zip(self.load).zip(&self.residual);
        let mut twice = terms.map(|((y, load), residual)| y * (load + residual)).sum::<f64>();
        if self.problem.has_limits() {
            for (b, contact) in self.problem.network.contact().iter().enumerate() {
                let at = self.problem.laws[b].at();
                twice += (self.y[contact.node] - 2.0 * at) * self.flux(b);
            }
        }
        -0.5 * twice
    }

    /// Applies one step, and adapts the held nodes; returns by how much the step lowered the energy.
    pub(super) fn step(&mut self, cycle: &mut Cycle<'_>, level: usize) -> f64 {
        let network = self.problem.network;
        if self.product == 0.0 {
            self.work += cycle.hold(level, &self.held);
        }
        let correction = cycle.apply(level, &self.residual);
        let product = dot(&self.residual, correction);
        self.last_product = product;
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
        // Neither is positive where nothing is left to correct at the nodes that are not held.
        if !(product > 0.0 && curvature > 0.0) {
            cycle.visit_once();
            self.product = 0.0;
            self.adapt();
            return 0.0;
        }
        let length = product / curvature;
        let before = self.is_guarded.then(|| (self.energy(), self.y.clone()));
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
        if let Some((energy, y)) = before
            && self.energy() - energy > ENERGY_ROUNDING * energy.abs()
        {
            self.y = y;
            self.descend(Slope { first: -product, second: curvature });
        }
        0.5 * length * product
    }

    /// Goes along the direction to the least energy, where each value that reaches the one of its law bends it, and
    /// relaxes every node: so the energy never grows.
    fn descend(&mut self, slope: Slope) {
        let network = self.problem.network;
        let mut bends: Vec<Bend> = Vec::new();
        for (b, contact) in network.contact().iter().enumerate() {
            let law = self.problem.laws[b];
            let (from, direction) = (self.y[contact.node] - law.at(), self.direction[contact.node]);
            if from * direction < 0.0 {
                let slope = contact.measure * (law.hi() - law.lo()) * direction.abs();
                bends.push(Bend { at: -from / direction, slope });
            }
        }
        let length = slope.least(bends);
        for (y, direction) in self.y.iter_mut().zip(&self.direction) {
            *y += length * direction;
        }
        self.relax();
        self.shift_into_contact();
        self.renew_residual();
    }

    /// Holds the contact nodes whose values have passed those of their laws, and releases those whose multiplier is
    /// outside the interval of the law; true if there are any.
    fn adapt(&mut self) -> bool {
        let network = self.problem.network;
        let mut changed = false;
        for (b, contact) in network.contact().iter().enumerate() {
            let node = contact.node;
            let from = self.y[node] - self.problem.laws[b].at();
            let has_crossed = if self.slips_down[b] { from > 0.0 } else { from < 0.0 };
            if !self.held[node] && has_crossed {
                self.residual[node] -= self.flux(b);
                self.slips_down[b] = false;
                self.change(node, -from);
                self.stick(b);
                changed = true;
            }
        }
        let releases =
            self.changes < EAGER_CHANGES || self.gain_of_releases() >= RELEASE * self.last_product;
        for (b, contact) in network.contact().iter().enumerate() {
            let node = contact.node;
            if !releases || !self.held[node] {
                continue;
            }
            let [above, below] = self.problem.ends(b).map(|end| self.residual[node] + end);
            if above > 0.0 {
                self.held[node] = false;
                self.change(node, above / network.diagonal()[node]);
                changed = true;
            } else if below < 0.0 {
                self.held[node] = false;
                self.slips_down[b] = true;
                self.residual[node] = below;
                self.change(node, below / network.diagonal()[node]);
                changed = true;
            }
        }
        self.changes += usize::from(changed);
        if changed && self.shift_into_contact() {
            self.renew_residual();
        }
        changed
    }

    /// Twice the energy that relaxing each held node apart would gain.
    fn gain_of_releases(&self) -> f64 {
        let network = self.problem.network;
        let mut gain = 0.0;
        for (b, contact) in network.contact().iter().enumerate() {
            let node = contact.node;
            if self.held[node] {
                let [above, below] = self.problem.ends(b).map(|end| self.residual[node] + end);
                let violation = above.max(0.0) + below.min(0.0);
                gain += violation * violation / network.diagonal()[node];
            }
        }
        gain
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
