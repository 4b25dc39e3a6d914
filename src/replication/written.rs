//! Refusals of statements and solvers, in the words in which a user has asked.

use super::record::Adviser;
use crate::pipeline::error::Error;
use crate::replication::fields::table::Voice;
use signorini_mathematics::solvers::{Refusal, Solver};
use signorini_mathematics::statement::{Failure, Statement, StatementError};

impl Voice {
    /// Returns the error of a statement that states no problem.
    pub(crate) fn stated(self, error: &StatementError) -> Error {
        Error::input(self.sentence(error))
    }

    /// Returns that error as a sentence.
    pub(crate) fn sentence(self, error: &StatementError) -> String {
        match (self, error) {
            (Self::Keys, _) => error.to_string(),
            (_, StatementError::Field { field, value, reason }) => {
                format!("{}: {reason}", self.with_value(field, value).trim_end())
            }
            _ => error.to_string(),
        }
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
                let adviser = Adviser { statement, voice: self, found_by: statement.solver };
                let failure = Failure::NoSolution { level: level.clone(), sum_load: *sum_load };
                Error::Stage(vec![adviser.on_failure(&failure).sentence()])
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
        let text = match (refusal, statement.has_grids()) {
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
}
