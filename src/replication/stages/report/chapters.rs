//! What the templates of the chapters are given: plain data, everything computed, nothing formatted.

use super::agreement::Agreement;
use super::search::{Fixed, Searched};
use super::times::Times;
use super::{About, versions};
use crate::discrete::load::integral;
use crate::experiments::targets;
use crate::identify::Findings;
use crate::identify::record::Record;
use crate::pipeline::error::{Failure, from_toml};
use crate::pipeline::{Inputs, hash};
use crate::problem::source::Source;
use crate::replication::comparison::TableComparison;
use crate::replication::project::IDENTIFIED;
use crate::replication::scene::Scene;
use crate::replication::stages::diff::{self, DIFF};
use crate::replication::stages::identify::{self, FINDINGS};
use crate::replication::stages::results::{self, Results};
use crate::replication::stages::solutions::SolutionFile;
use crate::replication::stages::solve::{self, HISTORY, OUTCOMES, Outcomes, PAIR, read_pair};
use crate::replication::stages::{artifact, bench, from_json, timings};
use crate::saddle::{Iteration, Outcome, Pair, StopRule, tolerance};
use serde::Serialize;
use std::collections::BTreeMap;
use tera::Context;

/// The rules that the chapters compare: of the tables, as printed, and with the dual one.
pub(super) const RULES: [StopRule; 3] = [StopRule::Signed, StopRule::Printed, StopRule::SignedDual];

/// Everything that the templates of the chapters know, by name.
pub(super) fn context(
    inputs: &Inputs,
    problems: &[Scene],
    others: &[Scene],
    solutions: &[&SolutionFile],
    about: &About,
) -> Result<Context, Failure> {
    let results = Results::read(artifact(inputs, results::ID, results::FILE)?)?;
    let table = |scene: &Scene| from_json(inputs, &diff::id(scene), DIFF);
    let tables = problems.iter().map(table).collect::<Result<Vec<TableComparison>, _>>()?;
    let problem = |(scene, table)| Problem::of(inputs, &results, scene, table);
    let shown = problems.iter().zip(&tables).map(problem).collect::<Result<Vec<_>, _>>()?;
    let others = others.iter().map(|scene| Other::of(inputs, scene));
    let text =
        String::from_utf8_lossy(inputs.files.get(IDENTIFIED).ok_or("no record of the search")?);
    let record: Record = from_toml(IDENTIFIED, &text)?;
    let grids: Vec<usize> = problems[0].grids.iter().map(|grid| grid.cells()).collect();

    let mut context = Context::new();
    context.insert("agreement", &Agreement::of(&results, &tables)?);
    context.insert("problems", &shown);
    context.insert("scenes", &others.collect::<Result<Vec<_>, _>>()?);
    context.insert("r", &tables[0].rows.iter().map(|row| row.r).collect::<Vec<_>>());
    context.insert("finest", &grids.last());
    context.insert("tolerance", &tolerance(grids.len()));
    context.insert("grids", &grids);
    context.insert("searched", &Searched::of(&record));
    context.insert("record", &record);
    context.insert("bench", &bench::results(inputs)?);
    let figures = figures(inputs);
    context.insert("provenance", &Provenance::of(inputs, figures.keys().copied().collect()));
    context.insert("figures", &figures);
    context.insert("solutions", solutions);
    context.insert("commands", &(about.commands)());
    context.insert("mermaid", &about.graph.mermaid());
    times_and_targets(inputs, &mut context)?;
    Ok(context)
}

/// What was recorded of times, if anything was, and what was to be reached.
fn times_and_targets(inputs: &Inputs, context: &mut Context) -> Result<(), Failure> {
    let accuracy = bench::result(inputs, "accuracy")?;
    let mut all = targets::of_accuracy(&accuracy);
    if let Some(timings) = timings::read(inputs)? {
        let times = Times::of(&timings, &accuracy);
        all.extend(times.targets());
        context.insert("cost", &times);
        context.insert("timings", &timings);
    }
    all.extend(targets::of_cube(&bench::result(inputs, "cube")?));
    context.insert("targets", &all);
    Ok(())
}

