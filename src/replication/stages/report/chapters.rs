//! What the templates of the chapters are given: plain data, everything computed, nothing formatted.

use super::digits::compared;
use super::search::{fixed, searched};
use super::times::times;
use super::versions;
use crate::discrete::load::integral;
use crate::discrete::norms::worst;
use crate::experiments::Range;
use crate::experiments::truth::{Elements, Truth};
use crate::identify::Findings;
use crate::identify::record::Record;
use crate::pipeline::error::{Failure, from_toml};
use crate::pipeline::{Inputs, hash};
use crate::problem::exact::Exact;
use crate::problem::source::Source;
use crate::replication::comparison::TableComparison;
use crate::replication::project::{IDENTIFIED, TRUTH};
use crate::replication::scene::Scene;
use crate::replication::stages::diff::{self, DIFF};
use crate::replication::stages::identify::{self, FINDINGS};
use crate::replication::stages::results::{self, Results};
use crate::replication::stages::solve::{self, HISTORY, OUTCOMES, Outcomes};
use crate::replication::stages::{artifact, bench, from_json};
use crate::saddle::{Iteration, Outcome, Pair, StopRule, tolerance};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use tera::Context;

/// The rules that the chapters compare: of the tables, as printed, and with the dual one.
pub(super) const RULES: [StopRule; 3] = [StopRule::Signed, StopRule::Printed, StopRule::SignedDual];

/// What the templates of the chapters know of results, by name.
pub(super) fn context(
    inputs: &Inputs,
    problems: &[Scene],
    others: &[Scene],
) -> Result<Context, Failure> {
    let results = Results::read(artifact(inputs, results::ID, results::FILE)?)?;
    let table = |scene: &Scene| from_json(inputs, &diff::id(scene), DIFF);
    let tables = problems.iter().map(table).collect::<Result<Vec<TableComparison>, _>>()?;
    let shown = problems.iter().zip(&tables);
    let shown = shown.map(|(scene, table)| problem(inputs, &results, scene, table));
    let others = others.iter().map(|scene| other(inputs, scene));
    let text = inputs.files.get(IDENTIFIED).ok_or("no record of the search")?;
    let record: Record = from_toml(IDENTIFIED, text)?;
    let grids: Vec<usize> = problems[0].grids.iter().map(|grid| grid.cells()).collect();

    let mut context = Context::new();
    context.insert("agreement", &results.agreement(&tables)?);
    context.insert("problems", &shown.collect::<Result<Vec<_>, _>>()?);
    context.insert("scenes", &others.collect::<Result<Vec<_>, _>>()?);
    context.insert("r", &tables[0].rows.iter().map(|row| row.r).collect::<Vec<_>>());
    context.insert("finest", &grids.last());
    context.insert("tolerance", &tolerance(grids.len()));
    context.insert("grids", &grids);
    // Depth and lift of the known solution whose lift is slight.
    let grid = problems[0].finest();
    let line = |k| grid.coordinate(k);
    let nodes = (0..grid.nodes()).map(|k| (line(k % grid.side()), line(k / grid.side())));
    let heights = nodes.map(|(x, y)| Exact::FreeCorner.at(x, y).value);
    context.insert("free_corner", &Range::of(heights));
    context.insert("searched", &searched(&record));
    context.insert("record", &record);
    context.insert("bench", &bench::results(inputs)?);
    let Truth { mut references, elements, .. } = bench::result(inputs, "truth")?;
    let text = inputs.files.get(TRUTH).ok_or("no true solutions")?;
    context.insert("digits", &compared(&mut references, text)?);
    context.insert("references", &references);
    context.insert("figures", &figures(inputs));
    context.insert("provenance", &provenance(inputs));
    let timings = bench::times(inputs)?;
    context.insert("cost", &times(&timings, &bench::result(inputs, "accuracy")?));
    context.insert("timings", &timings);
    context.insert("effectivity", &effectivity(&elements));
    Ok(context)
}

