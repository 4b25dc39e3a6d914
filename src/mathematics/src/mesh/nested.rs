//! The nested discrete problems of a mesh and its refinements.

use super::assemble::assemble_edges;
use super::refine::refine_edges;
use super::{Edges, Mesh, MeshError, Refined, assemble};
use crate::discrete::nested::NestedNetwork;

/// Returns the discrete problems of a mesh and its refinements, `times` of them, and the finest mesh.
///
/// # Errors
/// As [`refine`](super::refine).
pub fn refined<const D: usize, const V: usize>(
    mesh: &Mesh<D, V>,
    times: usize,
) -> Result<(Vec<NestedNetwork>, Mesh<D, V>), MeshError> {
    let (mut levels, mut finest, mut between) = (Vec::new(), mesh.clone(), Vec::new());
    for _ in 0..times {
        let edges = Edges::new(finest.points.len(), &finest.cells);
        let network = assemble_edges(&finest, &edges);
        let Refined { mesh, parents } = refine_edges(&finest, &edges)?;
        levels.push(NestedNetwork { network, parents: std::mem::replace(&mut between, parents) });
        finest = mesh;
    }
    levels.push(NestedNetwork { network: assemble(&finest), parents: between });
    Ok((levels, finest))
}
