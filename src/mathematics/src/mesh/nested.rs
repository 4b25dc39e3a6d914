//! The nested discrete problems of a mesh and its refinements.

use super::{Mesh, MeshError, Refined, assemble, refine};
use crate::discrete::nested::NestedNetwork;

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