/// One of the paper's problems: its scene, its solves under three stopping rules, its table.
#[derive(Serialize)]
struct Problem<'a> {
    #[serde(flatten)]
    scene: &'a Scene,
    /// Number of the problem, and of its table.
    number: u8,
    integral_f: f64,
    /// Values of f on its pieces, the background last.
    values: Vec<f64>,
    /// One column per r, stopped by the signed rule.
    signed: Vec<Outcomes>,
    /// The same, stopped by (13) as printed.
    printed: Vec<Outcomes>,
    table: &'a TableComparison,
    misses: Vec<Miss>,
    boundary_nodes: usize,
    /// Where the signed rule stops on the finest grid.
    stopped: Shape,
    /// The discrete solution there, with f integrated exactly.
    solution: Shape,
    /// What this run found out about f.
    findings: Findings,
    agreement: Agreement,
    /// Sum of the load vector on each grid.
    sums: Vec<f64>,
    /// What the largest published Delta a leaves in the gradient, h Delta a, and over the tolerance.
    gap: [f64; 2],
    finest: Vec<Finest>,
    /// How sharply the table fixes f.
    fixed: Fixed,
}

/// One r on the finest grid, under the three rules.
#[derive(Serialize)]
struct Finest {
    r: f64,
    signed: Outcome,
    printed: Outcome,
    dual: Outcome,
    /// `max |dM/dy|` over the tolerance where the signed rule stops.
    excess: f64,
}

/// A published Delta a that ours rounds differently.
#[derive(Serialize)]
struct Miss {
    r: f64,
    paper: f64,
    /// Ours in the last iterations: number and Delta a; the last is the one compared.
    last: Vec<(usize, f64)>,
}

/// A surface in a few numbers.
#[derive(Serialize)]
struct Shape {
    least: f64,
    greatest: f64,
    /// Boundary nodes whose multiplier is positive.
    contact: usize,
    /// Total inflow: the sum of h times the multiplier over the boundary.
    inflow: f64,
}

impl<'a> Problem<'a> {
    fn of(
        inputs: &Inputs,
        results: &Results,
        scene: &'a Scene,
        table: &'a TableComparison,
    ) -> Result<Self, Failure> {
        let columns = |rule: StopRule| -> Result<Vec<Outcomes>, String> {
            let column = |r: f64| from_json(inputs, &solve::id(scene, rule, r), OUTCOMES);
            table.rows.iter().map(|row| column(row.r)).collect()
        };
        let [signed, printed, dual] = RULES.map(columns);
        let (signed, printed, dual) = (signed?, printed?, dual?);
        let bound = tolerance(scene.grids.len());
        let three = signed.iter().zip(&printed).zip(&dual);
        let finest = three.filter_map(|((signed, printed), dual)| {
            let (r, signed) = (signed.r, *signed.levels.last()?);
            let (printed, dual) = (*printed.levels.last()?, *dual.levels.last()?);
            Some(Finest { r, signed, printed, dual, excess: signed.gradient_abs / bound })
        });
        let stopped = solve::id(scene, scene.stop[0], scene.draw_r);
        let stopped = read_pair(scene.finest(), artifact(inputs, &stopped, PAIR)?)?;
        let agreement =
            Agreement::of(&results.of_problem(&scene.name)?, std::slice::from_ref(table))?;
        let gap = agreement.paper_delta.greatest * scene.finest().h();
        let findings: Findings = from_json(inputs, &identify::id(scene), FINDINGS)?;
        Ok(Self {
            number: table.table,
            integral_f: integral(&scene.f),
            values: values(&scene.f),
            misses: misses(inputs, scene, table)?,
            boundary_nodes: stopped.a.len(),
            stopped: Shape::of(&stopped, scene),
            solution: Shape::of(&solve::solution(scene)?, scene),
            fixed: Fixed::of(&findings),
            findings,
            agreement,
            sums: signed[0].levels.iter().map(|outcome| outcome.sum_load).collect(),
            gap: [gap, gap / bound],
            finest: finest.collect(),
            signed,
            printed,
            table,
            scene,
        })
    }
}

impl Shape {
    fn of(pair: &Pair, scene: &Scene) -> Self {
        Self {
            least: pair.y.iter().copied().fold(f64::INFINITY, f64::min),
            greatest: pair.y.iter().copied().fold(f64::NEG_INFINITY, f64::max),
            contact: pair.a.iter().filter(|a| **a > 0.0).count(),
            inflow: scene.finest().h() * pair.a.iter().sum::<f64>(),
        }
    }
}

