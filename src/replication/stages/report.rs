//! The `report` stage: gathers what the other stages made, and turns it into pages and a book.

use super::diff::{self, DIFF};
use super::identify::{self, FINDINGS};
use super::solve::{self, OUTCOMES, Outcomes, PAIR, read_pair};
use super::{artifact, bench, figures, from_json, to_json};
use crate::discrete::load::{LoadRule, integral};
use crate::identify::record::Record;
use crate::pipeline::error::{Error, Result, from_toml};
use crate::pipeline::{Artifacts, Graph, Inputs, Node, Stage, Task, hash};
use crate::problem::source::{Region, Source};
use crate::replication::paper::TableComparison;
use crate::replication::project::{IDENTIFIED, Project};
use crate::replication::scene::{Output, Scene};
use crate::report::{
    self, Artifact, Column, CommandHelp, Compared, Figure, Figures, Level, Piece, Problem,
    Provenance, Report, Row, Solution, Version,
};
use crate::saddle::StopRule;
use crate::timing::recorded;
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicU64, Ordering};

/// The task that writes the pages and builds the book, from everything the `earlier` tasks make.
///
/// # Errors
/// [`Error::Input`] if the paper's problems do not ask for what the chapters show.
pub fn task(project: &Project, earlier: &[Task]) -> Result<Task> {
    let mut problems: Vec<Scene> =
        project.scenes.iter().filter(|scene| scene.paper_table.is_some()).cloned().collect();
    problems.sort_by_key(|scene| scene.paper_table);
    if problems.len() != 2 || problems[0].grids != problems[1].grids {
        return Err(Error::input(
            "the book needs two scenes with `paper_table`, on the same grids; restore problem1 and problem2",
        ));
    }
    for scene in &problems {
        let figures = figures::KINDS.iter().map(|(kind, _)| *kind);
        let missing = RULES
            .iter()
            .find(|rule| !scene.stop.contains(rule))
            .map(|rule| format!("\"{rule}\" to `stop`"))
            .or(figures
                .chain([Output::Table])
                .find(|kind| !scene.wants(*kind))
                .map(|kind| format!("\"{}\" to `outputs`", kind.name())));
        if let Some(missing) = missing {
            let name = &scene.name;
            return Err(Error::input(format!("scene `{name}`: the book shows it; add {missing}")));
        }
    }
    let others: Vec<Scene> = project
        .scenes
        .iter()
        .filter(|scene| scene.paper_table.is_none() && scene.wants(Output::Table))
        .cloned()
        .collect();
    let mut files = project.scene_files.clone();
    files.insert("pipeline/paper.toml".into(), project.paper_text.clone().into_bytes());
    files.extend(project.record_text.clone().map(|text| (IDENTIFIED.to_owned(), text)));
    files.extend(project.timings_text.clone().map(|text| (recorded::PATH.to_owned(), text)));
    let report_file =
        |(name, bytes): (&String, &Vec<u8>)| (format!("report/{name}"), bytes.clone());
    files.extend(project.templates.iter().map(report_file));
    let versions = versions();
    let commands = project.commands.clone();
    let needs: Vec<String> = earlier.iter().map(|task| task.id.clone()).collect();
    let own = Node { id: "report/book".into(), stage: Stage::Report, needs: needs.clone() };
    let graph = Graph::new(earlier.iter().map(Node::of).chain([own]).collect());
    let mut parameters: BTreeMap<String, String> = versions
        .iter()
        .map(|library| (format!("version of {}", library.name), library.version.clone()))
        .collect();
    // By hash: whoever asks what changed does not want to read it all, old and new.
    for (name, text) in [("commands", to_json(&commands)), ("graph", to_json(&graph))] {
        parameters.insert(name.into(), hash(&text));
    }
    let about = About { versions, commands, graph };
    Ok(Task {
        id: "report/book".into(),
        stage: Stage::Report,
        parameters,
        files,
        needs,
        export: Some("report"),
        work: Box::new(move |inputs| make(inputs, &problems, &others, &about)),
    })
}

