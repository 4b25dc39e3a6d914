//! Verdicts on the claims: each is split into cases that hold or do not, by a bound stated here.

use super::{ClaimLine, ClaimMeasure, Count, CountRow, Measured, UzawaCell, VARIANTS};
use crate::experiments::Range;
use crate::saddle::StopRule;
use serde::{Deserialize, Serialize};

/// Counts that differ by less than this factor count as equal.
const EQUAL: f64 = 1.1;
/// Tolerances above which a change of the multiplier is considerable.
const CONSIDERABLE: f64 = 10.0;
/// Factor above which iterations are many more.
const MANY: f64 = 2.0;

/// Verdict of the measurement on a claim.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ClaimVerdict {
    /// It holds in all cases.
    Confirmed,
    /// It holds in some.
    Partly,
    /// It holds in none.
    Refuted,
}

/// In how many cases a claim holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ClaimTally {
    /// Cases in which it holds.
    pub holds: usize,
    /// All cases.
    pub cases: usize,
    /// Verdict on the claim.
    pub verdict: ClaimVerdict,
}

impl ClaimTally {
    fn of(cases: impl IntoIterator<Item = bool>) -> Self {
        let (mut holds, mut all) = (0, 0);
        for case in cases {
            holds += usize::from(case);
            all += 1;
        }
        let verdict = match holds {
            0 => ClaimVerdict::Refuted,
            _ if holds == all => ClaimVerdict::Confirmed,
            _ => ClaimVerdict::Partly,
        };
        Self { holds, cases: all, verdict }
    }
}

/// The verdicts, with the numbers behind them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Verdicts {
    /// The speed depends on r: counts on the finest grid over the paper's range of r.
    pub depends_on_r: ClaimTally,
    /// The speed depends on r where r is at least 10.
    pub depends_on_large_r: ClaimTally,
    /// A line per problem and measure.
    pub spreads: Vec<Spread>,
    /// The speed depends on the problem: counts of the problems differ, per measure and r.
    pub depends_on_problem: ClaimTally,
    /// At the signed stop the multiplier moves by more than ten tolerances.
    pub still_moves: ClaimTally,
    /// More so in the last problem than in the first, per r.
    pub more_in_last: ClaimTally,
    /// The dual criterion at least doubles the iterations of the signed rule on the finest grid.
    pub dual_costs: ClaimTally,
    /// The dual criterion at least doubles the iterations of the printed rule.
    pub dual_costs_printed: ClaimTally,
    /// Factors by which it multiplies them, in the same order: signed, printed.
    pub dual_factors: [Option<Range>; 2],
    /// Cheaper than Uzawa's algorithm with exact inner minimisation.
    pub cheaper: ClaimTally,
    /// Cheaper than every variant of it.
    pub cheapest: ClaimTally,
    /// Sweeps of each variant of Uzawa's algorithm over those of Arrow-Hurwicz, then of the best of all
    /// variants in each cell, per target.
    pub gains: Vec<Ratios>,
    /// Ratios per r, over all problems, grids and targets: exact inner minimisation, and the best variant.
    pub gains_at: Vec<[Ratios; 2]>,
    /// Ratios with each method at its own best r, per problem, grid and target: exact inner
    /// minimisation, and the best variant.
    pub gains_at_best: [Option<Range>; 2],
    /// The gain over exact inner minimisation depends on r, per problem, grid and target.
    pub gain_depends_on_r: ClaimTally,
}

