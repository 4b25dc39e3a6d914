//! Problems on nested networks, and their connected components.

use super::levels::NetworkLevels;
use crate::discrete::components::components;
use crate::multigrid::input::{InputError, check_load};
use crate::problem::law::Law;

/// Nested problems under a law `[0, limit]`.
pub(super) struct NestedProblem<'a> {
    pub(super) levels: NetworkLevels<'a>,
    /// Scaled load of each level.
    pub(super) loads: Vec<Vec<f64>>,
    pub(super) components: Components,
    /// Factor by which the load was divided.
    pub(super) scale: f64,
}

impl NestedProblem<'_> {
    pub(super) fn finest(&self) -> usize {
        self.levels.finest()
    }

    /// Law on a level whose flux has this limit on the finest one.
    pub(super) fn law(&self, limit: f64, level: usize) -> Result<Law, InputError> {
        let [finest, network] = [self.finest(), level].map(|level| self.levels.network(level));
        // On curved boundaries the coarser polygons are shorter: their flux has to balance the same load.
        // Without contact nodes there is nothing to balance.
        let longer = if network.contact().is_empty() {
            1.0
        } else {
            finest.perimeter() / network.perimeter()
        };
        Ok(Law::new(0.0, limit * longer)?)
    }
}

/// Connected components of nested networks.
pub(super) struct Components {
    /// True for each component that has a fixed node.
    pub(super) has_fixed: Vec<bool>,
    /// Component of each contact node, for each level.
    pub(super) of_contact: Vec<Vec<u32>>,
    /// Component of each node of the finest level.
    of_nodes: Vec<u32>,
}

impl Components {
    /// Finds the components, and checks the load on the finest level.
    pub(super) fn of(
        levels: &NetworkLevels<'_>,
        law: Law,
        load: &[f64],
    ) -> Result<Self, InputError> {
        let (of_nodes, of_contact) = levels.components();
        let found = components(levels.network(levels.finest()), &of_nodes, load);
        check_load(&found, law)?;
        let has_fixed = found.iter().map(|component| component.has_fixed).collect();
        Ok(Self { has_fixed, of_contact, of_nodes })
    }

    /// Measure of the boundary of each component that balances this load on the finest level if it slips down, with
    /// this limit of the flux.
    pub(super) fn needed(&self, load: &[f64], limit: f64) -> Vec<f64> {
        let mut needed = vec![0.0; self.has_fixed.len()];
        for (&component, load) in self.of_nodes.iter().zip(load) {
            needed[component as usize] -= load / limit;
        }
        needed
    }
}
