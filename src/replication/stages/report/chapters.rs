//! Data for the templates of the chapters: computed numbers, not formatted.

use super::times::times;
use crate::pipeline::Inputs;
use crate::pipeline::error::{Failure, from_record};
use crate::pipeline::names::in_shell;
use crate::replication::comparison::TableComparison;
use crate::replication::fields::described::described;
use crate::replication::fields::write;
use crate::replication::identified::IdentifiedRecord;
use crate::replication::limits::LIMITS;
use crate::replication::numbers::Numbers;
use crate::replication::project::IDENTIFIED;
use crate::replication::record::levels::LevelNumbers;
use crate::replication::scene::{Output, Scene};
use crate::replication::stages::diff::{self, DIFF};
use crate::replication::stages::identify::{self, FINDINGS};
use crate::replication::stages::members;
use crate::replication::stages::results::{self, Results};
use crate::replication::stages::solve::{self, HISTORY, NUMBERS};
use crate::replication::stages::{artifact, bench, figures, from_json, scene_of};
use serde::Serialize;
use serde_json::{Value, json};
use signorini_mathematics::identify::Findings;
use signorini_mathematics::problem::exact::Known;
use signorini_mathematics::problem::source::Source;
use signorini_mathematics::saddle::{Iteration, Pair, StopRule, tolerance};
use std::collections::BTreeMap;
use tera::Context;

/// Rules that the chapters compare: that of the tables, the printed one, and the dual one.
pub(super) const RULES: [StopRule; 3] = [StopRule::Signed, StopRule::Printed, StopRule::SignedDual];

/// Returns the results that the templates of the chapters show, by name.
pub(super) fn context(
    inputs: &Inputs,
    problems: &[Scene],
    others: &[Scene],
) -> Result<Context, Failure> {
    let results = Results::read(artifact(inputs, results::ID, results::FILE)?)?;
    let mut tables: Vec<TableComparison> = Vec::new();
    for scene in problems {
        tables.push(from_json(inputs, &diff::id(scene), DIFF)?);
    }
    let text = inputs.file(IDENTIFIED)?.ok_or("no record of the search")?;
    let record: IdentifiedRecord = from_record(IDENTIFIED, text)?;
    let grids: Vec<usize> = problems[0].statement.fineness.cells();

    let mut context = Context::new();
    context.insert("agreement", &results.agreement(&tables)?);
    let problems_and_tables = problems.iter().zip(&tables);
    let mut shown = Vec::new();
    for (scene, table) in problems_and_tables {
        let problem = problem(inputs, &results, scene, table)?;
        context.insert(format!("problem{}", table.table), &problem);
        shown.push(problem);
    }
    context.insert("problems", &shown);
    let others = others.iter().map(|scene| other(inputs, scene));
    let others = others.collect::<Result<Vec<_>, _>>()?;
    let mut gallery: Vec<&BTreeMap<String, Value>> = others.iter().collect();
    gallery.retain(|scene| scene["outputs"] == json!([Output::Map]));
    context.insert("gallery", &gallery);
    context.insert("scenes", &others);
    context.insert("r", &tables[0].rows.iter().map(|row| row.r).collect::<Vec<_>>());
    context.insert("finest", &grids.last());
    context.insert("tolerance", &tolerance(grids.len()));
    context.insert("grids", &grids);
    context.insert("record", &record);
    context.insert("bench", &bench::results(inputs)?);
    context.insert("figures", &shown_figures(inputs));
    context.insert("versions", &super::versions());
    context.insert("version", env!("CARGO_PKG_VERSION"));
    // Of code and text, as an SPDX expression.
    context.insert("license", env!("CARGO_PKG_LICENSE"));
    context.insert("timings", &times(&bench::times(inputs)?)?);
    context.insert("fields", &described());
    context.insert("limits", &LIMITS);
    Ok(context)
}

/// Returns the fields of a scene and of its statement, the r that is drawn, and `more`.
fn extended(scene: &Scene, more: Value) -> BTreeMap<String, Value> {
    let drawn = json!({ "draw_r": scene.statement.saddle.map(|saddle| saddle.r) });
    let fields = [json!(scene), json!(scene.statement), drawn, more]
        .into_iter()
        .filter_map(|value| value.as_object().cloned());
    fields.flatten().collect()
}

