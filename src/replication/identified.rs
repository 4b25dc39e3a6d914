//! `pipeline/identified.toml`: results and extent of the searches for Figure 1.

use serde::{Deserialize, Serialize};
use signorini_mathematics::identify::Questions;

/// IdentifiedRecord of the searches: questions that every run answers again, and results of longer searches.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct IdentifiedRecord {
    /// Commit whose program made the longer searches, by their commands: this one tries two values on quadrants only.
    pub program: String,
    /// Questions that the stage `identify` answers.
    pub questions: Questions,
    /// Per table, the f that are compared.
    pub problem: Vec<Alternatives>,
    /// The search under every reading of the method, the best first.
    pub selection: SelectionRecord,
    /// Searches made, each with its extent.
    pub run: Vec<SearchRecord>,
}

/// The f that are compared for one table.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Alternatives {
    /// Number of the table.
    pub table: u8,
    /// Values of each on the quadrants: lower left, lower right, upper left, upper right.
    pub alternatives: Vec<[f64; 4]>,
}

/// One search under each reading of the method.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct SelectionRecord {
    /// The command that makes it, with any program.
    pub command: String,
    /// Candidates per reading and problem.
    pub candidates: u64,
    /// One entry per reading.
    pub variant: Vec<VariantRecord>,
}

/// Outcome under a reading.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct VariantRecord {
    /// The reading in words.
    pub name: String,
    /// Outcome for each problem.
    pub best: Vec<ReachedRecord>,
}

/// Outcome for one problem.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ReachedRecord {
    /// Greatest number of grids, coarsest first, on which some f has all counts.
    pub grids: usize,
    /// Number of f that have all counts on so many grids.
    pub f: u64,
}

/// One search.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct SearchRecord {
    /// Set that was searched, in words.
    pub what: String,
    /// The command, unless it was made by a scratch program.
    pub command: Option<String>,
    /// Candidates tried.
    pub candidates: u64,
    /// Candidates per second and core, if it was measured.
    pub rate: Option<u64>,
    /// Outcome, in words.
    pub outcome: String,
}

impl IdentifiedRecord {
    /// The f that are compared for this table.
    pub(crate) fn alternatives(&self, table: u8) -> &[[f64; 4]] {
        self.problem.iter().find(|p| p.table == table).map_or(&[], |p| &p.alternatives)
    }
}
