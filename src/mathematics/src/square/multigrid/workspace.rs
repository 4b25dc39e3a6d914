//! Public entry points: a workspace for repeated solution, and a function for a single one.

use super::coarsest::Coarsest;
use super::level::MultigridLevel;
use crate::discrete::end::End;
use crate::machine::threads::among_threads;
use crate::multigrid::{InputError, MultigridParams, check_size};
use crate::problem::law::{Law, OneSided};

/// Preallocated grids of the square for problems with `n` cells per side.
pub struct Multigrid {
    /// All grids, coarsest first.
    pub(super) levels: Vec<MultigridLevel>,
    pub(super) coarsest: Coarsest,
    pub(super) springs: SpringSource,
    /// Problem as given, seen as the one that is solved.
    pub(super) one_sided: OneSided,
    /// Flow through the boundary that balances the load.
    pub(super) needed: f64,
    /// Largest flux, in the units of the problem.
    pub(super) limit: f64,
    /// Power of two by which the load is divided, so that no residual overflows or underflows.
    pub(super) scale: f64,
    /// Norm of the load on the finest grid but one, before a residual takes its place.
    pub(super) coarse_load: f64,
    pub(super) work_units: f64,
}

/// Contact set from which the springs of the coarser grids were made.
pub(super) struct SpringSource {
    /// Cells per side of the grid of the contact set; `None` if there are no springs yet.
    pub(super) cells: Option<usize>,
    /// Flag for each boundary node of that grid.
    pub(super) in_contact: Vec<bool>,
}

impl Multigrid {
    /// Allocates grids of the square: 21.3 bytes per unknown, and padding of each row to a cache line.
    ///
    /// # Errors
    /// If `n` is not a power of two (at least 2) times 1, 3, 5 or 7.
    pub fn square(n: usize) -> Result<Self, InputError> {
        let coarsest = check_size(n)?;
        let cells = std::iter::successors(Some(coarsest), |cells| Some(2 * cells));
        Ok(Self {
            levels: cells.take_while(|&cells| cells <= n).map(MultigridLevel::new).collect(),
            coarsest: Coarsest::new(coarsest),
            springs: SpringSource { cells: None, in_contact: Vec::new() },
            one_sided: OneSided { is_reflected: false },
            needed: 0.0,
            limit: f64::INFINITY,
            scale: 1.0,
            coarse_load: 0.0,
            work_units: 0.0,
        })
    }
}

/// Minimises the energy `1/2 y'Ay - F'y` with the law's term at the boundary nodes of the square, under the paper's law
/// over `y >= 0` there; `A` is the five-point stiffness matrix of the natural boundary condition on a grid with `n`
/// cells per side.
///
/// The load and the solution hold `(n + 1)^2` numbers, x fastest.
///
/// # Errors
/// If `n` is not a power of two (at least 2) times 1, 3, 5 or 7, a length is wrong, a number is not finite, or the flux
/// cannot balance the load, under the paper's law if its sum is not negative: then the energy is not bounded below, or
/// has no unique minimiser.
pub fn solve_square(
    n: usize,
    law: Law,
    load: &[f64],
    params: &MultigridParams,
) -> Result<(Vec<f64>, End), InputError> {
    let mut grids = Multigrid::square(n)?;
    let mut solution = vec![0.0; load.len()];
    let outcome = among_threads(load.len(), || {
        let outcome = grids.solve(law, load, params)?;
        grids.write_solution(&mut solution);
        Ok::<_, InputError>(outcome)
    })?;
    Ok((solution, outcome))
}
