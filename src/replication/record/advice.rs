//! Remedies for warnings and failures, in the words of whoever asked.
//!
//! Central are [`Adviser::on_warning`] and [`Adviser::on_failure`]; the facts are sentences of the mathematics.

use crate::replication::fields::table::Voice;
use signorini_mathematics::discrete::load::LoadRule;
use signorini_mathematics::saddle::StopRule;
use signorini_mathematics::solvers::{ReachEnd, Solver};
use signorini_mathematics::statement::{Failure, Fineness, Statement, Warning};

/// A warning, or the reason why an answer is not what was asked for, with remedies.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Advice {
    /// Sentence without the remedies.
    pub(crate) fact: String,
    /// Empty if nothing can be done.
    pub(super) remedies: Vec<Remedy>,
}

impl Advice {
    /// Returns the fact and one remedy.
    pub(crate) fn sentence(&self) -> String {
        match &self.remedies[..] {
            [] => self.fact.clone(),
            remedies => format!("{}; {}", self.fact, combined(remedies)),
        }
    }
}

/// Advice to a user: words and, at their end, the field that follows it, as it is to be written.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Remedy {
    words: String,
    /// Empty without a field.
    field: String,
}

impl Remedy {
    pub(super) fn field(words: impl Into<String>, field: String) -> Self {
        Self { words: words.into(), field }
    }

    fn words(words: impl Into<String>) -> Self {
        Self { words: words.into(), field: String::new() }
    }
}

/// Returns one remedy in place of several: all fields that they give, each once; then, in words, those without.
pub(super) fn combined(remedies: &[Remedy]) -> String {
    let (mut fields, mut words): (Vec<&str>, Vec<&str>) = (Vec::new(), Vec::new());
    for remedy in remedies {
        let (list, text) = match &*remedy.field {
            "" => (&mut words, &*remedy.words),
            field => (&mut fields, field),
        };
        if !list.contains(&text) {
            list.push(text);
        }
    }
    match remedies {
        [first, others @ ..] if others.iter().all(|other| other == first) => {
            format!("{}{}", first.words, first.field)
        }
        _ if fields.is_empty() => words.join("; "),
        _ => {
            // The load before the solver, as in the help.
            fields.sort_unstable();
            words.insert(0, "");
            // Keys have values with spaces.
            let between = if fields[0].starts_with("--") { " " } else { ", " };
            format!("use {}{}", fields.join(between), words.join("; "))
        }
    }
}

/// Adviser on the answers to a statement: what is asked, and the words in which a user has asked it.
#[derive(Clone, Copy)]
pub(crate) struct Adviser<'a> {
    pub(crate) statement: &'a Statement,
    /// Way in which fields are written.
    pub(crate) voice: Voice,
    /// Solver that made the answer: multigrid leaves to the active set what its steps do not solve.
    pub(crate) found_by: Solver,
}

