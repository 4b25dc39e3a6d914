//! Reasons for which there is no problem.

use crate::bounds::NoBound;
use crate::mesh::MeshError;
use crate::multigrid::InputError;
use crate::problem::error::SourceError;
use crate::problem::unsolvable::Unsolvable;

/// Reason for which there is no problem with a unique solution.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ProblemError {
    /// The mesh cannot be refined.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// The text is no f, or f is not finite at some point, or too large or too small to compute with.
    #[error(transparent)]
    Source(#[from] SourceError),
    /// f is not finite at some point.
    #[error("f is not finite at some point; give a formula with finite values on the whole domain")]
    NotFinite,
    /// No bound of the error, by which a mesh would be refined.
    #[error("no bound of the error: {0}")]
    Bound(#[from] NoBound),
    /// Refused by a solver.
    #[error(transparent)]
    Solver(#[from] InputError),
    /// No flux can balance f on the polygon or polyhedron of the mesh, but on the domain with its curves.
    #[error("{0}, or refine the mesh: with the curves of its boundary the domain has a solution")]
    Coarse(Unsolvable),
    /// No flux can balance f.
    #[error(transparent)]
    Unsolvable(#[from] Unsolvable),
}
