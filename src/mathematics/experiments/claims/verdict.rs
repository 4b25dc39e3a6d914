//! Verdicts on the claims: each is split into cases that hold or do not, by a bound stated here.

use super::{Cell, Count, Line, Measure, Measured, Row, VARIANTS};
use crate::experiments::Range;
use crate::saddle::StopRule;
use serde::{Deserialize, Serialize};

/// Counts that differ by less than this factor count as equal.
const EQUAL: f64 = 1.1;
/// Tolerances above which a change of the multiplier is considerable.
const CONSIDERABLE: f64 = 10.0;
/// Factor above which iterations are many more.
const MANY: f64 = 2.0;

/// What the measurement says about a claim.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// It holds in all cases.
    Confirmed,
    /// It holds in some.
    Partly,
    /// It holds in none.
    Refuted,
}

/// In how many cases a claim holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Tally {
    /// Cases in which it holds.
    pub holds: usize,
    /// All cases.
    pub cases: usize,
    /// What that makes.
    pub verdict: Verdict,
}

impl Tally {
    fn of(cases: impl IntoIterator<Item = bool>) -> Self {
        let (mut holds, mut all) = (0, 0);
        for case in cases {
            holds += usize::from(case);
            all += 1;
        }
        let verdict = match holds {
            0 => Verdict::Refuted,
            _ if holds == all => Verdict::Confirmed,
            _ => Verdict::Partly,
        };
        Self { holds, cases: all, verdict }
    }
}

/// The verdicts, with the numbers behind them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Verdicts {
    /// The speed depends on r: counts on the finest grid over the paper's range of r.
    pub depends_on_r: Tally,
    /// The same over r from 10 up.
    pub depends_on_large_r: Tally,
    /// A line per problem and measure.
    pub spreads: Vec<Spread>,
    /// The speed depends on the problem: counts of the problems differ, per measure and r.
    pub depends_on_problem: Tally,
    /// At the signed stop the multiplier moves by more than ten tolerances.
    pub still_moves: Tally,
    /// More so in the last problem than in the first, per r.
    pub more_in_last: Tally,
    /// The dual criterion at least doubles the iterations of the signed rule on the finest grid.
    pub dual_costs: Tally,
    /// The same of the printed rule.
    pub dual_costs_printed: Tally,
    /// Factors by which it multiplies them, in the same order: signed, printed.
    pub dual_factors: [Option<Range>; 2],
    /// Cheaper than Uzawa's algorithm with exact inner minimisation.
    pub cheaper: Tally,
    /// Cheaper than every variant of it.
    pub cheapest: Tally,
    /// Sweeps of each variant of Uzawa's algorithm over those of Arrow-Hurwicz, then of the best of all
    /// variants in each cell, per target.
    pub gains: Vec<Ratios>,
    /// The same per r, over all problems, grids and targets: exact inner minimisation, and the best variant.
    pub gains_at: Vec<[Ratios; 2]>,
    /// The same with each method at its own best r, per problem, grid and target: exact inner
    /// minimisation, and the best variant.
    pub gains_at_best: [Option<Range>; 2],
    /// The gain over exact inner minimisation depends on r, per problem, grid and target.
    pub gain_depends_on_r: Tally,
}

/// How much the counts of a row vary, as greatest over least.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Spread {
    /// Problem.
    pub problem: u8,
    /// Cells per side.
    pub cells: usize,
    /// When the runs end.
    pub measure: Measure,
    /// Over the values of r between the least and the greatest of the paper.
    pub paper: f64,
    /// Over r from 10 up.
    pub large: f64,
    /// Whether some run in the paper's range hit the cap, so that the spread is only a lower bound.
    pub capped: bool,
}

/// Sweeps of a variant of Uzawa's algorithm over those of Arrow-Hurwicz, in the cells where the latter
/// converged.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Ratios {
    /// Which variant.
    pub name: String,
    /// KKT residual over the largest component of F, if it is the same in all cells.
    pub target: Option<f64>,
    /// Duality parameter, if it is the same in all cells.
    pub r: Option<f64>,
    /// Cells in which Arrow-Hurwicz takes fewer sweeps.
    pub cheaper: Tally,
    /// Cells in which the variant hit the cap: their ratio is a lower bound.
    pub capped: usize,
    /// Median of the ratios; NaN without cells, as is their range.
    pub median: f64,
    /// Their range.
    pub range: Range,
}

