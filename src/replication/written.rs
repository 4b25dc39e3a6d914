//! Words for an accuracy, as a scene or an option asks for it, and for the ways to it that end elsewhere.

use crate::pipeline::error::Error;
use crate::replication::fields::table::Voice;
use signorini_mathematics::bounds::Accuracy;
use signorini_mathematics::problem::text::plain;
use signorini_mathematics::solvers::{MOST_CELLS, ReachEnd, Refusal, Solved, takes_spectral};
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

    /// Returns why an answer is not as accurate as asked; none if it is, or is no solution.
    pub(crate) fn shortfall(self, accuracy: Accuracy, solved: &Solved) -> Option<Shortfall> {
        let reached = solved.reached.as_ref()?;
        let asked = self.accuracy(accuracy);
        let [less_or_spectral, needs_no_grid] = match self {
            Self::Options | Self::OverScene => {
                ["ask for less, or use --solver spectral", "--solver spectral needs no grid"]
            }
            Self::Keys => [
                "ask for less, or use solver = \"spectral\"",
                "solver = \"spectral\" needs no grid",
            ],
        };
        let (fact, remedy) = match reached.end {
            ReachEnd::Goal | ReachEnd::NoSolution => return None,
            ReachEnd::Finest { needed: Some(needed), best } => {
                let best = match best {
                    f64::INFINITY => "does not reach half".into(),
                    best => format!("reaches about {best:.1e}"),
                };
                let grid = match needed < 1e6 {
                    true => format!("of about 1/{needed:.0}"),
                    false => "finer than 1/1000000".into(),
                };
                let fact =
                    format!("takes a grid {grid}, too fine for memory; 1/{MOST_CELLS} {best}");
                (fact, needs_no_grid)
            }
            ReachEnd::Rounding { least } if reached.marks.is_none() => {
                (format!("is not reached: rounding errors leave {least:.1e}"), less_or_spectral)
            }
            end => {
                let bounds = solved.bounds().last()?.as_ref().ok()?;
                let error = error(accuracy, accuracy.reached(bounds));
                let [nodes, _] = solved.problem.lengths();
                let fact = format!("is not reached: {error} with {nodes} nodes; {}", reason(end));
                let less =
                    if takes_spectral(&solved.problem) { less_or_spectral } else { "ask for less" };
                (fact, remedy(end, solved, less))
            }
        };
        Some(Shortfall { fact: format!("{asked} {fact}"), remedy })
    }
}

/// Fact that an accuracy is not reached, with the remedy.
pub(crate) struct Shortfall {
    pub(crate) fact: String,
    pub(crate) remedy: &'static str,
}

impl From<Shortfall> for Error {
    fn from(Shortfall { fact, remedy }: Shortfall) -> Self {
        Self::input(format!("{fact}; {remedy}"))
    }
}

/// Bound that was reached, in words.
pub(crate) fn error(accuracy: Accuracy, reached: f64) -> String {
    let percent = plain(100.0 * reached, 3);
    match accuracy {
        _ if !reached.is_finite() => "error not below the solution".into(),
        Accuracy::Error(_) => format!("error at most {percent} %"),
        Accuracy::Energy(_) => format!("error of the energy at most {percent} %"),
    }
}

/// Reason for the end on adapted meshes, in words.
pub(crate) fn reason(end: ReachEnd) -> &'static str {
    match end {
        ReachEnd::Goal | ReachEnd::NoSolution => "the error is as small as asked",
        ReachEnd::Finest { .. } => "a finer mesh takes more memory than is left",
        ReachEnd::MostNodes { .. } => "a finer mesh has more nodes than was asked for",
        ReachEnd::Interrupted { .. } => "interrupted",
        ReachEnd::Rounding { .. } => "the bound of the error no longer falls",
    }
}

/// Remedy for an end on adapted meshes without the accuracy; `less` where nothing but a smaller accuracy helps.
fn remedy(end: ReachEnd, solved: &Solved, less: &'static str) -> &'static str {
    let has_converged = solved.ends().last().is_none_or(|last| last.end.has_converged());
    match end {
        ReachEnd::MostNodes { .. } => "raise --most-nodes",
        ReachEnd::Interrupted { .. } => "let it run to its end",
        ReachEnd::Rounding { .. } if !has_converged => {
            "the solver has not converged there: mesh with smaller aspects"
        }
        ReachEnd::Rounding { least: f64::INFINITY } => "leave it out where v = 0",
        ReachEnd::Rounding { .. } if solved.problem.levels().facts().by_quadrature => {
            "ask for less, or write jumps of f as shapes"
        }
        _ => less,
    }
}