fn values(f: &Source) -> Vec<f64> {
    let Source::Pieces { background, pieces } = f else { return Vec::new() };
    pieces.iter().map(|(_, value)| *value).chain([*background]).collect()
}

/// The values of Delta a that miss the published digits, each with the two before it.
fn misses(inputs: &Inputs, scene: &Scene, table: &TableComparison) -> Result<Vec<Miss>, String> {
    let missed = table.rows.iter().filter(|row| !row.delta_a_exact());
    let miss = missed.map(|row| {
        let id = solve::id(scene, scene.stop[0], row.r);
        let levels: Vec<Vec<Iteration>> = from_json(inputs, &id, HISTORY)?;
        let finest = levels.last().map_or(&[][..], |level| &level[level.len().saturating_sub(3)..]);
        let last = finest.iter().map(|iteration| (iteration.number, iteration.delta_a)).collect();
        Ok(Miss { r: row.r, paper: row.delta_a_paper, last })
    });
    miss.collect()
}

/// A scene that is not the paper's, under its first rule and with the r that is drawn.
#[derive(Serialize)]
struct Other<'a> {
    #[serde(flatten)]
    scene: &'a Scene,
    /// Its file, as written.
    text: String,
    integral_f: f64,
    /// The exact solution in LaTeX, if it is known.
    exact: Option<&'static str>,
    outcomes: Outcomes,
}

impl<'a> Other<'a> {
    fn of(inputs: &Inputs, scene: &'a Scene) -> Result<Self, Failure> {
        let path = format!("pipeline/scenes/{}.toml", scene.name);
        let text = inputs.files.get(&path).ok_or_else(|| format!("{path} is missing"))?;
        Ok(Self {
            text: String::from_utf8(text.clone())?,
            integral_f: integral(&scene.f),
            exact: scene.f.exact().map(|exact| exact.latex()),
            outcomes: from_json(inputs, &solve::id(scene, scene.stop[0], scene.draw_r), OUTCOMES)?,
            scene,
        })
    }
}

/// A figure and where its data are.
#[derive(Serialize)]
struct Figure {
    /// File name in the book's folder `figures`.
    file: String,
    /// Path in the book: a table beside the figure, or the page of data with the solution.
    data: String,
    hash: String,
}

/// All figures by their names.
fn figures<'a>(inputs: &'a Inputs) -> BTreeMap<&'a str, Figure> {
    let mut figures = BTreeMap::new();
    for made in inputs.artifacts.iter().filter(|(id, _)| id.starts_with("figures/")) {
        for (file, svg) in made.1 {
            let Some(name) = file.strip_suffix(".svg") else { continue };
            let table = format!("{name}.csv");
            let data = match made.1.contains_key(&table) {
                true => format!("figures/{table}"),
                false => "data.html".into(),
            };
            figures.insert(name, Figure { file: file.clone(), data, hash: short_hash(svg) });
        }
    }
    figures
}

/// As much of a hash as a reader compares.
fn short_hash(bytes: &[u8]) -> String {
    hash(bytes)[..12].to_owned()
}

/// Where the book's numbers come from: names and hashes of what was read and made, and versions.
#[derive(Serialize)]
struct Provenance<'a> {
    /// Names of all figures.
    figures: Vec<&'a str>,
    inputs: Vec<(String, String)>,
    artifacts: Vec<(String, String)>,
    versions: Vec<(String, String)>,
    /// Of code and text, as an SPDX expression.
    license: &'static str,
}

impl<'a> Provenance<'a> {
    fn of(inputs: &Inputs, figures: Vec<&'a str>) -> Self {
        let hashed = |(name, bytes): (&String, &Vec<u8>)| (name.clone(), short_hash(bytes));
        let made = inputs.artifacts.iter().filter(|(id, _)| !id.starts_with("solve/"));
        let made = made.flat_map(|(id, made)| {
            made.iter().map(move |(name, bytes)| (format!("{id}/{name}"), short_hash(bytes)))
        });
        Self {
            figures,
            inputs: inputs.files.iter().map(hashed).collect(),
            artifacts: made.collect(),
            versions: versions(),
            license: env!("CARGO_PKG_LICENSE"),
        }
    }
}
