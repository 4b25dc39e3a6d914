//! Data of the chapter on the search: ranges of f, the counts that bound them, and the extent of the search.

use crate::replication::identified::Record;
use serde_json::{Value, json};
use signorini_mathematics::discrete::norms::largest;
use signorini_mathematics::identify::{
    Breaks, COARSEST, Findings, Identifiability, Measure, Variant,
};
use std::collections::BTreeMap;

const QUADRANTS: [&str; 4] = ["lower left", "lower right", "upper left", "upper right"];

/// Returns the candidates that this run's search tried and that entered each grid, and its best f.
pub(super) fn blind(findings: &Findings) -> Value {
    let search = &findings.search;
    let best = search.found.first().map(|best| {
        json!({
            "f": best.f,
            "exact": best.exact,
            "cells": best.cells,
            "delta_a_exact": best.delta_a_exact,
            "deltas": best.delta_a.len(),
        })
    });
    json!({ "tried": search.tried, "entered": search.reached, "best": best })
}

/// Returns the range of f within which the counts of a table stay, and the counts that bound it.
pub(super) fn fixed(findings: &Findings) -> Value {
    let (map, target) = (&findings.identifiability, &findings.target);
    let directions: Vec<_> =
        map.directions.iter().map(|breaks| direction(findings, breaks)).collect();
    let percent = 0.01 * largest(&map.values);
    let (mut loose, mut holds) = (0, Vec::new());
    for (k, r) in target.r.iter().enumerate() {
        let moves: Vec<_> =
            (0..target.levels()).map(|level| greatest_move(map, k, level)).collect();
        loose += moves.iter().filter(|greatest| greatest.is_none_or(|it| it > percent)).count();
        holds.push(json!({ "r": r, "moves": moves }));
    }
    json!({
        "directions": directions,
        // Counts that no move of a single value by up to 1 % of the largest one changes.
        "loose": loose,
        "holds": holds,
        "percent": percent,
        "chosen_deltas": most_delta_a(findings, true),
        "other_deltas": most_delta_a(findings, false),
    })
}

/// Returns the quadrant whose value moves, with an empty name for the common factor, the moves down and up within which
/// no count changes, and the r and grid of the count that changes first on either side.
fn direction(findings: &Findings, breaks: &Breaks) -> Value {
    let (map, target) = (&findings.identifiability, &findings.target);
    let [down, up] = breaks.range;
    let [first_down, first_up] = breaks
        .first
        .map(|cell| cell.map(|(k, level)| json!({ "r": target.r[k], "cells": COARSEST << level })));
    json!({
        "name": breaks.piece.map_or("", |p| QUADRANTS[p]),
        "value": breaks.piece.map_or(1.0, |p| map.values[p]),
        "down": down,
        "up": up,
        "first_down": first_down,
        "first_up": first_up,
    })
}

/// Returns the greatest of the moves tried up to which this count stays, whichever single value moves; `None` if it
/// stays under all moves tried.
fn greatest_move(map: &Identifiability, k: usize, level: usize) -> Option<f64> {
    let single = map.directions.iter().filter(|breaks| breaks.piece.is_some());
    single.flat_map(|breaks| breaks.cells[k][level]).flatten().min_by(f64::total_cmp)
}

/// Returns the largest number of values of Delta a to both digits among the alternatives that give every count.
fn most_delta_a(findings: &Findings, chosen: bool) -> usize {
    let others = findings.alternatives.iter().filter(|other| other.chosen == chosen);
    let exact = others.map(|other| &other.found).filter(|found| found.exact == found.cells);
    exact.map(|found| found.delta_a_exact).max().unwrap_or(0)
}

/// Returns the number of candidates searched, and the results of the model selection for the selected variant and for
/// (13) as printed.
pub(super) fn searched(record: &Record) -> Value {
    let variants = &record.selection.variant;
    let searches: usize = variants.iter().map(|variant| variant.best.len()).sum();
    let selection = record.selection.candidates * searches as u64;
    let selected = Variant::default().to_string();
    let printed = Variant { measure: Measure::Printed, ..Variant::default() }.to_string();
    json!({
        "candidates": selection + record.run.iter().map(|run| run.candidates).sum::<u64>(),
        "selection": selection,
        "selected": variants.iter().find(|variant| variant.name == selected),
        "printed": variants.iter().find(|variant| variant.name == printed),
    })
}

/// Lists of all problems together: the name for the templates, and the place of the list in a problem.
pub(super) const LISTS: [(&str, &str); 3] = [
    ("directions", "/fixed/directions"),
    ("holds", "/fixed/holds"),
    ("alternatives", "/findings/alternatives"),
];

/// Joins the lists at this place in the problems; each element gets the number of its problem.
pub(super) fn numbered(problems: &[BTreeMap<String, Value>], place: &str) -> Vec<Value> {
    let mut joined = Vec::new();
    for problem in problems {
        let problem = json!(problem);
        for element in problem.pointer(place).and_then(Value::as_array).into_iter().flatten() {
            let mut element = element.clone();
            element["problem"] = problem["number"].clone();
            joined.push(element);
        }
    }
    joined
}
