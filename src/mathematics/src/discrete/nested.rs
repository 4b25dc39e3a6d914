//! Nested networks: the discrete problems of a triangulation and its refinements, coarsest first.

use super::network::Network;

/// Discrete problem of one mesh among its refinements.
#[derive(Clone, Debug)]
pub struct NestedNetwork {
    /// Discrete problem.
    pub network: Network,
    /// Nodes of the coarser network between which each further node lies; empty on the coarsest.
    pub parents: Vec<[u32; 2]>,
}

impl NestedNetwork {
    /// Number of nodes of the coarser network.
    pub fn coarse_nodes(&self) -> usize {
        self.network.nodes() - self.parents.len()
    }

    /// Returns the linear interpolation of a nodal vector of the coarser network.
    pub fn interpolate(&self, coarse: &[f64]) -> Vec<f64> {
        let mut fine = Vec::with_capacity(self.network.nodes());
        fine.extend_from_slice(coarse);
        let midpoint = |&[a, b]: &[u32; 2]| 0.5 * (coarse[a as usize] + coarse[b as usize]);
        fine.extend(self.parents.iter().map(midpoint));
        fine
    }

    /// Returns the linear interpolation of a boundary vector of the coarser network, whose values elsewhere are zero.
    pub fn interpolate_boundary(&self, coarser: &Network, values: &[f64]) -> Vec<f64> {
        let value = |node: u32| coarser.contact_at(node as usize).map_or(0.0, |(b, _)| values[b]);
        let old = self.coarse_nodes();
        let contact = self.network.contact().iter().map(|contact| contact.node);
        let interpolated = contact.map(|node| match node.checked_sub(old) {
            None => value(node as u32),
            Some(new) => 0.5 * self.parents[new].map(value).iter().sum::<f64>(),
        });
        interpolated.collect()
    }

    /// Returns the load vector of the coarser network that belongs to one of this network: the transpose of
    /// [`NestedNetwork::interpolate`].
    pub fn restrict(&self, fine: &[f64]) -> Vec<f64> {
        let (old, new) = fine.split_at(self.coarse_nodes());
        let mut coarse = old.to_vec();
        for (&[a, b], value) in self.parents.iter().zip(new) {
            coarse[a as usize] += 0.5 * value;
            coarse[b as usize] += 0.5 * value;
        }
        coarse
    }
}
