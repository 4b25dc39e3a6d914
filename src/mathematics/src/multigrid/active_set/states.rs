//! Problem under the law `[0, limit]` by the states of its nodes.

use crate::discrete::kkt::judge;
use crate::discrete::network::{Network, count_components};
use crate::discrete::norms::largest;
use crate::problem::balance::{Balance, ContactValue, place_at_zero};
use crate::problem::law::{BoundaryState, ContactNode, Law};
use std::cmp::Ordering;

/// Natural residual over the largest load up to which a circle of states is one of rounding errors.
const ROUNDING: f64 = 1e-11;

/// Problem under the law `[0, limit]`, whose solution is known from the states of its nodes. Inner nodes count as
/// slipping up, fixed nodes as sticking.
pub(crate) struct StateProblem<'a> {
    pub network: &'a Network,
    /// Connected component of each node.
    pub components: &'a [u32],
    pub load: &'a [f64],
    /// Largest flux.
    pub limit: f64,
}

impl StateProblem<'_> {
    /// States with all contact nodes at zero.
    pub(crate) fn all_stick(&self) -> Vec<BoundaryState> {
        let mut states = vec![BoundaryState::SlipsUp; self.load.len()];
        let contact = self.network.contact().iter().map(|contact| contact.node);
        let zero = contact.chain(self.network.fixed().iter().map(|&node| node as usize));
        zero.for_each(|node| states[node] = BoundaryState::Sticks);
        states
    }

    /// Gives values of contact nodes that have the other sign than their states, by rounding errors, the value zero.
    pub(super) fn put_into_states(&self, states: &[BoundaryState], y: &mut [f64]) {
        for contact in self.network.contact() {
            let value = &mut y[contact.node];
            *value = match states[contact.node] {
                BoundaryState::SlipsDown => value.min(0.0),
                _ => value.max(0.0),
            };
        }
    }

    pub(super) fn law(&self) -> Law {
        Law::new(0.0, self.limit).expect("a positive limit")
    }

    /// True if the solution with these states solves the problem but for rounding errors.
    pub(super) fn has_rounding_errors_alone(&self, states: &[BoundaryState], y: &[f64]) -> bool {
        let mut y = y.to_vec();
        self.put_into_states(states, &mut y);
        let natural = judge(self.network, self.law(), &y, self.load).kkt.natural;
        natural <= ROUNDING * largest(self.load)
    }

    /// States by the signs of the values of a vector; contact nodes at zero stick.
    pub(super) fn states_by_sign(&self, y: &[f64]) -> Vec<BoundaryState> {
        let mut states = self.all_stick();
        for contact in self.network.contact() {
            let value = y[contact.node];
            if value != 0.0 {
                states[contact.node] =
                    if value > 0.0 { BoundaryState::SlipsUp } else { BoundaryState::SlipsDown };
            }
        }
        states
    }

    /// Load with the flux of the nodes that slip down.
    pub(crate) fn load_with(&self, states: &[BoundaryState]) -> Vec<f64> {
        let mut load = self.load.to_vec();
        for contact in self.network.contact() {
            if states[contact.node] == BoundaryState::SlipsDown {
                load[contact.node] += contact.measure * self.limit;
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
        let has_fixed = self.has_fixed();
        let mut balances = vec![Balance::default(); has_fixed.len()];
        for &node in self.network.fixed() {
            next[node as usize] = BoundaryState::Sticks;
        }
        for contact in self.network.contact() {
            let node = contact.node;
            let gradient = self.network.gradient_at(node, y, self.load);
            next[node] = match states[node] {
                BoundaryState::Sticks if gradient < 0.0 => BoundaryState::SlipsUp,
                BoundaryState::Sticks if gradient > contact.measure * self.limit => {
                    BoundaryState::SlipsDown
                }
                BoundaryState::SlipsUp if y[node] >= 0.0 => BoundaryState::SlipsUp,
                BoundaryState::SlipsDown if y[node] <= 0.0 => BoundaryState::SlipsDown,
                _ => BoundaryState::Sticks,
            };
            balances[self.components[node] as usize].see(next[node], contact.measure);
        }
        for (component, (balance, needed)) in balances.iter().zip(self.needed()).enumerate() {
            if !has_fixed[component] && !balance.holds(needed) {
                self.shift(component, needed, y, &mut next);
            }
        }
        next
    }

    /// True for each component that has a fixed node.
    pub(super) fn has_fixed(&self) -> Vec<bool> {
        let mut has_fixed = vec![false; count_components(self.components)];
        for &node in self.network.fixed() {
            has_fixed[self.components[node as usize] as usize] = true;
        }
        has_fixed
    }

    /// Measure of each component that balances its load if it slips down.
    pub(super) fn needed(&self) -> Vec<f64> {
        let mut needed = vec![0.0; count_components(self.components)];
        for (&component, load) in self.components.iter().zip(self.load) {
            needed[component as usize] -= load / self.limit;
        }
        needed
    }

    /// Sets the states of a component after the shift by the constant of least energy, where nodes with the measure
    /// `needed` balance the load if they slip down. Returns this constant, to be subtracted.
    pub(super) fn shift(
        &self,
        component: usize,
        needed: f64,
        y: &[f64],
        next: &mut [BoundaryState],
    ) -> f64 {
        let mut nodes: Vec<ContactValue> = Vec::new();
        for &ContactNode { node, measure } in self.network.contact() {
            if self.components[node] as usize == component {
                let multiplier = self.network.gradient_at(node, y, self.load);
                nodes.push(ContactValue { number: node, measure, value: y[node], multiplier });
            }
        }
        let at = place_at_zero(&mut nodes, needed);
        for (place, node) in nodes.iter().enumerate() {
            next[node.number] = match place.cmp(&at) {
                Ordering::Less => BoundaryState::SlipsDown,
                Ordering::Equal => BoundaryState::Sticks,
                Ordering::Greater => BoundaryState::SlipsUp,
            };
        }
        nodes[at].value
    }
}