impl Verdicts {
    pub(super) fn of<'a>(r: &[f64], problems: &'a [Measured]) -> Self {
        let spreads: Vec<_> = problems.iter().flat_map(|problem| spreads(r, problem)).collect();
        let factors = |rule: StopRule| -> Vec<f64> {
            problems.iter().flat_map(|problem| lines(problem, rule)).map(|l| l.factor).collect()
        };
        let signed = factors(StopRule::SignedDual);
        let printed = factors(StopRule::PrintedDual);
        let many = |factors: &[f64]| Tally::of(factors.iter().map(|factor| *factor > MANY));
        let excess =
            |problem: &'a Measured| lines(problem, StopRule::Signed).map(|line| line.excess);
        let ends = || problems.first().zip(problems.last());
        let targets: Vec<f64> = problems.first().map(targets).unwrap_or_default();
        let of = |variant: usize| Ratios::of(variant, problems, None, None);
        let per_target =
            |&target| (0..=BEST).map(move |k| Ratios::of(k, problems, Some(target), None));
        let per_r = |r| [0, BEST].map(|variant| Ratios::of(variant, problems, None, Some(r)));
        Self {
            depends_on_r: Tally::of(spreads.iter().map(|spread| spread.paper > EQUAL)),
            depends_on_large_r: Tally::of(spreads.iter().map(|spread| spread.large > EQUAL)),
            depends_on_problem: Tally::of(ends().into_iter().flat_map(|(a, b)| differ(a, b))),
            still_moves: Tally::of(
                problems.iter().flat_map(excess).map(|excess| excess > CONSIDERABLE),
            ),
            more_in_last: Tally::of(
                ends()
                    .into_iter()
                    .flat_map(|(a, b)| excess(b).zip(excess(a)))
                    .map(|(last, first)| last > first),
            ),
            dual_costs: many(&signed),
            dual_costs_printed: many(&printed),
            dual_factors: [Range::of(signed), Range::of(printed)],
            cheaper: of(0).cheaper,
            cheapest: of(BEST).cheaper,
            gain_depends_on_r: Tally::of(problems.iter().flat_map(gain_depends_on_r)),
            gains: targets.iter().flat_map(per_target).collect(),
            gains_at: compared(problems).into_iter().map(per_r).collect(),
            gains_at_best: [0, BEST].map(|variant| gains_at_best(problems, variant)),
            spreads,
        }
    }
}

/// The lines of the table under a stopping rule.
fn lines(problem: &Measured, rule: StopRule) -> impl Iterator<Item = &Line> {
    problem.tables.iter().filter(move |table| table.rule == rule).flat_map(|table| &table.lines)
}

/// The row on the finest grid of each measure.
fn finest(problem: &Measured) -> impl Iterator<Item = &Row> {
    // Rows go from coarse to fine.
    problem.rows.chunk_by(|a, b| a.measure == b.measure).filter_map(<[Row]>::last)
}

fn spreads<'a>(r: &'a [f64], problem: &'a Measured) -> impl Iterator<Item = Spread> {
    let paper: Vec<f64> = problem.tables[0].lines.iter().map(|line| line.r).collect();
    let Range { least, greatest } = Range::of(paper).unwrap_or_default();
    finest(problem).map(move |row| {
        let within = |low: f64, high: f64| {
            let counts = r.iter().zip(&row.counts).filter(move |(r, _)| low <= **r && **r <= high);
            counts.map(|(_, count)| count)
        };
        let spread = |low: f64, high: f64| {
            let range = Range::of(within(low, high).map(|count| count.iterations as f64));
            range.map_or(f64::NAN, |range| range.greatest / range.least)
        };
        Spread {
            problem: problem.number,
            cells: row.cells,
            measure: row.measure,
            paper: spread(least, greatest),
            large: spread(10.0, f64::INFINITY),
            capped: within(least, greatest).any(|count| count.reached().is_none()),
        }
    })
}

/// Whether the counts of two problems on their finest grids differ, per measure and r, where both ended.
fn differ(a: &Measured, b: &Measured) -> Vec<bool> {
    let rows = finest(a).zip(finest(b));
    rows.flat_map(|(a, b)| a.counts.iter().zip(&b.counts))
        .filter_map(|(a, b)| Some((a.reached()? as f64, b.reached()? as f64)))
        .map(|(a, b)| a.max(b) > EQUAL * a.min(b))
        .collect()
}

