//! Differences between the square and the cube.

use super::level::MultigridLevel;
use super::transfer::Weighting;

/// Number of visits to each of the coarsest grids per visit to the next finer one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Visits {
    Single,
    Double,
}

/// Parameters and operations that differ between the square and the cube, in addition to the transfers.
pub(super) trait MultigridGeometry: Weighting + Sized {
    /// Description of the numbers of cells per side that can be used.
    const CELLS: &str;
    /// Over-relaxation factor inside, for the colour that the neighbouring transfers do not read or write.
    const RELAXATION: f64;
    /// Over-relaxation factor of the half-sweeps that begin and end a visit to a correction problem.
    const COARSE_RELAXATION: f64;
    /// Factor of the corrections to the problem under the law.
    const OVERCORRECTION: f64;
    /// Number of grids from the finest down to the first grid that is visited twice.
    const DOUBLE_VISITS_BELOW: usize;
    /// Number of visits to coarser grids during the second of two visits: `Double` is a W-cycle, `Single` an F-cycle.
    const IN_SECOND_VISIT: Visits;

    /// Returns the cells per side of the coarsest grid for `n` cells per side, or `None` if `n` cannot be used.
    fn coarsest(n: usize) -> Option<usize>;

    /// Sets `1 / (2 d + spring)` on all `levels`, coarsest first, for the contact set of a finer grid with `n` cells
    /// per side. Returns the work in visits of unknowns.
    fn set_springs(n: usize, in_contact: &[bool], levels: &mut [MultigridLevel]) -> f64;
}