impl Adviser<'_> {
    /// Returns a warning with its remedy.
    pub(crate) fn on_warning(self, warning: &Warning) -> Advice {
        let remedy = match warning {
            Warning::Rough { .. } | Warning::Force { .. } => Some(self.closer()),
            Warning::FineStart { .. } => {
                Some(self.multigrid("choose 1/(2^k m), such as 1/64, or "))
            }
            Warning::Rounding { .. } => Some(self.other_cells()),
            Warning::Points { .. } | Warning::Quadrature { .. } => {
                Some(Remedy::words(match self.has_grids() {
                    true => format!("choose a smaller {}", self.voice.name("h")),
                    false => "write jumps of f as shapes, or refine the mesh".into(),
                }))
            }
            Warning::Load { .. } | Warning::Energy if self.takes_exact() => {
                Some(Remedy::field("use ", self.exact()))
            }
            Warning::Error { .. } if self.statement.solver != Solver::Multigrid => {
                Some(self.multigrid("refine the grid, or try "))
            }
            Warning::Load { .. } | Warning::Energy | Warning::Error { .. } => {
                Some(Remedy::words("refine the grid"))
            }
            Warning::Jumps(_) => {
                Some(Remedy::field("use ", self.voice.with_text("load", "bilinear")))
            }
            Warning::Note(_)
            | Warning::NoCoarseSolution { .. }
            | Warning::CutOff { .. }
            | Warning::Tolerance { .. }
            | Warning::NoBound(_) => None,
        };
        Advice { fact: warning.to_string(), remedies: remedy.into_iter().collect() }
    }

    /// Returns a failure with its remedy.
    pub(crate) fn on_failure(self, failure: &Failure) -> Advice {
        let Statement { solver, .. } = self.statement;
        let remedy = match failure {
            Failure::Diverged { .. } if solver.is_nested() => {
                Remedy::words("choose a smaller r or scale f down")
            }
            Failure::Diverged { .. } => Remedy::words("scale f down"),
            Failure::NoSolution { .. } => Remedy::words(self.balanced()),
            Failure::CutOff { .. } if solver.is_nested() => {
                self.multigrid(&format!("raise {}, or use ", self.voice.name("max_iterations")))
            }
            Failure::CutOff { .. } if *solver == Solver::Multigrid => self.other_cells(),
            Failure::CutOff { .. } | Failure::NotSolved { .. } => self.closer(),
            Failure::TooFine { .. } => {
                Remedy::words(format!("{} needs no grid", self.solver(Solver::Spectral)))
            }
            &Failure::Accuracy { end, has_converged, by_quadrature, takes_spectral, .. } => {
                Remedy::words(match end {
                    ReachEnd::MostNodes { .. } => "raise --most-nodes".into(),
                    ReachEnd::Interrupted { .. } => "let it run to its end".into(),
                    ReachEnd::Rounding { .. } if !has_converged => {
                        "the solver has not converged there: mesh with smaller aspects".into()
                    }
                    ReachEnd::Rounding { least: f64::INFINITY } => {
                        "leave it out where v = 0".into()
                    }
                    ReachEnd::Rounding { .. } if by_quadrature => {
                        "ask for less, or write jumps of f as shapes".into()
                    }
                    _ if takes_spectral => {
                        format!("ask for less, or use {}", self.solver(Solver::Spectral))
                    }
                    _ => "ask for less".into(),
                })
            }
        };
        Advice { fact: failure.to_string(), remedies: vec![remedy] }
    }

    fn has_grids(self) -> bool {
        self.statement.has_grids()
    }

    /// Remedy by multigrid, behind these words.
    fn multigrid(self, words: &str) -> Remedy {
        Remedy::field(words, self.solver(Solver::Multigrid))
    }

    /// Field with a solver.
    fn solver(self, solver: Solver) -> String {
        self.voice.with_text("solver", solver.entry().name)
    }

    /// Name of the field by which grids of the square are chosen.
    fn fineness(self) -> String {
        match (self.voice, &self.statement.fineness) {
            (Voice::Keys, Fineness::Grids(_)) => self.voice.name("grids"),
            _ => self.voice.name("h"),
        }
    }

    /// True if the exact load may have another sum than that of the statement.
    fn takes_exact(self) -> bool {
        matches!(self.statement.load, Some(LoadRule::Nodal { .. }))
    }

    /// Field with the exact load.
    fn exact(self) -> String {
        self.voice.with_text("load", "exact")
    }

    /// Remedy for a load vector that no flux balances.
    fn balanced(self) -> String {
        let (fineness, has_contact) = (self.fineness(), self.statement.boundary.has_contact());
        let other = if has_contact { "a lower f" } else { "a wider law" };
        match self.takes_exact() {
            true => format!("use {}, another {fineness}, or {other}", self.exact()),
            false if self.has_grids() => format!("use another {fineness} or {other}"),
            false if has_contact => "lower f somewhere".into(),
            false => "change f, or widen the law".into(),
        }
    }

    /// Returns advice for a smaller residual; each option in it goes with those that are given, and none has been
    /// tried.
    fn closer(self) -> Remedy {
        let Statement { solver, saddle, tolerance, .. } = self.statement;
        match (solver, saddle.map(|settings| settings.stop)) {
            (Solver::Multigrid, _) if self.statement.accuracy().is_some() => {
                Remedy::words("ask for a smaller accuracy")
            }
            _ if tolerance.is_some() => {
                Remedy::words(format!("ask for a smaller {}", self.voice.name("tolerance")))
            }
            (Solver::Multigrid, _) if self.found_by == Solver::ActiveSet => self.other_cells(),
            (Solver::Multigrid, _) => Remedy::field("use ", self.solver(Solver::ActiveSet)),
            (_, Some(StopRule::PrintedDual) | None) => self.multigrid("use "),
            (_, Some(_)) => {
                let rule = self.voice.with_text("stop", StopRule::PrintedDual.name());
                self.multigrid(&format!("use {rule}, or "))
            }
        }
    }

    /// Remedy for a discrete problem that no solver has solved.
    fn other_cells(self) -> Remedy {
        Remedy::words(match self.has_grids() {
            true => format!("choose another {}", self.fineness()),
            false => {
                "its cells are stretched too much; mesh with smaller aspects, or with fewer cells"
                    .into()
            }
        })
    }
}

#[cfg(test)]
mod tests;
