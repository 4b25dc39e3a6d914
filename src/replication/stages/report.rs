//! The `report` stage: gathers what the other stages made, and turns it into pages and a book.

use super::diff::{self, DIFF};
use super::identify::{self, FINDINGS};
use super::solutions::{self, Kept};
use super::solve::{self, HISTORY, OUTCOMES, Outcomes, PAIR, read_pair};
use super::{artifact, bench, figures, from_json, results, to_json};
use crate::discrete::load::{LoadRule, integral};
use crate::identify::record::Record;
use crate::pipeline::error::from_toml;
use crate::pipeline::{Artifacts, Graph, Inputs, Node, Task, hash};
use crate::problem::source::{Region, Source};
use crate::replication::paper::{RowComparison, TableComparison};
use crate::replication::project::{IDENTIFIED, Project};
use crate::replication::scene::{Output, Scene};
use crate::report::results::Results;
use crate::report::{
    self, Artifact, Column, CommandHelp, Compared, Figure, Figures, Level, Miss, Piece, Problem,
    Provenance, Report, Row, Shape, Version,
};
use crate::saddle::{Iteration, Pair, StopRule};
use crate::timing::recorded;
use std::collections::BTreeMap;

/// What the chapters lack in this project, if they lack anything: with the paper's problems, or with
/// what one of them does not ask for, they are left out of the book.
pub fn left_out(project: &Project) -> Option<String> {
    let problems = project.problems();
    let [first, second] = problems[..] else {
        return Some("they need two scenes, one with `paper_table = 1` and one with 2".into());
    };
    if first.grids != second.grids {
        return Some(format!("`{}` and `{}` must have the same grids", first.name, second.name));
    }
    problems.iter().find_map(|scene| {
        let rule = RULES.iter().find(|rule| !scene.stop.contains(rule));
        let mut kinds = figures::KINDS.iter().map(|(kind, _)| *kind).chain([Output::Table]);
        let missing = rule.map(|rule| format!("\"{rule}\" to `stop`")).or(kinds
            .find(|kind| !scene.wants(*kind))
            .map(|kind| format!("\"{}\" to `outputs`", kind.name())))?;
        Some(format!("they show scene `{}`; add {missing}", scene.name))
    })
}

/// The task that writes the pages and builds the book, from everything the `earlier` tasks make.
pub fn task(project: &Project, earlier: &[Task]) -> Task {
    let problems: Vec<Scene> = project.problems().into_iter().cloned().collect();
    let other = |scene: &&Scene| !project.is_problem(scene) && scene.wants(Output::Table);
    let others: Vec<Scene> = project.scenes.iter().filter(other).cloned().collect();
    let left_out = left_out(project);
    let mut files = project.scene_files.clone();
    let paper_text = project.paper_text.clone().map(String::into_bytes);
    files.extend(paper_text.map(|text| ("pipeline/paper.toml".to_owned(), text)));
    files.extend(project.record_text.clone().map(|text| (IDENTIFIED.to_owned(), text)));
    files.extend(project.timings_text.clone().map(|text| (recorded::PATH.to_owned(), text)));
    let report_file =
        |(name, bytes): (&String, &Vec<u8>)| (format!("report/{name}"), bytes.clone());
    files.extend(project.templates.iter().map(report_file));
    let needs: Vec<String> = earlier.iter().map(|task| task.id.clone()).collect();
    let own = Node { id: "report/book".into(), needs: needs.clone() };
    let graph = Graph { nodes: earlier.iter().map(Node::of).chain([own]).collect() };
    // By hash: whoever asks what changed does not want to read it all, old and new.
    let parameters = BTreeMap::from([("graph".to_owned(), hash(&to_json(&graph)))]);
    let about = About { commands: project.commands, graph };
    Task {
        id: "report/book".into(),
        parameters,
        files,
        needs,
        export: Some("report"),
        work: Box::new(move |inputs| match &left_out {
            None => {
                let solutions = solutions::all(inputs, &problems, &others)?;
                let data = solutions.iter().flat_map(Kept::files).collect();
                book(inputs, data, |templates| {
                    let mut report = gather(inputs, &problems, &others, &about)?;
                    report.solutions = solutions.iter().map(|kept| kept.file.clone()).collect();
                    let context = report::context(&report).map_err(|e| e.to_string())?;
                    report::pages(templates, &context).map_err(|e| e.to_string())
                })
            }
            Some(reason) => {
                book(inputs, Artifacts::new(), |templates| Ok(report::stubs(templates, reason)))
            }
        }),
    }
}

