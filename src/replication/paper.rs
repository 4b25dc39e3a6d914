//! The published tables, and the tolerance we declare for them.

use super::fields::lists::repeated;
use crate::pipeline::error::{Error, Result, from_toml};
use serde::{Deserialize, Serialize};
use signorini_mathematics::identify::Target;

/// Path of the published tables in the project.
pub const PAPER: &str = "pipeline/paper.toml";

/// `pipeline/paper.toml`: facts as printed, and what we call a match.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Paper {
    /// Duality parameters, in the order of the rows.
    pub r: Vec<f64>,
    /// Tables 1 and 2.
    pub table: Vec<PublishedTable>,
}

/// One published table with its declared tolerances.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PublishedTable {
    /// Number of the table.
    pub number: u8,
    /// `counts[k][level]`: iterations for `r[k]` on each grid.
    pub counts: Vec<Vec<usize>>,
    /// Delta a on the finest grid, per row.
    pub delta_a: Vec<f64>,
    /// A count is within tolerance if it differs by at most this share of the published one...
    pub count_share: f64,
    /// ...or by at most this many iterations.
    pub count_slack: usize,
    /// Delta a is within tolerance if the ratio of the two is at most this factor, either way.
    pub delta_a_factor: f64,
}

impl Paper {
    /// Parses and validates `pipeline/paper.toml`.
    ///
    /// # Errors
    /// [`Error::Input`] with the line of the mistake.
    pub fn parse(text: impl AsRef<[u8]>) -> Result<Self> {
        let paper: Self = from_toml(PAPER, text)?;
        match paper.mistake() {
            Some(mistake) => Err(Error::input(format!("{PAPER}: {mistake}"))),
            None => Ok(paper),
        }
    }

    /// Returns the first mistake in the values, in words, if there is one.
    fn mistake(&self) -> Option<String> {
        let positive = self.r.iter().all(|&r| r.is_finite() && r > 0.0);
        if self.r.is_empty() || !positive || repeated(&self.r).is_some() {
            return Some("`r` must list positive numbers, each once".into());
        }
        for (k, table) in self.table.iter().enumerate() {
            let number = table.number;
            if let Some(mistake) = table.mistake(self.r.len()) {
                return Some(format!("table {number} {mistake}"));
            }
            if self.table[..k].iter().any(|other| other.number == number) {
                return Some(format!("two tables have the number {number}; change one"));
            }
        }
        None
    }

    /// Returns the published table of this number.
    pub(crate) fn published(&self, number: u8) -> Result<&PublishedTable> {
        self.table.iter().find(|table| table.number == number).ok_or_else(|| {
            let known: Vec<_> = self.table.iter().map(|table| table.number.to_string()).collect();
            Error::input(match known.is_empty() {
                true => format!("there is no published table {number}: pipeline/paper.toml is missing or has no \
                    tables; put it back"),
                false => format!("pipeline/paper.toml has no table {number}; it has {}", known.join(", ")),
            })
        })
    }

    /// Returns the published table of this number in the form that a search takes.
    pub(crate) fn target(&self, number: u8) -> Result<Target> {
        let PublishedTable { counts, delta_a, .. } = self.published(number)?.clone();
        let target = Target { r: self.r.clone(), counts, delta_a };
        match target.validate() {
            Err(e) => Err(Error::input(format!("{PAPER}, table {number}: {e}"))),
            Ok(()) => Ok(target),
        }
    }
}

impl PublishedTable {
    /// Returns the first mistake in the numbers, in words, if there is one; `rows` is the number of values of r, and
    /// must be the number of rows.
    fn mistake(&self, rows: usize) -> Option<String> {
        let width = self.counts.first().map_or(0, Vec::len);
        if width == 0 {
            return Some("has no counts".into());
        }
        if self.counts.len() != rows
            || self.delta_a.len() != rows
            || self.counts.iter().any(|row| row.len() != width)
        {
            return Some("does not have one full row per r".into());
        }
        if let Some(value) = self.delta_a.iter().find(|v| !(**v > 0.0 && v.is_finite())) {
            return Some(format!("has delta_a = {value}, which must be a positive number"));
        }
        for (key, value, least, example) in [
            ("count_share", self.count_share, 0.0, 0.05),
            ("delta_a_factor", self.delta_a_factor, 1.0, 1.5),
        ] {
            if !(value >= least && value.is_finite()) {
                return Some(format!(
                    "has {key} = {value}, which must be a number from {least} on, such as {example}"
                ));
            }
        }
        None
    }
}