/// Cells per side from which the guaranteed bound of the error is close to the error.
const EFFECTIVE_FROM: usize = 64;

/// The greatest guaranteed bound over the error from [`EFFECTIVE_FROM`] on, for the default load and `bilinear`.
fn effectivity(elements: &[Elements]) -> Value {
    let levels = || elements.iter().flat_map(|one| &one.levels);
    let fine = || levels().filter(|level| level.cells >= EFFECTIVE_FROM);
    json!({
        "from": EFFECTIVE_FROM,
        "exact": worst(fine().map(|level| level.effectivity[1])),
        "bilinear": worst(fine().map(|level| level.bilinear[1])),
    })
}

/// The fields of a scene, and more.
fn extended(scene: &Scene, more: Value) -> BTreeMap<String, Value> {
    let fields = [json!(scene), more].into_iter().filter_map(|value| value.as_object().cloned());
    fields.flatten().collect()
}

/// One of the paper's problems: its scene, its solves under the [`RULES`], its table.
fn problem(
    inputs: &Inputs,
    results: &Results,
    scene: &Scene,
    table: &TableComparison,
) -> Result<BTreeMap<String, Value>, Failure> {
    let columns = |rule: StopRule| -> Result<Vec<Outcomes>, String> {
        let column = |r: f64| from_json(inputs, &solve::id(scene, rule, r), OUTCOMES);
        table.rows.iter().map(|row| column(row.r)).collect()
    };
    let [signed, printed, dual] = RULES.map(columns);
    let (signed, printed, dual) = (signed?, printed?, dual?);
    let bound = tolerance(scene.grids.len());
    let three = signed.iter().zip(&printed).zip(&dual);
    let finest = three.filter_map(|((signed, printed), dual)| {
        let (r, signed) = (signed.r, signed.levels.last()?);
        let (printed, dual) = (printed.levels.last()?, dual.levels.last()?);
        // `max |dM/dy|` over the tolerance where the signed rule stops.
        let excess = signed.gradient_abs / bound;
        Some(
            json!({ "r": r, "signed": signed, "printed": printed, "dual": dual, "excess": excess }),
        )
    });
    let stopped = solve::pair(inputs, scene, scene.stop[0])?;
    let delta_a = table.rows.iter().map(|row| row.delta_a_paper).fold(0.0, f64::max);
    let gap = delta_a * scene.finest().h();
    let findings: Findings = from_json(inputs, &identify::id(scene), FINDINGS)?;
    let more = json!({
        "number": table.table,
        "integral_f": integral(&scene.f),
        "values": values(&scene.f),
        "misses": misses(inputs, scene, table)?,
        "boundary_nodes": stopped.a.len(),
        "stopped": shape(&stopped, scene),
        "solution": shape(&solve::solution(scene)?, scene),
        "fixed": fixed(&findings),
        "findings": findings,
        "agreement": results.of_problem(&scene.name)?.agreement(std::slice::from_ref(table))?,
        // Of the load vector on each grid.
        "sums": signed[0].levels.iter().map(|outcome| outcome.sum_load).collect::<Vec<_>>(),
        // What the largest published Delta a leaves in the gradient, h Delta a, and over the tolerance.
        "gap": [gap, gap / bound],
        // A row per r.
        "finest": finest.collect::<Vec<_>>(),
        // A column per r.
        "signed": signed,
        "printed": printed,
        "table": table,
    });
    Ok(extended(scene, more))
}

/// A surface in a few numbers.
fn shape(pair: &Pair, scene: &Scene) -> Value {
    let heights = Range::of(pair.y.iter().copied());
    json!({
        "least": heights.map(|range| range.least),
        "greatest": heights.map(|range| range.greatest),
        // Boundary nodes in contact.
        "contact": pair.in_contact(scene.finest()).into_iter().filter(|&contact| contact).count(),
        // Total inflow: the sum of h times the multiplier over the boundary.
        "inflow": scene.finest().h() * pair.a.iter().sum::<f64>(),
    })
}

