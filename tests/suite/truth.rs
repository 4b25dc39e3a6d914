//! Reference values and finite elements against true solutions; contact, iteration by iteration.

use crate::common::found;
use crate::reference::REFERENCES;
use serde_json::json;
use signorini::timing::recorded::{number, text};
use signorini_mathematics::experiments::{Findings, Rows};
use std::sync::OnceLock;

fn findings() -> &'static Findings {
    static ONCE: OnceLock<Findings> = OnceLock::new();
    ONCE.get_or_init(|| found("truth", &json!({ "cells": [16, 32, 64], "sampled": 8 })).unwrap())
}

/// Rows of the table `values` of a problem.
fn values(problem: &str) -> Rows {
    findings()["values"].wherever("problem", problem).unwrap()
}

#[test]
fn arcs_are_numbered_and_forces_alike() {
    let forces = values("four-arcs").wherever("quantity", "force").unwrap();
    assert_eq!(forces.len(), 4);
    for force in forces.numbers("value").unwrap() {
        assert!((force - 1.0 / 32.0).abs() < 1e-10, "{force}");
    }
}

/// Texts of all numbers of a solution of the record, in its order.
fn texts(solution: &toml::Value) -> Vec<&str> {
    match solution {
        toml::Value::String(text) => vec![text],
        toml::Value::Array(values) => values.iter().flat_map(texts).collect(),
        table => ["energy", "centre", "corners", "contact", "from", "to", "force"]
            .iter()
            .filter_map(|key| table.get(key))
            .flat_map(texts)
            .collect(),
    }
}

#[test]
fn the_record_agrees_with_both_programs() {
    let record: toml::Table = include_str!("../../pipeline/truth.toml").parse().unwrap();
    let solutions = record["solution"].as_array().unwrap();
    assert_eq!(solutions.len(), 6);
    for solution in solutions {
        let f = solution["f"].as_str().unwrap();
        let theirs = texts(solution);
        // Of the second program and of one in quadruple precision: not the last bit of a double apart.
        if let Some(known) = REFERENCES.iter().find(|known| known.f == f) {
            for (digits, known) in theirs.iter().zip([known.energy, known.centre]) {
                assert!(
                    (digits.parse::<f64>().unwrap() - known).abs() <= 2e-16 * known.abs(),
                    "{f}"
                );
            }
        }
        let reference = findings()["references"].wherever("f", f).unwrap();
        let ours = values(text(&reference[0], "problem")).numbers("value").unwrap();
        assert_eq!(ours.len(), theirs.len(), "{f}");
        for (ours, theirs) in ours.into_iter().zip(theirs) {
            let error = (ours - theirs.parse::<f64>().unwrap()).abs();
            assert!(error <= 1e-10, "{f}: {ours} is not {theirs}");
        }
    }
}

#[test]
fn bounds_hold_and_are_sharp() {
    let elements = &findings()["elements"];
    for row in elements.iter() {
        let [below, above] = ["lower", "upper"].map(|column| number(row, column));
        assert!(below <= 1.0 + 1e-9 && above >= 1.0 - 1e-9, "{row:?}");
        assert!(row["holds"] != false, "{row:?}");
        if row["cells"] != 64 {
            continue;
        }
        // Cells that a circle cuts add more than those that a straight jump does.
        let most = if text(row, "f").contains("disc") { 1.05 } else { 1.02 };
        assert!(below > 0.98 && above < most, "{row:?}");
        // The load of an accuracy is what the flux balances.
        let [below, above] = ["bilinear_lower", "bilinear_upper"].map(|column| number(row, column));
        assert!((0.98..=1.0 + 1e-9).contains(&below), "{row:?}");
        assert!((1.0 - 1e-9..1.01).contains(&above), "{row:?}");
    }
    for problem in elements.texts("problem").unwrap() {
        let rows = elements.wherever("problem", problem).unwrap();
        // From the coarsest grid to the finest, by two halvings.
        for (column, order) in [("error", 1.0), ("energy", 2.0)] {
            let errors = rows.numbers(column).unwrap();
            if let [coarse, _, fine] = errors[..] {
                assert!((0.5 * (coarse / fine).log2() - order).abs() < 0.1, "{problem} {errors:?}");
            }
        }
    }
    assert_eq!(elements.iter().filter(|row| row["holds"] == true).count(), 18);
    for column in ["bracket", "balance"] {
        let defects = findings()["references"].numbers(column).unwrap();
        assert!(!defects.is_empty() && defects.iter().all(|defect| *defect < 1e-10), "{defects:?}");
    }
}

#[test]
fn values_at_nodes_are_those_of_finite_elements() {
    let samples = |problem: &str| {
        findings()["samples"].wherever("problem", problem).unwrap().numbers("v").unwrap()
    };
    let [first, second] = ["problem 1", "problem 2"].map(samples);
    assert_eq!((first.len(), second.len()), (81, 81));
    // The corners in contact, the others, and the centre.
    assert_eq!((first[80], second[0]), (0.0, 0.0));
    assert!((first[0] - REFERENCES[3].corners[3]).abs() < 1e-11);
    assert!((second[40] - REFERENCES[4].centre).abs() < 1e-11);
    // The rim never sinks below zero.
    for values in [first, second] {
        let rim = (0..81).filter(|k| k % 9 == 0 || k % 9 == 8 || *k < 9 || *k >= 72);
        assert!(rim.clone().count() == 32 && rim.into_iter().all(|k| values[k] >= 0.0));
    }
}

#[test]
fn energies_of_the_book_have_the_digits_that_both_ends_of_their_brackets_share() {
    let truths = &findings()["plane_truths"];
    for row in truths.iter() {
        let digits: Vec<char> = text(row, "energy")
            .chars()
            .filter(char::is_ascii_digit)
            .skip_while(|&c| c == '0')
            .collect();
        let known = -libm::log10(number(row, "bracket"));
        assert!((known - 3.0..=known + 1.0).contains(&(digits.len() as f64)), "{row:?}");
    }
}