/// What the book tells about the program and its run.
struct About {
    versions: Vec<Version>,
    commands: Vec<CommandHelp>,
    graph: Graph,
}

/// The rules that the chapters compare, in the order of the columns.
const RULES: [StopRule; 3] = [StopRule::Signed, StopRule::Printed, StopRule::SignedDual];

type Made<T> = std::result::Result<T, String>;

fn make(inputs: &Inputs, problems: &[Scene], others: &[Scene], about: &About) -> Made<Artifacts> {
    let comparisons = problems
        .iter()
        .map(|scene| from_json::<TableComparison>(inputs, &diff::id(scene), DIFF))
        .collect::<Made<Vec<_>>>()?;
    let report = Report {
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
            contact: figure(inputs, Output::Contact)?,
            histories: figure(inputs, Output::History)?,
            identifiability: figure(inputs, Output::Identify)?,
            bench: bench_figures(inputs),
        },
        bench: bench::results(inputs)?,
        commands: about.commands.clone(),
        provenance: provenance(inputs, about),
        timings: super::timings::read(inputs)?,
        record: {
            let text = inputs.files.get(IDENTIFIED).ok_or("the record of the search is missing")?;
            from_toml::<Record>(IDENTIFIED, &String::from_utf8_lossy(text))
                .map_err(|e| e.to_string())?
        },
    };
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
    let pages = report::pages(&templates, &report).map_err(|e| e.to_string())?;
    files.extend(pages.iter().map(|(name, page)| (name.clone(), page.clone().into_bytes())));
    for (name, bytes) in pictures(inputs) {
        files.insert(format!("src/figures/{name}"), bytes.clone());
    }
    let built = report::build(&files, &scratch()).map_err(|e| e.to_string())?;
    let pages = pages.into_iter().map(|(name, page)| (name, page.into_bytes()));
    Ok(pages
        .chain(built.into_iter().map(|(name, bytes)| (format!("book/{name}"), bytes)))
        .collect())
}

/// A folder for mdBook to work in; its name is in no artifact.
fn scratch() -> std::path::PathBuf {
    static COUNTER: AtomicU64 = AtomicU64::new(0);
    let unique = COUNTER.fetch_add(1, Ordering::Relaxed);
    std::env::temp_dir().join(format!("signorini-book-{}-{unique}", std::process::id()))
}

fn problem(inputs: &Inputs, scene: &Scene, comparison: &TableComparison) -> Made<Problem> {
    let columns = |rule: StopRule| -> Made<Vec<Column>> {
        let column = |row: &crate::replication::paper::RowComparison| {
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
        solution: Solution {
            cells: scene.finest().cells(),
            r: scene.draw_r,
            least: pair.y.iter().copied().fold(f64::INFINITY, f64::min),
            greatest: pair.y.iter().copied().fold(f64::NEG_INFINITY, f64::max),
            contact_nodes: pair.a.iter().filter(|a| **a > 0.0).count(),
            boundary_nodes: pair.a.len(),
        },
        findings: from_json(inputs, &identify::id(scene), FINDINGS)?,
    })
}

fn rows(comparison: &TableComparison) -> Vec<Row> {
    let of_row = |row: &crate::replication::paper::RowComparison| Row {
        r: row.r,
        counts: (0..row.ours.len())
            .map(|k| Compared {
                ours: row.ours[k],
                paper: row.paper[k],
                exact: row.ours[k] == row.paper[k],
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

/// Pictures by file name.
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
    Ok(Figure { hash: hash(svg), file, note: String::new(), command: figures::COMMAND.into() })
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
            .map(|(name, bytes)| Artifact { name: name.clone(), hash: hash(bytes) })
            .collect(),
        artifacts: made.map(|(name, bytes)| Artifact { name, hash: hash(bytes) }).collect(),
        versions: about.versions.clone(),
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
