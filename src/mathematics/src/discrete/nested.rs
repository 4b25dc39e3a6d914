//! Nested discrete problems, coarsest first: grids of the square, or networks of a triangulation and its refinements.

use super::domain::DiscreteDomain;
use super::grid::Grid;
use super::network::Network;
use crate::problem::law::Law;

/// Discrete problems of all levels, coarsest first.
#[derive(Clone, Copy, Debug)]
pub enum DiscreteLevels<'a> {
    /// Grids of the square, without a matrix in memory, and the law on its boundary.
    Grids(&'a [Grid], Law),
    /// Networks of a mesh and its refinements.
    Networks(&'a [NestedNetwork]),
}

impl<'a> DiscreteLevels<'a> {
    /// Number of levels, at least one.
    pub fn count(self) -> usize {
        match self {
            Self::Grids(grids, _) => grids.len(),
            Self::Networks(networks) => networks.len(),
        }
    }

    /// Grid or network of a level, counted from 0.
    pub fn level(self, level: usize) -> DiscreteDomain<'a> {
        match self {
            Self::Grids(grids, law) => (grids[level], law).into(),
            Self::Networks(networks) => (&networks[level].network).into(),
        }
    }
}

/// Returns the number of the connected component of each node of the finest network, as [`Network::components`] numbers
/// them: further nodes belong to those of their parents.
pub(crate) fn nested_components(networks: &[NestedNetwork]) -> Vec<u32> {
    let mut components = networks[0].network.components();
    for NestedNetwork { parents, .. } in &networks[1..] {
        components.reserve(parents.len());
        for &[parent, _] in parents {
            components.push(components[parent as usize]);
        }
    }
    components
}

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
