//! `solve --accuracy` and `--accuracy-energy`: the guaranteed bounds, and the grids that are tried to reach them.

use crate::pipeline::error::{Error, Result};
use crate::replication::scene::MAX_CELLS;
use signorini_mathematics::bounds::Bounds;

/// Cells per side of the first grid.
pub(super) const FIRST: usize = 16;
/// Cells per side from which on errors fall like a power of the width of the grid.
const SETTLED: usize = 128;
/// Largest ratio of the widths of a grid and the next one.
const STRIDE: usize = 8;

/// Largest value that a guaranteed bound may have.
#[derive(Clone, Copy, Debug)]
pub(super) enum Accuracy {
    /// Error in the energy norm, relative to that of the solution.
    Error(f64),
    /// Width of the bracket of the energy, relative to the energy.
    Energy(f64),
}

impl Accuracy {
    /// Returns the name of the option.
    pub(super) fn option(self) -> &'static str {
        match self {
            Self::Error(_) => "accuracy",
            Self::Energy(_) => "accuracy-energy",
        }
    }

    pub(super) fn wanted(self) -> f64 {
        let (Self::Error(wanted) | Self::Energy(wanted)) = self;
        wanted
    }

    pub(super) fn reached(self, bounds: &Bounds) -> f64 {
        match self {
            Self::Error(_) => bounds.relative(),
            Self::Energy(_) => bounds.relative_energy(),
        }
    }

    /// Returns the accepted relative error in the energy norm, whose square is that of the energy.
    pub(super) fn error(self) -> f64 {
        match self {
            Self::Error(wanted) => wanted,
            Self::Energy(wanted) => wanted.sqrt(),
        }
    }

    /// Returns the order of the bound: the power of the width of the grid that is proportional to it.
    fn order(self) -> f64 {
        match self {
            Self::Error(_) => 1.0,
            Self::Energy(_) => 3.0,
        }
    }

    /// Refuses a value that is not between 0 and 1.
    pub(super) fn check(self) -> Result<()> {
        let wanted = self.wanted();
        if wanted > 0.0 && wanted < 1.0 {
            return Ok(());
        }
        let example = match self {
            Self::Error(_) => "1e-3 for an error of 0.1 % in the energy norm",
            Self::Energy(_) => "1e-6 for six digits of the energy",
        };
        Err(Error::input(format!("{self}: must be between 0 and 1, e.g. {example}")))
    }

    /// Returns the cells per side of the grid after the last of those `tried`, whose bounds are too large.
    pub(super) fn next(self, tried: &[TriedGrid]) -> Result<usize> {
        let TriedGrid { cells: finest, reached } = tried[tried.len() - 1];
        // Of two grids of nearly the same width the coarser may be better, if the borders of f are among its lines.
        let before = tried.iter().filter(|grid| 2 * grid.cells <= finest);
        let before = before.map(|grid| grid.reached).fold(f64::INFINITY, f64::min);
        // The relative error is infinite if the error may be as large as the solution.
        let settled = finest >= SETTLED && reached.is_finite();
        if settled && finest > SETTLED && reached >= before {
            return Err(Error::input(format!(
                "{self}: rounding errors leave {before:.1e}; ask for less, or use --solver spectral"
            )));
        }
        let order = self.order();
        let needed = finest as f64 * libm::pow(reached / self.wanted(), 1.0 / order);
        let last = MAX_CELLS as f64;
        if finest == MAX_CELLS || (settled && needed > 1.02 * last) {
            let best = match reached * libm::pow(finest as f64 / last, order) {
                f64::INFINITY => "does not reach half".into(),
                best => format!("reaches about {best:.1e}"),
            };
            let grid = match needed < 1e6 {
                true => format!("of about 1/{needed:.0}"),
                false => "finer than 1/1000000".into(),
            };
            return Err(Error::input(format!(
                "{self} takes a grid {grid}, too fine for memory; 1/{MAX_CELLS} {best}, and --solver spectral needs \
                 no grid"
            )));
        }
        Ok(size(needed.min(finest as f64 * STRIDE as f64)).clamp(finest + 1, MAX_CELLS))
    }
}

impl std::fmt::Display for Accuracy {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(out, "--{} {:?}", self.option(), self.wanted())
    }
}

/// Grid that was tried, with the bound that it gave.
#[derive(Clone, Copy, Debug)]
pub(super) struct TriedGrid {
    pub cells: usize,
    pub reached: f64,
}

/// Returns the least number of cells per side from 1.003 times `needed` on that multigrid takes: four to seven times a
/// power of two.
fn size(needed: f64) -> usize {
    let needed = (1.003 * needed).ceil() as usize;
    let mut unit = 2;
    while 8 * unit < needed {
        unit *= 2;
    }
    unit * needed.div_ceil(unit).max(4)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_suit_multigrid_and_are_hardly_finer_than_needed() {
        for needed in 9..5000 {
            let n = size(f64::from(needed));
            let odd = n >> n.trailing_zeros();
            assert!(odd <= 7 && n as f64 >= f64::from(needed), "{needed} {n}");
            assert!((n as f64) < 1.3 * f64::from(needed) + 2.0, "{needed} {n}");
        }
    }
}
