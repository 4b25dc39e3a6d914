//! Verdicts on the claims: each is split into cases that hold or do not, by a bound stated here.

use super::{Cell, Count, Measure, Measured, Row, VARIANTS};
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
    pub dual_factors: [Range; 2],
    /// Cheaper than Uzawa's algorithm with exact inner minimisation.
    pub cheaper: Tally,
    /// Cheaper than every variant of it.
    pub cheapest: Tally,
    /// Per variant, then the best of all variants in each cell.
    pub gains: Vec<Gain>,
    /// The same per r, over all problems, grids and targets.
    pub gains_at: Vec<GainAt>,
    /// The same with each method at its own best r, per problem, grid and target: exact inner
    /// minimisation, and the best variant.
    pub gains_at_best: [Range; 2],
    /// The gain over exact inner minimisation depends on r, per problem, grid and target.
    pub gain_depends_on_r: Tally,
}

/// Least and greatest.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Range {
    /// Least.
    pub least: f64,
    /// Greatest.
    pub greatest: f64,
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

/// Sweeps of a variant of Uzawa's algorithm over those of Arrow-Hurwicz.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Gain {
    /// Which variant.
    pub name: String,
    /// KKT residual over the largest component of F.
    pub target: f64,
    /// Cells in which Arrow-Hurwicz takes fewer sweeps.
    pub cheaper: Tally,
    /// Cells in which the variant hit the cap: their ratio is a lower bound.
    pub capped: usize,
    /// Cells left out because Arrow-Hurwicz hit the cap too.
    pub left_out: usize,
    /// Median of the ratios.
    pub median: f64,
    /// Their range.
    pub range: Range,
}

/// Sweeps of Uzawa's algorithm over those of Arrow-Hurwicz at one r.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct GainAt {
    /// Duality parameter.
    pub r: f64,
    /// With exact inner minimisation.
    pub exact: Range,
    /// The best variant of each cell.
    pub best: Range,
    /// Cells in which exact inner minimisation hit the cap.
    pub capped: usize,
}

impl Verdicts {
    pub(super) fn of(r: &[f64], problems: &[Measured]) -> Self {
        let spreads: Vec<_> = problems.iter().flat_map(|problem| spreads(r, problem)).collect();
        let lines = |problem: &Measured, rule: StopRule| {
            let table = problem.tables.iter().find(|table| table.rule == rule);
            table.map(|table| table.lines.clone()).unwrap_or_default()
        };
        let factors = |rule: StopRule| -> Vec<f64> {
            problems.iter().flat_map(|problem| lines(problem, rule)).map(|l| l.factor).collect()
        };
        let signed = factors(StopRule::SignedDual);
        let printed = factors(StopRule::PrintedDual);
        let many = |factors: &[f64]| Tally::of(factors.iter().map(|factor| *factor > MANY));
        let excess = |problem: &Measured| -> Vec<f64> {
            lines(problem, StopRule::Signed).iter().map(|line| line.excess).collect()
        };
        let ends = || problems.first().zip(problems.last());
        let targets: Vec<f64> = problems.first().map(targets).unwrap_or_default();
        let gains: Vec<Gain> = targets.iter().flat_map(|target| gains(problems, *target)).collect();
        let cheaper = |name: &str| {
            let of = |gain: &&Gain| gain.name == name;
            let holds: usize = gains.iter().filter(of).map(|gain| gain.cheaper.holds).sum();
            let cases: usize = gains.iter().filter(of).map(|gain| gain.cheaper.cases).sum();
            Tally::of((0..cases).map(|k| k < holds))
        };
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
                    .flat_map(|(a, b)| excess(b).into_iter().zip(excess(a)))
                    .map(|(last, first)| last > first),
            ),
            dual_costs: many(&signed),
            dual_costs_printed: many(&printed),
            dual_factors: [Range::of(&signed), Range::of(&printed)],
            cheaper: cheaper(VARIANTS[0].name),
            cheapest: cheaper(BEST),
            gain_depends_on_r: Tally::of(problems.iter().flat_map(gain_depends_on_r)),
            gains,
            gains_at: gains_at(problems),
            gains_at_best: [
                gains_at_best(problems, |counts| counts[0]),
                gains_at_best(problems, best),
            ],
            spreads,
        }
    }
}

impl Range {
    fn of(values: &[f64]) -> Self {
        Self {
            least: values.iter().copied().fold(f64::INFINITY, f64::min),
            greatest: values.iter().copied().fold(0.0, f64::max),
        }
    }
}

/// The row on the finest grid of each measure.
fn finest(problem: &Measured) -> impl Iterator<Item = &Row> {
    // Rows go from coarse to fine.
    problem.rows.chunk_by(|a, b| a.measure == b.measure).filter_map(<[Row]>::last)
}

