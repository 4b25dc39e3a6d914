//! Solvers in one table: names, domains, memory, how each runs and how it stops.
//!
//! A new solver is an entry of [`SOLVERS`] and a room of its own.

use crate::discrete::end::{End, Outcome};
use crate::discrete::kkt::Judgement;
use crate::discrete::stop::Stop;
use crate::discrete::transfer::Prolongation;
use crate::levels::{NodalVectors, Problem, ProblemError, SaddleRun};
use crate::multigrid::active_set::{MOST_CELLS, MOST_NODES_IN_PLANE, MOST_NODES_IN_SPACE};
use crate::multigrid::{Goal, InputError, MultigridParams, check_size};
use crate::saddle::{Method, Monitor, Params};
use crate::spectral::{SpectralError, true_solution};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::fmt;

/// Solver, by the names of [`SOLVERS`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Solver {
    /// The paper's method.
    ArrowHurwicz,
    /// Uzawa's method.
    Uzawa,
    /// Uzawa's method with the proximal term.
    UzawaProximal,
    /// Primal-dual active set.
    ActiveSet,
    /// Full multigrid.
    Multigrid,
    /// Conformal map and Riemann-Hilbert problem.
    Spectral,
}

/// Entry of [`SOLVERS`].
pub struct SolverEntry {
    /// Solver.
    pub solver: Solver,
    /// Name on the command line and in records.
    pub name: &'static str,
    /// Name in sentences and legends.
    pub in_words: &'static str,
    /// Description in the help.
    pub description: &'static str,
    /// Run, and its end.
    pub run: SolverRun,
    /// Most cells per side on the square; none if memory is the only limit.
    pub most_on_square: Option<usize>,
    /// True if it solves on meshes as well.
    pub on_meshes: bool,
    /// Most nodes of a mesh in the plane and in space; none if memory is the only limit.
    pub most_nodes: [Option<usize>; 2],
    /// Bytes per node of all vectors and factors on the square, for the cells per side: measured, rounded up.
    pub bytes_per_node: fn(u64) -> u64,
}

/// Way in which a solver runs and stops.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SolverRun {
    /// Saddle-point method over all levels, until its stopping rule is met.
    Nested {
        /// Weight of the proximal term in a minimisation before each step of the multiplier; none for a single sweep.
        weight: Option<f64>,
    },
    /// Solve on the finest level alone, until its contact set is at rest.
    ActiveSet,
    /// Solve on the finest level, until a goal is reached.
    Multigrid,
    /// Solution without a level, at a given resolution.
    Spectral,
}

/// Solvers, in the order of the help.
pub const SOLVERS: [SolverEntry; 6] = [
    SolverEntry {
        solver: Solver::ArrowHurwicz,
        name: "arrow-hurwicz",
        in_words: "Arrow-Hurwicz",
        description: "The paper's method on nested grids",
        run: SolverRun::Nested { weight: None },
        most_on_square: None,
        on_meshes: true,
        most_nodes: [None; 2],
        bytes_per_node: vectors,
    },
    SolverEntry {
        solver: Solver::Uzawa,
        name: "uzawa",
        in_words: "Uzawa",
        description: "Uzawa's method on nested grids: a full minimisation before each step of the multiplier",
        run: SolverRun::Nested { weight: Some(0.0) },
        most_on_square: None,
        on_meshes: true,
        most_nodes: [None; 2],
        bytes_per_node: vectors,
    },
    SolverEntry {
        solver: Solver::UzawaProximal,
        name: "uzawa-proximal",
        in_words: "proximal Uzawa",
        description: "Uzawa's method with iterative proximal regularisation",
        run: SolverRun::Nested { weight: Some(1.0) },
        most_on_square: None,
        on_meshes: true,
        most_nodes: [None; 2],
        bytes_per_node: vectors,
    },
    SolverEntry {
        solver: Solver::ActiveSet,
        name: "active-set",
        in_words: "active set",
        description: "Primal-dual active set with banded Cholesky factors: slow, independent, exact; on the square \
            down to 1/256",
        run: SolverRun::ActiveSet,
        most_on_square: Some(MOST_CELLS),
        on_meshes: true,
        most_nodes: [Some(MOST_NODES_IN_PLANE), Some(MOST_NODES_IN_SPACE)],
        bytes_per_node: banded_factors,
    },
    SolverEntry {
        solver: Solver::Multigrid,
        name: "multigrid",
        in_words: "multigrid",
        description: "Full multigrid to the rounding floor: the fastest on a grid",
        run: SolverRun::Multigrid,
        most_on_square: None,
        on_meshes: true,
        most_nodes: [None; 2],
        bytes_per_node: vectors,
    },
    SolverEntry {
        solver: Solver::Spectral,
        name: "spectral",
        in_words: "spectral",
        description: "The true solution to rounding, for piecewise constant f",
        run: SolverRun::Spectral,
        most_on_square: None,
        on_meshes: false,
        most_nodes: [None; 2],
        bytes_per_node: vectors,
    },
];

