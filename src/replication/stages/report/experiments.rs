//! Findings of the experiments by the names that the chapters use: ranges, rules, methods and grids.

use crate::pipeline::Inputs;
use crate::replication::stages::bench;
use serde_json::{Value, json};
use signorini_mathematics::experiments::accuracy::AccuracyFindings;
use signorini_mathematics::experiments::claims::{ClaimMeasure, Claims, Spread, WeightRow};
use signorini_mathematics::experiments::problems::{FRICTION, FrictionProblem};
use signorini_mathematics::experiments::stress::Stress;
use signorini_mathematics::experiments::truth::{Elements, ElementsLevel, Reference};
use signorini_mathematics::experiments::work::{Comparison, CostLaw};
use signorini_mathematics::saddle::StopRule;
use tera::Context;

/// Variant of Uzawa's method in [`Claims`] whose inner minimisation is not carried to its end.
const LOOSE: &str = "Uzawa, loose inside";

/// Inserts the findings of the experiments with grids and rules.
pub(super) fn insert(context: &mut Context, inputs: &Inputs) -> Result<(), String> {
    let found: AccuracyFindings = bench::result(inputs, "accuracy")?;
    context.insert("accuracy", &accuracy(&found));
    context.insert("comparison", &comparison(&found.comparison));
    let of_the_paper = bench::result(inputs, "claims")?;
    context.insert("claims", &claims(&of_the_paper));
    context.insert("friction", &friction(&of_the_paper, &bench::result(inputs, "friction")?));
    context.insert("stress", &stress(&bench::result(inputs, "stress")?));
    Ok(())
}

fn accuracy(found: &AccuracyFindings) -> Value {
    let ranges = &found.ranges;
    let mut work = Vec::new();
    for (k, goal) in ["discretisation error", "residual", "rounding floor"].iter().enumerate() {
        let [known, others] = [ranges.known[k], ranges.others[k]];
        work.push(json!({
            "goal": goal,
            "known": { "least": known[0], "greatest": known[1] },
            "others": { "least": others[0], "greatest": others[1] },
        }));
    }
    json!({
        "from": ranges.from,
        "tolerance": ranges.tolerance,
        "smooth": { "least": ranges.orders[0], "greatest": ranges.orders[1] },
        "jumps": { "least": ranges.contact[0], "greatest": ranges.contact[1] },
        "algebraic": { "l2": ranges.algebraic[0], "h1": ranges.algebraic[1] },
        "work": work,
        // Exponents of 1/h in the sweeps of the paper's method from zero.
        "known_law": law(&found.laws, "exact("),
        "problem2_law": law(&found.laws, "quadrant("),
    })
}

/// Returns the law from zero to the least target for the f that begins with this text.
fn law<'a>(laws: &'a [CostLaw], f: &str) -> Option<&'a CostLaw> {
    let laws = laws.iter().filter(|law| !law.nested && law.f.starts_with(f));
    laws.min_by(|a, b| a.target.total_cmp(&b.target))
}

/// Returns the work units of each method to the discretisation error, on all grids and on the finest one.
fn comparison(found: &Comparison) -> Value {
    let mut rows: Vec<Value> = Vec::new();
    for run in &found.runs {
        let name = run.method.to_lowercase().replace('-', "_");
        for (k, reached) in run.reached.iter().enumerate() {
            if k == rows.len() {
                rows.push(json!({ "cells": reached.cells }));
            }
            rows[k][&name] = reached.work_units.into();
        }
    }
    json!({
        "name": found.name,
        "finest": rows.last(),
        "uzawa_ahead": rows.iter().filter(|row| uzawa_is_ahead(row)).count(),
        "rows": rows,
    })
}

fn uzawa_is_ahead(row: &Value) -> bool {
    row["uzawa"].as_f64() < row["arrow_hurwicz"].as_f64()
}

