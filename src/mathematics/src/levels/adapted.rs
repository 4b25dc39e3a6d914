//! Levels by adaptive refinement in the plane: meshes that are bisected where the guaranteed error is large, until it
//! is small enough.
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
//! The bounds fall like the inverse root of the number of nodes, whatever the corners and ends of contact. Where they
//! do not fall although the number of nodes has doubled, the solution is computed to rounding once, and if that does
//! not help the run ends: f has parts that its quadrature misses, or rounding errors are reached.

mod anew;
mod marking;
mod meshes;
#[cfg(test)]
mod tests;

use super::triangulations::read;
use super::{Problem, ProblemError, Watch};
use crate::bounds::{Accuracy, Bounds, NoBound};
use crate::discrete::end::Outcome;
use crate::discrete::kkt::Judgement;
use crate::mesh::PlaneMesh;
use crate::problem::law::Law;
use meshes::Meshes;
use std::ops::ControlFlow;

/// Reason for which a run of adaptive refinement ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AdaptedEnd {
    /// The bound is small enough.
    Goal,
    /// The next mesh would have more nodes than are allowed.
    Nodes,
    /// The bound did not fall although the number of nodes had doubled.
    NoLongerFalls,
}

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

/// Mesh of a run on which a solution was sought, for those who watch it.
#[derive(Clone, Debug)]
pub struct AdaptedMesh {
    /// Number of nodes.
    pub nodes: usize,
    /// Guaranteed bounds there, or the reason for which there are none.
    pub bounds: Result<Bounds, NoBound>,
}

/// Result of a run.
pub struct AdaptedRun {
    /// Problem, whose levels are the meshes.
    pub problem: Problem,
    /// Nodal vector of the finest mesh.
    pub y: Vec<f64>,
    /// Judgement of the vector.
    pub judgement: Judgement,
    /// Guaranteed bounds for the vector.
    pub bounds: Bounds,
    /// End on each mesh with a solution, coarsest first.
    outcomes: Vec<Outcome>,
    /// Reason for the end.
    pub end: AdaptedEnd,
    /// Number of meshes on which a solution was sought; the problem has those between them as well.
    pub meshes: usize,
    /// Cells that were marked for each bisection, from which [`Problem::on_bisected`] makes the meshes anew.
    pub marks: Vec<Vec<u32>>,
}

impl AdaptedRun {
    /// End on each mesh with a solution, coarsest first; the first meshes of a curved domain may be too coarse for one.
    pub fn outcomes(&self) -> &[Outcome] {
        &self.outcomes
    }
}

impl Adaption<'_> {
    /// Number of bisections from one solution to the next that takes the least time: each mesh with a solution has
    /// about three times the nodes of the one before, and all of them together half as many again as the last.
    pub const BISECTIONS: usize = 2;

    /// Solves on one mesh after the other until the goal is met, or no finer mesh is of use or allowed. `watch` is
    /// shown each mesh.
    ///
    /// # Errors
    /// [`ProblemError`] if there is no problem, or no bound on the finest mesh that is allowed.
    pub fn run(&self, watch: &mut dyn FnMut(&AdaptedMesh)) -> Result<AdaptedRun, ProblemError> {
        let run = self.run_while(
            &mut |mesh| {
                watch(mesh);
                ControlFlow::Continue(())
            },
            &|_| (),
        )?;
        Ok(run.expect("whoever watches lets the run go on"))
    }

    /// As [`Adaption::run`], as long as `watch` lets it go on; none if it does not. `ended` is told each step as well.
    ///
    /// # Errors
    /// As [`Adaption::run`].
    pub fn run_while(
        &self,
        watch: &mut dyn FnMut(&AdaptedMesh) -> ControlFlow<()>,
        ended: Watch<'_>,
    ) -> Result<Option<AdaptedRun>, ProblemError> {
        let f = read(self.coarsest, self.f)?;
        let mut meshes = Meshes::new(self, f, ended)?;
        loop {
            let solved = meshes.solved()?;
            let bounds =
                solved.as_ref().map(|found| found.bounds.clone()).map_err(|reason| *reason);
            if watch(&AdaptedMesh { nodes: meshes.nodes(), bounds }).is_break() {
                return Ok(None);
            }
            let end = match &solved {
                Ok(found) if self.goal.excess(&found.bounds) <= 1.0 => Some(AdaptedEnd::Goal),
                Ok(_) if meshes.has_stalled() => Some(AdaptedEnd::NoLongerFalls),
                Err(reason) if meshes.is_hopeless(reason) => return Err((*reason).into()),
                _ if meshes.refine(solved.as_ref().ok())? => None,
                _ => Some(AdaptedEnd::Nodes),
            };
            if let Some(end) = end {
                return Ok(Some(meshes.finished(end, solved?)));
            }
        }
    }
}
