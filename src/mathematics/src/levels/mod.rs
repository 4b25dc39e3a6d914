//! Problems: a domain with f, a law and the conditions on the parts of the boundary, and its nested discrete problems.
//!
//! Central is [`Problem`], which is checked once, when it is made. What solvers, judges, bounds, pictures and files
//! need of a grid or a mesh is the trait [`Levels`], with two implementors: [`Lattices`], the paper's grids of the
//! square, without a matrix in memory, and [`Triangulations`], a mesh with its refinements. What only the square has
//! asks [`Levels::discrete`].

mod bisected;
mod error;
mod lattices;
mod problem;
mod steps;
mod triangulations;

pub use error::ProblemError;
pub use lattices::Lattices;
pub use problem::{Problem, Reserve};
pub use steps::{Step, Watch};
pub use triangulations::Triangulations;
pub(crate) use triangulations::read;

use crate::bounds::{Bounds, NoBound};
use crate::discrete::contact::ContactArc;
use crate::discrete::kkt::Judgement;
use crate::discrete::nested::NestedNetwork;
use crate::discrete::norms::Errors;
use crate::mesh::{AnyMesh, Condition, PlaneMesh};
use crate::problem::error::SourceError;
use crate::problem::law::{ContactNode, Law};
use crate::problem::unsolvable::Component;
use crate::saddle::Pair;
use std::borrow::Cow;

/// Nested discrete problems of one domain and one f. Levels are numbered from 0 on, coarsest first.
pub trait Levels: Send + Sync {
    /// Number of levels, at least one.
    fn count(&self) -> usize;

    /// Number of dimensions, 2 or 3.
    fn dimension(&self) -> u8;

    /// Name of a level in sentences, such as `grid 1/64`, `refinement 3` or `the mesh of 900 nodes`.
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

    /// Facts on the domain that a user has to know, in a line each, as [`AnyMesh::notes`] has them.
    fn notes(&self) -> Vec<String> {
        Vec::new()
    }

    /// True if v = 0 on a part of the boundary.
    fn has_fixed_part(&self) -> bool;

    /// Judges a nodal vector of a level with this load vector, apart from the solvers.
    fn judge(&self, level: usize, law: Law, vectors: NodalVectors<'_>) -> Judgement;

    /// Connected components of the domain, with f.
    fn components(&self) -> Vec<Component>;

    /// Connected components of the domain with the curves of its boundary in place of the facets of the finest mesh, by
    /// an estimate.
    fn components_on_curves(&self) -> Vec<Component> {
        self.components()
    }

    /// True if the flux that a law allows can balance a load vector of a level: then the discrete problem has a
    /// solution.
    fn is_solvable(&self, level: usize, law: Law, load: &[f64]) -> bool;

    /// Contact at the nodes in [`Levels::contact`]: where the multiplier is inside the interval of the law or v is
    /// zero, up to rounding errors.
    fn in_contact(&self, law: Law, pair: &Pair) -> Vec<bool>;

    /// Arcs in contact on the boundary of a domain in the plane, for a nodal vector of the finest level and its
    /// judgement; none in space.
    fn arcs(&self, y: &[f64], judgement: &Judgement) -> Option<Vec<ContactArc>>;

    /// Names of the parts of the boundary that are in contact by the judgement of a vector of the finest level, empty
    /// if there is no contact; none where the boundary has one part, or none as on the square.
    fn parts_in_contact(&self, judgement: &Judgement) -> Option<String>;

    /// Errors of a nodal vector of the finest level; none if the solution has no formula.
    fn errors(&self, y: &[f64], load: &[f64]) -> Option<KnownErrors>;

    /// Guaranteed bounds for a nodal vector of the finest level under a law.
    ///
    /// # Errors
    /// [`NoBound`].
    fn bounds(&self, law: Law, y: &[f64]) -> Result<Bounds, NoBound>;

    /// Coarsest mesh of a domain in the plane, from which meshes may be adapted; none on the square, and in space.
    fn coarsest(&self) -> Option<&PlaneMesh>;

    /// Copy of the mesh of the finest level.
    fn mesh(&self) -> AnyMesh;

    /// Picture of a domain in the plane, with so many cells across at most, with the means of f over its triangles;
    /// none in space.
    ///
    /// # Errors
    /// [`SourceError::NoValue`] if f is not finite at a point of a mesh coarser than the finest.
    fn map_of_f(&self, most_cells: usize) -> Result<Option<(Drawing, Vec<f64>)>, SourceError>;

    /// Picture of a domain in the plane, with so many cells across at most; none in space.
    fn drawing(&self, most_cells: usize) -> Option<Drawing>;

    /// Closed curves of the boundary of a domain in the plane; none in space.
    fn curves(&self) -> Option<Vec<ClosedCurve>>;

    /// Ending of the files for ParaView, `vti` or `vtu`.
    fn vtk_ending(&self) -> &'static str;

    /// Solution of the finest level under a law in VTK's XML format, with this name.
    fn vtk(&self, name: &str, law: Law, pair: &Pair) -> Vec<u8>;

    /// Solution of the finest level under a law in NPZ format; none if it is larger than the format allows.
    fn npz(&self, law: Law, pair: &Pair) -> Option<Vec<u8>>;

    /// Nodal values of the finest level in NPY format.
    fn npy(&self, pair: &Pair) -> Vec<u8>;

    /// Discrete problems, for what is faster on the square, and what only the square or only meshes have.
    fn discrete(&self) -> Discrete<'_>;
}

/// Discrete problems of all levels, as solvers take them.
pub enum Discrete<'a> {
    /// Grids of the square, without a matrix in memory.
    Lattices(&'a Lattices),
    /// Networks of a mesh and its refinements, coarsest first.
    Networks(&'a [NestedNetwork]),
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

/// Mesh of a picture, which may be coarser than the finest one.
pub struct Drawing {
    /// Mesh.
    pub mesh: PlaneMesh,
    /// Position of each of its nodes in a nodal vector of the finest level.
    pub nodes: Vec<usize>,
}

/// Closed curve of a boundary in the plane.
pub struct ClosedCurve {
    /// Names of the parts of the boundary on the curve; none on the square, whose sides have names.
    pub parts: Option<String>,
    /// Nodes of the finest level in their order along the curve.
    pub nodes: Vec<usize>,
    /// Coordinates of these nodes.
    pub points: Vec<[f64; 2]>,
    /// Condition on the edge from the node to the next one, the first after the last.
    pub conditions: Vec<Condition>,
    /// Arc lengths of the nodes, from 0 on.
    pub places: Vec<f64>,
    /// Length of the curve.
    pub length: f64,
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
    /// True if f is that of a known solution.
    pub is_known: bool,
}

/// Bound of the rounding error of the integral of f, over the integral of |f|.
pub(crate) const ROUNDING: f64 = 1e-12;

impl Integrals {
    /// Bound of the rounding error of the integral of f, and of each sum that balances it.
    pub fn rounding(&self) -> f64 {
        ROUNDING * self.of_size.abs()
    }
}

/// Errors against a known solution.
#[derive(Clone, Copy, Debug)]
pub struct KnownErrors {
    /// Errors of v.
    pub values: Errors,
    /// Error of the multiplier in L2; none where it is not measured.
    pub multiplier_l2: Option<f64>,
}
