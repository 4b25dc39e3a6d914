//! Problems: a domain with f, a law and the conditions on the parts of the boundary, and its nested discrete problems.
//!
//! Central is [`Problem`], which is checked once, when it is made. What solvers, judges, bounds, pictures and files need
//! of a grid or a mesh is the trait [`Levels`], with two implementors: [`Lattices`], the paper's grids of the square,
//! without a matrix in memory, and [`Triangulations`], a mesh with its refinements. Fast paths that only the square has
//! ask [`Levels::discrete`] whether they may be used.

mod lattices;
mod problem;
mod triangulations;
mod unsolvable;

pub use lattices::Lattices;
pub use problem::{Problem, Reserve};
pub use triangulations::Triangulations;
pub use unsolvable::{Unsolvable, shown_integral};

use crate::bounds::{Bounds, NoBound};
use crate::discrete::contact::ContactArc;
use crate::discrete::kkt::Judgement;
use crate::discrete::nested::NestedNetwork;
use crate::discrete::norms::Errors;
use crate::mesh::{AnyMesh, Touching};
use crate::problem::error::SourceError;
use crate::problem::law::{ContactNode, Law};
use crate::saddle::Pair;
use std::borrow::Cow;

/// Nested discrete problems of one domain and one f. Levels are numbered from 0 on, coarsest first.
pub trait Levels: Send + Sync {
    /// Number of levels, at least one.
    fn count(&self) -> usize;

    /// Number of dimensions, 2 or 3.
    fn dimension(&self) -> u8;

    /// Name of a level in sentences, such as `grid 1/64` or `refinement 3`.
    fn name(&self, level: usize) -> String;

    /// Number of cells per side; none on a mesh.
    fn cells(&self, level: usize) -> Option<usize>;

    /// Number of nodes, the length of a nodal vector.
    fn nodes(&self, level: usize) -> usize;

    /// Width of the cells of the finest level: on a mesh, the length of the longest edge.
    fn width(&self) -> f64;

    /// Longest side of the least box around the domain, along the axes.
    fn extent(&self) -> f64;

    /// f, in one line.
    fn f(&self) -> String;

    /// Pieces of f that are certain to lie outside the domain, where they change nothing.
    fn outside(&self) -> Vec<String>;

    /// Integrals of f over the domain.
    fn integrals(&self) -> &Integrals;

    /// Part of the integral of |f| that the quadrature of f may have missed; none if f is constant on pieces.
    fn missed(&self) -> Option<f64>;

    /// Load vector (6) of the finest level.
    fn finest_load(&self) -> &[f64];

    /// Load vector (6) of a level.
    ///
    /// # Errors
    /// [`SourceError::NoValue`] if f is not finite at a point of a level coarser than the finest.
    fn load(&self, level: usize) -> Result<Cow<'_, [f64]>, SourceError>;

    /// Boundary nodes of the finest level where the law holds, in the order of a boundary vector.
    fn contact(&self) -> Cow<'_, [ContactNode]>;

    /// Place where the domain touches itself with nodes of both sides, if there is one.
    fn touching(&self) -> Option<&Touching> {
        None
    }

    /// True if v = 0 on a part of the boundary.
    fn has_fixed_part(&self) -> bool;

    /// Judges a nodal vector of a level with this load vector, apart from the solvers.
    fn judge(&self, level: usize, law: Law, vectors: NodalVectors<'_>) -> Judgement;

    /// True if the flux that a law allows can balance a load vector of a level, by more than rounding: then the discrete
    /// problem has a solution.
    fn is_solvable(&self, level: usize, law: Law, load: &[f64]) -> bool;

    /// Contact at the nodes in [`Levels::contact`]: where the multiplier is inside the interval of the law or v is zero, up
    /// to rounding errors.
    fn in_contact(&self, law: Law, pair: &Pair) -> Vec<bool>;

    /// Arcs in contact on the boundary of a domain in the plane, for a nodal vector of the finest level and its judgement;
    /// none in space.
    fn arcs(&self, y: &[f64], judgement: &Judgement) -> Option<Vec<ContactArc>>;

    /// Errors of a nodal vector of the finest level; none if the solution has no formula.
    fn errors(&self, y: &[f64], load: &[f64]) -> Option<KnownErrors>;

    /// Guaranteed bounds for a nodal vector of the finest level under a law.
    ///
    /// # Errors
    /// [`NoBound`].
    fn bounds(&self, law: Law, y: &[f64]) -> Result<Bounds, NoBound>;

    /// Copy of the mesh of a level. The first nodes of a refined mesh are those of the coarser ones.
    fn mesh(&self, level: usize) -> AnyMesh;

    /// Means of f over the cells of the mesh of a level.
    ///
    /// # Errors
    /// [`SourceError::NoValue`] if f is not finite at a point of a level coarser than the finest.
    fn means(&self, level: usize) -> Result<Vec<f64>, SourceError>;

    /// Discrete problems in the form that fast paths take.
    fn discrete(&self) -> Discrete<'_>;
}

/// Nested discrete problems in the form that solvers take.
#[derive(Clone, Copy)]
pub enum Discrete<'a> {
    /// Grids of the square, whose matrix is a stencil.
    Lattices(&'a Lattices),
    /// Matrices of meshes.
    Networks(&'a [NestedNetwork]),
}

/// Nodal vector, and the load vector of its level.
#[derive(Clone, Copy, Debug)]
pub struct NodalVectors<'a> {
    /// Values of v at the nodes.
    pub y: &'a [f64],
    /// Load vector F.
    pub load: &'a [f64],
}

/// Integrals of f over the domain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Integrals {
    /// Integral of f.
    pub of_f: f64,
    /// Integral of |f|.
    pub of_size: f64,
    /// True if f is not constant on pieces, at least somewhere, so that the integrals are by quadrature.
    pub by_quadrature: bool,
}

/// Errors against a known solution.
#[derive(Clone, Copy, Debug)]
pub struct KnownErrors {
    /// Errors of v.
    pub values: Errors,
    /// Error of the multiplier in L2; none where it is not measured.
    pub multiplier_l2: Option<f64>,
}