/// Values of f on its pieces, the background last.
fn values(f: &Source) -> Vec<f64> {
    let Source::Pieces { background, pieces } = f else { return Vec::new() };
    pieces.iter().map(|(_, value)| *value).chain([*background]).collect()
}

/// The values of Delta a that miss the published digits, each with that of the last three iterations.
fn misses(inputs: &Inputs, scene: &Scene, table: &TableComparison) -> Result<Vec<Value>, String> {
    let missed = table.rows.iter().filter(|row| !row.delta_a_exact());
    let miss = missed.map(|row| {
        let id = solve::id(scene, scene.stop[0], row.r);
        let levels: Vec<Vec<Iteration>> = from_json(inputs, &id, HISTORY)?;
        let finest = levels.last().map_or(&[][..], |level| &level[level.len().saturating_sub(3)..]);
        let last: Vec<_> = finest.iter().map(|step| (step.number, step.delta_a)).collect();
        Ok(json!({ "r": row.r, "paper": row.delta_a_paper, "last": last }))
    });
    miss.collect()
}

/// A scene that is not the paper's, under its first rule and with the r that is drawn.
fn other(inputs: &Inputs, scene: &Scene) -> Result<BTreeMap<String, Value>, Failure> {
    let path = format!("pipeline/scenes/{}.toml", scene.name);
    let text = inputs.files.get(&path).ok_or_else(|| format!("{path} is missing"))?;
    let solved = solve::id(scene, scene.stop[0], scene.draw_r);
    let outcomes: Outcomes = from_json(inputs, &solved, OUTCOMES)?;
    let more = json!({
        "text": String::from_utf8(text.clone())?,
        "integral_f": integral(&scene.f),
        // The exact solution in LaTeX, if it is known.
        "exact": scene.f.exact().map(|exact| exact.latex()),
        // Per grid, as `solve` names it.
        "ends": outcomes.levels.iter().map(Outcome::end).collect::<Vec<_>>(),
        "outcomes": outcomes,
    });
    Ok(extended(scene, more))
}

/// All figures by their names: the file in the book's folder `figures`, and where in the book its data are, in
/// a table beside it or on the page of data with the solution.
fn figures<'a>(inputs: &'a Inputs) -> BTreeMap<&'a str, Value> {
    let mut figures = BTreeMap::new();
    for made in inputs.artifacts.iter().filter(|(id, _)| id.starts_with("figures/")) {
        for (file, svg) in made.1 {
            let Some(name) = file.strip_suffix(".svg") else { continue };
            let table = format!("{name}.csv");
            let data = match made.1.contains_key(&table) {
                true => format!("figures/{table}"),
                false => "data.html".into(),
            };
            figures.insert(name, json!({ "file": file, "data": data, "hash": short_hash(svg) }));
        }
    }
    figures
}

/// As much of a hash as a reader compares.
fn short_hash(bytes: &[u8]) -> String {
    hash(bytes)[..12].to_owned()
}

/// Where the book's numbers come from: names and hashes of what was read and made, and versions.
fn provenance(inputs: &Inputs) -> Value {
    let made = inputs.artifacts.iter().filter(|(id, _)| !id.starts_with("solve/"));
    let made = made.flat_map(|(id, made)| {
        made.iter().map(move |(name, bytes)| (format!("{id}/{name}"), short_hash(bytes)))
    });
    let read = inputs.files.iter().map(|(name, bytes)| (name, short_hash(bytes)));
    json!({
        "figures": figures(inputs).keys().collect::<Vec<_>>(),
        "inputs": read.collect::<Vec<_>>(),
        "artifacts": made.collect::<Vec<_>>(),
        "versions": versions(),
        // Of code and text, as an SPDX expression.
        "license": env!("CARGO_PKG_LICENSE"),
    })
}