fn spreads<'a>(r: &'a [f64], problem: &'a Measured) -> impl Iterator<Item = Spread> {
    let paper: Vec<f64> = problem.tables[0].lines.iter().map(|line| line.r).collect();
    let Range { least, greatest } = Range::of(&paper);
    finest(problem).map(move |row| {
        let within = |low: f64, high: f64| {
            let counts = r.iter().zip(&row.counts).filter(move |(r, _)| low <= **r && **r <= high);
            counts.map(|(_, count)| count.iterations as f64).collect::<Vec<_>>()
        };
        let spread = |range: Range| range.greatest / range.least;
        let inside = r.iter().zip(&row.counts).filter(|(r, _)| least <= **r && **r <= greatest);
        Spread {
            problem: problem.number,
            cells: row.cells,
            measure: row.measure,
            paper: spread(Range::of(&within(least, greatest))),
            large: spread(Range::of(&within(10.0, f64::INFINITY))),
            capped: inside.into_iter().any(|(_, count)| count.reached().is_none()),
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

/// Name of the best variant in each cell.
const BEST: &str = "the best of these";

fn gains(problems: &[Measured], target: f64) -> Vec<Gain> {
    let cells = || problems.iter().flat_map(|p| &p.cells).filter(|cell| cell.target == target);
    let left_out = cells().filter(|cell| cell.arrow_hurwicz.reached().is_none()).count();
    let gain = |name: &str, pick: &dyn Fn(&[Count; 4]) -> Count| {
        let pairs: Vec<_> = cells()
            .filter_map(|cell| Some((cell.arrow_hurwicz.reached()?, pick(&cell.uzawa))))
            .collect();
        let mut ratios: Vec<f64> =
            pairs.iter().map(|(ours, theirs)| theirs.iterations as f64 / *ours as f64).collect();
        let cheaper = Tally::of(ratios.iter().map(|ratio| *ratio > 1.0));
        ratios.sort_by(f64::total_cmp);
        Gain {
            name: name.into(),
            target,
            cheaper,
            capped: pairs.iter().filter(|(_, theirs)| theirs.reached().is_none()).count(),
            left_out,
            median: ratios.get(ratios.len() / 2).copied().unwrap_or(f64::NAN),
            range: Range::of(&ratios),
        }
    };
    let mut gains: Vec<_> = (0..VARIANTS.len())
        .map(|variant| gain(VARIANTS[variant].name, &|counts| counts[variant]))
        .collect();
    gains.push(gain(BEST, &best));
    gains
}

/// The variant with the fewest sweeps.
fn best(counts: &[Count; 4]) -> Count {
    let least = counts.iter().min_by_key(|count| (count.reached().is_none(), count.iterations));
    *least.expect("four of them")
}

fn gains_at(problems: &[Measured]) -> Vec<GainAt> {
    let mut all: Vec<f64> = problems.iter().flat_map(|p| &p.cells).map(|cell| cell.r).collect();
    all.sort_by(f64::total_cmp);
    all.dedup();
    let at = |r: f64| {
        let cells = || problems.iter().flat_map(|p| &p.cells).filter(move |cell| cell.r == r);
        let range = |pick: fn(&[Count; 4]) -> Count| {
            let ratio = |cell: &Cell| {
                let ours = cell.arrow_hurwicz.reached()?;
                Some(pick(&cell.uzawa).iterations as f64 / ours as f64)
            };
            Range::of(&cells().filter_map(ratio).collect::<Vec<_>>())
        };
        let capped = cells().filter(|cell| cell.uzawa[0].reached().is_none()).count();
        GainAt { r, exact: range(|counts| counts[0]), best: range(best), capped }
    };
    all.into_iter().map(at).collect()
}

fn gains_at_best(problems: &[Measured], pick: fn(&[Count; 4]) -> Count) -> Range {
    let ratio = |cells: &[Cell]| {
        let ours = cells.iter().filter_map(|cell| cell.arrow_hurwicz.reached()).min()?;
        let theirs = cells.iter().map(|cell| pick(&cell.uzawa).iterations).min()?;
        Some(theirs as f64 / ours as f64)
    };
    let rows = problems.iter().flat_map(|problem| problem.cells.chunk_by(same_row));
    Range::of(&rows.filter_map(ratio).collect::<Vec<_>>())
}

/// Whether two cells differ in r only.
fn same_row(a: &Cell, b: &Cell) -> bool {
    a.cells == b.cells && a.target == b.target
}

/// Whether the gain over exact inner minimisation varies with r, per grid and target.
fn gain_depends_on_r(problem: &Measured) -> Vec<bool> {
    let vary = |cells: &[Cell]| {
        let ratios: Vec<f64> = cells
            .iter()
            .filter_map(|cell| {
                Some(cell.uzawa[0].iterations as f64 / cell.arrow_hurwicz.reached()? as f64)
            })
            .collect();
        let range = Range::of(&ratios);
        range.greatest > EQUAL * range.least
    };
    problem.cells.chunk_by(same_row).map(vary).collect()
}