/// Variation of the counts of a row, as greatest over least.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Spread {
    /// Problem.
    pub problem: u8,
    /// Cells per side.
    pub cells: usize,
    /// When the runs end.
    pub measure: ClaimMeasure,
    /// Over the values of r between the least and the greatest of the paper.
    pub paper: f64,
    /// Over r from 10 up.
    pub large: f64,
    /// True if some run in the paper's range hit the cap, so that the spread is only a lower bound.
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
    pub cheaper: ClaimTally,
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
        let many = |factors: &[f64]| ClaimTally::of(factors.iter().map(|factor| *factor > MANY));
        let excess =
            |problem: &'a Measured| lines(problem, StopRule::Signed).map(|line| line.excess);
        let ends = || problems.first().zip(problems.last());
        let targets: Vec<f64> = problems.first().map(targets).unwrap_or_default();
        let of = |variant: usize| Ratios::of(variant, problems, None, None);
        let per_target =
            |&target| (0..=BEST).map(move |k| Ratios::of(k, problems, Some(target), None));
        let per_r = |r| [0, BEST].map(|variant| Ratios::of(variant, problems, None, Some(r)));
        Self {
            depends_on_r: ClaimTally::of(spreads.iter().map(|spread| spread.paper > EQUAL)),
            depends_on_large_r: ClaimTally::of(spreads.iter().map(|spread| spread.large > EQUAL)),
            depends_on_problem: ClaimTally::of(ends().into_iter().flat_map(|(a, b)| differ(a, b))),
            still_moves: ClaimTally::of(
                problems.iter().flat_map(excess).map(|excess| excess > CONSIDERABLE),
            ),
            more_in_last: ClaimTally::of(
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
            gain_depends_on_r: ClaimTally::of(problems.iter().flat_map(gain_depends_on_r)),
            gains: targets.iter().flat_map(per_target).collect(),
            gains_at: compared(problems).into_iter().map(per_r).collect(),
            gains_at_best: [0, BEST].map(|variant| gains_at_best(problems, variant)),
            spreads,
        }
    }
}

/// The lines of the table under a stopping rule.
fn lines(problem: &Measured, rule: StopRule) -> impl Iterator<Item = &ClaimLine> {
    problem.tables.iter().filter(move |table| table.rule == rule).flat_map(|table| &table.lines)
}

