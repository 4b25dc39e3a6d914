//! Nested networks: the discrete problems of a mesh and its refinements, coarsest first.

use crate::discrete::network::Network;
use crate::mesh::{Mesh, MeshError, Refined, assemble, refine};

/// Discrete problem of one mesh among its refinements.
#[derive(Clone, Debug)]
pub struct NestedNetwork {
    /// Discrete problem.
    pub network: Network,
    /// Nodes of the coarser network between which each further node lies; empty on the coarsest.
    pub parents: Vec<[u32; 2]>,
}

/// Returns the discrete problems of a mesh and its refinements, `times` of them, and the finest mesh.
///
/// # Errors
/// As [`refine`].
pub fn refined<const D: usize, const V: usize>(
    mesh: &Mesh<D, V>,
    times: usize,
) -> Result<(Vec<NestedNetwork>, Mesh<D, V>), MeshError> {
    let mut levels = vec![NestedNetwork { network: assemble(mesh), parents: Vec::new() }];
    let mut finest = mesh.clone();
    for _ in 0..times {
        let Refined { mesh, parents } = refine(&finest)?;
        levels.push(NestedNetwork { network: assemble(&mesh), parents });
        finest = mesh;
    }
    Ok((levels, finest))
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
