//! Uniform refinements of the first mesh beside adapted ones: where cells are stretched one of them may meet the goal
//! with fewer nodes, since all cells keep their shape.

use super::meshes::Meshes;
use crate::levels::ProblemError;
use crate::mesh::quarter;

/// Number of nodes up to which each refinement is tried.
const FEW: usize = 500;
/// Part of the error that is left at least when all cells are divided into four; one half is usual at best.
const LEAST_LEFT: f64 = 0.4;

/// Uniform refinements of the first mesh.
pub(super) struct UniformMeshes<'a> {
    meshes: Meshes<'a>,
    /// Least error to be expected, over that of the goal.
    expected: f64,
}

impl Meshes<'_> {
    /// Solves on the uniform refinements of the first mesh with at most so many nodes that may meet the goal; true if
    /// one does, which takes the place of the meshes so far.
    pub(super) fn is_overtaken(&mut self, most_nodes: usize) -> Result<bool, ProblemError> {
        let mut uniform = match self.uniform.take() {
            Some(uniform) => uniform,
            None => {
                let meshes = Meshes::new(self.adaption, self.ended)?;
                Box::new(UniformMeshes { meshes, expected: 0.0 })
            }
        };
        let is_overtaken = uniform.reaches(most_nodes)?;
        if is_overtaken {
            *self = uniform.meshes;
            self.is_solved = true;
        } else {
            self.uniform = Some(uniform);
        }
        Ok(is_overtaken)
    }
}

impl UniformMeshes<'_> {
    /// True if a refinement with at most so many nodes meets the goal: the last one then.
    fn reaches(&mut self, most_nodes: usize) -> Result<bool, ProblemError> {
        let Self { meshes, expected } = self;
        while meshes.finest().points().len() + meshes.sides.len() <= most_nodes {
            let Ok(finer) = quarter(meshes.finest()) else { break };
            meshes.marks.push(Vec::new());
            meshes.add(vec![finer])?;
            *expected *= LEAST_LEFT;
            if meshes.finest().points().len() > FEW && *expected > 1.0 {
                continue;
            }
            meshes.found = meshes.solved()?;
            let left = match &meshes.found {
                Ok(found) => meshes.adaption.goal.square_left(&found.bounds),
                Err(_) => 0.0,
            };
            if left >= 1.0 {
                return Ok(true);
            }
            // A bound that does not tell is no reason to wait.
            *expected = if left > 0.0 { 1.0 / left.sqrt() } else { 0.0 };
        }
        Ok(false)
    }
}