/// Returns, of one of the paper's problems, the scene, the solves under the [`RULES`], and the table.
fn problem(
    inputs: &Inputs,
    results: &Results,
    scene: &Scene,
    table: &TableComparison,
) -> Result<BTreeMap<String, Value>, Failure> {
    let [signed, printed, dual] = RULES.map(|rule| solves(inputs, scene, rule, table));
    let (signed, printed, dual) = (signed?, printed?, dual?);
    let bound = tolerance(scene.grids().len());
    let mut finest = Vec::new();
    for ((signed, printed), dual) in signed.iter().zip(&printed).zip(&dual) {
        let last = [signed, printed, dual].map(|solve| solve.levels.last());
        if let [Some(last_signed), Some(last_printed), Some(last_dual)] = last {
            finest.push(json!({
                "r": signed.r,
                "signed": last_signed,
                "printed": last_printed,
                "dual": last_dual,
                // `max |dM/dy|` over the tolerance where the signed rule stops.
                "excess": last_signed.gradient_abs.map(|gradient| gradient / bound),
            }));
        }
    }
    let solved_problem = solve::problem(inputs, scene)?;
    let stopped = solve::pair_on_grid(inputs, scene)?;
    let delta_a = table.rows.iter().map(|row| row.delta_a_paper).fold(0.0, f64::max);
    let gap = delta_a * scene.finest().h();
    let Findings { search, identifiability, .. } =
        from_json(inputs, &identify::id(scene), FINDINGS)?;
    let more = json!({
        "number": table.table,
        "integral_f": solved_problem.levels().facts().integral,
        "values": values(&scene.source()),
        "misses": misses(inputs, scene, table)?,
        "boundary_nodes": stopped.a.len(),
        "stopped": shape(&stopped, scene),
        "solution": shape(&solve::solution(scene)?, scene),
        // What the stage `identify` found.
        "search": search,
        "holds": identifiability.holds,
        "loose": identifiability.loose,
        "agreement": results.of_problem(&scene.name)?.agreement(std::slice::from_ref(table))?,
        // Of the load vector on each grid.
        "sums": signed[0].levels.iter().map(|level| level.sum_load).collect::<Vec<_>>(),
        // Part of the gradient that the largest published Delta a causes, h Delta a, and over the tolerance.
        "gap": { "gradient": gap, "tolerances": gap / bound },
        "beyond": beyond(&solve::gradient(inputs, scene)?, bound),
        // A row per r.
        "finest": finest,
        // A column per r.
        "signed": signed,
        "printed": printed,
        "table": table,
    });
    Ok(extended(scene, more))
}

/// Numbers on the grids of a solve with an r.
#[derive(Serialize)]
struct SolveWithR {
    r: f64,
    levels: Vec<LevelNumbers>,
}

/// Returns the solves of a scene under a rule, one for each row of the table.
fn solves(
    inputs: &Inputs,
    scene: &Scene,
    rule: StopRule,
    table: &TableComparison,
) -> Result<Vec<SolveWithR>, String> {
    let mut solves = Vec::new();
    for row in &table.rows {
        let numbers: Numbers = from_json(inputs, &members::id(scene, rule, row.r), NUMBERS)?;
        solves.push(SolveWithR { r: row.r, levels: numbers.levels() });
    }
    Ok(solves)
}

/// Returns the numbers of nodes where a component of the gradient is beyond the tolerance, by its sign.
fn beyond(gradient: &[f64], tolerance: f64) -> Value {
    json!({
        "negative": gradient.iter().filter(|&&component| component < -tolerance).count(),
        "positive": gradient.iter().filter(|&&component| component > tolerance).count(),
        "nodes": gradient.len(),
    })
}

/// Returns a few numbers that describe a surface.
fn shape(pair: &Pair, scene: &Scene) -> Value {
    json!({
        "least": pair.y.iter().copied().reduce(f64::min),
        "greatest": pair.y.iter().copied().reduce(f64::max),
        // Boundary nodes in contact.
        "contact": pair.in_contact((scene.finest(), scene.law())).into_iter().filter(|&contact| contact).count(),
        // Contact force: the sum of h times the multiplier over the boundary.
        "force": scene.finest().h() * pair.a.iter().sum::<f64>(),
    })
}

/// Returns the value of f on its first piece, and elsewhere.
fn values(f: &Source) -> Value {
    match f {
        Source::Pieces { background, pieces } => json!({
            "piece": pieces.first().map(|(_, value)| *value), "elsewhere": background,
        }),
        Source::Exact(_) | Source::Formula(_) => Value::Null,
    }
}

/// Returns the published values of Delta a whose digits do not come out, each with the values of Delta a in the last
/// three iterations.
fn misses(inputs: &Inputs, scene: &Scene, table: &TableComparison) -> Result<Vec<Value>, String> {
    let mut misses = Vec::new();
    for row in table.rows.iter().filter(|row| !row.delta_a_exact()) {
        let id = members::id(scene, scene.saddle().stop, row.r);
        let levels: Vec<Vec<Iteration>> = from_json(inputs, &id, HISTORY)?;
        let finest = levels.last().map_or(&[][..], |level| &level[level.len().saturating_sub(3)..]);
        let last =
            finest.iter().map(|step| json!({ "number": step.number, "delta_a": step.delta_a }));
        let last: Vec<Value> = last.collect();
        misses.push(json!({ "r": row.r, "paper": row.delta_a_paper, "last": last }));
    }
    Ok(misses)
}

