//! The nested discrete problems of a mesh and its refinements.

use super::assemble::{assemble_edges, assemble_sides, check_meetings};
use super::refine::refine_edges;
use super::{Edges, Mesh, MeshError, Refined, Sides};
use crate::discrete::nested::NestedNetwork;

/// Mesh and its refinements, coarsest first, with their discrete problems.
pub(crate) struct NestedMeshes<const D: usize, const V: usize> {
    /// Meshes.
    pub meshes: Vec<Mesh<D, V>>,
    /// Discrete problem of each mesh.
    pub networks: Vec<NestedNetwork>,
    /// Sides of the cells of the finest mesh.
    pub sides: Sides<V>,
}

/// Returns a mesh and its refinements, `times` of them, with their discrete problems.
///
/// # Errors
/// As [`refine`](super::refine), and as [`check_meetings`].
pub(crate) fn nested_meshes<const D: usize, const V: usize>(
    mesh: &Mesh<D, V>,
    times: usize,
) -> Result<NestedMeshes<D, V>, MeshError> {
    check_meetings(mesh)?;
    let (mut networks, mut meshes, mut between) = (Vec::new(), vec![mesh.clone()], Vec::new());
    for _ in 0..times {
        let finest = &meshes[meshes.len() - 1];
        let edges = Edges::new(finest.points.len(), &finest.cells);
        let network = assemble_edges(finest, &edges);
        let Refined { mesh, parents } = refine_edges(finest, &edges)?;
        networks.push(NestedNetwork { network, parents: std::mem::replace(&mut between, parents) });
        meshes.push(mesh);
    }
    // In space parts meet at new nodes too.
    let mut with_formulas = meshes[1..].iter().filter(|mesh| !mesh.values.is_empty());
    with_formulas.try_for_each(check_meetings)?;
    let finest = &meshes[meshes.len() - 1];
    let sides = Sides::new(finest);
    let network = assemble_sides(finest, &sides);
    networks.push(NestedNetwork { network, parents: between });
    Ok(NestedMeshes { meshes, networks, sides })
}

/// Returns the discrete problems of a mesh and its refinements, `times` of them, and the finest mesh.
///
/// # Errors
/// As [`refine`](super::refine).
pub fn refined<const D: usize, const V: usize>(
    mesh: &Mesh<D, V>,
    times: usize,
) -> Result<(Vec<NestedNetwork>, Mesh<D, V>), MeshError> {
    let NestedMeshes { mut meshes, networks, .. } = nested_meshes(mesh, times)?;
    Ok((networks, meshes.pop().expect("at least the coarsest mesh")))
}