impl Solver {
    /// Solvers that use a grid.
    pub const ON_GRIDS: [Self; 5] =
        [Self::ArrowHurwicz, Self::Uzawa, Self::UzawaProximal, Self::ActiveSet, Self::Multigrid];

    /// Saddle-point methods, which run over nested grids.
    pub const NESTED: &'static [Self] = &[Self::ArrowHurwicz, Self::Uzawa, Self::UzawaProximal];

    /// Entry of [`SOLVERS`].
    pub fn entry(self) -> &'static SolverEntry {
        SOLVERS.iter().find(|entry| entry.solver == self).expect("each solver has an entry")
    }

    /// True if the solver is a saddle-point method.
    pub fn is_nested(self) -> bool {
        matches!(self.entry().run, SolverRun::Nested { .. })
    }

    /// Solver with this name.
    pub fn named(name: &str) -> Option<Self> {
        SOLVERS.iter().find(|entry| entry.name == name).map(|entry| entry.solver)
    }

    /// Refuses a grid of the square with so many cells per side that the solver cannot do with.
    ///
    /// # Errors
    /// [`SizeRefusal`].
    pub fn check_cells(self, cells: usize) -> Result<(), SizeRefusal> {
        if let Some(most) = self.entry().most_on_square.filter(|&most| cells > most) {
            return Err(SizeRefusal::TooFine { solver: self, cells, most });
        }
        if self.entry().run == SolverRun::Multigrid {
            check_size(cells)?;
        }
        Ok(())
    }

    /// Refuses a mesh in `dimension` dimensions with about so many nodes that the solver cannot do with.
    ///
    /// # Errors
    /// [`SizeRefusal`].
    pub fn check_nodes(self, dimension: u8, nodes: f64) -> Result<(), SizeRefusal> {
        let entry = self.entry();
        if !entry.on_meshes {
            return Err(SizeRefusal::NotOnMeshes(self));
        }
        match entry.most_nodes[usize::from(dimension - 2)].filter(|&most| nodes > most as f64) {
            Some(most) => Err(SizeRefusal::TooManyNodes { solver: self, nodes, most }),
            None => Ok(()),
        }
    }

    /// Saddle-point method whose minimisations end at this bound on the gradient, `loose` or not as in
    /// [`Method::Uzawa`]; none for other solvers.
    pub fn method(self, inner: f64, loose: bool) -> Option<Method> {
        match self.entry().run {
            SolverRun::Nested { weight: None } => Some(Method::ArrowHurwicz),
            SolverRun::Nested { weight: Some(weight) } => {
                Some(Method::Uzawa { weight, inner, loose })
            }
            SolverRun::ActiveSet | SolverRun::Multigrid | SolverRun::Spectral => None,
        }
    }
}

impl fmt::Display for Solver {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(self.entry().name)
    }
}

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

