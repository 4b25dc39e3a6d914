//! What the prose says about the data: counts of agreements, ranges of ratios, worst residuals.

use super::data::{Column, Problem, Report, Row};
use super::room::{Fixed, Searched};
use crate::saddle::{Outcome, StopReason, tolerance};
use serde::Serialize;

/// How much of one or more tables agrees with the paper.
#[derive(Clone, Debug, Default, Serialize)]
pub(super) struct Agreement {
    cells: usize,
    exact: usize,
    within: usize,
    /// Largest difference of a count.
    worst: usize,
    /// Counts on the two finest grids that are not exact.
    inexact_fine: usize,
    deltas: usize,
    deltas_exact: usize,
    deltas_within: usize,
    /// Counts that (13) as printed would have given exactly.
    printed_exact: usize,
}

/// Least and greatest of some values.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(super) struct Range {
    least: f64,
    greatest: f64,
}

/// Facts about all problems together.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Facts {
    agreement: Agreement,
    /// Cells per side of the finest grid.
    cells: usize,
    /// Number of grids.
    levels: usize,
    /// Bound of the stopping rules on the finest grid.
    tolerance: f64,
    /// Whether each f is made of quadrants only.
    quarters: bool,
    comparison: Comparison,
    searched: Searched,
}

/// A problem as the templates see it.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Told<'a> {
    #[serde(flatten)]
    problem: &'a Problem,
    agreement: Agreement,
    /// Sum of the load vector on each grid.
    sums: Vec<f64>,
    /// Whether the discrete problem has a solution on every grid: whether all sums are negative.
    solvable: bool,
    /// Whether, on some grid, no pair can meet (13) as printed: the components of (8) add up to at
    /// most minus the sum of the load, so that one is at least its mean in absolute value.
    unreachable: bool,
    comparison: Comparison,
    /// Largest Delta a on the finest grid under the signed rule.
    delta: f64,
    /// Largest Delta a in the paper's table.
    paper_delta: f64,
    /// What such a change of the multiplier leaves in the gradient, h Delta a.
    paper_gap: f64,
    /// That over the tolerance.
    paper_excess: f64,
    finest: Vec<Finest<'a>>,
    /// How sharply the table fixes f.
    fixed: Fixed,
}

/// The stopping rules against each other on the finest grid, over some columns.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Comparison {
    columns: usize,
    /// `max |dM/dy|` over the tolerance where the signed rule stops.
    excess: Option<Range>,
    /// Iterations under (13) as printed over those under the signed rule, where both converge.
    printed: Option<Range>,
    /// Columns in which (13) as printed is not met on some grid.
    printed_failed: usize,
    /// The same two for the signed rule with the dual one.
    dual: Option<Range>,
    dual_failed: usize,
    signed_failed: usize,
}

/// One r on the finest grid, under the three rules.
#[derive(Clone, Debug, Serialize)]
struct Finest<'a> {
    r: f64,
    signed: &'a Outcome,
    printed: &'a Outcome,
    dual: &'a Outcome,
    /// Count in the paper.
    paper: usize,
    /// `max |dM/dy|` over the tolerance where the signed rule stops.
    excess: f64,
}

impl Facts {
    pub(super) fn of(report: &Report) -> Self {
        let mut agreement = Agreement::default();
        for problem in &report.problems {
            agreement.add(&Agreement::of(problem));
        }
        Self {
            agreement,
            cells: report.grids.last().copied().unwrap_or_default(),
            levels: report.grids.len(),
            tolerance: tolerance(report.grids.len()),
            quarters: report.problems.iter().all(|problem| {
                let mut pieces = problem.f.split(';').map(str::trim);
                pieces.all(|piece| piece.starts_with("quadrant(") || piece.starts_with("else="))
            }),
            comparison: Comparison::of(&report.problems),
            searched: Searched::of(&report.record),
        }
    }
}

