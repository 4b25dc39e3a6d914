//! The experiment on the paper's claims: its counts, what must hold of them, and the verdicts.

use crate::common::{found, table_problems, this_project as project};
use crate::solvers::on_threads;
use serde_json::{Value, json};
use signorini::replication::comparison::Row;
use signorini_mathematics::discrete::load::load;
use signorini_mathematics::experiments::{Findings, Rows};
use signorini_mathematics::problem::law::Law;
use signorini_mathematics::saddle::{NestedGrids, Params, StopRule, solve_nested};
use std::sync::OnceLock;

/// Fields of a plan with fewer r than in the book, and without the finest grid where it is dear.
fn fewer() -> Value {
    let targets = json!([{ "kkt": 1e-3, "cells": 32 }, { "kkt": 1e-6, "cells": 16 }]);
    json!({ "per_decade": 2, "targets": targets })
}

fn measured(table: &str) -> &'static Rows {
    static ONCE: OnceLock<Findings> = OnceLock::new();
    &ONCE.get_or_init(|| found("claims", &fewer()).unwrap())[table]
}

/// Runs of a problem under a stopping rule with an r, coarsest grid first.
fn runs(problem: u8, rule: StopRule, r: f64) -> Rows {
    let runs = measured("runs").wherever("problem", problem).unwrap();
    runs.wherever("end", rule.name()).unwrap().wherever("r", r).unwrap()
}

#[test]
fn the_signed_table_is_the_published_one() {
    let project = project();
    for problem in [1, 2] {
        let mut rows = Vec::new();
        for &r in &project.paper.r {
            let runs = runs(problem, StopRule::Signed, r).wherever("stop", "converged").unwrap();
            let counts = runs.numbers("sweeps").unwrap().iter().map(|&n| n as usize).collect();
            let delta_a = runs.numbers("delta_a").unwrap()[4];
            rows.push(Row { r, counts, capped: vec![false; 5], delta_a });
        }
        let compared = project.paper.compare(problem, "claims", &rows).unwrap();
        assert_eq!(compared.exact, 25, "problem {problem}");
    }
}

#[test]
fn the_lanes_count_what_the_solver_counts() {
    let project = project();
    let scene = project.scene("problem2").unwrap();
    let grids = scene.grids();
    let loads: Vec<_> =
        grids.iter().map(|&grid| load(grid, &scene.source(), scene.load())).collect();
    for rule in StopRule::ALL {
        let params = Params { r: 10.0, rule, ..Params::default() };
        let (outcomes, _) = solve_nested(
            &NestedGrids { grids: &grids, prolongation: scene.saddle().prolongation },
            Law::SIGNORINI,
            &loads,
            &params,
            &mut (),
        );
        let runs = runs(2, rule, 10.0);
        let theirs: Vec<_> = outcomes.iter().map(|one| one.end.iterations as f64).collect();
        assert_eq!(runs.numbers("sweeps").unwrap(), theirs, "{rule}");
        assert_eq!(runs.numbers("delta_a").unwrap()[4], outcomes[4].end.change());
        assert_eq!(runs.numbers("kkt").unwrap()[4], outcomes[4].kkt.relative);
    }
}

#[test]
fn from_ten_up_r_makes_no_difference_to_an_accuracy() {
    // For large r the penalty alone holds the contact nodes at zero.
    let cases = measured("cases").wherever("claim", "depends-on-large-r").unwrap();
    for target in [1e-3, 1e-6] {
        let spreads = cases.wherever("target", target).unwrap().numbers("value").unwrap();
        assert_eq!(spreads.len(), 2);
        assert!(spreads.iter().all(|&spread| spread <= 1.01), "{spreads:?}");
    }
}

#[test]
fn the_verdicts_reproduce() {
    for (claim, holds, all) in [
        ("still-moves", 10, 10),
        ("more-in-last", 5, 5),
        ("dual-costs", 10, 10),
        ("dual-costs-printed", 5, 10),
        ("cheaper than Uzawa, exact inside", 30, 30),
        ("gain-depends-on-r", 6, 6),
    ] {
        let cases = measured("cases").wherever("claim", claim).unwrap();
        assert_eq!(cases.len(), all, "{claim}");
        assert_eq!(cases.wherever("holds", true).unwrap().len(), holds, "{claim}");
    }
    for partly in ["depends-on-r", "cheaper than the best of these"] {
        let cases = measured("cases").wherever("claim", partly).unwrap();
        let holds = cases.wherever("holds", true).unwrap().len();
        assert!(0 < holds && holds < cases.len(), "{partly}");
    }
}

#[test]
fn threads_change_nothing() {
    let mut fewer = fewer();
    fewer["per_decade"] = json!(1);
    fewer["decades"] = json!([0, 2]);
    fewer["compared_r"] = json!([1.0, 10.0]);
    fewer["targets"] = json!([{ "kkt": 1e-3, "cells": 16 }]);
    fewer["problems"] = json!(table_problems());
    for problem in fewer["problems"].as_array_mut().unwrap() {
        problem["statement"]["fineness"] = json!({ "grids": [4, 8, 16] });
    }
    let small = || found("claims", &fewer).unwrap();
    assert_eq!(on_threads(1, small), small());
}

#[test]
fn a_load_without_solution_is_an_error() {
    let mut problems = json!(table_problems());
    problems[0]["statement"]["f"] = "else=1".into();
    let error = found("claims", &json!({ "problems": problems })).unwrap_err();
    assert!(error.contains("no solution on grid 1/4"), "{error}");
}
