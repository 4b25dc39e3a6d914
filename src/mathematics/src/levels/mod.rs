//! Problems: a domain with f and the laws on the parts of its boundary, and its nested discrete problems.
//!
//! Central is [`Problem`], which is checked once, when it is made. What is particular to a kind of domain, its geometry
//! and its load, is the trait [`Levels`], with two implementors: [`Lattices`], the paper's grids of the square, without
//! a matrix in memory, and `Triangulations`, a mesh with its refinements. All else, such as arcs in contact, errors and
//! files, are functions of the problem, the same for both. Solvers ask
//! [`Levels::discrete`], and what only the square has [`Levels::lattices`].

mod bisected;
mod lattices;
mod problem;
mod triangulations;
mod vectors;

pub use lattices::Lattices;
pub use problem::{Problem, Reserve};
pub(crate) use triangulations::{Triangulations, VectorErrors, read};
pub use vectors::OnPart;

use crate::bounds::{Bounds, NoBound};
use crate::discrete::nested::DiscreteLevels;
use crate::mesh::{AnyMesh, ClosedCurve, MeshError, PlaneMesh};
use crate::multigrid::InputError;
use crate::problem::error::SourceError;
use crate::problem::exact::Known;
use crate::problem::law::Law;
use crate::problem::unsolvable::{Component, Unsolvable};
use std::borrow::Cow;

/// Geometry and load of the nested discrete problems of one domain and one f. Levels are numbered from 0 on, coarsest
/// first.
pub trait Levels: Send + Sync {
    /// Facts on the domain, f and the finest level.
    fn facts(&self) -> &Facts;

    /// Grids or networks, which solvers take.
    fn discrete(&self) -> DiscreteLevels<'_>;

    /// Grids with f, for what only the square has; none on a mesh.
    fn lattices(&self) -> Option<&Lattices> {
        None
    }

    /// Mesh of a level; that of a grid is made.
    fn mesh(&self, level: usize) -> Cow<'_, AnyMesh>;

    /// Closed curves of the boundary of a domain in the plane, on the finest level; none in space.
    fn boundary(&self) -> Vec<ClosedCurve>;

    /// Picture of a domain in the plane, with so many cells across at most; none in space.
    fn drawing(&self, most_cells: usize) -> Option<Drawing>;

    /// Means of f over the cells of the mesh with so many cells across at most: in the plane, that of the picture.
    ///
    /// # Errors
    /// [`SourceError::NoValue`] if f is not finite at a point of a mesh coarser than the finest.
    fn means(&self, most_cells: usize) -> Result<Cow<'_, [f64]>, SourceError>;

    /// Part of the integral of |f| that the quadrature of f may have missed; none if f is constant on pieces.
    fn missed(&self) -> Option<f64>;

    /// Load vector (6) of the finest level.
    fn finest_load(&self) -> &[f64];

    /// Load vector (6) of a level.
    ///
    /// # Errors
    /// [`SourceError::NoValue`] if f is not finite at a point of a level coarser than the finest.
    fn load(&self, level: usize) -> Result<Cow<'_, [f64]>, SourceError>;

    /// Connected components of the domain, with f.
    fn components(&self) -> Vec<Component>;

    /// Connected components of the domain with the curves of its boundary in place of the facets of the finest mesh, by
    /// an estimate.
    fn components_on_curves(&self) -> Vec<Component> {
        self.components()
    }

    /// Names of the parts of the boundary that are neither free nor fixed, with their laws; on the square one part
    /// without a name.
    fn laws(&self) -> Vec<(String, Law)>;

    /// Guaranteed bounds for a nodal vector of the finest level.
    ///
    /// # Errors
    /// [`NoBound`].
    fn bounds(&self, y: &[f64]) -> Result<Bounds, NoBound>;

    /// Guaranteed error of a nodal vector in each cell of the finest mesh; empty on the square, and without a bound.
    fn local_errors(&self, y: &[f64]) -> Vec<f64>;
}

/// Facts on nested discrete problems.
#[derive(Clone, Debug, PartialEq)]
pub struct Facts {
    /// Number of dimensions, 2 or 3.
    pub dimension: u8,
    /// Width of the cells of the finest level: on a mesh, the length of the longest edge.
    pub width: f64,
    /// Longest side of the least box around the domain, along the axes.
    pub extent: f64,
    /// f, in one line.
    pub f: String,
    /// Integral of f over the domain.
    pub integral: f64,
    /// Integral of |f|.
    pub size: f64,
    /// Integral of the absolute value of the flux over the free parts of the boundary.
    pub given: f64,
    /// Flux out through these parts.
    pub given_flux: f64,
    /// True if f is not constant on pieces, at least somewhere, so that the integrals are by quadrature.
    pub by_quadrature: bool,
    /// Known solution whose f this is.
    pub known: Option<Known>,
    /// Facts on the domain and f that a user has to know, in a line each: those of [`AnyMesh::notes`], and the pieces
    /// of f that are certain to lie outside the domain.
    pub notes: Vec<String>,
    /// True if meshes are finer where the error is large, so that most of them are not shown.
    pub is_adapted: bool,
}

/// Part of the integral of |f| from which on bounds are those of another f, if the points miss it.
const MISSED: f64 = 0.1;

/// Refuses bounds for an f of which the points of its quadrature miss this part.
///
/// # Errors
/// [`NoBound::Missed`].
pub(crate) fn check_missed(missed: Option<f64>) -> Result<(), NoBound> {
    match missed.filter(|missed| *missed > MISSED) {
        Some(part) => Err(NoBound::Missed { part }),
        None => Ok(()),
    }
}

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
    /// A law that the grids of the square do not take.
    #[error(
        "grids of the square take laws under which v sticks at 0, not {0}; take the mesh of the square"
    )]
    OnGrids(Law),
}

/// Mesh of a picture, which may be coarser than the finest one.
pub struct Drawing {
    /// Mesh.
    pub mesh: PlaneMesh,
    /// Position of each of its nodes in a nodal vector of the finest level.
    pub nodes: Vec<usize>,
}

/// Bound of the rounding error of the integral of f, over the integral of |f|.
pub(crate) const ROUNDING: f64 = 1e-12;

impl Facts {
    /// An integral of f, or a sum that balances one; zero for a sum of rounding errors.
    pub fn without_rounding(&self, sum: f64) -> f64 {
        if sum.abs() <= self.rounding() { 0.0 } else { sum }
    }

    /// Bound of the rounding error of the integral of f, and of each sum that balances it.
    pub fn rounding(&self) -> f64 {
        ROUNDING * (self.size.abs() + self.given)
    }
}

/// Step that has just ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// A mesh and its matrix.
    Mesh,
    /// f on the cells, and the load vector.
    Load,
    /// A solution.
    Solver,
    /// Judgement and bounds of a solution.
    Bounds,
}

/// Is told each step that has ended, by the thread that was at it: a mesh and its load are made at the same time.
pub type Watch<'a> = &'a (dyn Fn(Step) + Sync);
