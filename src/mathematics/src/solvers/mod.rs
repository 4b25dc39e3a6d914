//! Solvers in one table: names, domains, memory, and the function that runs each on a [`Problem`].
//!
//! A new solver is a room of its own, and an entry of [`SOLVERS`] with a function that hands it a problem.

mod adapted;
mod convergence;
mod reach;
mod run;
mod size;
mod solved;
mod solver;
mod table;
#[cfg(test)]
mod values;

pub use adapted::Adaption;
pub use convergence::Convergence;
pub(crate) use reach::Grids;
pub(crate) use reach::reach;
pub use reach::{Tried, Watcher};
pub(crate) use run::saddle_together;
pub use run::{FoundSolution, Run};
pub use size::{MOST_CELLS, Memory, SizeRefusal, TooLarge};
pub use solved::{ReachEnd, Reached, Solved};
pub use solver::Solver;
pub use table::{SOLVERS, SolverEntry};

use crate::bounds::NoBound;
use crate::discrete::transfer::Prolongation;
use crate::levels::{Problem, ProblemError};
use crate::mesh::MeshError;
use crate::multigrid::{Goal, InputError};
use crate::problem::unsolvable::Unsolvable;
use crate::saddle::{Monitor, Params, StopRule};
use crate::spectral::PlaneError;
use serde::{Deserialize, Serialize};

/// Settings of a run; what is solved is in the [`Problem`].
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    /// Solver.
    pub solver: Solver,
    /// Settings of the saddle-point methods.
    pub saddle: SaddleSettings,
    /// Goal of multigrid; of saddle-point methods too if it is a KKT residual.
    pub goal: Goal,
}

impl Settings {
    /// Settings of a solver with all else as usual.
    pub fn of(solver: Solver) -> Self {
        Self { solver, saddle: SaddleSettings::default(), goal: Goal::RoundingFloor }
    }
}

/// Settings of a saddle-point method.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SaddleSettings {
    /// Interpolation of pairs to the next grid of the square.
    pub prolongation: Prolongation,
    /// Duality parameter, positive.
    pub r: f64,
    /// Stopping rule; its tolerance follows from the level.
    pub stop: StopRule,
    /// Limit of iterations per level.
    pub max_iterations: usize,
}

impl Default for SaddleSettings {
    /// Settings of `solve`: r = 10, and the rule as printed.
    fn default() -> Self {
        let max_iterations = Params::default().max_iterations;
        Self {
            prolongation: Prolongation::default(),
            r: 10.0,
            stop: StopRule::Printed,
            max_iterations,
        }
    }
}

/// Reason for which a solver refuses a problem.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Refusal {
    /// Wrong input.
    #[error(transparent)]
    Input(InputError),
    /// A number of cells per side that cannot be used.
    #[error(transparent)]
    GridSize(InputError),
    /// No flux can balance the load vector of a level, although one can balance f.
    #[error("{reason}")]
    Unbalanced {
        /// Name of the level.
        level: String,
        /// Sum of the load vector.
        sum_load: f64,
        /// Reason.
        reason: Unsolvable,
    },
    /// f is not finite at a point of a coarser level, or there is no problem on it.
    #[error(transparent)]
    Problem(ProblemError),
    /// The mesh cannot be refined.
    #[error(transparent)]
    Mesh(MeshError),
    /// No bound of the error, by which grids or meshes would become finer.
    #[error("no bound of the error: {0}")]
    NoBound(NoBound),
    /// The domain does not have the solver.
    #[error("{0} is for domains in the plane")]
    NotInSpace(Solver),
    /// Meshes are adapted in the plane alone.
    #[error("meshes are adapted in the plane alone")]
    NotInPlane,
    /// The next grid on the way to an accuracy is too large.
    #[error(transparent)]
    Size(#[from] TooLarge),
    /// Whoever watches has broken off.
    #[error("interrupted")]
    Interrupted,
    /// Domain or f is not as the spectral solver takes it, or no solution was found that stands its checks.
    #[error(transparent)]
    Spectral(#[from] PlaneError),
}

impl From<ProblemError> for Refusal {
    fn from(error: ProblemError) -> Self {
        match error {
            ProblemError::Mesh(e) => Self::Mesh(e),
            ProblemError::Bound(e) => Self::NoBound(e),
            e => Self::Problem(e),
        }
    }
}

impl Refusal {
    /// Refusal of the discrete problem on the finest level.
    fn on_finest(problem: &Problem, error: InputError) -> Self {
        let InputError::Unsolvable(reason) = error else {
            let is_of_size = matches!(error, InputError::GridSize { .. });
            return if is_of_size { Self::GridSize(error) } else { Self::Input(error) };
        };
        let (level, sum_load) = (problem.name(problem.finest()), reason.integral);
        Self::Unbalanced { level, sum_load, reason }
    }
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
    Ok(find(problem, settings, monitor)?.on_levels(problem))
}

/// As [`solve_watched`], but a true solution is not evaluated on the levels.
///
/// # Errors
/// As [`solve`].
pub(crate) fn find(
    problem: &Problem,
    settings: &Settings,
    monitor: &mut dyn Monitor,
) -> Result<FoundSolution, Refusal> {
    (settings.solver.entry().run)(problem, settings, monitor)
}
