//! What the prose says about the data: counts of agreements, ranges of ratios, worst residuals.

use super::data::{Problem, Report};
use super::results::{Results, Summary};
use super::search::{Fixed, Searched};
use crate::saddle::{Outcome, StopRule, tolerance};
use serde::Serialize;

/// How the tables agree with the paper, and what the stopping rules leave and cost on the finest grid.
///
/// Of one problem, or of all together.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Comparison {
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
    /// Values of r.
    columns: usize,
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
    paper_delta: Summary,
}

/// Facts about all problems together.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Facts {
    #[serde(flatten)]
    all: Comparison,
    /// Cells per side of the finest grid.
    finest: usize,
    /// Bound of the stopping rules there.
    tolerance: f64,
    searched: Searched,
}

/// A problem as the templates see it.
#[derive(Clone, Debug, Serialize)]
pub(super) struct WithFacts<'a> {
    #[serde(flatten)]
    problem: &'a Problem,
    facts: Comparison,
    /// Sum of the load vector on each grid.
    sums: Vec<f64>,
    /// What the largest published Delta a leaves in the gradient, h Delta a, and over the tolerance.
    gap: [f64; 2],
    finest: Vec<Finest<'a>>,
    /// How sharply the table fixes f.
    fixed: Fixed,
}

/// One r on the finest grid, under the three rules.
#[derive(Clone, Debug, Serialize)]
struct Finest<'a> {
    r: f64,
    signed: &'a Outcome,
    printed: &'a Outcome,
    dual: &'a Outcome,
    /// `max |dM/dy|` over the tolerance where the signed rule stops.
    excess: f64,
}

impl Facts {
    pub(super) fn of(report: &Report) -> Result<Self, String> {
        Ok(Self {
            all: Comparison::of(&report.results, &report.problems)?,
            finest: report.grids.last().copied().unwrap_or_default(),
            tolerance: tolerance(report.grids.len()),
            searched: Searched::of(&report.record),
        })
    }
}

impl<'a> WithFacts<'a> {
    pub(super) fn of(results: &Results, problem: &'a Problem) -> Result<Self, String> {
        let columns = problem.signed.iter().zip(&problem.printed).zip(&problem.signed_dual);
        let bound = tolerance(problem.table.first().map_or(0, |row| row.counts.len()));
        let finest = columns.filter_map(|((signed, printed), dual)| {
            let (r, signed) = (signed.r, signed.outcomes.last()?);
            let (printed, dual) = (printed.outcomes.last()?, dual.outcomes.last()?);
            Some(Finest { r, signed, printed, dual, excess: signed.gradient_abs / bound })
        });
        let facts = Comparison::of(results, std::slice::from_ref(problem))?;
        let gap = facts.paper_delta.greatest / problem.cells as f64;
        let first = problem.signed.first().map_or(&[][..], |column| &column.outcomes);
        Ok(Self {
            finest: finest.collect(),
            sums: first.iter().map(|outcome| outcome.sum_load).collect(),
            gap: [gap, gap / bound],
            fixed: Fixed::of(&problem.findings),
            facts,
            problem,
        })
    }
}

impl Comparison {
    fn of(results: &Results, problems: &[Problem]) -> Result<Self, String> {
        let all = |found: Result<Vec<Summary>, String>| {
            let mine = found?.into_iter();
            let mine = mine.filter(|s| problems.iter().any(|problem| problem.name == s.problem));
            mine.reduce(|a, b| a.and(&b)).ok_or("the table of results lacks a problem".to_owned())
        };
        let signed = all(results.agreement(StopRule::Signed))?;
        let rows = || problems.iter().flat_map(|problem| &problem.table);
        Ok(Self {
            cells: signed.cases,
            exact: signed.sum as usize,
            printed_exact: all(results.agreement(StopRule::Printed))?.sum as usize,
            deltas: rows().count(),
            deltas_exact: rows().filter(|row| row.delta_a.exact).count(),
            deltas_within: rows().filter(|row| row.delta_a.within).count(),
            columns: rows().count(),
            excess: all(results.excess("gradient_abs"))?,
            printed: all(results.factor(StopRule::Printed))?,
            dual: all(results.factor(StopRule::SignedDual))?,
            counts: all(results.on_finest(StopRule::Signed, "iterations"))?,
            delta: all(results.on_finest(StopRule::Signed, "delta_a"))?,
            paper_delta: all(results.on_finest(StopRule::Signed, "published_delta_a"))?,
        })
    }
}
