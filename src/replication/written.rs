//! Refusals of statements and solvers, in the words in which a user has asked; words for an accuracy, and for the ways
//! to it that end elsewhere.

use super::record::Judge;
use super::record::advice::{Remedy, Warning};
use crate::pipeline::error::Error;
use crate::replication::fields::table::Voice;
use signorini_mathematics::bounds::Accuracy;
use signorini_mathematics::problem::text::percent;
use signorini_mathematics::solvers::{MOST_CELLS, ReachEnd, Refusal, Solved, Solver};
use signorini_mathematics::statement::{Statement, StatementError};

impl Voice {
    /// Returns the error of a statement that states no problem.
    pub(crate) fn stated(self, error: &StatementError) -> Error {
        Error::input(match (self, error) {
            (Self::Keys, _) => error.to_string(),
            (_, StatementError::Field { field, value, reason }) => {
                format!("{}: {reason}", self.with_value(field, value).trim_end())
            }
            _ => error.to_string(),
        })
    }

    /// Returns the error of a solver that refuses the problem of a statement.
    pub(crate) fn refused(self, statement: &Statement, refusal: &Refusal) -> Error {
        if let Some(error) = self.refused_accuracy(statement, refusal) {
            return error;
        }
        let multigrid = self.with_text("solver", Solver::Multigrid.entry().name);
        let is_multigrid = statement.solver == Solver::Multigrid;
        match refusal {
            // The integral of f has been judged before.
            Refusal::Unbalanced { level, sum_load, .. } => {
                let judge = Judge { statement, voice: self, is_papers: false };
                Error::Stage(vec![judge.unbalanced(level, *sum_load).sentence()])
            }
            Refusal::GridSize(e) => Error::input(format!("{}: {e}", self.name("h"))),
            Refusal::NotInSpace(_) => {
                let solver = self.name("solver");
                Error::input(format!("{solver} {refusal}; choose another solver"))
            }
            Refusal::Spectral(e) => match e.remedy() {
                Some(remedy) => Error::input(format!("{e}; use {multigrid}, or {remedy}")),
                None => Error::Stage(vec![format!("{e}; use {multigrid}")]),
            },
            _ if is_multigrid => Error::input(format!("{refusal}; check f")),
            _ => Error::input(format!("{refusal}; check f, or use {multigrid}")),
        }
    }

    /// Returns the error of a way to the accuracy of a statement; none if it is of the solver, or no accuracy is asked
    /// for.
    fn refused_accuracy(self, statement: &Statement, refusal: &Refusal) -> Option<Error> {
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
    pub(crate) fn shortfall(self, accuracy: Accuracy, solved: &Solved) -> Option<Warning> {
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
                let bounds = solved.last_bounds()?;
                let error = error(accuracy, accuracy.reached(bounds));
                let [nodes, _] = solved.problem.lengths();
                let fact = format!("is not reached: {error} with {nodes} nodes; {}", reason(end));
                let less =
                    if solved.problem.takes_spectral() { less_or_spectral } else { "ask for less" };
                (fact, remedy(end, solved, less))
            }
        };
        Some(Warning::new(format!("{asked} {fact}"), Remedy::of_words(remedy)))
    }
}

/// Bound that was reached, in words.
pub(crate) fn error(accuracy: Accuracy, reached: f64) -> String {
    let percent = percent(reached, 3);
    match accuracy {
        _ if !reached.is_finite() => "error not below the solution".into(),
        Accuracy::Error(_) => format!("error at most {percent}"),
        Accuracy::Energy(_) => format!("error of the energy at most {percent}"),
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
