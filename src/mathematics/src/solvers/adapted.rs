//! Adaptive refinement in the plane: meshes that are bisected where the guaranteed error is large, until it is small
//! enough.
//!
//! # Algorithm
//! On each mesh in turn:
//!
//! 1. Integrate f. On the first mesh solve, on each other one improve the interpolated solution by four steps of the
//!    multilevel method: more steps lower the bounds by next to nothing. After two steps the energy has converged, but
//!    not the bounds, for which residuals are carried along trees of cells: under friction they exceed those of the
//!    solution by half.
//! 2. Bound the error. The square of the bound is a sum over the cells. End if the goal is met.
//! 3. Mark the cells with the largest parts, until they have two thirds of the sum, and bisect them; mark, by the parts
//!    that are to be expected in their pieces, and bisect once more, before the next solution. Where less is missing,
//!    less is marked, on all meshes until the goal alike: the last mesh is to meet it, and no other one to be near. On
//!    a curved boundary the energy between chord and curve counts as a part of the cell, since no bound feels it.
//!
//! Uniform refinements of the first mesh are solved as well where stretched cells have much of the error, as far as
//! they have fewer nodes than the next adapted mesh and may meet the goal; the first that does is the last mesh.
//!
//! The bounds fall like the inverse root of the number of nodes, whatever the corners and ends of contact. Where they
//! do not fall although the number of nodes has doubled, the solution is computed to rounding once, and if that does
//! not help the run ends: f has parts that its quadrature misses, or rounding errors are reached.

mod marking;
mod meshes;
#[cfg(test)]
mod tests;
mod uniform;

use super::Refusal;
use super::reach::{Watcher, reach};
use super::solved::Solved;
use crate::bounds::Accuracy;
use crate::levels::Watch;
use crate::mesh::PlaneMesh;
use crate::problem::law::Law;
use uniform::MeshesOfBothWays;

/// Problem to be solved on adapted meshes.
#[derive(Clone, Copy, Debug)]
pub struct Adaption<'a> {
    /// First mesh.
    pub coarsest: &'a PlaneMesh,
    /// f as text.
    pub f: &'a str,
    /// Law where the boundary is in contact.
    pub law: Law,
    /// Goal.
    pub goal: Accuracy,
    /// Most nodes of a mesh.
    pub most_nodes: usize,
    /// Number of bisections from one mesh with a solution to the next, at least one.
    pub bisections: usize,
}

impl Adaption<'_> {
    /// Number of bisections from one solution to the next that takes the least time: each mesh with a solution has
    /// about three times the nodes of the one before, and all of them together half as many again as the last.
    pub const BISECTIONS: usize = 2;

    /// Solves on one mesh after the other until the goal is met, or no finer mesh is of use or allowed. The watcher is
    /// shown each mesh, and `steps` told each step.
    ///
    /// # Errors
    /// [`Refusal`], also if there is no bound on the finest mesh that is allowed.
    pub fn run(&self, watcher: &mut dyn Watcher, steps: Watch<'_>) -> Result<Solved, Refusal> {
        reach(MeshesOfBothWays::new(self, steps)?, self.goal, watcher)
    }
}
