//! Verdicts on the claims: each is split into cases that hold or do not, by a bound stated here.

use super::ratios::{EXACT_INSIDE, Ratios, Rival, compared, gain_depends_on_r};
use super::tally::{ClaimTally, EQUAL};
use super::{BestParameter, ClaimLine, ClaimMeasure, Count, CountRow, Measured};
use crate::discrete::norms::worst;
use crate::experiments::Range;
use crate::saddle::StopRule;
use serde::{Deserialize, Serialize};

/// Number of tolerances above which a change of the multiplier is considerable.
const CONSIDERABLE: f64 = 10.0;
/// Factor above which there are many more iterations.
const MANY: f64 = 2.0;

/// Verdicts on all claims, with the numbers that they are drawn from.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Verdicts {
    /// Claim "the speed depends on r": counts on the finest grid over the paper's range of r.
    pub depends_on_r: ClaimTally,
    /// Claim "the speed depends on r" for r from 10 up.
    pub depends_on_large_r: ClaimTally,
    /// Spread of the counts over r, per problem and measure.
    pub spreads: Vec<Spread>,
    /// Claim "the speed depends on the problem": counts of the problems differ, per measure and r.
    pub depends_on_problem: ClaimTally,
    /// Claim "at the signed stop the multiplier moves by more than ten tolerances".
    pub still_moves: ClaimTally,
    /// Claim "at the signed stop the multiplier moves more in the last problem than in the first", per r.
    pub more_in_last: ClaimTally,
    /// Claim "the dual criterion at least doubles the iterations of the signed rule on the finest grid".
    pub dual_costs: ClaimTally,
    /// Claim "the dual criterion at least doubles the iterations of the printed rule on the finest grid".
    pub dual_costs_printed: ClaimTally,
    /// Factors by which the dual criterion multiplies the iterations of the signed and of the printed rule.
    pub dual_factors: DualFactors,
    /// Greatest last change of the multiplier under the printed rule, in units of the tolerance.
    pub printed_excess: f64,
    /// Claim "Arrow-Hurwicz is cheaper than Uzawa's algorithm with exact inner minimisation".
    pub cheaper: ClaimTally,
    /// Claim "Arrow-Hurwicz is cheaper than every variant of Uzawa's algorithm".
    pub cheapest: ClaimTally,
    /// Sweeps of each variant of Uzawa's algorithm over those of Arrow-Hurwicz, then of the best of all
    /// variants in each cell, per target.
    pub gains: Vec<Ratios>,
    /// Sweeps of Uzawa's algorithm over those of Arrow-Hurwicz per r, over all problems, grids and targets.
    pub gains_at: Vec<GainsAt>,
    /// Claim "the gain over exact inner minimisation depends on r", per problem, grid and target.
    pub gain_depends_on_r: ClaimTally,
}

/// Factors by which the dual criterion multiplies the iterations of a rule.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct DualFactors {
    /// Range under the signed rule.
    pub signed: Option<Range>,
    /// Range under the printed rule.
    pub printed: Option<Range>,
}

/// Sweeps of Uzawa's algorithm over those of Arrow-Hurwicz for one r.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct GainsAt {
    /// Duality parameter.
    pub r: f64,
    /// Ratios of the method with exact inner minimisation.
    pub exact: Ratios,
    /// Ratios of the best variant.
    pub best: Ratios,
}

/// Spread of the counts of a row: the greatest over the least.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Spread {
    /// TableProblem.
    pub problem: u8,
    /// Cells per side.
    pub cells: usize,
    /// Measure by which the runs end.
    pub measure: ClaimMeasure,
    /// Spread over the values of r between the least and the greatest of the paper, if there are any.
    pub paper: Option<f64>,
    /// Spread over the values of r from 10 up, if there are any.
    pub large: Option<f64>,
    /// Best r, if a run reached its end.
    pub best: Option<BestParameter>,
}

