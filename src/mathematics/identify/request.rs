//! What to search: a family of f, and the way to go through it.

use super::IdentifyError;
use super::space::{Lattice, Space};
use super::variant::Variant;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::ops::Range;
use std::str::FromStr;

/// How to go through a space.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", tag = "method")]
pub enum Method {
    /// Every point of the lattice.
    Enumerate,
    /// Simulated annealing on the lattice, from random points.
    Anneal {
        /// Number of independent chains.
        chains: u64,
        /// Candidates each chain tries.
        steps: u64,
    },
}

/// What to search. Two equal requests give equal reports.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Request {
    /// Family of f.
    pub space: Space,
    /// Values allowed: one lattice for all pieces, or one per piece.
    pub values: Vec<Lattice>,
    /// Reading of the method.
    pub variant: Variant,
    /// How to search.
    pub method: Method,
    /// Whether f must have a negative integral, as (2) asks.
    pub negative_integral: bool,
    /// Number of coarse grids whose counts must come out exactly; enumeration only. Two discard
    /// nearly everything at a cost of microseconds.
    pub exact_grids: usize,
    /// Seed of everything random.
    pub seed: u64,
    /// How many candidates to keep.
    pub top: usize,
    /// The share of one machine of several; none for the whole search.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub part: Option<Part>,
}

/// One of several parts into which a search is cut, each to be done by a process of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Part {
    /// Which, counted from one.
    pub number: u64,
    /// How many there are.
    pub of: u64,
}

impl Part {
    /// Its share of this many blocks.
    pub(super) fn share(self, blocks: u64) -> Range<u64> {
        let end =
            |parts: u64| (u128::from(blocks) * u128::from(parts) / u128::from(self.of)) as u64;
        end(self.number - 1)..end(self.number)
    }
}

impl FromStr for Part {
    type Err = IdentifyError;

    fn from_str(text: &str) -> Result<Self, IdentifyError> {
        let parsed = text.split_once('/').and_then(|(number, of)| {
            let part = Self { number: number.parse().ok()?, of: of.parse().ok()? };
            (1..=part.of).contains(&part.number).then_some(part)
        });
        parsed.ok_or_else(|| IdentifyError::Part(text.into()))
    }
}

impl fmt::Display for Part {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "{}/{}", self.number, self.of)
    }
}