fn targets(problem: &Measured) -> Vec<f64> {
    let mut targets: Vec<f64> = problem.cells.iter().map(|cell| cell.target).collect();
    targets.dedup();
    targets
}

/// Stands for the best variant of each cell, after the numbers of [`VARIANTS`].
const BEST: usize = VARIANTS.len();

impl Cell {
    /// The count of a variant: in no case more than the cap.
    fn uzawa(&self, variant: usize) -> Count {
        let best =
            || self.uzawa.iter().min_by_key(|count| (count.reached().is_none(), count.iterations));
        *self.uzawa.get(variant).or_else(best).expect("there are variants")
    }

    /// Its sweeps over those of Arrow-Hurwicz, if the latter converged.
    fn ratio(&self, variant: usize) -> Option<f64> {
        Some(self.uzawa(variant).iterations as f64 / self.arrow_hurwicz.reached()? as f64)
    }
}

impl Ratios {
    /// Over the cells with this target and this r, where they are given.
    fn of(variant: usize, problems: &[Measured], target: Option<f64>, r: Option<f64>) -> Self {
        let cells = problems.iter().flat_map(|problem| &problem.cells).filter(|cell| {
            target.is_none_or(|target| cell.target == target) && r.is_none_or(|r| cell.r == r)
        });
        let cells: Vec<_> =
            cells.filter_map(|cell| Some((cell.ratio(variant)?, cell.uzawa(variant)))).collect();
        let mut ratios: Vec<f64> = cells.iter().map(|(ratio, _)| *ratio).collect();
        ratios.sort_by(f64::total_cmp);
        Self {
            name: VARIANTS.get(variant).map_or("the best of these", |variant| variant.name).into(),
            target,
            r,
            cheaper: Tally::of(ratios.iter().map(|ratio| *ratio > 1.0)),
            capped: cells.iter().filter(|(_, count)| count.reached().is_none()).count(),
            median: median(&ratios),
            range: Range::of(ratios).unwrap_or(Range { least: f64::NAN, greatest: f64::NAN }),
        }
    }
}

/// The values of r at which methods are compared, ascending.
fn compared(problems: &[Measured]) -> Vec<f64> {
    let mut all: Vec<f64> = problems.iter().flat_map(|p| &p.cells).map(|cell| cell.r).collect();
    all.sort_by(f64::total_cmp);
    all.dedup();
    all
}

/// The cells that differ in r only, together.
fn rows(problem: &Measured) -> impl Iterator<Item = &[Cell]> {
    problem.cells.chunk_by(|a, b| a.cells == b.cells && a.target == b.target)
}

fn gains_at_best(problems: &[Measured], variant: usize) -> Option<Range> {
    let ratio = |cells: &[Cell]| {
        let ours = cells.iter().filter_map(|cell| cell.arrow_hurwicz.reached()).min()?;
        let theirs = cells.iter().map(|cell| cell.uzawa(variant).iterations).min()?;
        Some(theirs as f64 / ours as f64)
    };
    Range::of(problems.iter().flat_map(rows).filter_map(ratio))
}

/// Whether the gain over exact inner minimisation varies with r, per grid and target.
fn gain_depends_on_r(problem: &Measured) -> Vec<bool> {
    let ratios = |cells: &[Cell]| Range::of(cells.iter().filter_map(|cell| cell.ratio(0)));
    let vary = |range: Option<Range>| range.is_some_and(|r| r.greatest > EQUAL * r.least);
    rows(problem).map(|cells| vary(ratios(cells))).collect()
}

/// Median of sorted numbers: of an even number, the mean of the two in the middle; NaN of none.
fn median(sorted: &[f64]) -> f64 {
    let middle = sorted.len() / 2;
    match sorted.len() {
        0 => f64::NAN,
        n if n % 2 == 1 => sorted[middle],
        _ => f64::midpoint(sorted[middle - 1], sorted[middle]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_of_an_even_number_is_between_the_middle_two() {
        assert_eq!(median(&[1.0, 2.0, 4.0]), 2.0);
        assert_eq!(median(&[1.0, 2.0, 4.0, 8.0]), 3.0);
        assert!(median(&[]).is_nan());
    }
}