impl Verdicts {
    pub(super) fn of(r: &[f64], problems: &[Measured]) -> Self {
        let spreads: Vec<_> = problems.iter().flat_map(|problem| spreads(r, problem)).collect();
        let signed = factors(problems, StopRule::SignedDual);
        let printed = factors(problems, StopRule::PrintedDual);
        let ends = problems.first().zip(problems.last());
        let targets = problems.first().map(targets).unwrap_or_default();
        let mut gains = Vec::new();
        for target in targets {
            for rival in Rival::all() {
                gains.push(Ratios::of(rival, problems, Some(target), None));
            }
        }
        let mut gains_at = Vec::new();
        for r in compared(problems) {
            let [exact, best] =
                [EXACT_INSIDE, Rival::Best].map(|rival| Ratios::of(rival, problems, None, Some(r)));
            gains_at.push(GainsAt { r, exact, best });
        }
        Self {
            depends_on_r: ClaimTally::of(spreads.iter().map(|spread| spread.paper > Some(EQUAL))),
            depends_on_large_r: ClaimTally::of(
                spreads.iter().map(|spread| spread.large > Some(EQUAL)),
            ),
            depends_on_problem: ClaimTally::of(
                ends.map(|(first, last)| differ(first, last)).unwrap_or_default(),
            ),
            still_moves: ClaimTally::of(
                excesses(problems, StopRule::Signed).map(|excess| excess > CONSIDERABLE),
            ),
            more_in_last: ClaimTally::of(
                ends.map(|(first, last)| moves_more(last, first)).unwrap_or_default(),
            ),
            dual_costs: ClaimTally::of(signed.iter().map(|factor| *factor > MANY)),
            dual_costs_printed: ClaimTally::of(printed.iter().map(|factor| *factor > MANY)),
            dual_factors: DualFactors { signed: Range::of(signed), printed: Range::of(printed) },
            printed_excess: worst(excesses(problems, StopRule::Printed)),
            cheaper: Ratios::of(EXACT_INSIDE, problems, None, None).cheaper,
            cheapest: Ratios::of(Rival::Best, problems, None, None).cheaper,
            gain_depends_on_r: ClaimTally::of(problems.iter().flat_map(gain_depends_on_r)),
            gains,
            gains_at,
            spreads,
        }
    }
}

/// Lines of the table under a stopping rule.
fn lines(problem: &Measured, rule: StopRule) -> impl Iterator<Item = &ClaimLine> {
    problem.tables.iter().filter(move |table| table.rule == rule).flat_map(|table| &table.lines)
}

/// Factors by which a stopping rule multiplies the iterations of the rule without its dual criterion.
fn factors(problems: &[Measured], rule: StopRule) -> Vec<f64> {
    problems.iter().flat_map(|problem| lines(problem, rule)).map(|line| line.factor).collect()
}

/// Last changes of the multiplier under a stopping rule, in units of the tolerance.
fn excesses(problems: &[Measured], rule: StopRule) -> impl Iterator<Item = f64> {
    problems.iter().flat_map(move |problem| lines(problem, rule)).map(|line| line.excess)
}

/// True, per r, if the multiplier moves more at the signed stop of problem `a` than of problem `b`.
fn moves_more(a: &Measured, b: &Measured) -> Vec<bool> {
    let [a, b] = [a, b].map(|problem| lines(problem, StopRule::Signed));
    a.zip(b).map(|(a, b)| a.excess > b.excess).collect()
}

/// Rows on the finest grid of each measure.
fn finest(problem: &Measured) -> impl Iterator<Item = &CountRow> {
    // Rows go from coarse to fine.
    problem.rows.chunk_by(|a, b| a.measure == b.measure).filter_map(<[CountRow]>::last)
}

/// Spreads on the finest grid of each measure.
fn spreads(r: &[f64], problem: &Measured) -> Vec<Spread> {
    let paper = Range::of(problem.tables[0].lines.iter().map(|line| line.r)).unwrap_or_default();
    let large = Range { least: 10.0, greatest: f64::INFINITY };
    let mut all = Vec::new();
    for row in finest(problem) {
        all.push(Spread {
            problem: problem.number,
            cells: row.cells,
            measure: row.measure,
            paper: spread(&row.counts_within(r, paper)),
            large: spread(&row.counts_within(r, large)),
            best: row.best,
        });
    }
    all
}

impl CountRow {
    /// Counts for those of the values `r` of the sweep that lie in a range.
    fn counts_within(&self, r: &[f64], range: Range) -> Vec<Count> {
        let mut counts = Vec::new();
        for (r, count) in r.iter().zip(&self.counts) {
            if range.least <= *r && *r <= range.greatest {
                counts.push(*count);
            }
        }
        counts
    }
}