fn claims(found: &Claims) -> Value {
    let verdicts = &found.verdicts;
    let (mut spreads, mut gains, mut gains_at, mut sums) = (vec![], vec![], vec![], vec![]);
    for problem in &found.problems {
        sums.push(json!({ "published": problem.sums[0], "averaged": problem.sums[1] }));
    }
    let first = found.problems.first();
    for spread in &verdicts.spreads {
        if first.is_some_and(|first| first.number == spread.problem) {
            spreads.push(all_spreads(found, spread));
        }
    }
    for gain in verdicts.gains.iter().filter(|gain| gain.target == rough(found)) {
        let mut others = verdicts.gains.iter().filter(|other| other.name == gain.name);
        let fine = others.find(|other| other.target == fine(found));
        gains.push(json!({ "name": gain.name, "rough": gain, "fine": fine }));
    }
    for [exact, best] in &verdicts.gains_at {
        gains_at.push(json!({ "r": exact.r, "exact": exact, "best": best }));
    }
    let [signed, printed] = verdicts.dual_factors;
    let [exact, best] = verdicts.gains_at_best;
    json!({
        "rough": { "kkt": rough(found) },
        "fine": { "kkt": fine(found), "cells": found.targets.last().map(|target| target.1) },
        "dual_factors": { "signed": signed, "printed": printed },
        "printed_delta": printed_delta(found),
        "spreads": spreads,
        "gains": gains,
        "loose": verdicts.gains.iter().find(|gain| gain.name == LOOSE),
        "gains_at": gains_at,
        "gains_at_best": { "exact": exact, "best": best },
        // Sums of the loads on the finest grid, problem by problem.
        "sums": sums,
        "compared_from": first.and_then(|first| first.cells.first()).map(|cell| cell.cells),
    })
}

/// Returns the counts of the problems with friction under the printed rule with the largest r of the paper, and the counts
/// for each weight of the proximal term, those of the paper's problems first.
fn friction(of_the_paper: &Claims, found: &Claims) -> Value {
    let (mut counts, mut weights) = (Vec::new(), Vec::new());
    for row in &of_the_paper.weight_rows {
        weights.push(weight_row(format!("problem {}", row.problem), row));
    }
    for (FrictionProblem { f, g }, problem) in FRICTION.into_iter().zip(&found.problems) {
        let table = problem.tables.iter().find(|table| table.rule == StopRule::Printed);
        let line = table.and_then(|table| table.lines.iter().max_by(|a, b| a.r.total_cmp(&b.r)));
        let iterations =
            line.map(|line| line.counts.iter().map(|count| count.iterations).collect::<Vec<_>>());
        let delta_a = line.map(|line| line.delta_a);
        counts.push(json!({ "f": f, "g": g, "counts": iterations, "delta_a": delta_a }));
    }
    for (FrictionProblem { f, g }, row) in FRICTION.into_iter().zip(&found.weight_rows) {
        weights.push(weight_row(format!("`{f}`, g = {g}"), row));
    }
    let rows = || of_the_paper.weight_rows.iter().chain(&found.weight_rows);
    let change = rows().map(|row| change(&found.weights, row)).fold(0.0, f64::max);
    let is_ahead = |row: &&WeightRow| {
        row.counts.iter().any(|count| count.iterations <= row.arrow_hurwicz.iterations)
    };
    let ahead = rows().filter(is_ahead).count();
    json!({
        "counts": counts,
        "weights": weights,
        "target": rough(found),
        "change": 100.0 * change,
        "ahead": ahead,
    })
}

/// Largest relative change of the count by a weight of at most 1, against the weight 0.
fn change(weights: &[f64], row: &WeightRow) -> f64 {
    let Some(without) = row.counts.first().map(|count| count.iterations as f64) else { return 0.0 };
    let small = weights.iter().zip(&row.counts).filter(|(weight, _)| **weight <= 1.0);
    small.map(|(_, count)| (count.iterations as f64 / without - 1.0).abs()).fold(0.0, f64::max)
}

