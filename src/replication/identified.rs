//! `pipeline/identified.toml`: results and extent of the searches for Figure 1.

use serde::{Deserialize, Serialize};
use signorini_mathematics::identify::Questions;

/// Record of the searches: questions that every run answers again, and results of longer searches.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Record {
    /// Commit whose program made the longer searches, by their commands: this one tries two values on quadrants only.
    pub program: String,
    /// Questions that the stage `identify` answers.
    pub questions: Questions,
    /// Per table, the f that are compared.
    pub problem: Vec<Alternatives>,
    /// The model selection, the best variant first.
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

/// Equal searches with several variants of the method.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct SelectionRecord {
    /// The commands that make it, one per problem.
    pub commands: Vec<String>,
    /// Candidates per variant and problem.
    pub candidates: u64,
    /// One entry per variant.
    pub variant: Vec<VariantRecord>,
}

/// Best results with a variant.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct VariantRecord {
    /// The variant in words.
    pub name: String,
    /// Sum of the objectives of both problems.
    pub total: f64,
    /// Best f for each problem.
    pub best: Vec<BestRecord>,
}

/// The best f for one problem.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct BestRecord {
    /// Counts that come out.
    pub exact: usize,
    /// Misfit of the others.
    pub misfit: f64,
    /// Values of Delta a to the printed digits.
    pub delta_a: usize,
    /// Values on the quadrants.
    pub f: Vec<f64>,
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

impl Record {
    /// The f that are compared for this table.
    pub(crate) fn alternatives(&self, table: u8) -> &[[f64; 4]] {
        self.problem.iter().find(|p| p.table == table).map_or(&[], |p| &p.alternatives)
    }
}