/// The row on the finest grid of each measure.
fn finest(problem: &Measured) -> impl Iterator<Item = &CountRow> {
    // Rows go from coarse to fine.
    problem.rows.chunk_by(|a, b| a.measure == b.measure).filter_map(<[CountRow]>::last)
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

/// True if the counts of two problems on their finest grids differ, per measure and r, where both ended.
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

impl UzawaCell {
    /// The count of a variant: in no case more than the cap.
    fn uzawa(&self, variant: usize) -> Count {
        let best =
            || self.uzawa.iter().min_by_key(|count| (count.reached().is_none(), count.iterations));
        *self.uzawa.get(variant).or_else(best).expect("there are variants")
    }

    /// Sweeps over those of Arrow-Hurwicz, if the latter converged.
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
            cheaper: ClaimTally::of(ratios.iter().map(|ratio| *ratio > 1.0)),
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
fn rows(problem: &Measured) -> impl Iterator<Item = &[UzawaCell]> {
    problem.cells.chunk_by(|a, b| a.cells == b.cells && a.target == b.target)
}

fn gains_at_best(problems: &[Measured], variant: usize) -> Option<Range> {
    let ratio = |cells: &[UzawaCell]| {
        let ours = cells.iter().filter_map(|cell| cell.arrow_hurwicz.reached()).min()?;
        let theirs = cells.iter().map(|cell| cell.uzawa(variant).iterations).min()?;
        Some(theirs as f64 / ours as f64)
    };
    Range::of(problems.iter().flat_map(rows).filter_map(ratio))
}

/// True if the gain over exact inner minimisation varies with r, per grid and target.
fn gain_depends_on_r(problem: &Measured) -> Vec<bool> {
    let ratios = |cells: &[UzawaCell]| Range::of(cells.iter().filter_map(|cell| cell.ratio(0)));
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
    use super::super::ClaimTable;
    use super::*;
    use crate::saddle::StopReason;

    fn reached(iterations: usize) -> Count {
        Count { iterations, stop: StopReason::Converged }
    }

    fn capped() -> Count {
        Count { iterations: 50, stop: StopReason::IterationLimit }
    }

    fn measured(number: u8, cells: Vec<UzawaCell>) -> Measured {
        let tables = vec![ClaimTable { rule: StopRule::Signed, lines: Vec::new() }];
        Measured { number, sums: [0.0; 2], rows: Vec::new(), tables, cells }
    }

    fn cell(r: f64, arrow_hurwicz: Count, uzawa: [Count; 4]) -> UzawaCell {
        UzawaCell { cells: 16, target: 1e-3, r, arrow_hurwicz, uzawa }
    }

    /// Cells of two problems for two values of r; in one of them Arrow-Hurwicz does not converge.
    fn made_up() -> [Measured; 2] {
        let first = [
            cell(1.0, reached(10), [reached(30), reached(20), capped(), reached(15)]),
            cell(10.0, reached(20), [reached(20), reached(10), reached(40), capped()]),
        ];
        let second = [
            cell(1.0, capped(), [reached(60), capped(), capped(), reached(45)]),
            cell(10.0, reached(10), [reached(80), capped(), capped(), capped()]),
        ];
        [measured(1, first.into()), measured(2, second.into())]
    }

    #[test]
    fn ratios_are_of_the_cells_where_arrow_hurwicz_converged() {
        let problems = made_up();
        let of = |variant, r| {
            let Ratios { cheaper: ClaimTally { holds, cases, .. }, capped, median, range, .. } =
                Ratios::of(variant, &problems, Some(1e-3), r);
            (holds, cases, capped, median, [range.least, range.greatest])
        };
        assert_eq!(of(0, None), (2, 3, 0, 3.0, [1.0, 8.0]));
        // Of two variants the best is the one that converged, though it took more sweeps than the cap of the other.
        assert_eq!(of(BEST, None), (2, 3, 0, 1.5, [0.5, 8.0]));
        assert_eq!(of(2, Some(10.0)), (2, 2, 1, 3.5, [2.0, 5.0]));
        let none = Ratios::of(0, &problems, Some(1e-6), None);
        assert!(none.median.is_nan() && none.cheaper.cases == 0);
    }

    #[test]
    fn gains_are_per_target_per_r_and_at_the_best_r_of_each_method() {
        let verdicts = Verdicts::of(&[], &made_up());
        let gains = verdicts.gains.iter().map(|gain| (gain.target, gain.r, gain.median));
        let medians = [3.0, 2.0, 5.0, 2.5, 1.5];
        assert_eq!(gains.collect::<Vec<_>>(), medians.map(|median| (Some(1e-3), None, median)));
        let at = verdicts.gains_at.iter().map(|pair| {
            pair.each_ref().map(|of| (of.target, of.r.unwrap(), of.cheaper.cases, of.median))
        });
        let expected = [
            [(None, 1.0, 1, 3.0), (None, 1.0, 1, 1.5)],
            [(None, 10.0, 2, 4.5), (None, 10.0, 2, 4.25)],
        ];
        assert_eq!(at.collect::<Vec<_>>(), expected);
        let best = verdicts.gains_at_best.map(Option::unwrap);
        assert_eq!(best.map(|range| [range.least, range.greatest]), [[2.0, 6.0], [1.0, 4.5]]);
        let ClaimTally { holds, cases, .. } = verdicts.gain_depends_on_r;
        assert_eq!((holds, cases), (1, 2));
        assert_eq!((verdicts.cheaper.holds, verdicts.cheapest.holds), (2, 2));
    }

    #[test]
    fn the_median_of_an_even_number_is_between_the_middle_two() {
        assert_eq!(median(&[1.0, 2.0, 4.0]), 2.0);
        assert_eq!(median(&[1.0, 2.0, 4.0, 8.0]), 3.0);
        assert!(median(&[]).is_nan());
    }
}
