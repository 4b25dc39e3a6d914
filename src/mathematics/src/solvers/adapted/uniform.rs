//! Uniform refinements of the first mesh beside adapted meshes: where cells are stretched one of them may meet the goal
//! with fewer nodes, since all cells keep their shape.

use super::Adaption;
use super::meshes::Meshes;
use crate::bounds::{Bounds, NoBound};
use crate::levels::{ProblemError, Watch};
use crate::mesh::quarter;
use crate::saddle::Monitor;
use crate::solvers::Refusal;
use crate::solvers::reach::Refining;
use crate::solvers::solved::{ReachEnd, Reached, Solved};

/// Number of nodes up to which each refinement is tried.
const FEW: usize = 500;
/// Part of the error that is left at least when all cells are divided into four; one half is usual at best.
const LEAST_LEFT: f64 = 0.4;

/// Adapted meshes, and uniform refinements of the first one.
pub(super) struct MeshesOfBothWays<'a> {
    adaption: &'a Adaption<'a>,
    /// Is told each step.
    ended: Watch<'a>,
    adapted: Meshes<'a>,
    /// Uniform refinements; none before they are of use.
    uniform: Option<Meshes<'a>>,
    /// Least error to be expected on the last of them, over that of the goal.
    expected: f64,
    /// True if the last of them meets the goal.
    is_overtaken: bool,
}

impl<'a> MeshesOfBothWays<'a> {
    /// The first mesh.
    pub(super) fn new(adaption: &'a Adaption<'a>, ended: Watch<'a>) -> Result<Self, ProblemError> {
        let (adapted, uniform) = (Meshes::new(adaption, ended)?, None);
        Ok(Self { adaption, ended, adapted, uniform, expected: 0.0, is_overtaken: false })
    }

    /// Meshes of the way that is ahead.
    fn ahead(&self) -> &Meshes<'a> {
        self.uniform.as_ref().filter(|_| self.is_overtaken).unwrap_or(&self.adapted)
    }

    /// Solves on the uniform refinements with at most so many nodes that may meet the goal, until one does.
    fn refine_uniformly(&mut self, most_nodes: usize) -> Result<(), Refusal> {
        let uniform = match &mut self.uniform {
            Some(uniform) => uniform,
            none => none.insert(Meshes::new(self.adaption, self.ended)?),
        };
        while !self.is_overtaken && uniform.nodes() + uniform.sides.len() <= most_nodes {
            let Ok(finer) = quarter(uniform.finest()) else { break };
            uniform.marks.push(Vec::new());
            uniform.add(vec![finer])?;
            self.expected *= LEAST_LEFT;
            if uniform.nodes() > FEW && self.expected > 1.0 {
                continue;
            }
            let bounds = uniform.solve(&mut ())?;
            let left = bounds.map_or(0.0, |bounds| self.adaption.goal.square_left(&bounds));
            // A bound that does not tell is no reason to wait.
            self.expected = if left > 0.0 { 1.0 / left.sqrt() } else { 0.0 };
            self.is_overtaken = left >= 1.0;
        }
        Ok(())
    }
}

impl Refining for MeshesOfBothWays<'_> {
    fn nodes(&self) -> usize {
        self.ahead().nodes()
    }

    fn solve(&mut self, monitor: &mut dyn Monitor) -> Result<Result<Bounds, NoBound>, Refusal> {
        match &self.ahead().found {
            Ok(found) if self.is_overtaken => Ok(Ok(found.bounds.clone())),
            _ => self.adapted.solve(monitor),
        }
    }

    fn has_failed(&self) -> bool {
        self.ahead().has_failed()
    }

    fn is_hopeless(&self, reason: &NoBound) -> bool {
        self.adapted.is_hopeless(reason)
    }

    fn refine(&mut self) -> Result<Option<ReachEnd>, Refusal> {
        let end = self.adapted.refine()?;
        if self.adapted.is_stretched {
            self.refine_uniformly(match end {
                None => self.adapted.nodes() - 1,
                Some(_) => self.adaption.most_nodes,
            })?;
        }
        Ok(end.filter(|_| !self.is_overtaken))
    }

    fn finished(self, reached: Reached) -> Result<Solved, Refusal> {
        match self.uniform {
            Some(uniform) if self.is_overtaken => {
                let tried = uniform.outcomes.len();
                uniform.finished(Reached { tried, ..reached })
            }
            _ => self.adapted.finished(reached),
        }
    }
}
