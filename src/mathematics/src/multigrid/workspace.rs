//! Public entry points: a workspace for repeated solution, and two functions for a single one.
//!
//! Nothing here is generic, so that all loops are compiled with the options of this package.

use super::hierarchy::Hierarchy;
use super::input::InputError;
use super::square::Square;
use super::{MultigridOutcome, MultigridParams};
use crate::discrete::law_and_load::LawAndLoad;
use crate::machine::threads::among_threads;

/// Preallocated grids for problems with `n` cells per side.
pub struct Multigrid {
    grids: Hierarchy<Square>,
}

impl Multigrid {
    /// Allocates grids of the square: 21.3 bytes per unknown, and padding of each row to a cache line.
    ///
    /// # Errors
    /// If `n` is not a power of two (at least 2) times 1, 3, 5 or 7.
    pub fn square(n: usize) -> Result<Self, InputError> {
        Ok(Self { grids: Hierarchy::allocate(n)? })
    }

    /// Memory that one thread needs, in bytes. Each further thread takes a few rows.
    pub fn bytes(&self) -> usize {
        self.grids.bytes()
    }

    /// Bytes per unknown that the passes of the last solve and [`Multigrid::write_solution`] move together, if each
    /// reads and writes every row once.
    ///
    /// On grids too large for the caches, this number over the bandwidth of the memory is a lower bound of the time.
    pub fn traffic(&self) -> f64 {
        self.grids.traffic()
    }

    /// Solves the problem for one load; `start`, if given, replaces the nested iteration.
    ///
    /// # Errors
    /// If a length is wrong, a number is not finite, or the flux cannot balance the load; under the paper's law, if its
    /// sum is not negative.
    pub fn solve(
        &mut self,
        problem: LawAndLoad<'_>,
        start: Option<&[f64]>,
        params: &MultigridParams,
    ) -> Result<MultigridOutcome, InputError> {
        self.grids.solve(problem, start, params)
    }

    /// Copies the solution in the order of the load.
    ///
    /// # Panics
    /// If the slice has another length.
    pub fn write_solution(&self, solution: &mut [f64]) {
        self.grids.write_solution(solution)
    }

    /// Solves the problem for one load and returns the solution with the outcome.
    fn solve_once(
        mut self,
        problem: LawAndLoad<'_>,
        start: Option<&[f64]>,
        params: &MultigridParams,
    ) -> Result<(Vec<f64>, MultigridOutcome), InputError> {
        let mut solution = vec![0.0; problem.load.len()];
        let outcome = among_threads(problem.load.len(), || {
            let outcome = self.solve(problem, start, params)?;
            self.write_solution(&mut solution);
            Ok::<_, InputError>(outcome)
        })?;
        Ok((solution, outcome))
    }
}

/// Minimises the energy `1/2 y'Ay - F'y` with the law's term at the boundary nodes of the square, under the paper's law
/// over `y >= 0` there; `A` is the five-point stiffness matrix of the natural boundary condition on a grid with `n`
/// cells per side.
///
/// The load and the solution hold `(n + 1)^2` numbers, x fastest. `start`, if given, replaces the nested iteration.
///
/// # Errors
/// If `n` is not a power of two (at least 2) times 1, 3, 5 or 7, a length is wrong, a number is not finite, or the flux
/// cannot balance the load, under the paper's law if its sum is not negative: then the energy is not bounded below, or
/// has no unique minimiser.
pub fn solve_square(
    n: usize,
    problem: LawAndLoad<'_>,
    start: Option<&[f64]>,
    params: &MultigridParams,
) -> Result<(Vec<f64>, MultigridOutcome), InputError> {
    Multigrid::square(n)?.solve_once(problem, start, params)
}