/// Reason for which a solver does not run on a grid or mesh.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SizeRefusal {
    /// Finer than the table of solvers allows.
    #[error("grid 1/{cells} is too fine for {solver}; 1/{most} is the finest")]
    TooFine {
        /// Solver.
        solver: Solver,
        /// Cells per side.
        cells: usize,
        /// Most cells per side.
        most: usize,
    },
    /// More nodes than the table of solvers allows.
    #[error("about {nodes:.0} nodes are too many for {solver}; {most} are the most")]
    TooManyNodes {
        /// Solver.
        solver: Solver,
        /// Number of nodes, about.
        nodes: f64,
        /// Most nodes.
        most: usize,
    },
    /// The domain does not have the solver.
    #[error("{0} is for the square alone")]
    NotOnMeshes(Solver),
    /// A number of cells that cannot be halved to a coarse grid.
    #[error(transparent)]
    Cells(#[from] InputError),
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
    let Settings { solver, goal, .. } = *settings;
    let (levels, law, load) = (problem.levels(), problem.law(), problem.load());
    let (y, end) = match solver.entry().run {
        SolverRun::Nested { .. } => return solve_nested(problem, settings, monitor),
        SolverRun::ActiveSet => levels.active_set(law)?,
        SolverRun::Multigrid => {
            let params = MultigridParams { goal, ..MultigridParams::default() };
            let solved = levels.multigrid(law, &params)?;
            // Some meshes are stretched too much: factors solve those that are small enough.
            let has_ended = solved.1.stop != Stop::IterationLimit;
            let nodes = levels.nodes(problem.finest()) as f64;
            match Solver::ActiveSet.check_nodes(levels.dimension(), nodes) {
                Ok(()) if !has_ended => levels.active_set(law)?,
                _ => solved,
            }
        }
        SolverRun::Spectral => true_values(problem, solver)?,
    };
    let (judgement, level) = (problem.judge(&y), problem.finest());
    let has_solution = levels.is_solvable(level, law, load);
    let end = Outcome::new(end, &judgement, levels.cells(level), load, has_solution);
    Ok(Run { y, ends: vec![end], first_level: level, judgement })
}

/// The true solution at the nodes of the finest grid of the square, whose judgement is that of the grid.
fn true_values(problem: &Problem, solver: Solver) -> Result<(Vec<f64>, End), Refusal> {
    let lattices = problem.lattices().ok_or(Refusal::NotOnMeshes(solver))?;
    let found = true_solution(problem.law(), lattices.source())?;
    let end =
        End { iterations: found.steps, work_units: 0.0, stop: Stop::Converged, delta_a: None };
    Ok((found.solution.on_grid(lattices.finest()).y, end))
}

/// Runs a saddle-point method over all levels.
fn solve_nested(
    problem: &Problem,
    settings: &Settings,
    monitor: &mut dyn Monitor,
) -> Result<Run, Refusal> {
    let loads: Vec<Vec<f64>> = problem.loads()?.into_iter().map(Cow::into_owned).collect();
    let method = settings.solver.method(0.0, false).expect("a saddle-point method");
    let params = &Params { method, ..settings.params };
    let run = SaddleRun { params, prolongation: settings.prolongation, monitor };
    let (ends, pair) = problem.levels().saddle(problem.law().with_loads(&loads), run);
    let (level, y) = (ends.len() - 1, pair.y);
    let judgement = problem.judge_on(level, NodalVectors { y: &y, load: &loads[level] });
    Ok(Run { y, ends, first_level: 0, judgement })
}

fn vectors(_: u64) -> u64 {
    48
}

/// Two banded matrices, and the vectors.
fn banded_factors(n: u64) -> u64 {
    200 + 16 * (n + 2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_and_the_lists_agree_with_the_ways_to_run() {
        for entry in &SOLVERS {
            let nested = matches!(entry.run, SolverRun::Nested { .. });
            let without_grid = matches!(entry.run, SolverRun::Spectral);
            assert_eq!(Solver::NESTED.contains(&entry.solver), nested, "{}", entry.name);
            assert_eq!(Solver::ON_GRIDS.contains(&entry.solver), !without_grid, "{}", entry.name);
            assert_eq!(entry.solver.method(1e-3, false).is_some(), nested, "{}", entry.name);
            assert_eq!(Solver::named(entry.name), Some(entry.solver));
            assert_eq!(entry.solver.entry().name, entry.name);
            assert_eq!(
                recorded_name(entry.solver),
                entry.name,
                "records have the names of the command line"
            );
        }
    }

    /// Name under which a solver is written to records.
    fn recorded_name(solver: Solver) -> String {
        use serde::de::IntoDeserializer;
        use serde::de::value::{Error, StrDeserializer};
        for entry in &SOLVERS {
            let read: StrDeserializer<'_, Error> = entry.name.into_deserializer();
            if Solver::deserialize(read) == Ok(solver) {
                return entry.name.to_owned();
            }
        }
        String::new()
    }
}
