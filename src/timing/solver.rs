//! The solvers by their names: on the command line, in the record of times, in pictures.

use clap::ValueEnum;
use serde::{Deserialize, Serialize};
use std::fmt;

/// Solver. The descriptions of the variants are those of `solve --help`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Solver {
    /// The paper's method on nested grids
    ArrowHurwicz,
    /// A full minimisation before each step of the multiplier, on nested grids
    Uzawa,
    /// The same with iterative proximal regularisation
    UzawaProximal,
    /// Primal-dual active set with banded Cholesky factors: slow, independent, exact; down to 1/256, on the cube to 1/24
    ActiveSet,
    /// Full multigrid to the rounding floor: the fastest on a grid
    Multigrid,
    /// The true solution to rounding, for piecewise constant f
    Spectral,
}

impl Solver {
    /// Solvers that use a grid.
    pub const ON_GRIDS: [Self; 5] =
        [Self::ArrowHurwicz, Self::Uzawa, Self::UzawaProximal, Self::ActiveSet, Self::Multigrid];

    /// Saddle-point methods, which run over nested grids.
    pub const NESTED: &'static [Self] = &[Self::ArrowHurwicz, Self::Uzawa, Self::UzawaProximal];

    /// Returns the name in sentences and legends.
    pub fn in_words(self) -> &'static str {
        match self {
            Self::ArrowHurwicz => "Arrow-Hurwicz",
            Self::Uzawa => "Uzawa",
            Self::UzawaProximal => "proximal Uzawa",
            Self::ActiveSet => "active set",
            Self::Multigrid => "multigrid",
            Self::Spectral => "spectral",
        }
    }
}

impl fmt::Display for Solver {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let value = self.to_possible_value().expect("no solver is hidden");
        out.write_str(value.get_name())
    }
}
