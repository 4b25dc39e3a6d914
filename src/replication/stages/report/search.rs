//! What the chapter on the search says: how far f may move, which counts hold it, how much was searched.

use crate::discrete::norms::largest;
use crate::identify::record::Record;
use crate::identify::{Breaks, COARSEST, Findings, Measure, Variant};
use serde_json::{Value, json};

const QUADRANTS: [&str; 4] = ["lower left", "lower right", "upper left", "upper right"];

/// How sharply a table fixes f.
pub(super) fn fixed(findings: &Findings) -> Value {
    let (map, target) = (&findings.identifiability, &findings.target);
    let cell = |at: Option<(usize, usize)>| at.map(|(k, n)| (target.r[k], COARSEST << n));
    // What moves, nothing for the common factor; how far down and up; and the count that changes first.
    let direction = |b: &Breaks| {
        json!({
            "name": b.piece.map_or("", |p| QUADRANTS[p]),
            "value": b.piece.map_or(1.0, |p| map.values[p]),
            "range": b.range,
            "first": b.first.map(cell),
        })
    };
    // Up to which move of the ladder a count stays, whichever single value moves.
    let stays = |k: usize, level: usize| {
        let single = map.directions.iter().filter(|b| b.piece.is_some());
        single.flat_map(|b| b.cells[k][level]).flatten().min_by(f64::total_cmp)
    };
    let row = |k| (0..target.levels()).map(|level| stays(k, level)).collect::<Vec<_>>();
    let holds: Vec<_> = (0..target.r.len()).map(row).collect();
    let named = target.r.iter().zip(&holds).map(|(r, moves)| json!({ "r": r, "moves": moves }));
    let percent = 0.01 * largest(&map.values);
    // Alternatives for which every count comes out: the most values of Delta a to both digits.
    let deltas = |chosen: bool| {
        let others = findings.alternatives.iter().filter(|other| other.chosen == chosen);
        let scores = others.map(|other| &other.found.score).filter(|s| s.exact == s.cells);
        scores.map(|score| score.delta_a_exact).max().unwrap_or(0)
    };
    json!({
        "directions": map.directions.iter().map(direction).collect::<Vec<_>>(),
        // Counts that no move of a single value by up to 1 % of the largest one changes.
        "loose": holds.iter().flatten().filter(|h| h.is_none_or(|h| h > percent)).count(),
        "holds": named.collect::<Vec<_>>(),
        "percent": percent,
        "chosen_deltas": deltas(true),
        "other_deltas": deltas(false),
    })
}

/// How much was searched, and what the model selection says of the variant selected and of (13) as printed.
pub(super) fn searched(record: &Record) -> Value {
    let named = |variant: Variant| {
        let name = variant.to_string();
        record.selection.variant.iter().find(|v| v.name == name)
    };
    let searches: usize = record.selection.variant.iter().map(|v| v.best.len()).sum();
    let selection = record.selection.candidates * searches as u64;
    json!({
        "candidates": selection + record.run.iter().map(|run| run.candidates).sum::<u64>(),
        "selection": selection,
        "selected": named(Variant::default()),
        "printed": named(Variant { measure: Measure::Printed, ..Variant::default() }),
    })
}
