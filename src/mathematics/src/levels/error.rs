//! Reasons for which there is no problem.

use crate::mesh::{MeshError, MeshSourceError};
use crate::problem::error::SourceError;
use crate::problem::unsolvable::Unsolvable;

/// Reason for which there is no problem with a unique solution.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ProblemError {
    /// The mesh cannot be refined.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// The text is no f on the mesh.
    #[error(transparent)]
    Text(#[from] MeshSourceError),
    /// f is not finite at some point, or too large or too small to compute with.
    #[error(transparent)]
    Source(#[from] SourceError),
    /// f is not finite at some point.
    #[error("f is not finite at some point; give a formula with finite values on the whole domain")]
    NotFinite,
    /// No flux can balance f.
    #[error(transparent)]
    Unsolvable(#[from] Unsolvable),
}
