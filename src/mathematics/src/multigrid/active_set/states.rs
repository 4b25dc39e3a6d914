//! Problem under laws `[0, limit]` and `(-inf, 0]` by the states of its nodes.

use crate::discrete::network::{Network, count_components};
use crate::discrete::norms::largest;
use crate::problem::balance::{Balance, ContactValue, place_at_zero};
use crate::problem::law::{BoundaryState, ContactNode, Law};

/// Natural residual over the largest load up to which a circle of states is one of rounding errors.
const ROUNDING: f64 = 1e-11;

/// Problem under laws `[0, limit]` and `(-inf, 0]`, whose solution is known from the states of its nodes. Inner nodes
/// count as slipping up, fixed nodes as sticking.
pub(crate) struct StateProblem<'a> {
    pub network: &'a Network,
    /// Connected component of each node.
    pub components: &'a [u32],
    pub load: &'a [f64],
    /// Laws of the nodes with a law, in the order of the network.
    pub laws: &'a [Law],
}

impl StateProblem<'_> {
    /// States in which all contact nodes stick.
    pub(crate) fn all_stick(&self) -> Vec<BoundaryState> {
        let mut states = vec![BoundaryState::SlipsUp; self.load.len()];
        for contact in self.network.boundary() {
            states[contact.node] = BoundaryState::Sticks;
        }
        states
    }

    /// Gives values of contact nodes that are on the other side of their laws' than the states say, by rounding errors,
    /// these values.
    pub(super) fn put_into_states(&self, states: &[BoundaryState], y: &mut [f64]) {
        for (contact, law) in self.network.contact().iter().zip(self.laws) {
            let value = &mut y[contact.node];
            *value = match states[contact.node] {
                BoundaryState::SlipsDown => value.min(law.at()),
                _ => value.max(law.at()),
            };
        }
    }

    /// Gives nodes that stick the values of their laws.
    pub(super) fn put_at_values(&self, states: &[BoundaryState], y: &mut [f64]) {
        for (contact, law) in self.network.boundary().iter().zip(self.laws) {
            if states[contact.node] == BoundaryState::Sticks {
                y[contact.node] = law.at();
            }
        }
    }

    /// Contact nodes with their laws, and the ends of the flux through the boundary at each.
    fn contact(&self) -> impl Iterator<Item = (&ContactNode, &Law, [f64; 2])> {
        let contact = self.network.contact().iter().zip(self.laws);
        contact.map(|(contact, law)| {
            (contact, law, [law.lo(), law.hi()].map(|end| contact.measure * end))
        })
    }

    /// True if the solution with these states solves the problem but for rounding errors.
    pub(super) fn has_rounding_errors_alone(&self, states: &[BoundaryState], y: &[f64]) -> bool {
        let mut y = y.to_vec();
        self.put_into_states(states, &mut y);
        let gradient = |node| self.network.gradient_at(node, &y, self.load);
        let natural = self.network.natural_residual(self.laws, &y, gradient);
        natural <= ROUNDING * largest(self.load)
    }

    /// States by the values of a vector; contact nodes at the values of their laws stick.
    pub(super) fn states_by_sign(&self, y: &[f64]) -> Vec<BoundaryState> {
        let mut states = self.all_stick();
        for (contact, law) in self.network.contact().iter().zip(self.laws) {
            let value = y[contact.node];
            if value != law.at() {
                states[contact.node] = match value > law.at() {
                    true => BoundaryState::SlipsUp,
                    false => BoundaryState::SlipsDown,
                };
            }
        }
        states
    }

    /// Load with the flux of the nodes that slip down.
    pub(crate) fn load_with(&self, states: &[BoundaryState]) -> Vec<f64> {
        let mut load = self.load.to_vec();
        for (contact, _, [_, most]) in self.contact() {
            if states[contact.node] == BoundaryState::SlipsDown {
                load[contact.node] += most;
            }
        }
        load
    }

    /// Returns the states of the next step of the primal-dual active set method, where `y` is the solution with the
    /// present ones.
    ///
    /// A solution whose nodes could then not balance the load of a connected component, or of which none would stick,
    /// is shifted by the constant of least energy: the node that it [sets to zero](place_at_zero) sticks, and the
    /// others slip.
    pub(crate) fn next_states(&self, states: &[BoundaryState], y: &[f64]) -> Vec<BoundaryState> {
        let mut next = vec![BoundaryState::SlipsUp; states.len()];
        let is_held = self.network.held_components(self.components);
        let mut balances = vec![Balance::default(); is_held.len()];
        for contact in self.network.held() {
            next[contact.node] = BoundaryState::Sticks;
        }
        for (contact, law, ends) in self.contact() {
            let (node, [least, most]) = (contact.node, ends);
            let gradient = self.network.gradient_at(node, y, self.load);
            next[node] = match states[node] {
                BoundaryState::Sticks if gradient < least => BoundaryState::SlipsUp,
                BoundaryState::Sticks if gradient > most => BoundaryState::SlipsDown,
                BoundaryState::SlipsUp if y[node] >= law.at() => BoundaryState::SlipsUp,
                BoundaryState::SlipsDown if y[node] <= law.at() => BoundaryState::SlipsDown,
                _ => BoundaryState::Sticks,
            };
            balances[self.components[node] as usize].see(next[node], ends);
        }
        for (component, (balance, needed)) in balances.iter().zip(self.needed()).enumerate() {
            if !is_held[component] && !balance.holds(needed) {
                self.shift(component, needed, y, &mut next);
            }
        }
        next
    }

    /// Flux through the boundary of each component that balances its load.
    pub(super) fn needed(&self) -> Vec<f64> {
        let mut needed = vec![0.0; count_components(self.components)];
        for (&component, load) in self.components.iter().zip(self.load) {
            needed[component as usize] -= load;
        }
        needed
    }

    /// Sets the states of a component after the shift by the constant of least energy, where the flux `needed` balances
    /// the load. Returns this constant, to be subtracted.
    pub(super) fn shift(
        &self,
        component: usize,
        needed: f64,
        y: &[f64],
        next: &mut [BoundaryState],
    ) -> f64 {
        let mut nodes: Vec<ContactValue> = Vec::new();
        for (&ContactNode { node, .. }, law, ends) in self.contact() {
            if self.components[node] as usize == component {
                let multiplier = self.network.gradient_at(node, y, self.load);
                let value = y[node] - law.at();
                nodes.push(ContactValue { number: node, ends, value, multiplier });
            }
        }
        let zero = place_at_zero(&mut nodes, needed);
        for (place, node) in nodes.iter().enumerate() {
            next[node.number] = node.state(place, zero);
        }
        nodes[zero].value
    }
}
