//! Solvers in one table: names, domains, memory, and the function that runs each.

use super::run::{FoundSolution, active_set, multigrid, saddle, truth};
use super::{Refusal, Settings, Solver};
use crate::levels::Problem;
use crate::multigrid::active_set::{MOST_CELLS, MOST_NODES_IN_PLANE, MOST_NODES_IN_SPACE};
use crate::saddle::{Method, Monitor};
use std::fmt;

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
    /// Solves a problem; only a saddle-point method shows its iterations to the monitor.
    pub run: fn(&Problem, &Settings, &mut dyn Monitor) -> Result<FoundSolution, Refusal>,
    /// Saddle-point method that runs over all levels, until its stopping rule is met; none for other solvers.
    pub method: Option<Method>,
    /// True if it solves discrete problems, and not the problem itself.
    pub is_discrete: bool,
    /// True if it solves in space as well as in the plane.
    pub in_space: bool,
    /// Most cells per side on the square; none if memory is the only limit.
    pub most_on_square: Option<usize>,
    /// Most nodes of a mesh in the plane and in space; none if memory is the only limit.
    pub most_nodes: [Option<usize>; 2],
    /// Bytes per node of all vectors and factors on the square, for the cells per side: measured, rounded up.
    pub bytes_per_node: fn(u64) -> u64,
}

/// Saddle-point method on nested levels.
const NESTED: SolverEntry = SolverEntry {
    solver: Solver::ArrowHurwicz,
    name: "arrow-hurwicz",
    in_words: "Arrow-Hurwicz",
    description: "The paper's method on nested grids",
    run: saddle,
    method: Some(Method::ArrowHurwicz),
    is_discrete: true,
    in_space: true,
    most_on_square: None,
    most_nodes: [None; 2],
    bytes_per_node: vectors,
};

/// Solvers, in the order of the help.
pub const SOLVERS: [SolverEntry; 7] = [
    NESTED,
    SolverEntry {
        solver: Solver::Uzawa,
        name: "uzawa",
        in_words: "Uzawa",
        description: "Uzawa's method on nested grids: a full minimisation before each step of the multiplier",
        method: Some(Method::Uzawa { weight: 0.0, inner: 0.0, loose: false }),
        ..NESTED
    },
    SolverEntry {
        solver: Solver::UzawaLoose,
        name: "uzawa-loose",
        in_words: "loose Uzawa",
        description: "Uzawa's method, each minimisation to a tenth of its gradient",
        method: Some(Method::Uzawa { weight: 0.0, inner: 0.0, loose: true }),
        ..NESTED
    },
    SolverEntry {
        solver: Solver::UzawaProximal,
        name: "uzawa-proximal",
        in_words: "proximal Uzawa",
        description: "Uzawa's method with iterative proximal regularisation",
        method: Some(Method::Uzawa { weight: 1.0, inner: 0.0, loose: false }),
        ..NESTED
    },
    SolverEntry {
        solver: Solver::ActiveSet,
        name: "active-set",
        in_words: "active set",
        description: "Primal-dual active set with sparse Cholesky factors: slow, independent, exact; on the square \
            down to 1/256",
        run: active_set,
        method: None,
        most_on_square: Some(MOST_CELLS),
        most_nodes: [Some(MOST_NODES_IN_PLANE), Some(MOST_NODES_IN_SPACE)],
        bytes_per_node: banded_factors,
        ..NESTED
    },
    SolverEntry {
        solver: Solver::Multigrid,
        name: "multigrid",
        in_words: "multigrid",
        description: "Full multigrid to the rounding floor: the fastest on a grid",
        run: multigrid,
        method: None,
        ..NESTED
    },
    SolverEntry {
        solver: Solver::Spectral,
        name: "spectral",
        in_words: "spectral",
        description: "The true solution in the plane, with a guaranteed bracket",
        run: truth,
        method: None,
        is_discrete: false,
        in_space: false,
        ..NESTED
    },
];

impl Solver {
    /// Solvers that use a grid.
    pub fn on_grids() -> Vec<Self> {
        Self::with(|entry| entry.is_discrete)
    }

    /// Saddle-point methods, which run over nested grids.
    pub fn nested() -> Vec<Self> {
        Self::with(|entry| entry.method.is_some())
    }

    /// Solvers whose entries have a property, in their order.
    fn with(property: impl Fn(&SolverEntry) -> bool) -> Vec<Self> {
        SOLVERS.iter().filter(|entry| property(entry)).map(|entry| entry.solver).collect()
    }

    /// Entry of [`SOLVERS`].
    pub fn entry(self) -> &'static SolverEntry {
        SOLVERS.iter().find(|entry| entry.solver == self).expect("each solver has an entry")
    }

    /// True if the solver is a saddle-point method.
    pub fn is_nested(self) -> bool {
        self.entry().method.is_some()
    }

    /// Solver with this name.
    pub fn named(name: &str) -> Option<Self> {
        SOLVERS.iter().find(|entry| entry.name == name).map(|entry| entry.solver)
    }
}

impl fmt::Display for Solver {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(self.entry().name)
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
    use serde::Deserialize;

    #[test]
    fn names_are_those_of_records_and_lists_follow_from_the_table() {
        for entry in &SOLVERS {
            assert_eq!(Solver::named(entry.name), Some(entry.solver));
            assert_eq!(entry.solver.entry().name, entry.name);
            assert_eq!(
                recorded_name(entry.solver),
                entry.name,
                "records have the names of the command line"
            );
        }
        let nested = Solver::nested();
        let uzawa = [Solver::Uzawa, Solver::UzawaLoose, Solver::UzawaProximal];
        assert_eq!(nested, [&[Solver::ArrowHurwicz], &uzawa[..]].concat());
        assert_eq!(
            Solver::on_grids(),
            [&nested[..], &[Solver::ActiveSet, Solver::Multigrid]].concat()
        );
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
