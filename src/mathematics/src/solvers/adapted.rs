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
//! they have fewer nodes than the next adapted mesh and may meet the goal; the first that does is the last mesh. There
//! one of them may meet the goal with fewer nodes, since all cells keep their shape.
//!
//! The bounds fall like the inverse root of the number of nodes, whatever the corners and ends of contact. Where they
//! do not fall although the number of nodes has doubled, the solution is computed to rounding once, and if that does
//! not help the run ends: f has parts that its quadrature misses, or rounding errors are reached.

mod meshes;
#[cfg(test)]
mod tests;

use crate::bounds::{Accuracy, Bounds, NoBound};
use crate::levels::{ProblemError, Watch};
use crate::mesh::{PlaneMesh, quarter};
use crate::saddle::Monitor;
use crate::solvers::Refusal;
use crate::solvers::reach::{Refining, Watcher, reach};
use crate::solvers::solved::{ReachEnd, Reached, Solved};
use meshes::Meshes;

/// Problem to be solved on adapted meshes.
#[derive(Clone, Copy, Debug)]
pub struct Adaption<'a> {
    /// First mesh.
    pub coarsest: &'a PlaneMesh,
    /// f as text.
    pub f: &'a str,
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

/// Returns the least number of cells, by increasing numbers, whose squares sum to at least a fraction of all; of equal
/// squares those of the cells with lower numbers. A square that is no positive number counts as zero.
pub(super) fn largest_parts(squares: &[f64], fraction: f64) -> Vec<u32> {
    let square = |cell: &u32| squares[*cell as usize];
    let mut marked: Vec<u32> =
        (0..squares.len() as u32).filter(|cell| square(cell) > 0.0).collect();
    marked.sort_by(|a, b| square(b).total_cmp(&square(a)));
    let wanted = fraction * marked.iter().map(square).sum::<f64>();
    let mut sum = 0.0;
    let reaches = |cell| {
        sum += square(cell);
        sum >= wanted
    };
    let enough = marked.iter().position(reaches).map_or(marked.len(), |last| last + 1);
    marked.truncate(enough);
    marked.sort_unstable();
    marked
}

/// Squares to be expected in the pieces of cells, from the squares in the cells; `origins` has the number of the cell
/// of each piece, increasing. Where the solution is smooth, the square in a cell falls like the square of its area.
pub(super) fn expected_squares(squares: &[f64], origins: &[u32]) -> Vec<f64> {
    let mut expected = Vec::with_capacity(origins.len());
    for pieces in origins.chunk_by(|a, b| a == b) {
        let count = pieces.len() as f64;
        let square = squares[pieces[0] as usize] / (count * count);
        expected.extend(pieces.iter().map(|_| square));
    }
    expected
}

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
