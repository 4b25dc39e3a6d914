//! Known solutions, by a formula or from the spectral solver, and errors against them.

use crate::discrete::grid::{Grid, nested};
use crate::discrete::load::{Diagonal, LoadRule, load};
use crate::levels::Problem;
use crate::problem::exact::Exact;
use crate::problem::law::Law;
use crate::problem::source::Source;
use crate::solvers::true_solution;
use crate::spectral::TrueSolution;

/// A problem whose solution is known.
pub(super) enum KnownSolution {
    /// By a formula.
    Formula(Exact),
    /// From the spectral solver.
    Spectral(Box<Spectral>),
}

/// A problem solved by the spectral solver.
pub(super) struct Spectral {
    /// Name.
    pub(super) name: String,
    /// Right-hand side.
    pub(super) f: Source,
    /// Solution.
    pub(super) solution: TrueSolution,
}

/// Cells per side of the grid at whose nodes solutions of the spectral solver are evaluated: a power of two.
pub(super) const SAMPLED: usize = 32;

impl KnownSolution {
    /// Solves for f in the notation of scenes.
    ///
    /// # Errors
    /// A sentence if f cannot be read, or there is no solution.
    pub(super) fn spectral(name: &str, f: &str) -> Result<Self, String> {
        let f: Source = f.parse().map_err(|e| format!("{name}: {e}"))?;
        let solution =
            true_solution(&on_square(&f, SAMPLED)?).map_err(|e| format!("{name}: {e}"))?;
        Ok(Self::Spectral(Box::new(Spectral { name: name.into(), f, solution })))
    }

    /// Name, as in `exact(name)` if there is a formula.
    pub(super) fn name(&self) -> &str {
        match self {
            Self::Formula(exact) => exact.name(),
            Self::Spectral(known) => &known.name,
        }
    }

    /// Right-hand side.
    pub(super) fn f(&self) -> Source {
        match self {
            Self::Formula(exact) => Source::from(*exact),
            Self::Spectral(known) => known.f.clone(),
        }
    }

    /// Load vector. If f jumps, f is integrated exactly, so that the discrete energy is that of `v_h`.
    pub(super) fn load(&self, grid: Grid) -> Vec<f64> {
        let rule = match self {
            Self::Formula(_) => LoadRule::default(),
            Self::Spectral(_) => LoadRule::Exact { diagonal: Diagonal::default() },
        };
        load(grid, &self.f(), rule)
    }
}

/// Problem on the grid with so many cells per side.
fn on_square(f: &Source, cells: usize) -> Result<Problem, String> {
    let grids = nested(&[cells]).map_err(|e| e.clone())?;
    Problem::on_square(grids, f.clone(), LoadRule::default(), Law::SIGNORINI)
        .map_err(|e| e.to_string())
}
