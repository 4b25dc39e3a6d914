//! Accuracy that a scene or an option asks for: the guaranteed bounds, and the grids that are tried to reach them.

use crate::pipeline::error::{Error, Result};
use serde::{Deserialize, Serialize};
use signorini_mathematics::bounds::{Bounds, NoBound};
use signorini_mathematics::multigrid::Goal;

/// Largest number of cells per side; two nodal vectors of that grid take about 1 GB.
pub const MAX_CELLS: usize = 8192;
/// Cells per side of the first grid.
pub(crate) const FIRST: usize = 16;
/// Cells per side from which on errors fall like a power of the width of the grid.
const SETTLED: usize = 128;
/// Largest ratio of the widths of a grid and the next one.
const STRIDE: usize = 8;

/// Largest value that a guaranteed bound may have.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Accuracy {
    /// Error in the energy norm, relative to that of the solution.
    #[serde(rename = "accuracy")]
    Error(f64),
    /// Width of the bracket of the energy, relative to the energy.
    #[serde(rename = "accuracy_energy")]
    Energy(f64),
}

/// Way in which an accuracy is written, for messages.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Written {
    /// As an option of `solve`.
    Option,
    /// As a key of a scene.
    Key,
}

impl Written {
    /// Accuracy as the user wrote it.
    pub(crate) fn text(self, accuracy: Accuracy) -> String {
        let (option, wanted) = (accuracy.option(), accuracy.wanted());
        match self {
            Self::Option => format!("--{option} {wanted:?}"),
            Self::Key => format!("{} = {wanted:?}", option.replace('-', "_")),
        }
    }

    /// Choice of the solver without grids.
    fn spectral(self) -> &'static str {
        match self {
            Self::Option => "--solver spectral",
            Self::Key => "solver = \"spectral\"",
        }
    }
}

impl Accuracy {
    /// Solves on one grid of the square after the other until the guaranteed bounds are small enough. `solve` gets the
    /// cells per side, and returns the bounds, or none if it failed and no finer grid is to be tried. All coarser
    /// grids together cost less than the last one.
    ///
    /// # Errors
    /// [`Error::Input`] if no grid reaches the accuracy, and those of `solve`.
    pub(crate) fn reach(
        self,
        written: Written,
        mut solve: impl FnMut(usize) -> Result<Option<Bounds>>,
    ) -> Result<()> {
        self.check(written)?;
        let (mut finest, mut tried) = (FIRST, Vec::new());
        while let Some(bounds) = solve(finest)? {
            let reached = self.reached(&bounds);
            if reached <= self.wanted() {
                break;
            }
            tried.push(TriedGrid { cells: finest, reached });
            finest = self.next(written, &tried)?;
        }
        Ok(())
    }

    /// Returns what a grid of the square tells: its bounds, or that a finer one is needed, whose points miss less of f.
    ///
    /// # Errors
    /// [`Error::Input`] if no grid has bounds.
    pub(crate) fn of_grid(
        self,
        written: Written,
        bounds: std::result::Result<Bounds, NoBound>,
    ) -> Result<Bounds> {
        match bounds {
            Err(NoBound::Missed { .. }) => Ok(Bounds::NONE),
            Err(reason) => {
                let asked = written.text(self);
                Err(Error::input(format!("{asked}: no bound of the error: {reason}; scale f")))
            }
            Ok(bounds) => Ok(bounds),
        }
    }

    /// Returns the goal of multigrid on a grid.
    pub(crate) fn goal(self) -> Goal {
        match self {
            Self::Error(_) => Goal::DiscretisationError,
            // The bracket of the energy is much narrower than the error.
            Self::Energy(_) => Goal::RoundingFloor,
        }
    }

    /// Returns the goal of adaptive refinement on a mesh.
    pub(crate) fn goal_on_meshes(self) -> signorini_mathematics::bounds::Accuracy {
        match self {
            Self::Error(wanted) => signorini_mathematics::bounds::Accuracy::Error(wanted),
            Self::Energy(wanted) => signorini_mathematics::bounds::Accuracy::Energy(wanted),
        }
    }

    /// Returns the name of the option.
    pub(crate) fn option(self) -> &'static str {
        match self {
            Self::Error(_) => "accuracy",
            Self::Energy(_) => "accuracy-energy",
        }
    }

    pub(crate) fn wanted(self) -> f64 {
        let (Self::Error(wanted) | Self::Energy(wanted)) = self;
        wanted
    }

    pub(crate) fn reached(self, bounds: &Bounds) -> f64 {
        match self {
            Self::Error(_) => bounds.relative(),
            Self::Energy(_) => bounds.relative_energy(),
        }
    }

    /// Returns the accepted relative error in the energy norm, whose square is that of the energy.
    pub(crate) fn error(self) -> f64 {
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
    pub(crate) fn check(self, written: Written) -> Result<()> {
        let wanted = self.wanted();
        if wanted > 0.0 && wanted < 1.0 {
            return Ok(());
        }
        let example = match self {
            Self::Error(_) => "1e-3 for an error of 0.1 % in the energy norm",
            Self::Energy(_) => "1e-6 for six digits of the energy",
        };
        let asked = written.text(self);
        Err(Error::input(format!("{asked}: must be between 0 and 1, e.g. {example}")))
    }

    /// Returns the cells per side of the grid after the last of those `tried`, whose bounds are too large.
    fn next(self, written: Written, tried: &[TriedGrid]) -> Result<usize> {
        let (asked, spectral) = (written.text(self), written.spectral());
        let TriedGrid { cells: finest, reached } = tried[tried.len() - 1];
        // Of two grids of nearly the same width the coarser may be better, if the borders of f are among its lines.
        let before = tried.iter().filter(|grid| 2 * grid.cells <= finest);
        let before = before.map(|grid| grid.reached).fold(f64::INFINITY, f64::min);
        // The relative error is infinite if the error may be as large as the solution.
        let settled = finest >= SETTLED && reached.is_finite();
        if settled && finest > SETTLED && reached >= before {
            return Err(Error::input(format!(
                "{asked}: rounding errors leave {before:.1e}; ask for less, or use {spectral}"
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
                "{asked} takes a grid {grid}, too fine for memory; 1/{MAX_CELLS} {best}, and {spectral} needs no grid"
            )));
        }
        Ok(size(needed.min(finest as f64 * STRIDE as f64)).clamp(finest + 1, MAX_CELLS))
    }
}

/// Grid that was tried, with the bound that it gave.
#[derive(Clone, Copy, Debug)]
struct TriedGrid {
    cells: usize,
    reached: f64,
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
