//! Solvers by their names.

use serde::{Deserialize, Serialize};

/// Solver, by the names of [`SOLVERS`](super::SOLVERS).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Solver {
    /// The paper's method.
    ArrowHurwicz,
    /// Uzawa's method.
    Uzawa,
    /// Uzawa's method, each minimisation as far as it is of use.
    UzawaLoose,
    /// Uzawa's method with the proximal term.
    UzawaProximal,
    /// Primal-dual active set.
    ActiveSet,
    /// Full multigrid.
    Multigrid,
    /// True solution, by powers at corners and ends of contact.
    Spectral,
}