/// What the book tells about the program and its run; of the program, the digest is an input anyway.
struct About {
    commands: fn() -> Vec<CommandHelp>,
    graph: Graph,
}

/// The rules that the chapters compare, in the order of the columns.
const RULES: [StopRule; 3] = [StopRule::Signed, StopRule::Printed, StopRule::SignedDual];

type Made<T> = std::result::Result<T, String>;

/// Everything that the chapters tell.
fn gather(inputs: &Inputs, problems: &[Scene], others: &[Scene], about: &About) -> Made<Report> {
    let comparisons = problems
        .iter()
        .map(|scene| from_json::<TableComparison>(inputs, &diff::id(scene), DIFF))
        .collect::<Made<Vec<_>>>()?;
    Ok(Report {
        grids: problems[0].grids.iter().map(|grid| grid.cells()).collect(),
        r: comparisons[0].rows.iter().map(|row| row.r).collect(),
        tolerance: comparisons[0].tolerance.clone(),
        problems: problems
            .iter()
            .zip(&comparisons)
            .map(|(scene, comparison)| problem(inputs, scene, comparison))
            .collect::<Made<_>>()?,
        scenes: others.iter().map(|scene| other(inputs, scene)).collect::<Made<_>>()?,
        figures: Figures {
            figure1: figure(inputs, Output::Source)?,
            figure2: figure(inputs, Output::Surface)?,
            stops: picture(inputs, figures::STOPS)?,
            contact: figure(inputs, Output::Contact)?,
            histories: figure(inputs, Output::History)?,
            identifiability: figure(inputs, Output::Identify)?,
            bench: bench_figures(inputs),
        },
        solutions: Vec::new(),
        results: Results::read(artifact(inputs, results::ID, results::FILE)?)?,
        bench: bench::results(inputs)?,
        commands: (about.commands)(),
        provenance: provenance(inputs, about),
        timings: super::timings::read(inputs)?,
        record: {
            let text = inputs.files.get(IDENTIFIED).ok_or("the record of the search is missing")?;
            from_toml::<Record>(IDENTIFIED, &String::from_utf8_lossy(text))
                .map_err(|e| e.to_string())?
        },
    })
}

/// The pages made of the templates, and the book made of the pages and of `data`, files by name.
fn book(
    inputs: &Inputs,
    mut data: Artifacts,
    pages: impl Fn(&BTreeMap<String, String>) -> Made<BTreeMap<String, String>>,
) -> Made<Artifacts> {
    let mut templates = BTreeMap::new();
    let mut files = Artifacts::new();
    for (path, bytes) in inputs.files {
        let Some(name) = path.strip_prefix("report/") else { continue };
        if let Some(template) = name.strip_prefix("templates/") {
            let text =
                String::from_utf8(bytes.clone()).map_err(|_| format!("{path} is not UTF-8"))?;
            templates.insert(template.to_owned(), text);
        } else {
            files.insert(name.into(), bytes.clone());
        }
    }
    let mut pages = pages(&templates)?;
    for (path, page) in &mut pages {
        let Some(name) = path.strip_prefix("src/").and_then(|path| path.strip_suffix(".md")) else {
            continue;
        };
        let (with_links, tables) = report::with_data(name, page);
        *page = with_links;
        data.extend(tables);
    }
    files.extend(pages.iter().map(|(name, page)| (name.clone(), page.clone().into_bytes())));
    files.extend(data.into_iter().map(|(name, bytes)| (format!("src/data/{name}"), bytes)));
    for (name, bytes) in pictures(inputs) {
        files.insert(format!("src/figures/{name}"), bytes.clone());
    }
    if let Ok(csv) = artifact(inputs, results::ID, results::FILE) {
        files.insert(format!("src/{}", results::FILE), csv.into());
    }
    let built = report::build(&files, inputs.scratch).map_err(|e| e.to_string())?;
    let pages = pages.into_iter().map(|(name, page)| (name, page.into_bytes()));
    Ok(pages
        .chain(built.into_iter().map(|(name, bytes)| (format!("book/{name}"), bytes)))
        .collect())
}

