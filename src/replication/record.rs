//! Record of an answer: the failure, the warnings and the remedy that `solve`, `run`, studies, tables and Python give.
//!
//! Central is [`Judge::record`], the one judge of answers; [`advice`] has the words.

pub(crate) mod advice;
pub(crate) mod details;
mod judging;
pub(crate) mod levels;

pub(crate) use judging::{CONTACT_FORCE, FLUX, Judge, load_misses};

use advice::{Remedy, Warning, combined, remedies};

/// Warnings and failure of an answer, beside its numbers.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Record {
    pub(crate) warnings: Vec<Warning>,
    /// Reason why the answer is no solution.
    pub(crate) failure: Option<Warning>,
    /// Reason why the solution is not as accurate as asked.
    pub(crate) shortfall: Option<Warning>,
}

impl Record {
    /// Reason why the answer is not what was asked for.
    pub(crate) fn refusal(&self) -> Option<&Warning> {
        self.failure.as_ref().or(self.shortfall.as_ref())
    }

    /// Facts of the warnings, without advice.
    pub(crate) fn facts(&self) -> Vec<String> {
        self.warnings.iter().map(|warning| warning.fact.clone()).collect()
    }

    /// Returns one advice for the failure and all warnings; what is no solution has its own.
    pub(crate) fn remedy(&self) -> Option<String> {
        let mut all: Vec<Remedy> = Vec::new();
        all.extend(self.refusal().into_iter().flat_map(|failure| failure.remedies.clone()));
        if self.failure.is_none() {
            all.extend(remedies(&self.warnings));
        }
        (!all.is_empty()).then(|| combined(&all))
    }
}

/// Texts, each once, with those of whom they are said, in the order of the first.
#[derive(Default)]
pub(crate) struct Grouped(Vec<(String, Vec<String>)>);

impl Grouped {
    /// Adds a text that is said of `whom`.
    pub(crate) fn add(&mut self, text: String, whom: String) {
        match self.0.iter_mut().find(|(known, _)| *known == text) {
            Some((_, all)) => all.push(whom),
            None => self.0.push((text, vec![whom])),
        }
    }

    /// The first texts, `most` of them.
    pub(crate) fn first(&self, most: usize) -> &[(String, Vec<String>)] {
        &self.0[..self.0.len().min(most)]
    }

    /// Number of the other texts.
    pub(crate) fn beyond(&self, most: usize) -> usize {
        self.0.len().saturating_sub(most)
    }
}