/// Returns a scene that is not the paper's, solved under its first rule and with the r that is drawn.
fn other(inputs: &Inputs, scene: &Scene) -> Result<BTreeMap<String, Value>, Failure> {
    let path = format!("pipeline/scenes/{}.toml", scene.name);
    let text = inputs.file(&path)?.ok_or_else(|| format!("{path} is missing"))?;
    let rule = scene.first_rule();
    let numbers = solve::drawn(inputs, scene, rule)?;
    let problem = solve::problem(inputs, scene)?;
    let facts = problem.levels().facts();
    let exact = match facts.known {
        Some(Known::Square(exact)) => Some(exact.latex()),
        _ => None,
    };
    let held = scene.wants(Output::Map).then(|| {
        solve::pair(inputs, scene, rule, &problem).map(|pair| solve::held(&problem, &pair))
    });
    let more = json!({
        "text": std::str::from_utf8(text)?,
        "command": picture_command(scene),
        "has_contact": scene.statement.boundary.has_contact(),
        // Share of the boundary under the law on which v is held, of a scene with a map.
        "held": held.transpose()?,
        "f": facts.f,
        // The exact solution in LaTeX, if it is known.
        "exact": exact,
        // Bound of the error over the solution, if it is less than that.
        "relative": solve::relative(scene, &numbers),
        // The finest level; none for the spectral solver.
        "level": numbers.levels().pop().filter(|level| level.nodes.is_some()),
        "energy": numbers.shown_energy(5),
    });
    Ok(extended(scene, more))
}

/// Returns the command that solves a scene and draws its map, in lines for half a page, each option with its value on
/// one.
fn picture_command(scene: &Scene) -> String {
    /// Most characters of a line, unless an option alone has more.
    const MOST: usize = 46;
    let out = format!("--out target/{}.svg", scene.name);
    let words = write::command(&scene.statement).split_off(1).into_iter();
    let (mut text, mut taken) = ("cargo run --release --".to_owned(), 22);
    for word in words.chain(["--map".to_owned(), out]) {
        let length = word.chars().count();
        let is_new = taken + 1 + length > MOST;
        text += if is_new { " \\\n  " } else { " " };
        text += &word;
        taken = if is_new { 2 + length } else { taken + 1 + length };
    }
    text
}

/// Returns all figures by their names: the file in the book's folder `figures`, and the path in the book of its data,
/// a table beside it or the page of data with the solution; and its size in pixels.
fn shown_figures<'a>(inputs: &'a Inputs) -> BTreeMap<&'a str, Value> {
    let mut figures = BTreeMap::new();
    for (_, made) in inputs.artifacts.iter().filter(|(id, _)| id.starts_with("figures/")) {
        for (file, bytes) in made {
            let Some(name) = file.strip_suffix(".svg") else { continue };
            let table = format!("{name}.csv");
            let data = match made.contains_key(&table) {
                true => format!("figures/{table}"),
                false => "fields.html".into(),
            };
            let [width, height] = ["width", "height"].map(|key| attribute(bytes, key));
            figures.insert(
                name,
                json!({
                    "name": name, "file": file, "data": data, "width": width, "height": height,
                    "command": command(inputs, name),
                }),
            );
        }
    }
    figures
}

/// Returns the command that draws a figure of a scene; none for one that `signorini run` alone draws.
fn command(inputs: &Inputs, figure: &str) -> Option<String> {
    let mut scenes = inputs.artifacts.keys().filter_map(|task| scene_of(task));
    let own = figures::scene_of(figure).filter(|own| scenes.any(|scene| scene == *own))?;
    Some(format!("signorini run {}", in_shell(own)))
}

/// Returns an attribute of the root of an SVG file that is a number.
fn attribute(svg: &[u8], key: &str) -> Option<f64> {
    let root = std::str::from_utf8(svg).ok()?.split('>').next()?;
    let value = |key: &str| root.split_once(&format!(" {key}=\""))?.1.split('"').next();
    let in_pixels = value(key)?.parse().ok();
    // A picture for print has a length with a unit, and four steps of its view are a pixel.
    in_pixels.or_else(|| {
        let place = if key == "width" { 2 } else { 3 };
        let view: f64 = value("viewBox")?.split(' ').nth(place)?.parse().ok()?;
        Some(view / 4.0)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::replication::stages::solve::tests::{ACCURATE, with_solved};

    #[test]
    fn chapters_of_scenes_with_an_accuracy_solve_nothing() {
        for text in ACCURATE {
            with_solved(text, |inputs, scene| {
                let told = other(inputs, scene).unwrap();
                assert_eq!(told["text"], text);
                assert!(told["relative"].as_f64().is_some_and(|error| error <= 0.1));
            });
        }
    }
}