fn problem(inputs: &Inputs, scene: &Scene, comparison: &TableComparison) -> Made<Problem> {
    let columns = |rule: StopRule| -> Made<Vec<Column>> {
        let column = |row: &RowComparison| {
            let outcomes: Outcomes = from_json(inputs, &solve::id(scene, rule, row.r), OUTCOMES)?;
            Ok(Column { r: row.r, outcomes: outcomes.levels })
        };
        comparison.rows.iter().map(column).collect()
    };
    let [signed, printed, signed_dual] = RULES.map(columns);
    let drawn = solve::id(scene, scene.stop[0], scene.draw_r);
    let pair = read_pair(scene.finest(), artifact(inputs, &drawn, PAIR)?)?;
    let [load, tie, diagonal] = load_names(scene.load);
    Ok(Problem {
        name: scene.name.clone(),
        number: usize::from(comparison.table),
        title: scene.title.clone(),
        f: scene.f.to_string(),
        integral_f: integral(&scene.f),
        pieces: pieces(&scene.f),
        load,
        tie,
        diagonal,
        prolongation: name_of(scene.prolongation),
        signed: signed?,
        printed: printed?,
        signed_dual: signed_dual?,
        table: rows(comparison),
        misses: misses(inputs, scene, comparison)?,
        cells: scene.finest().cells(),
        drawn_r: scene.draw_r,
        boundary_nodes: pair.a.len(),
        stop: shape(&pair, scene.finest().h()),
        solution: shape(&solve::solution(scene)?, scene.finest().h()),
        findings: from_json(inputs, &identify::id(scene), FINDINGS)?,
    })
}

fn shape(pair: &Pair, h: f64) -> Shape {
    Shape {
        least: pair.y.iter().copied().fold(f64::INFINITY, f64::min),
        greatest: pair.y.iter().copied().fold(f64::NEG_INFINITY, f64::max),
        contact: pair.a.iter().filter(|a| **a > 0.0).count(),
        inflow: h * pair.a.iter().sum::<f64>(),
    }
}

/// The values of Delta a that miss the published digits, each with the two before it.
fn misses(inputs: &Inputs, scene: &Scene, comparison: &TableComparison) -> Made<Vec<Miss>> {
    let missed = comparison.rows.iter().filter(|row| !row.delta_a_exact());
    let miss = |row: &RowComparison| {
        let id = solve::id(scene, scene.stop[0], row.r);
        let levels: Vec<Vec<Iteration>> = from_json(inputs, &id, HISTORY)?;
        let finest = levels.last().map_or(&[][..], |level| &level[level.len().saturating_sub(3)..]);
        let last = finest.iter().map(|iteration| (iteration.number, iteration.delta_a)).collect();
        Ok(Miss { r: row.r, paper: row.delta_a_paper, last })
    };
    missed.map(miss).collect()
}

fn rows(comparison: &TableComparison) -> Vec<Row> {
    let of_row = |row: &RowComparison| Row {
        r: row.r,
        counts: (0..row.ours.len())
            .map(|k| Compared {
                ours: row.ours[k],
                paper: row.paper[k],
                exact: row.count_exact(k),
                within: row.within[k],
            })
            .collect(),
        delta_a: Compared {
            ours: row.delta_a_ours,
            paper: row.delta_a_paper,
            exact: row.delta_a_exact(),
            within: row.delta_a_within,
        },
    };
    comparison.rows.iter().map(of_row).collect()
}

/// Rule, tie and diagonal as scenes name them; empty where the rule has none.
fn load_names(rule: LoadRule) -> [String; 3] {
    let value = serde_json::to_value(rule).expect("plain data");
    ["rule", "tie", "diagonal"].map(|key| value[key].as_str().unwrap_or_default().to_owned())
}

/// The name by which scenes know a value.
fn name_of(value: impl serde::Serialize) -> String {
    let value = serde_json::to_value(value).expect("plain data");
    value.as_str().unwrap_or_default().to_owned()
}

fn pieces(f: &Source) -> Vec<Piece> {
    let Source::Pieces { background, pieces } = f else { return Vec::new() };
    let words = |region: &Region| match region {
        Region::Quadrant { right, upper } => {
            let (row, column) =
                (if *upper { "upper" } else { "lower" }, if *right { "right" } else { "left" });
            format!("{row} {column} quadrant")
        }
        other => other.to_string(),
    };
    let mut all: Vec<Piece> = pieces
        .iter()
        .map(|(region, value)| Piece { region: words(region), value: *value })
        .collect();
    all.push(Piece { region: "elsewhere".into(), value: *background });
    all
}