/// Greatest over least of some counts; none without counts.
fn spread(counts: &[Count]) -> Option<f64> {
    let range = Range::of(counts.iter().map(|count| count.iterations as f64))?;
    Some(range.greatest / range.least)
}

/// True, per measure and r, if the counts of two problems on their finest grids differ. Runs that did not reach their
/// end are left out.
fn differ(a: &Measured, b: &Measured) -> Vec<bool> {
    let mut all = Vec::new();
    for (a, b) in finest(a).zip(finest(b)) {
        for (a, b) in a.counts.iter().zip(&b.counts) {
            if let (Some(a), Some(b)) = (a.reached(), b.reached()) {
                all.push(a.max(b) as f64 > EQUAL * a.min(b) as f64);
            }
        }
    }
    all
}

fn targets(problem: &Measured) -> Vec<f64> {
    let mut targets: Vec<f64> = problem.cells.iter().map(|cell| cell.target).collect();
    targets.dedup();
    targets
}

#[cfg(test)]
mod tests {
    use super::super::{ClaimTable, UzawaCell};
    use super::*;
    use crate::discrete::stop::Stop;

    fn reached(iterations: usize) -> Count {
        Count { iterations, stop: Stop::Converged }
    }

    fn capped() -> Count {
        Count { iterations: 50, stop: Stop::IterationLimit }
    }

    fn measured(number: u8, cells: Vec<UzawaCell>) -> Measured {
        let tables = vec![ClaimTable { rule: StopRule::Signed, lines: Vec::new() }];
        let (f, law) = (String::new(), None);
        Measured { number, f, law, sums: [0.0; 2], rows: Vec::new(), tables, cells }
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

    /// Cells in which Arrow-Hurwicz is cheaper, all cells, cells at the limit, median and range.
    fn numbers(rival: Rival, r: Option<f64>) -> (usize, usize, usize, f64, [f64; 2]) {
        let Ratios { cheaper, capped, median, range, .. } =
            Ratios::of(rival, &made_up(), Some(1e-3), r);
        let Range { least, greatest } = range.unwrap();
        (cheaper.holds, cheaper.cases, capped, median.unwrap(), [least, greatest])
    }

    #[test]
    fn ratios_are_of_the_cells_where_arrow_hurwicz_converged() {
        let problems = made_up();
        assert_eq!(numbers(EXACT_INSIDE, None), (2, 3, 0, 3.0, [1.0, 8.0]));
        // Of two variants the best is the one that converged, though it took more sweeps than the limit of the other.
        assert_eq!(numbers(Rival::Best, None), (2, 3, 0, 1.5, [0.5, 8.0]));
        assert_eq!(numbers(Rival::Variant(2), Some(10.0)), (2, 2, 1, 3.5, [2.0, 5.0]));
        let none = Ratios::of(EXACT_INSIDE, &problems, Some(1e-6), None);
        assert_eq!((none.median, none.range, none.cheaper.cases), (None, None, 0));
    }

    #[test]
    fn gains_are_per_target_and_per_r() {
        let verdicts = Verdicts::of(&[], &made_up());
        let gains = verdicts.gains.iter().map(|gain| (gain.target, gain.r, gain.median.unwrap()));
        let medians = [3.0, 2.0, 5.0, 2.5, 1.5];
        assert_eq!(gains.collect::<Vec<_>>(), medians.map(|median| (Some(1e-3), None, median)));
        let at = verdicts.gains_at.iter().map(|GainsAt { exact, best, .. }| {
            [exact, best]
                .map(|one| (one.target, one.r.unwrap(), one.cheaper.cases, one.median.unwrap()))
        });
        let expected = [
            [(None, 1.0, 1, 3.0), (None, 1.0, 1, 1.5)],
            [(None, 10.0, 2, 4.5), (None, 10.0, 2, 4.25)],
        ];
        assert_eq!(at.collect::<Vec<_>>(), expected);
        let ClaimTally { holds, cases, .. } = verdicts.gain_depends_on_r;
        assert_eq!((holds, cases), (1, 2));
        assert_eq!((verdicts.cheaper.holds, verdicts.cheapest.holds), (2, 2));
    }
}
