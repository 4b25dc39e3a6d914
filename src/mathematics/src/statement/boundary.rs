//! Laws on the parts of the boundary of a statement, by their numbers.

use crate::problem::law::{Law, LawError, LawNumber};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// One table for the whole boundary: for each part that is named, and under the empty name for all others, the numbers
/// of its law. Where nothing is said, the law is the paper's.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Boundary {
    parts: BTreeMap<String, BTreeMap<LawNumber, f64>>,
}

impl Boundary {
    /// Boundary with one law on all of it.
    pub fn under(of: LawNumber, number: f64) -> Self {
        Self::default().with("", of, number)
    }

    /// The boundary with this number on a part, or under the empty name on all parts that are not named.
    #[must_use]
    pub fn with(mut self, part: &str, of: LawNumber, number: f64) -> Self {
        // A part has one law.
        self.parts.insert(part.to_owned(), BTreeMap::from([(of, number)]));
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
    pub fn numbers(&self, of: LawNumber) -> impl Iterator<Item = (&str, f64)> {
        self.parts.iter().filter_map(move |(part, own)| Some((part.as_str(), *own.get(&of)?)))
    }

    /// First number of a part, with its meaning; none if nothing is said.
    pub fn first(&self, part: &str) -> Option<(LawNumber, f64)> {
        self.parts.get(part)?.first_key_value().map(|(of, number)| (*of, *number))
    }

    /// Law on a part, or under the empty name on those that are not named.
    ///
    /// # Errors
    /// [`LawError`] if its number makes none.
    pub fn law(&self, part: &str) -> Result<Law, LawError> {
        let said = self.first(part).or_else(|| self.first(""));
        said.map_or(Ok(Law::SIGNORINI), |(of, number)| of.law(number))
    }

    /// The laws in words, other ones than the paper's, with the parts on which they hold; none if there are none.
    ///
    /// # Errors
    /// As [`Boundary::law`].
    pub fn in_words(&self) -> Result<Option<String>, LawError> {
        let mut laws = Vec::new();
        for (part, numbers) in &self.parts {
            if numbers.keys().any(|of| !matches!(of, LawNumber::Free | LawNumber::Fixed)) {
                let on = if part.is_empty() { String::new() } else { format!(" on {part}") };
                laws.push(format!("{}{on}", self.law(part)?));
            }
        }
        Ok((!laws.is_empty()).then(|| laws.join(", ")))
    }

    /// True if the law is the paper's on all parts that are neither free nor fixed.
    pub fn is_signorini(&self) -> bool {
        let mut numbers = self.parts.values().flat_map(BTreeMap::keys);
        numbers.all(|of| matches!(of, LawNumber::Free | LawNumber::Fixed))
    }
}