fn other(inputs: &Inputs, scene: &Scene) -> Made<report::Scene> {
    let (rule, r) = (scene.stop[0], scene.draw_r);
    let outcomes: Outcomes = from_json(inputs, &solve::id(scene, rule, r), OUTCOMES)?;
    let levels = outcomes.levels.iter().enumerate();
    Ok(report::Scene {
        name: scene.name.clone(),
        title: scene.title.clone(),
        text: text_of(inputs, &format!("pipeline/scenes/{}.toml", scene.name))?,
        figures: figures::KINDS
            .iter()
            .filter(|(kind, _)| scene.wants(*kind))
            .map(|(kind, _)| (kind.name().into(), format!("{}-{}.svg", scene.name, kind.name())))
            .collect(),
        f: scene.f.to_string(),
        integral_f: integral(&scene.f),
        exact: scene.f.exact().map(|exact| exact.latex().to_owned()),
        rule: rule.to_string(),
        r,
        levels: levels
            .map(|(k, outcome)| Level { outcome: *outcome, error: outcomes.errors.get(k).copied() })
            .collect(),
    })
}

/// A file of the project that was read, as text.
fn text_of(inputs: &Inputs, path: &str) -> Made<String> {
    let bytes = inputs.files.get(path).ok_or_else(|| format!("{path} is missing"))?;
    String::from_utf8(bytes.clone()).map_err(|_| format!("{path} is not UTF-8"))
}

/// Pictures and their data by file name.
fn pictures<'a>(inputs: &'a Inputs) -> impl Iterator<Item = (&'a String, &'a Vec<u8>)> {
    inputs.artifacts.iter().filter(|(id, _)| id.starts_with("figures/")).flat_map(|(_, made)| made)
}

fn figure(inputs: &Inputs, kind: Output) -> Made<Figure> {
    let (_, name) = figures::KINDS.iter().find(|(k, _)| *k == kind).expect("a kind of figure");
    picture(inputs, name)
}

fn picture(inputs: &Inputs, name: &str) -> Made<Figure> {
    let file = format!("{name}.svg");
    let svg = artifact(inputs, &figures::id(name), &file)?;
    Ok(drawn(inputs, file, svg))
}

/// A picture; what it is drawn from is a table beside it, or a solution on the page of data.
fn drawn(inputs: &Inputs, file: String, svg: &[u8]) -> Figure {
    let table = file.replace(".svg", ".csv");
    let data = match pictures(inputs).any(|(name, _)| *name == table) {
        true => format!("figures/{table}"),
        false => "data.html".into(),
    };
    Figure { hash: short_hash(svg), file, data, command: figures::COMMAND.into() }
}

/// As much of a hash as a reader compares.
fn short_hash(bytes: &[u8]) -> String {
    hash(bytes)[..12].to_owned()
}

/// The pictures of experiments and of recorded times, if there are any, by name.
fn bench_figures(inputs: &Inputs) -> BTreeMap<String, Figure> {
    let names = bench::PICTURES.iter().map(|picture| picture.name).chain(super::timings::names());
    names.filter_map(|name| Some((name.to_owned(), picture(inputs, name).ok()?))).collect()
}

fn provenance(inputs: &Inputs, about: &About) -> Provenance {
    let made = inputs.artifacts.iter().filter(|(id, _)| !id.starts_with("solve/")).flat_map(
        |(id, made)| made.iter().map(move |(name, bytes)| (format!("{id}/{name}"), bytes)),
    );
    Provenance {
        command: "cargo run --release".into(),
        inputs: inputs
            .files
            .iter()
            .map(|(name, bytes)| Artifact { name: name.clone(), hash: short_hash(bytes) })
            .collect(),
        artifacts: made.map(|(name, bytes)| Artifact { name, hash: short_hash(bytes) }).collect(),
        figures: pictures(inputs)
            .filter(|(name, _)| name.ends_with(".svg"))
            .map(|(name, svg)| drawn(inputs, name.clone(), svg))
            .collect(),
        versions: versions(),
        graph: about.graph.clone(),
        license: env!("CARGO_PKG_LICENSE").into(),
    }
}

/// The versions of what shows in the book, as the build resolved them.
///
/// Cargo writes one field to a line, so that a run with nothing to do need not parse it all.
pub fn versions() -> Vec<Version> {
    const SHOWN: [&str; 6] =
        ["mdbook-driver", "plotters", "polars", "pulldown-latex", "signorini", "tera"];
    let packages = include_str!("../../../Cargo.lock").split("[[package]]").skip(1);
    let field = |package: &str, key: &str| {
        let value = package.lines().find_map(|line| line.strip_prefix(key)?.strip_prefix(" = "));
        value.unwrap_or_default().trim_matches('"').to_owned()
    };
    packages
        .map(|package| Version { name: field(package, "name"), version: field(package, "version") })
        .filter(|package| SHOWN.contains(&package.name.as_str()))
        .collect()
}
