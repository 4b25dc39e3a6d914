//! What the chapter on the search says: how far f may move, which counts hold it, how much was searched.

use crate::identify::record::{Record, VariantRecord};
use crate::identify::{Breaks, COARSEST, Findings, Measure, Variant};
use serde::Serialize;

/// How sharply a table fixes f.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Fixed {
    /// One entry per quadrant, then the common factor.
    directions: Vec<Direction>,
    /// One row per r, one entry per grid: the smallest move of a single value that changes the count.
    holds: Vec<Vec<Option<f64>>>,
    /// Counts that no single value changes within 1 % of the largest one.
    loose: usize,
    /// That 1 %.
    percent: f64,
    /// Alternatives for which every count comes out.
    equal: usize,
    /// Values of Delta a to both digits for the recovered f, and the most among the others with all counts.
    chosen_deltas: usize,
    other_deltas: usize,
}

/// How far a value may move alone.
#[derive(Clone, Debug, Serialize)]
struct Direction {
    /// What moves: a quadrant, or nothing for the common factor.
    name: &'static str,
    /// Its value.
    value: f64,
    /// How far down and up.
    range: [f64; 2],
    /// The count that changes first, down and up: r, and cells per side of the grid.
    first: [Option<(f64, usize)>; 2],
}

/// How much was searched, and what the model selection says about two variants.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Searched {
    /// Candidates of all searches.
    candidates: u64,
    /// Those of the model selection.
    selection: u64,
    selected: Option<VariantRecord>,
    /// (13) as printed.
    printed: Option<VariantRecord>,
}

const QUADRANTS: [&str; 4] = ["lower left", "lower right", "upper left", "upper right"];

impl Fixed {
    pub(super) fn of(findings: &Findings) -> Self {
        let (map, target) = (&findings.identifiability, &findings.target);
        let cell = |at: Option<(usize, usize)>| at.map(|(k, n)| (target.r[k], COARSEST << n));
        let direction = |b: &Breaks| Direction {
            name: b.piece.map_or("", |p| QUADRANTS[p]),
            value: b.piece.map_or(1.0, |p| map.values[p]),
            range: b.range,
            first: b.first.map(cell),
        };
        let moves = |k: usize, level: usize| {
            let single = map.directions.iter().filter(|b| b.piece.is_some());
            single.flat_map(move |b| b.cells[k][level]).flatten().min_by(f64::total_cmp)
        };
        let levels = target.levels();
        let holds: Vec<Vec<_>> = (0..target.r.len())
            .map(|k| (0..levels).map(|level| moves(k, level)).collect())
            .collect();
        let percent = 0.01 * map.values.iter().fold(0.0f64, |m, v| m.max(v.abs()));
        let loose = holds.iter().flatten().filter(|h| h.is_none_or(|h| h > percent)).count();
        let equal: Vec<_> = findings
            .alternatives
            .iter()
            .filter(|a| a.found.score.exact == a.found.score.cells)
            .collect();
        let deltas = |chosen: bool| {
            let of = equal.iter().filter(|a| a.chosen == chosen);
            of.map(|a| a.found.score.delta_a_exact).max().unwrap_or(0)
        };
        Self {
            directions: map.directions.iter().map(direction).collect(),
            loose,
            holds,
            percent,
            chosen_deltas: deltas(true),
            other_deltas: deltas(false),
            equal: equal.len(),
        }
    }
}

impl Searched {
    pub(super) fn of(record: &Record) -> Self {
        let named = |variant: Variant| {
            let name = variant.to_string();
            record.selection.variant.iter().find(|v| v.name == name).cloned()
        };
        let searches: usize = record.selection.variant.iter().map(|v| v.best.len()).sum();
        let selection = record.selection.candidates * searches as u64;
        Self {
            candidates: selection + record.run.iter().map(|run| run.candidates).sum::<u64>(),
            selection,
            selected: named(Variant::default()),
            printed: named(Variant { measure: Measure::Printed, ..Variant::default() }),
        }
    }
}
