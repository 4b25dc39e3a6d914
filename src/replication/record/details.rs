//! Details of an answer in JSON, beside its numbers: what only JSON shows.
//!
//! Central is [`details`]: `solve` prints them, a study with its members, and the artifact of a member has them.

use super::Record;
use super::levels::LevelNumbers;
use crate::replication::fields::member::Varying;
use crate::replication::fields::table::FIELDS;
use serde::Serialize;
use serde_json::{Map, Value, json};
use signorini_mathematics::bounds::Accuracy;
use signorini_mathematics::problem::law::Law;
use signorini_mathematics::solvers::{Run, Solved};
use signorini_mathematics::statement::{Fineness, Statement};

/// Returns the details of the answer to a statement, with its numbers on these levels.
pub(crate) fn details(
    statement: &Statement,
    solved: &Solved,
    record: &Record,
    levels: &[LevelNumbers],
) -> Map<String, Value> {
    let facts = solved.problem.levels().facts();
    let mut json = Map::new();
    let mut insert = |of: Value| json.extend(of.as_object().cloned().unwrap_or_default());
    insert(json!({
        "f": facts.f,
        "dimension": facts.dimension,
        "integral_f": solved.integral(),
        "contact": solved.contact(),
        "bound": bound(solved),
        "failure": record.failure.as_ref().map(|failure| &failure.fact),
    }));
    if let Some(reason) = solved.no_bound() {
        insert(json!({ "bound_reason": reason.to_string() }));
    }
    match solved.problem.law() {
        Some(Law::SIGNORINI) => {}
        Some(law) => insert(json!({ "law": ends(law) })),
        None => {
            let laws = solved.problem.levels().laws().into_iter();
            insert(
                json!({ "law": laws.map(|(part, law)| (part, ends(law))).collect::<Map<_, _>>() }),
            );
        }
    }
    if let Some(found) = solved.truth() {
        insert(of_truth(&found.checks));
    }
    let parts = solved.on_parts();
    if parts.len() > 1 || parts.iter().any(|part| part.law.is_by_formula()) {
        let mut rows = Vec::new();
        for part in parts {
            let states = (part.states.all() > 0).then_some(part.states);
            let law = part.in_words;
            rows.push(
                json!({ "part": part.name, "law": law, "force": part.force, "states": states }),
            );
        }
        insert(json!({ "parts": rows }));
    }
    if let Some(run) = solved.run() {
        insert(json!({ "grids": levels }));
        insert(on_levels(statement, solved, run));
        insert(of_method(statement, solved, run));
    }
    json
}

/// Returns the settings, by name, on which an answer on levels depends besides f and how fine they are: the law, and
/// the fields that not all solvers take.
pub(crate) fn settings(statement: &Statement) -> Vec<(&'static str, Varying)> {
    let laws = statement.boundary.in_words().ok().flatten();
    let mut settings: Vec<_> = laws.map(|laws| ("law", Varying::Text(laws))).into_iter().collect();
    for field in FIELDS.iter().filter(|field| field.is_of_solver()) {
        // Of the problem, what is not as usual.
        if field.is_of_problem && field.named(statement).is_none() {
            continue;
        }
        settings.extend(field.varying(statement).map(|value| (field.name, value)));
    }
    settings
}

/// Numbers of a law; none where its value is a formula.
fn ends(law: Law) -> Value {
    json!({ "at": law.at(), "lo": finite(law.lo()), "hi": finite(law.hi()) })
}

/// A number, null if it is infinite.
fn finite(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}

/// Guaranteed bounds on the finest level; null without.
fn bound(solved: &Solved) -> Value {
    let Some(bounds) = solved.last_bounds() else { return Value::Null };
    let mut json = json!({
        "energy": bounds.energy,
        "error": bounds.error,
        "recovered": bounds.recovered,
        "relative": { "energy": bounds.relative_energy(), "error": bounds.relative() },
        "reserve": solved.reserves(),
    });
    if let Some(curve) = bounds.curve {
        json["curve"] = curve.into();
    }
    json
}

/// Details that only a true solution has.
fn of_truth(checks: &impl Serialize) -> Value {
    json!({
        "grids": null,
        "grids_reason": "the spectral solver uses no grid",
        "checks": checks,
    })
}

/// Details of a solution on levels.
fn on_levels(statement: &Statement, solved: &Solved, run: &Run) -> Value {
    let problem = &solved.problem;
    let states = run.judgement.state_counts();
    let has_width =
        statement.domain.is_square() || matches!(statement.fineness, Fineness::Width(_));
    let mut json = json!({
        // Of the square and the cube that of their cells, on other meshes the longest edge.
        "h": match statement.fineness.cells().last() {
            Some(&cells) if has_width && statement.accuracy().is_none() => 1.0 / cells as f64,
            _ => problem.levels().facts().width,
        },
        "unknowns": run.y.len(),
        "contact_nodes": { "nodes": states.sticks, "boundary_nodes": states.all() },
    });
    if !problem.is_signorini() {
        json["states"] = json!(states);
    }
    if let Some(errors) = solved.errors() {
        json["errors"] = json!(errors);
    }
    if problem.levels().facts().dimension == 3 {
        json["contact_reason"] =
            "the contact set in space is part of a surface, without arcs".into();
    }
    json
}

/// Details of the way in which a solution on levels was found.
fn of_method(statement: &Statement, solved: &Solved, run: &Run) -> Value {
    let mut json = json!({});
    if statement.solver.is_nested() {
        let sweeps = run.ends.iter().map(|outcome| outcome.end.sweeps());
        json["sweeps_per_grid"] = sweeps.collect::<Vec<_>>().into();
    }
    let Some(accuracy) = statement.accuracy() else { return json };
    if let Accuracy::Energy(_) = accuracy {
        json["energy_of_linear_v"] = run.last().energy.into();
    }
    if let Some(way) = solved.way() {
        json["adapted"] = json!({
            "meshes": way.tried,
            "kind": way.kind(),
            "nodes": run.y.len(),
            "reached": solved.last_bounds().map(|bounds| accuracy.reached(bounds)),
            "end": way.end.name(),
        });
    }
    json
}
