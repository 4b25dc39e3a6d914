//! Words for an accuracy, as a scene or an option asks for it, and for the ways to it that end elsewhere.

use crate::pipeline::error::{Error, Result};
use signorini_mathematics::bounds::Accuracy;
use signorini_mathematics::solvers::{MOST_CELLS, ReachEnd, Refusal};
use signorini_mathematics::statement::Statement;

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
        let (option, wanted) = (option(accuracy), accuracy.wanted());
        match self {
            Self::Option => format!("--{option} {wanted:?}"),
            Self::Key => format!("{} = {wanted:?}", option.replace('-', "_")),
        }
    }

    /// Refuses a value that is not between 0 and 1.
    pub(crate) fn check(self, accuracy: Accuracy) -> Result<()> {
        let wanted = accuracy.wanted();
        if wanted > 0.0 && wanted < 1.0 {
            return Ok(());
        }
        let example = match accuracy {
            Accuracy::Error(_) => "1e-3 for an error of 0.1 % in the energy norm",
            Accuracy::Energy(_) => "1e-6 for six digits of the energy",
        };
        let asked = self.text(accuracy);
        Err(Error::input(format!("{asked}: must be between 0 and 1, e.g. {example}")))
    }

    /// Returns the error of a way to the accuracy of a statement; none if it is of the solver, or no accuracy is asked
    /// for.
    pub(crate) fn refused(self, statement: &Statement, refusal: &Refusal) -> Option<Error> {
        let asked = self.text(statement.accuracy()?);
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
        let asked = self.text(accuracy);
        let spectral = match self {
            Self::Option => "--solver spectral",
            Self::Key => "solver = \"spectral\"",
        };
        let (needed, best) = match end {
            ReachEnd::Goal | ReachEnd::NoSolution => return Ok(()),
            ReachEnd::Rounding { least } => {
                return Err(Error::input(format!(
                    "{asked}: rounding errors leave {least:.1e}; ask for less, or use {spectral}"
                )));
            }
            ReachEnd::Finest { needed, best } => (needed.unwrap_or(f64::INFINITY), best),
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

/// Returns the name of the option that asks for an accuracy.
pub(crate) fn option(accuracy: Accuracy) -> &'static str {
    match accuracy {
        Accuracy::Error(_) => "accuracy",
        Accuracy::Energy(_) => "accuracy-energy",
    }
}
