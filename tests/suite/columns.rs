//! Templates name tables and columns that are there: of findings, of recorded times, and of other data.

use crate::common::found;
use regex::Regex;
use serde_json::{Value, json};
use signorini::timing::recorded::Timings;
use signorini_mathematics::experiments::{EXPERIMENTS, Rows};
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

/// Columns of other rows: of versions, of what the stage `identify` finds, of what its record keeps, of the times of
/// both fast solvers, and of studies.
const OTHERS: [&str; 16] = [
    "name",
    "found.exact",
    "found.delta_a_exact",
    "candidates",
    "chosen",
    "milliseconds",
    "ratio",
    "friction",
    "contact_length",
    "solution",
    "h",
    "error_l2",
    "error_h1",
    "error_max",
    "error_relative",
    "iterations",
];

/// Fields of the plan of an experiment with which it takes next to no time.
fn coarse(experiment: &str) -> Value {
    match experiment {
        "radius" => json!({ "cells": [8], "r": [10.0, 1.0] }),
        "truth" => json!({ "cells": [16], "sampled": 8 }),
        _ => json!({}),
    }
}

fn enter(rows: &Rows, columns: &mut BTreeSet<String>) {
    columns.extend(rows.iter().flat_map(|row| row.keys().cloned()));
}

#[test]
fn every_table_and_column_that_a_template_names_is_there() {
    let (mut tables, mut columns) = (BTreeSet::new(), BTreeSet::from(OTHERS.map(str::to_owned)));
    for experiment in &EXPERIMENTS {
        tables.insert(format!("{}.plan", experiment.name));
        for (table, rows) in found(experiment.name, &coarse(experiment.name)).unwrap() {
            enter(&rows, &mut columns);
            tables.insert(format!("{}.{table}", experiment.name));
        }
    }
    let timings = Timings::parse(include_str!("../../pipeline/timings.toml")).unwrap().extended();
    for rows in json!(timings).as_object().unwrap().values() {
        if let Ok(rows) = serde_json::from_value(rows.clone()) {
            enter(&rows, &mut columns);
        }
    }
    let table = Regex::new(r"\bbench\.(\w+\.\w+)").unwrap();
    let column =
        Regex::new(r#"\b(?:where|column|order|rate)\((?:key|x)="([^"]+)"(?:, y="([^"]+)")?"#)
            .unwrap();
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("report/templates");
    let mut seen = 0;
    for template in fs::read_dir(folder).unwrap() {
        let path = template.unwrap().path();
        let text = fs::read_to_string(&path).unwrap();
        for named in table.captures_iter(&text) {
            assert!(tables.contains(&named[1]), "{}: no table {}", path.display(), &named[1]);
        }
        for named in column.captures_iter(&text) {
            for name in named.iter().skip(1).flatten() {
                let name = name.as_str();
                assert!(columns.contains(name), "{}: no column {name}", path.display());
                seen += 1;
            }
        }
    }
    assert!(seen > 100, "{seen}");
}
