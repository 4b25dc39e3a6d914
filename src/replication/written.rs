//! Words for an accuracy, as a scene or an option asks for it, and for the ways to it that end elsewhere.

use crate::pipeline::error::{Error, Result};
use crate::replication::fields::table::Voice;
use signorini_mathematics::bounds::Accuracy;
use signorini_mathematics::solvers::{MOST_CELLS, ReachEnd, Refusal};
use signorini_mathematics::statement::Statement;

impl Voice {
    /// Returns the error of a way to the accuracy of a statement; none if it is of the solver, or no accuracy is asked
    /// for.
    pub(crate) fn refused(self, statement: &Statement, refusal: &Refusal) -> Option<Error> {
        let asked = self.accuracy(statement.accuracy()?);
        let text = match (refusal, statement.domain.is_square()) {
            (Refusal::Interrupted, _) => return Some(Error::Interrupted),
            (e @ Refusal::NoBound(_), true) => format!("{asked}: {e}; scale f"),
            (Refusal::Size(e), true) => e.on_grid(&format!("{asked}: grid 1/{}", e.finest)),
            (_, true) => return None,
            (Refusal::Mesh(e), false) => {
                format!("{}: {e}", statement.domain.name)
            }
            (e @ Refusal::NotInPlane, false) => {
                format!("{asked}: {e}; in space, choose how fine by the number of refinements")
            }
            (e, false) => format!("{asked}: {e}"),
        };
        Some(Error::input(text))
    }

    /// Refuses an accuracy that no grid of the square reaches.
    pub(crate) fn check_end(self, accuracy: Accuracy, end: ReachEnd) -> Result<()> {
        let asked = self.accuracy(accuracy);
        let spectral = match self {
            Self::Options | Self::OverScene => "--solver spectral",
            Self::Keys => "solver = \"spectral\"",
        };
        let (needed, best) = match end {
            ReachEnd::Goal | ReachEnd::NoSolution => return Ok(()),
            ReachEnd::Interrupted { .. } => return Err(Error::Interrupted),
            ReachEnd::Rounding { least } => {
                return Err(Error::input(format!(
                    "{asked}: rounding errors leave {least:.1e}; ask for less, or use {spectral}"
                )));
            }
            ReachEnd::Finest { needed, best } => (needed.unwrap_or(f64::INFINITY), best),
            ReachEnd::MostNodes { best } => (f64::INFINITY, best),
        };
        let best = match best {
            f64::INFINITY => "does not reach half".into(),
            best => format!("reaches about {best:.1e}"),
        };
        let grid = match needed < 1e6 {
            true => format!("of about 1/{needed:.0}"),
            false => "finer than 1/1000000".into(),
        };
        Err(Error::input(format!(
            "{asked} takes a grid {grid}, too fine for memory; 1/{MOST_CELLS} {best}, and {spectral} needs no grid"
        )))
    }
}
