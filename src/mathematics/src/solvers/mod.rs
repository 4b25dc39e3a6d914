//! Solvers in one table: names, domains, memory, and the function that runs each on a [`Problem`].
//!
//! A new solver is a room of its own, and an entry of [`SOLVERS`] with a function that hands it a problem.

mod run;
mod size;
mod table;

pub use run::Found;
pub use size::SizeRefusal;
pub use table::{SOLVERS, Solver, SolverEntry};

use crate::discrete::end::Outcome;
use crate::discrete::kkt::Judgement;
use crate::discrete::transfer::Prolongation;
use crate::levels::{Problem, ProblemError};
use crate::multigrid::{Goal, InputError};
use crate::saddle::{Monitor, Params};
use crate::spectral::SpectralError;

/// Settings of a run; what is solved is in the [`Problem`].
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    /// Solver.
    pub solver: Solver,
    /// Parameters of the saddle-point methods, but method and tolerance, which follow from the solver and the level.
    pub params: Params,
    /// Interpolation of pairs to the next grid of the square.
    pub prolongation: Prolongation,
    /// Goal of multigrid.
    pub goal: Goal,
}

impl Settings {
    /// Settings of a solver with all else as usual.
    pub fn of(solver: Solver) -> Self {
        let (params, prolongation) = (Params::default(), Prolongation::default());
        Self { solver, params, prolongation, goal: Goal::RoundingFloor }
    }
}

/// Run of a solver.
pub struct Run {
    /// Nodal vector of the finest level.
    pub y: Vec<f64>,
    /// End on each level on which the solver stopped, coarsest first; the last may be `Diverged`.
    pub ends: Vec<Outcome>,
    /// Number of the level of the first end, of adapted meshes its position among them; the others follow.
    pub first_level: usize,
    /// Judgement of the vector.
    pub judgement: Judgement,
}

impl Run {
    /// End on the finest level.
    pub fn last(&self) -> &Outcome {
        &self.ends[self.ends.len() - 1]
    }
}

/// Reason for which a solver refuses a problem.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Refusal {
    /// Wrong input.
    #[error(transparent)]
    Input(#[from] InputError),
    /// f is not finite at a point of a coarser level.
    #[error(transparent)]
    Problem(#[from] ProblemError),
    /// The domain does not have the solver.
    #[error("{0} is for the square alone")]
    NotOnMeshes(Solver),
    /// f is not constant on pieces, or no solution was found that stands its checks.
    #[error(transparent)]
    Spectral(#[from] SpectralError),
}

/// Solves a problem.
///
/// # Errors
/// [`Refusal`]. A limit that was reached, and values that are not finite, are ends of a run.
pub fn solve(problem: &Problem, settings: &Settings) -> Result<Run, Refusal> {
    solve_watched(problem, settings, &mut ())
}

/// Solves a problem; a saddle-point method shows its iterations, and its pair on each level, to the monitor.
///
/// # Errors
/// As [`solve`].
pub fn solve_watched(
    problem: &Problem,
    settings: &Settings,
    monitor: &mut dyn Monitor,
) -> Result<Run, Refusal> {
    Ok((settings.solver.entry().run)(problem, settings, monitor)?.run(problem))
}
