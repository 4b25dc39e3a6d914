//! Record of an answer: the failure, the warnings and the remedy that `solve`, `run`, studies, tables and Python give.
//!
//! Central is [`Record::of`]: the mathematics judges, [`Adviser`] has the remedies in the words of whoever asked.

mod advice;
pub(crate) mod details;
pub(crate) mod levels;

pub(crate) use advice::{Advice, Adviser};

use crate::replication::fields::table::Voice;
use advice::{Remedy, combined};
use signorini_mathematics::solvers::Solved;
use signorini_mathematics::statement::{Failure, Statement};
use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

/// Warnings and failure of an answer, beside its numbers.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Record {
    pub(crate) warnings: Vec<Advice>,
    /// Reason why the answer is not what was asked for.
    pub(crate) failure: Option<Advice>,
    /// False if the answer is no solution, whatever its accuracy.
    pub(crate) is_solution: bool,
    /// Distance of the energy from that of the true solution, over that; none unless it is asked for and known.
    pub(crate) error_true: Option<f64>,
}

impl Record {
    /// Judges the answer to a statement, with remedies in this voice.
    pub(crate) fn of((statement, voice): (&Statement, Voice), solved: &Solved) -> Self {
        let judged = statement.judged(solved);
        let found_by = solved.run().map_or(statement.solver, |run| run.solver);
        let adviser = Adviser { statement, voice, found_by };
        let mut warnings: Vec<_> =
            judged.warnings.iter().map(|of| adviser.on_warning(of)).collect();
        let mut error_true = None;
        if statement.with_truth {
            match true_energy(statement, solved) {
                Ok(truth) => error_true = Some(((solved.energy() - truth) / truth).abs()),
                Err(reason) => warnings.push(Advice {
                    fact: format!("no true solution to compare with: {reason}"),
                    remedies: vec![Remedy::field("leave out ", voice.name("compare"))],
                }),
            }
        }
        let is_solution = judged.failure.as_ref().is_none_or(Failure::is_of_accuracy);
        let failure = judged.failure.map(|failure| {
            let mut advice = adviser.on_failure(&failure);
            // Any of the doubts may be the reason.
            if let Failure::NotSolved { .. } = failure {
                advice.remedies.extend(remedies(&warnings));
            }
            advice
        });
        Self { warnings, failure, is_solution, error_true }
    }

    /// Facts of the warnings, without advice.
    pub(crate) fn facts(&self) -> Vec<String> {
        self.warnings.iter().map(|warning| warning.fact.clone()).collect()
    }

    /// Returns one remedy for the failure and all warnings; what is no solution has its own.
    pub(crate) fn remedy(&self) -> Option<String> {
        let mut all: Vec<Remedy> =
            self.failure.iter().flat_map(|failure| failure.remedies.clone()).collect();
        if self.is_solution {
            all.extend(remedies(&self.warnings));
        }
        (!all.is_empty()).then(|| combined(&all))
    }

    /// Returns the warnings a line each; where several have a remedy, the last line has one remedy for all. If the
    /// answer is no solution, the error has the remedy.
    pub(crate) fn lines(&self) -> String {
        let remedies = remedies(&self.warnings);
        let mut text = String::new();
        for warning in &self.warnings {
            let is_whole = remedies.len() < 2 && self.is_solution;
            let shown = if is_whole { warning.sentence() } else { warning.fact.clone() };
            text += &format!("warning: {shown}\n");
        }
        if remedies.len() > 1 && self.is_solution {
            text += &format!("remedy for all: {}\n", combined(&remedies));
        }
        text
    }
}

/// Energies of true solutions that were found before, or the reasons for none, by what their problems depend on.
static TRUE_ENERGIES: Mutex<BTreeMap<String, Result<f64, String>>> = Mutex::new(BTreeMap::new());

/// Energy of the true solution of the problem of a statement, of which this is an answer.
fn true_energy(
    Statement { domain, boundary, f, k, reaction, .. }: &Statement,
    solved: &Solved,
) -> Result<f64, String> {
    let problem = format!("{domain:?} {boundary:?} {f} {k:?} {reaction:?}");
    let known = TRUE_ENERGIES.lock().unwrap_or_else(PoisonError::into_inner).get(&problem).cloned();
    // Not under the lock: threads that wait for it could not help to find the solution.
    known.unwrap_or_else(|| {
        let found = solved.problem.true_solution();
        let found = found.map(|found| found.energy).map_err(|e| e.to_string());
        let mut all = TRUE_ENERGIES.lock().unwrap_or_else(PoisonError::into_inner);
        all.entry(problem).or_insert(found).clone()
    })
}

/// Remedies of warnings, in their order.
fn remedies(warnings: &[Advice]) -> Vec<Remedy> {
    warnings.iter().flat_map(|warning| warning.remedies.clone()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn warnings_have_their_remedies_or_one_for_all() {
        let warning = |fact: &str, remedies: &[Remedy]| Advice {
            fact: fact.into(),
            remedies: remedies.to_vec(),
        };
        let load = Remedy::field("use ", "--load exact".into());
        let solver = Remedy::field("use this, or ", "--solver multigrid".into());
        let warnings = [warning("a", &[solver]), warning("b", &[]), warning("c", &[load])];
        let record = |count: usize, is_solution| Record {
            warnings: warnings[..count].to_vec(),
            failure: None,
            is_solution,
            error_true: None,
        };
        assert_eq!(
            record(2, true).lines(),
            "warning: a; use this, or --solver multigrid\nwarning: b\n"
        );
        let facts = "warning: a\nwarning: b\nwarning: c\n";
        let remedy = "use --load exact --solver multigrid";
        assert_eq!(record(3, true).lines(), format!("{facts}remedy for all: {remedy}\n"));
        assert_eq!(record(3, true).remedy().unwrap(), remedy);
        assert_eq!((record(3, false).lines(), record(3, false).remedy()), (facts.into(), None));
    }
}
