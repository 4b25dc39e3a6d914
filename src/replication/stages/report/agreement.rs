//! How the tables agree with the paper, and what the stopping rules leave and cost on the finest grid.

use crate::pipeline::error::Failure;
use crate::replication::comparison::TableComparison;
use crate::replication::stages::results::{Results, Summary};
use crate::saddle::StopRule;
use serde::Serialize;

/// The agreement of one problem, or of all together.
#[derive(Serialize)]
pub(super) struct Agreement {
    /// Published counts.
    cells: usize,
    /// Those that the signed rule gives.
    exact: usize,
    /// Those that (13) as printed gives.
    printed_exact: usize,
    /// Published values of Delta a, those to both digits, and those within the declared tolerance.
    deltas: usize,
    deltas_exact: usize,
    deltas_within: usize,
    /// `max |dM/dy|` over the tolerance where the signed rule stops.
    excess: Summary,
    /// Iterations under (13) as printed over those under the signed rule.
    printed: Summary,
    /// The same for the signed rule with the dual one.
    dual: Summary,
    /// Iterations under the signed rule.
    counts: Summary,
    /// Delta a under the signed rule, and as published.
    delta: Summary,
    pub(super) paper_delta: Summary,
}

impl Agreement {
    pub(super) fn of(results: &Results, tables: &[TableComparison]) -> Result<Self, Failure> {
        let signed = results.agreement(StopRule::Signed)?;
        let sum = |of: fn(&TableComparison) -> usize| tables.iter().map(of).sum();
        Ok(Self {
            cells: signed.cases,
            exact: signed.sum as usize,
            printed_exact: results.agreement(StopRule::Printed)?.sum as usize,
            deltas: sum(|table| table.rows.len()),
            deltas_exact: sum(|table| table.delta_a_exact),
            deltas_within: sum(|table| table.delta_a_within),
            excess: results.excess()?,
            printed: results.factor(StopRule::Printed)?,
            dual: results.factor(StopRule::SignedDual)?,
            counts: results.on_finest("iterations")?,
            delta: results.on_finest("delta_a")?,
            paper_delta: results.on_finest("published_delta_a")?,
        })
    }
}
