//! `solve --accuracy` and `--accuracy-energy`: what is guaranteed, and the grids that are tried for it.

use crate::bounds::Bounds;
use crate::pipeline::error::{Error, Result};
use crate::replication::scene::MAX_CELLS;

/// Cells per side of the first grid.
pub(super) const FIRST: usize = 16;
/// From here on errors are known to fall like a power of the width of the grid.
const SETTLED: usize = 128;
/// Widths fall by this factor at most from one grid to the next.
const STRIDE: usize = 8;

/// The most that a guaranteed bound may be.
#[derive(Clone, Copy, Debug)]
pub(super) enum Accuracy {
    /// Error in the energy norm, relative to that of the solution.
    Error(f64),
    /// Width of the bracket of the energy, relative to the energy.
    Energy(f64),
}

impl Accuracy {
    /// The option that asks for it.
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

    /// Relative error in the energy norm that is accepted: the energy has its square.
    pub(super) fn error(self) -> f64 {
        match self {
            Self::Error(wanted) => wanted,
            Self::Energy(wanted) => wanted.sqrt(),
        }
    }

    /// The power of the width of the grid like which the bound falls.
    fn order(self) -> f64 {
        match self {
            Self::Error(_) => 1.0,
            Self::Energy(_) => 3.0,
        }
    }

    /// Refuses what is not between 0 and 1.
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

    /// The grid after the last of those tried, with what each has `reached`, which is not enough.
    pub(super) fn next(self, tried: &[(usize, f64)]) -> Result<usize> {
        let (finest, reached) = tried[tried.len() - 1];
        // Of two grids of nearly the same width the coarser may be better, if the borders of f are among its lines.
        let before = tried.iter().filter(|(cells, _)| 2 * cells <= finest);
        let before = before.map(|&(_, reached)| reached).fold(f64::INFINITY, f64::min);
        // An error that may be as large as the solution has no size relative to it.
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
                "{self} takes a grid {grid}, too fine for memory; 1/{MAX_CELLS} {best}, and --solver spectral needs no grid"
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

/// The least size of grid that multigrid takes, four to seven times a power of two, with a little to spare.
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