fn weight_row(name: String, row: &WeightRow) -> Value {
    let WeightRow { cells, counts, arrow_hurwicz, .. } = row;
    json!({ "name": name, "cells": cells, "counts": counts, "arrow_hurwicz": arrow_hurwicz })
}

/// The larger KKT residual to reach.
fn rough(found: &Claims) -> Option<f64> {
    found.targets.first().map(|target| target.0)
}

/// The smaller KKT residual to reach.
fn fine(found: &Claims) -> Option<f64> {
    found.targets.last().map(|target| target.0)
}

/// Returns the spreads of all problems for the measure of this one, each with the best r there.
fn all_spreads(found: &Claims, spread: &Spread) -> Value {
    let mut problems = Vec::new();
    for problem in &found.problems {
        let mut same = found.verdicts.spreads.iter().filter(|s| s.problem == problem.number);
        let row = problem
            .rows
            .iter()
            .find(|row| row.measure == spread.measure && row.cells == spread.cells);
        problems.push(json!({
            "spread": same.find(|s| s.measure == spread.measure),
            "best": row.and_then(|row| row.best),
        }));
    }
    let measure = match spread.measure {
        ClaimMeasure::Rule(rule) => json!({ "rule": rule }),
        ClaimMeasure::Kkt(kkt) => json!({ "kkt": kkt }),
    };
    json!({ "measure": measure, "cells": spread.cells, "problems": problems })
}

/// Returns the greatest last change of the multiplier under the printed rule, in units of the tolerance.
fn printed_delta(found: &Claims) -> f64 {
    let tables = found.problems.iter().flat_map(|problem| &problem.tables);
    let lines = tables.filter(|table| table.rule == StopRule::Printed).flat_map(|t| &t.lines);
    lines.map(|line| line.excess).fold(0.0, f64::max)
}

fn stress(found: &Stress) -> Value {
    let same = found.summary.scaled_same;
    json!({
        "contact": { "name": found.plan.contact.0, "f": found.plan.contact.1 },
        // Least and greatest exponent of the factor of f with the same iterations.
        "scaled_same": same.map(|[least, greatest]| json!({ "least": least, "greatest": greatest })),
        "deficit_runs": found.deficits.iter().map(Vec::len).sum::<usize>(),
    })
}

/// Returns, of finite elements against true solutions, the effectivities on the coarsest and the finest grid and the
/// orders, problem by problem.
pub(super) fn elements(elements: &[Elements]) -> Vec<Value> {
    let mut rows = Vec::new();
    for one in elements {
        let [error, energy, ends] = one.orders;
        rows.push(json!({
            "name": one.name,
            "coarse": one.levels.first().map(effectivity),
            "fine": one.levels.last().map(effectivity),
            "orders": { "error": error, "energy": energy, "ends": ends },
        }));
    }
    rows
}

fn effectivity(level: &ElementsLevel) -> Value {
    let [least, greatest] = level.effectivity;
    json!({ "cells": level.cells, "least": least, "greatest": greatest })
}

/// Returns the values of the true solutions that are not exactly zero, problem by problem.
pub(super) fn references(references: &[Reference]) -> Vec<Value> {
    let mut rows = Vec::new();
    for Reference { name, f, numbers, .. } in references {
        let places = ["lower left", "lower right", "upper right", "upper left"];
        let corners = places.iter().zip(&numbers.corners).filter(|(_, v)| v.digits != "0");
        let corners = corners.map(|(place, v)| json!({ "place": place, "v": v.digits }));
        let mut contact = Vec::new();
        for arc in &numbers.contact {
            let [from, to] =
                [&arc.from, &arc.to].map(|[x, y]| json!({ "x": x.digits, "y": y.digits }));
            contact.push(json!({ "from": from, "to": to, "force": arc.force.digits }));
        }
        rows.push(json!({
            "name": name,
            "f": f,
            "energy": numbers.energy.digits,
            "centre": numbers.centre.digits,
            "corners": corners.collect::<Vec<_>>(),
            "contact": contact,
        }));
    }
    rows
}
