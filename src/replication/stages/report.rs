//! The `report` stage: makes pages and a book of the artifacts of the other stages.

mod chapters;
mod digits;
mod times;

use super::solutions::Solutions;
use super::{artifact, figures, results, to_json};
use crate::pipeline::error::{CONFLICT, Failure, conflict};
use crate::pipeline::names::{alike, clash, composed};
use crate::pipeline::{Artifacts, Graph, GraphNode, Inputs, Task, hash};
use crate::replication::project::{Project, TRUTH};
use crate::replication::scene::{Output, Scene};
use crate::report;
pub(crate) use crate::report::TEMPLATE;
use crate::timing::recorded;
use serde_json::{Value, json};
use std::collections::{BTreeMap, BTreeSet};

/// The task that makes the pages and the book.
pub(crate) const ID: &str = "report/book";

/// Returns the reason to leave all pages made from templates out of the book, if there is one: the project lacks the
/// paper's problems, recorded times or true solutions, or one of the problems lacks an r, a rule or an output that the
/// chapters show.
pub(crate) fn left_out(project: &Project) -> Option<String> {
    let problems = project.problems();
    let [first, second] = problems[..] else {
        return Some("they need two scenes, one with `paper_table = 1` and one with 2".into());
    };
    if first.on_grids().grids != second.on_grids().grids {
        return Some(format!("`{}` and `{}` must have the same grids", first.name, second.name));
    }
    if !project.files.contains_key(recorded::PATH) {
        return Some(
            "they show recorded times; record some with `signorini bench --record`".into(),
        );
    }
    if !project.files.contains_key(TRUTH) {
        return Some(
            "they show true solutions; restore pipeline/truth.toml, or make it with benches/peers/truth.py".into(),
        );
    }
    problems.iter().find_map(|scene| {
        if scene.saddle().r != project.paper.r {
            let (name, r) = (&scene.name, &project.paper.r);
            return Some(format!(
                "they show scene `{name}` for the paper's r; let it have r = {r:?}"
            ));
        }
        let missing = missing_setting(scene)?;
        Some(format!("they show scene `{}`; add {missing}", scene.name))
    })
}

/// Returns a rule or an output that the chapters show and the scene does not ask for, if there is one.
fn missing_setting(scene: &Scene) -> Option<String> {
    if let Some(rule) = chapters::RULES.iter().find(|rule| !scene.saddle().stop.contains(rule)) {
        return Some(format!("\"{rule}\" to `stop`"));
    }
    let mut outputs = figures::KINDS
        .iter()
        .filter(|kind| kind.shared_name.is_some())
        .map(|kind| kind.output)
        .chain([Output::Table]);
    let missing = outputs.find(|output| !scene.wants(*output))?;
    Some(format!("\"{missing}\" to `outputs`"))
}

/// The task that writes the pages and builds the book, from the artifacts of all `earlier` tasks.
pub(crate) fn task(project: &Project, earlier: &[Task]) -> Task {
    let problems: Vec<Scene> = project.problems().into_iter().cloned().collect();
    let mut others = project.scenes.clone();
    others.retain(|scene| !scene.is_problem() && scene.wants(Output::Table));
    let left_out = left_out(project);
    let mut files = project.files.clone();
    for (name, file) in &project.templates {
        files.insert(format!("report/{name}"), file.clone());
    }
    let needs: Vec<String> = earlier.iter().map(|task| task.id.clone()).collect();
    let mut graph = Graph::of(earlier);
    graph.0.push(GraphNode::new(ID, &needs));
    // By hash, because `explain` prints changed parameters, old and new.
    let mut parameters = BTreeMap::from([("graph".to_owned(), hash(&to_json(&graph)))]);
    if let Some(book_toml) = project.templates.get("book.toml") {
        // A file that cannot be read is refused when the task runs.
        let programs = report::program_hashes(book_toml.bytes().unwrap_or_default());
        parameters
            .extend(programs.into_iter().map(|(name, hash)| (format!("program {name}"), hash)));
    }
    let commands = project.commands;
    let task = Task::new(ID, parameters, needs, move |inputs| {
        if let Some(reason) = &left_out {
            return book(inputs, Artifacts::new(), |templates| {
                Ok(report::stubs(templates, reason)?)
            });
        }
        let Solutions { listed, files } = Solutions::of(inputs, &problems, &others)?;
        book(inputs, files, |templates| {
            let mut context = chapters::context(inputs, &problems, &others)?;
            context.insert("solutions", &listed);
            context.insert("commands", &commands());
            context.insert("mermaid", &graph.mermaid());
            context.insert("origins", &origins(&graph));
            Ok(report::pages(templates, &context)?)
        })
    });
    Task { files, export: Some("report"), ..task }
}

/// Returns, for each figure, its name, the id of its task, and what that needs: the stage with the scene or the
/// experiment, as in `solve/plate`, of all runs together.
fn origins(graph: &Graph) -> Vec<Value> {
    let mut origins = Vec::new();
    for GraphNode { id, needs } in &graph.0 {
        let Some(name) = id.strip_prefix("figures/") else { continue };
        let parts = |id: &String| id.split('/').take(2).collect::<Vec<_>>().join("/");
        let needs: BTreeSet<String> = needs.iter().map(parts).collect();
        origins.push(json!({ "name": name, "task": id, "needs": needs }));
    }
    origins
}