impl<'a> Told<'a> {
    pub(super) fn of(problem: &'a Problem) -> Self {
        let sums: Vec<f64> = problem
            .signed
            .first()
            .map(|column| column.outcomes.iter().map(|o| o.sum_load).collect())
            .unwrap_or_default();
        let unreachable = problem.signed.first().is_some_and(|column| {
            let levels = column.outcomes.iter().enumerate();
            levels.into_iter().any(|(k, outcome)| {
                let nodes = (outcome.cells + 1).pow(2);
                outcome.sum_load / nodes as f64 > tolerance(k + 1)
            })
        });
        let largest = |delta: fn(&Row) -> f64| problem.table.iter().map(delta).fold(0.0, f64::max);
        let paper_delta = largest(|row| row.delta_a.paper);
        let finest: Vec<_> = rows(problem)
            .filter_map(|(row, [signed, printed, dual])| {
                let signed = signed.outcomes.last()?;
                Some(Finest {
                    r: row.r,
                    signed,
                    printed: printed.outcomes.last()?,
                    dual: dual.outcomes.last()?,
                    paper: row.counts.last()?.paper,
                    excess: signed.gradient_abs / tolerance(row.counts.len()),
                })
            })
            .collect();
        let h = finest.first().map_or(0.0, |line| 1.0 / line.signed.cells as f64);
        let paper_gap = h * paper_delta;
        let paper_excess = paper_gap / tolerance(sums.len());
        Self {
            problem,
            agreement: Agreement::of(problem),
            solvable: sums.iter().all(|sum| *sum < 0.0),
            unreachable,
            sums,
            comparison: Comparison::of(std::slice::from_ref(problem)),
            delta: largest(|row| row.delta_a.ours),
            paper_delta,
            paper_gap,
            paper_excess,
            finest,
            fixed: Fixed::of(&problem.findings),
        }
    }
}

/// The rows of a problem's table with its columns under the signed, printed and signed-dual rules.
fn rows(problem: &Problem) -> impl Iterator<Item = (&Row, [&Column; 3])> {
    let columns = problem.signed.iter().zip(&problem.printed);
    problem
        .table
        .iter()
        .zip(columns.zip(&problem.signed_dual))
        .map(|(row, ((signed, printed), dual))| (row, [signed, printed, dual]))
}

fn converged(column: &Column) -> bool {
    column.outcomes.iter().all(|outcome| outcome.stop == StopReason::Converged)
}

impl Agreement {
    fn of(problem: &Problem) -> Self {
        let mut sum = Self::default();
        for (row, [_, printed, _]) in rows(problem) {
            let fine = row.counts.iter().rev().take(2);
            sum.inexact_fine += fine.filter(|count| !count.exact).count();
            for (count, outcome) in row.counts.iter().zip(&printed.outcomes) {
                sum.cells += 1;
                sum.exact += usize::from(count.exact);
                sum.within += usize::from(count.within);
                sum.worst = sum.worst.max(count.ours.abs_diff(count.paper));
                sum.printed_exact += usize::from(
                    outcome.stop == StopReason::Converged && outcome.iterations == count.paper,
                );
            }
            sum.deltas += 1;
            sum.deltas_exact += usize::from(row.delta_a.exact);
            sum.deltas_within += usize::from(row.delta_a.within);
        }
        sum
    }

    fn add(&mut self, other: &Self) {
        self.cells += other.cells;
        self.exact += other.exact;
        self.within += other.within;
        self.worst = self.worst.max(other.worst);
        self.inexact_fine += other.inexact_fine;
        self.deltas += other.deltas;
        self.deltas_exact += other.deltas_exact;
        self.deltas_within += other.deltas_within;
        self.printed_exact += other.printed_exact;
    }
}

impl Comparison {
    fn of(problems: &[Problem]) -> Self {
        let columns: Vec<_> = problems.iter().flat_map(rows).map(|(_, columns)| columns).collect();
        let failed =
            |rule: usize| columns.iter().filter(|columns| !converged(columns[rule])).count();
        let finest =
            || columns.iter().filter_map(|columns| Some((columns[0].outcomes.last()?, *columns)));
        let ratio = |rule: usize| {
            Range::of(finest().filter_map(|(signed, columns)| {
                let other = columns[rule].outcomes.last()?;
                (converged(columns[rule]) && converged(columns[0]))
                    .then(|| other.iterations as f64 / signed.iterations as f64)
            }))
        };
        Self {
            columns: columns.len(),
            excess: Range::of(finest().map(|(signed, columns)| {
                signed.gradient_abs / tolerance(columns[0].outcomes.len())
            })),
            printed: ratio(1),
            printed_failed: failed(1),
            dual: ratio(2),
            dual_failed: failed(2),
            signed_failed: failed(0),
        }
    }
}

impl Range {
    /// `None` if there are no values.
    fn of(values: impl Iterator<Item = f64>) -> Option<Self> {
        values.fold(None, |range, x| {
            Some(range.map_or(Self { least: x, greatest: x }, |range: Self| Self {
                least: range.least.min(x),
                greatest: range.greatest.max(x),
            }))
        })
    }
}
