//! Solvers in one table: names, domains, memory, how each runs and how it stops.
//!
//! A new solver is an entry of [`SOLVERS`] and a room of its own.

use crate::discrete::law_and_load::LawAndLoad;
use crate::discrete::stop::Stop;
use crate::multigrid::active_set::{ActiveSetOutcome, MOST_CELLS, active_set};
use crate::multigrid::{InputError, MultigridOutcome, MultigridParams, solve_square};
use crate::saddle::Method;
use serde::{Deserialize, Serialize};
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
    /// Bytes per node of all vectors and factors on the square, for the cells per side: measured, rounded up.
    pub bytes_per_node: fn(u64) -> u64,
}

/// Way in which a solver runs and stops.
#[derive(Clone, Copy)]
pub enum SolverRun {
    /// Saddle-point method over nested grids, until its stopping rule is met.
    Nested {
        /// Weight of the proximal term in a minimisation before each step of the multiplier; none for a single sweep.
        weight: Option<f64>,
    },
    /// Solve on the finest grid alone.
    Finest {
        /// Solve on the square.
        square: SolveOnGrid,
        /// True if the solve stops at a goal; false if it stops where its contact set is at rest.
        takes_goal: bool,
    },
    /// Solution without a grid, at a given resolution.
    Spectral,
}

/// Solve on the grid with this number of cells per side, for a law and a load vector, with the goal of these
/// parameters.
pub type SolveOnGrid = fn(usize, LawAndLoad<'_>, &MultigridParams) -> Result<FinestRun, InputError>;

/// Solvers, in the order of the help.
pub const SOLVERS: [SolverEntry; 6] = [
    SolverEntry {
        solver: Solver::ArrowHurwicz,
        name: "arrow-hurwicz",
        in_words: "Arrow-Hurwicz",
        description: "The paper's method on nested grids",
        run: SolverRun::Nested { weight: None },
        most_on_square: None,
        bytes_per_node: vectors,
    },
    SolverEntry {
        solver: Solver::Uzawa,
        name: "uzawa",
        in_words: "Uzawa",
        description: "Uzawa's method on nested grids: a full minimisation before each step of the multiplier",
        run: SolverRun::Nested { weight: Some(0.0) },
        most_on_square: None,
        bytes_per_node: vectors,
    },
    SolverEntry {
        solver: Solver::UzawaProximal,
        name: "uzawa-proximal",
        in_words: "proximal Uzawa",
        description: "Uzawa's method with iterative proximal regularisation",
        run: SolverRun::Nested { weight: Some(1.0) },
        most_on_square: None,
        bytes_per_node: vectors,
    },
    SolverEntry {
        solver: Solver::ActiveSet,
        name: "active-set",
        in_words: "active set",
        description: "Primal-dual active set with banded Cholesky factors: slow, independent, exact; on the square \
            down to 1/256",
        run: SolverRun::Finest {
            square: |n, LawAndLoad { law, load }, _| {
                active_set(n, law, load).map(FinestRun::of_active_set)
            },
            takes_goal: false,
        },
        most_on_square: Some(MOST_CELLS),
        bytes_per_node: banded_factors,
    },
    SolverEntry {
        solver: Solver::Multigrid,
        name: "multigrid",
        in_words: "multigrid",
        description: "Full multigrid to the rounding floor: the fastest on a grid",
        run: SolverRun::Finest {
            square: |n, problem, params| {
                solve_square(n, problem, None, params).map(FinestRun::of_multigrid)
            },
            takes_goal: true,
        },
        most_on_square: None,
        bytes_per_node: vectors,
    },
    SolverEntry {
        solver: Solver::Spectral,
        name: "spectral",
        in_words: "spectral",
        description: "The true solution to rounding, for piecewise constant f",
        run: SolverRun::Spectral,
        most_on_square: None,
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

    /// Saddle-point method whose minimisations end at this bound on the gradient, `loose` or not as in
    /// [`Method::Uzawa`]; none for other solvers.
    pub fn method(self, inner: f64, loose: bool) -> Option<Method> {
        match self.entry().run {
            SolverRun::Nested { weight: None } => Some(Method::ArrowHurwicz),
            SolverRun::Nested { weight: Some(weight) } => {
                Some(Method::Uzawa { weight, inner, loose })
            }
            SolverRun::Finest { .. } | SolverRun::Spectral => None,
        }
    }
}

impl fmt::Display for Solver {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(self.entry().name)
    }
}

/// Run of a solver on the finest grid alone.
pub struct FinestRun {
    /// Nodal values of the solution.
    pub y: Vec<f64>,
    /// Cycles, or changes of the contact set.
    pub iterations: usize,
    /// End of the run.
    pub stop: Stop,
    /// Cost in sweeps of the finest grid, if the solver counts it.
    pub work_units: Option<f64>,
}

impl FinestRun {
    /// Run of multigrid.
    pub fn of_multigrid((y, outcome): (Vec<f64>, MultigridOutcome)) -> Self {
        let MultigridOutcome { cycles, stop, work_units, .. } = outcome;
        Self { y, iterations: cycles, stop, work_units: Some(work_units) }
    }

    /// Run of the active set method.
    pub fn of_active_set((y, outcome): (Vec<f64>, ActiveSetOutcome)) -> Self {
        Self { y, iterations: outcome.steps, stop: outcome.stop, work_units: None }
    }
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
