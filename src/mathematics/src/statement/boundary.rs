//! Laws on the parts of the boundary of a statement, by their numbers.

use super::StatementError;
use crate::problem::formula::Formula;
use crate::problem::law::{Law, LawNumber};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// One table for the whole boundary: for each part that is named, and under the empty name for all others, the numbers
/// of its law; in place of its value, or of the flux of a free part, there may be a formula. Where nothing is said, the
/// law is the paper's.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Boundary {
    parts: BTreeMap<String, BTreeMap<LawNumber, Formula>>,
}

impl Boundary {
    /// Boundary with one law on all of it.
    pub fn under(of: LawNumber, number: impl Into<Formula>) -> Self {
        Self::default().with("", of, number)
    }

    /// The boundary with this number on a part, or under the empty name on all parts that are not named; a law takes
    /// the place of another one there, and of numbers that do not go with it.
    #[must_use]
    pub fn with(mut self, part: &str, of: LawNumber, number: impl Into<Formula>) -> Self {
        let numbers = self.parts.entry(part.to_owned()).or_default();
        if of.is_law() {
            numbers.retain(|other, _| !other.is_law() && of.goes_with(*other));
        }
        numbers.insert(of, number.into());
        self
    }

    /// The boundary without numbers of this kind.
    #[must_use]
    pub fn without(mut self, of: LawNumber) -> Self {
        self.parts.values_mut().for_each(|numbers| _ = numbers.remove(&of));
        self.parts.retain(|_, numbers| !numbers.is_empty());
        self
    }

    /// True if nothing is said: the law is the paper's everywhere.
    pub fn is_empty(&self) -> bool {
        self.parts.is_empty()
    }

    /// Names of the parts of which something is said, in their order.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.parts.keys().map(String::as_str).filter(|part| !part.is_empty())
    }

    /// Parts with a number of this kind; the name of all others is empty, and comes first.
    pub fn numbers(&self, of: LawNumber) -> impl Iterator<Item = (&str, &Formula)> {
        self.parts.iter().filter_map(move |(part, own)| Some((part.as_str(), own.get(&of)?)))
    }

    /// The first number of a part, with what it says: that of its law, if it has one; none if nothing is said.
    pub fn first(&self, part: &str) -> Option<(LawNumber, &Formula)> {
        self.parts.get(part)?.first_key_value().map(|(of, number)| (*of, number))
    }

    /// Number of this kind on a part, or else on all that are not named.
    fn number(&self, part: &str, of: LawNumber) -> Option<&Formula> {
        [part, ""].into_iter().find_map(|part| self.parts.get(part)?.get(&of))
    }

    /// Number that says which law holds on a part; none for the paper's law.
    fn said(&self, part: &str) -> Option<(LawNumber, &Formula)> {
        [part, ""].into_iter().find_map(|part| self.first(part).filter(|(of, _)| of.is_law()))
    }

    /// Formula of the value, or of the flux of a free part, in the law on a part, or under the empty name on those that
    /// are not named; none of a number.
    pub fn formula(&self, part: &str) -> Option<&Formula> {
        let of = match self.said(part) {
            Some((of, _)) if !of.goes_with(LawNumber::Gap) => of,
            _ => LawNumber::Gap,
        };
        self.number(part, of).filter(|value| value.number().is_none())
    }

    /// Law on a part, or under the empty name on those that are not named.
    ///
    /// # Errors
    /// [`StatementError::Field`] if its numbers make none.
    pub fn law(&self, part: &str) -> Result<Law, StatementError> {
        let said = self.said(part);
        for (of, number) in self.parts.get(part).into_iter().flatten() {
            let refused = |reason| StatementError::field(of.name(), assigned(part, number), reason);
            if let Some((law, _)) = said.filter(|(law, _)| law != of && !law.goes_with(*of)) {
                let [own, law] = [of.name(), law.name()];
                let reason = format!("a {own} does not go with {law} there; leave one of them out");
                return Err(refused(reason));
            }
            if number.number().is_none() && !of.takes_formulas() {
                return Err(refused("must be a number, e.g. 0.3".into()));
            }
        }
        /// Number of a law, 0 in place of a formula.
        fn plain(number: &Formula) -> f64 {
            number.number().unwrap_or_default()
        }
        let [gap, flux] = [LawNumber::Gap, LawNumber::Flux]
            .map(|of| self.number(part, of).map(plain).unwrap_or_default());
        let law = match said.map(|(of, number)| (of, plain(number))) {
            None => Law::above(gap, flux),
            Some((LawNumber::Below, most)) => Law::below(most, flux),
            Some((of, number)) if of.goes_with(LawNumber::Gap) => {
                of.law(number).and_then(|law| law.with_at(gap))
            }
            Some((of, number)) => of.law(number),
        };
        let law = law.map_err(|e| {
            let zero = Formula::from(gap);
            let (of, number) = self.first(part).or(said).unwrap_or((LawNumber::Gap, &zero));
            StatementError::field(of.name(), assigned(part, number), e)
        })?;
        Ok(if self.formula(part).is_some() { law.by_formula() } else { law })
    }

    /// The laws in words, each with the part on which it holds; none if nothing is said.
    ///
    /// # Errors
    /// As [`Boundary::law`].
    pub fn in_words(&self) -> Result<Option<String>, StatementError> {
        let mut laws = Vec::new();
        for part in self.parts.keys() {
            let on = if part.is_empty() { String::new() } else { format!(" on {part}") };
            laws.push(self.law(part)?.in_words(self.formula(part)) + &on);
        }
        Ok((!laws.is_empty()).then(|| laws.join(", ")))
    }

    /// True if what sticks is in contact, wherever it may move.
    pub fn has_contact(&self) -> bool {
        let parts = [""].into_iter().chain(self.names());
        parts.filter_map(|part| self.law(part).ok()).all(|law| law.is_contact() || !law.may_move())
    }

    /// True if the law is the paper's on all parts that are neither free nor fixed.
    pub fn is_signorini(&self) -> bool {
        let mut numbers = self.parts.values().flat_map(BTreeMap::keys);
        numbers.all(|of| matches!(of, LawNumber::Free | LawNumber::Fixed))
    }
}

/// A number of a part as options have it; of all parts that are not named the number alone.
fn assigned(part: &str, number: &Formula) -> String {
    if part.is_empty() { number.to_string() } else { format!("{part}={number}") }
}
