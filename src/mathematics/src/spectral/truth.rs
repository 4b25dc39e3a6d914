//! Ways to the true solution on all connected components of a domain.

use super::contact::start::PlaneStart;
use super::fit::Effort;
use super::problem::PlaneProblem;
use super::solution::{TrueSolution, solve};
use crate::mesh::PlaneMesh;
use crate::problem::source::Source;
use crate::spectral::error::PlaneError;

/// Nodes, at most, of the meshes whose solutions are starts in turn, on a domain with at most so many sides.
const STARTS: [f64; 2] = [6e3, 6e4];
const SIDES: f64 = 20.0;

/// Solves the problem on the domain of a mesh in the plane, whose boundary is straight or lies on the circles of its
/// parts.
///
/// # Errors
/// [`PlaneError`].
pub(crate) fn true_solution_on(mesh: &PlaneMesh, f: &[Source]) -> Result<TrueSolution, PlaneError> {
    let mut all: Option<TrueSolution> = None;
    for component in mesh.split() {
        let problem = PlaneProblem::on_mesh(&component, f)?;
        let sides = problem.domain.sides().filter(|side| !side.is_after_bend).count() as f64;
        // Short sides want short edges.
        let most_nodes = STARTS.map(|nodes| nodes * (sides / SIDES).max(1.0).powi(2));
        let starts = most_nodes
            .into_iter()
            .filter_map(|most| PlaneStart::on_mesh(&problem, &component, f, most));
        let own = solved(&problem, starts)?;
        all = Some(if let Some(before) = all { before.with(own) } else { own });
    }
    Ok(all.expect("a mesh has a component"))
}

/// Checks that [`true_solution_on`] takes the domain of a mesh, and f.
///
/// # Errors
/// [`PlaneError`].
pub(crate) fn check_plane(mesh: &PlaneMesh, f: &[Source]) -> Result<(), PlaneError> {
    mesh.split().iter().try_for_each(|component| PlaneProblem::on_mesh(component, f).map(|_| ()))
}

/// Solves a problem from the contact sets of discrete solutions in turn.
fn solved(
    problem: &PlaneProblem,
    starts: impl Iterator<Item = PlaneStart>,
) -> Result<TrueSolution, PlaneError> {
    let mut error = PlaneError::NotFound("multigrid found no solution to begin with".into());
    let mut effort = Effort::default();
    for start in starts {
        match solve(problem, &start, &mut effort) {
            Err(failed) => error = failed,
            found => return found,
        }
    }
    Err(error)
}