/// Makes the pages from the templates, and the book from the pages and from `data`; all are files by name.
fn book(
    inputs: &Inputs,
    data: Artifacts,
    pages: impl Fn(&BTreeMap<String, String>) -> Result<BTreeMap<String, String>, Failure>,
) -> Result<Artifacts, Failure> {
    let mut templates = BTreeMap::new();
    let mut files = Artifacts::new();
    for (path, file) in inputs.files {
        let bytes = file.bytes()?;
        let Some(name) = path.strip_prefix("report/") else {
            // Pages may include files of the project.
            files.insert(format!("../{path}"), bytes.to_vec());
            continue;
        };
        match name.strip_prefix("templates/") {
            Some(page) if [".md", ".tera", ".js"].iter().any(|ending| page.ends_with(ending)) => {
                let text = String::from_utf8(bytes.to_vec());
                let text = text.map_err(|_| format!("{path} is not UTF-8; save it as UTF-8"))?;
                if let Some(line) = conflict(text.as_bytes()) {
                    return Err(format!("{path}: line {line}: {CONFLICT}; resolve it there").into());
                }
                templates.insert(page.to_owned(), composed(&text));
            }
            // Other files that pages show, such as a photograph.
            Some(other) => _ = files.insert(format!("src/{other}"), bytes.to_vec()),
            None => _ = files.insert(name.into(), bytes.to_vec()),
        }
    }
    let pages = pages(&templates)?;
    let mut made = Artifacts::new();
    for (name, bytes) in data {
        made.insert(format!("src/data/{name}"), bytes);
    }
    for (_, pictures) in inputs.artifacts.iter().filter(|(id, _)| id.starts_with("figures/")) {
        for (name, bytes) in pictures {
            made.insert(format!("src/figures/{name}"), bytes.clone());
        }
    }
    if let Ok(csv) = artifact(inputs, results::ID, results::FILE) {
        made.insert(format!("src/{}", results::FILE), csv.into());
    }
    refuse_replaced(&files, &templates, made.keys().chain(pages.keys()))?;
    files.extend(made);
    files.extend(pages.iter().map(|(name, page)| (name.clone(), page.clone().into_bytes())));
    let built = report::build(&files, inputs.scratch).map_err(|mistake| {
        report::in_template(mistake, &pages, &templates).replace(['\n', '\r'], " ")
    })?;
    let mut artifacts = Artifacts::new();
    for (name, page) in pages {
        artifacts.insert(name, page.into_bytes());
    }
    for (name, bytes) in built {
        artifacts.insert(format!("book/{name}"), bytes);
    }
    Ok(artifacts)
}

/// Refuses a file of the user, among `files` or `templates`, with the name of one that the run has `made`. Other names
/// that some file systems do not tell apart count as the same.
fn refuse_replaced<'a>(
    files: &Artifacts,
    templates: &BTreeMap<String, String>,
    made: impl Iterator<Item = &'a String>,
) -> Result<(), Failure> {
    // A page is made of its template.
    let own = |name: &&str| {
        !templates.contains_key(*name) && !templates.contains_key(&format!("{name}.tera"))
    };
    let made = made.filter_map(|name| name.strip_prefix("src/")).filter(own);
    let made: BTreeMap<String, &str> = made.map(|name| (alike(name), name)).collect();
    let users = files.keys().filter_map(|name| name.strip_prefix("src/"));
    let users: Vec<&str> = users.chain(templates.keys().map(String::as_str)).collect();
    for name in &users {
        if let Some(same) = made.get(&alike(name)) {
            return Err(format!(
                "report/templates/{name}: a run makes a file of this name, {same}; rename this one"
            )
            .into());
        }
    }
    let folders = made.values().chain(&users).filter_map(|name| Some(name.rsplit_once('/')?.0));
    match clash(folders) {
        None => Ok(()),
        Some((one, other)) => Err(format!(
            "report/templates: `{one}` and `{other}` are one folder where capitals or the way to write accents do not \
             count; rename your own"
        )
        .into()),
    }
}

/// Returns names and versions of the packages that the book names, as the build resolved them.
pub(crate) fn versions() -> Vec<(String, String)> {
    const SHOWN: [&str; 6] =
        ["mdbook-driver", "plotters", "polars", "pulldown-latex", "signorini", "tera"];
    let mut versions = Vec::new();
    for package in include_str!("../../../Cargo.lock").split("[[package]]").skip(1) {
        let name = field(package, "name");
        if SHOWN.contains(&name) {
            versions.push((name.to_owned(), field(package, "version").to_owned()));
        }
    }
    versions
}

/// Returns the value of a field in a section of `Cargo.lock`.
///
/// Cargo writes one field to a line, so that a run with nothing to do need not parse the whole file.
fn field<'a>(section: &'a str, key: &str) -> &'a str {
    let value = section.lines().find_map(|line| line.strip_prefix(key)?.strip_prefix(" = "));
    value.unwrap_or_default().trim_matches('"')
}
