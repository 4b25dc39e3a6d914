//! How the tables agree with the paper, and what the stopping rules leave and cost on the finest grid.

use crate::replication::comparison::TableComparison;
use crate::replication::stages::results::Results;
use crate::saddle::StopRule;
use polars::prelude::PolarsResult;
use serde_json::{Value, json};

/// The agreement of one problem, or of all together.
pub(super) fn agreement(results: &Results, tables: &[TableComparison]) -> PolarsResult<Value> {
    let signed = results.agreement(StopRule::Signed)?;
    let sum = |of: fn(&TableComparison) -> usize| tables.iter().map(of).sum::<usize>();
    Ok(json!({
        // Published counts; those that the signed rule gives, and (13) as printed.
        "cells": signed.cases,
        "exact": signed.sum as usize,
        "printed_exact": results.agreement(StopRule::Printed)?.sum as usize,
        // Published values of Delta a; those to both digits, and within the declared tolerance.
        "deltas": sum(|table| table.rows.len()),
        "deltas_exact": sum(|table| table.delta_a_exact),
        "deltas_within": sum(|table| table.delta_a_within),
        // `max |dM/dy|` over the tolerance where the signed rule stops.
        "excess": results.excess()?,
        // Iterations under (13) as printed, and under the dual rule, over those under the signed rule.
        "printed": results.factor(StopRule::Printed)?,
        "dual": results.factor(StopRule::SignedDual)?,
        // Iterations and Delta a under the signed rule, and Delta a as published.
        "counts": results.on_finest("iterations")?,
        "delta": results.on_finest("delta_a")?,
        "paper_delta": results.on_finest("published_delta_a")?,
    }))
}
