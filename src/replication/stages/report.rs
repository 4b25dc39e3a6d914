//! The `report` stage: gathers what the other stages made, and turns it into pages and a book.

mod chapters;
mod digits;
mod search;
mod times;

use super::{artifact, figures, results, solutions, to_json};
use crate::pipeline::error::{CONFLICT, Failure, conflict};
use crate::pipeline::{Artifacts, Graph, Inputs, Task, hash};
use crate::replication::project::{Project, TRUTH};
use crate::replication::scene::{Output, Scene};
use crate::report;
pub(crate) use crate::report::TEMPLATE;
use crate::timing::recorded;
use std::collections::BTreeMap;

/// The task that makes the pages and the book.
pub(crate) const ID: &str = "report/book";

/// What the chapters lack in this project, if they lack anything: with the paper's problems, with recorded times
/// or true solutions, or with what one of the problems does not ask for, all pages made from templates are left out
/// of the book.
pub(crate) fn left_out(project: &Project) -> Option<String> {
    let problems = project.problems();
    let [first, second] = problems[..] else {
        return Some("they need two scenes, one with `paper_table = 1` and one with 2".into());
    };
    if first.grids != second.grids {
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
        if scene.r != project.paper.r {
            let (name, r) = (&scene.name, &project.paper.r);
            return Some(format!(
                "they show scene `{name}` for the paper's r; let it have r = {r:?}"
            ));
        }
        let rule = chapters::RULES.iter().find(|rule| !scene.stop.contains(rule));
        let mut kinds = figures::KINDS.iter().map(|kind| kind.0).chain([Output::Table]);
        let missing = rule.map(|rule| format!("\"{rule}\" to `stop`")).or(kinds
            .find(|kind| !scene.wants(*kind))
            .map(|kind| format!("\"{kind}\" to `outputs`")))?;
        Some(format!("they show scene `{}`; add {missing}", scene.name))
    })
}

/// The task that writes the pages and builds the book, from everything the `earlier` tasks make.
pub(crate) fn task(project: &Project, earlier: &[Task]) -> Task {
    let problems: Vec<Scene> = project.problems().into_iter().cloned().collect();
    let other = |scene: &&Scene| !scene.is_problem() && scene.wants(Output::Table);
    let others: Vec<Scene> = project.scenes.iter().filter(other).cloned().collect();
    let left_out = left_out(project);
    let mut files = project.files.clone();
    let report_file =
        |(name, bytes): (&String, &Vec<u8>)| (format!("report/{name}"), bytes.clone());
    files.extend(project.templates.iter().map(report_file));
    let needs: Vec<String> = earlier.iter().map(|task| task.id.clone()).collect();
    let mut graph = Graph::of(earlier);
    graph.0.push((ID.into(), needs.clone()));
    // By hash: whoever asks what changed does not want to read it all, old and new.
    let parameters = BTreeMap::from([("graph".to_owned(), hash(&to_json(&graph)))]);
    let commands = project.commands;
    let work = move |inputs: &Inputs| {
        if let Some(reason) = &left_out {
            let stubs = |templates: &_| Ok(report::stubs(templates, reason)?);
            return book(inputs, Artifacts::new(), stubs);
        }
        let (solutions, data) = solutions::all(inputs, &problems, &others)?;
        book(inputs, data, |templates| {
            let mut context = chapters::context(inputs, &problems, &others)?;
            context.insert("solutions", &solutions);
            context.insert("commands", &commands());
            context.insert("mermaid", &graph.mermaid());
            Ok(report::pages(templates, &context)?)
        })
    };
    Task { files, export: Some("report"), ..Task::new(ID, parameters, needs, work) }
}

/// The pages made of the templates, and the book made of the pages and of `data`, files by name.
fn book(
    inputs: &Inputs,
    mut data: Artifacts,
    pages: impl Fn(&BTreeMap<String, String>) -> Result<BTreeMap<String, String>, Failure>,
) -> Result<Artifacts, Failure> {
    let mut templates = BTreeMap::new();
    let mut files = Artifacts::new();
    for (path, bytes) in inputs.files {
        let Some(name) = path.strip_prefix("report/") else { continue };
        match name.strip_prefix("templates/") {
            Some(page) if [".md", ".tera", ".js"].iter().any(|ending| page.ends_with(ending)) => {
                let text = String::from_utf8(bytes.clone());
                let text = text.map_err(|_| format!("{path} is not UTF-8; save it as UTF-8"))?;
                if let Some(line) = conflict(text.as_bytes()) {
                    return Err(format!("{path}: line {line}: {CONFLICT}; resolve it there").into());
                }
                templates.insert(page.to_owned(), text);
            }
            // What pages show besides, such as a photograph.
            Some(other) => _ = files.insert(format!("src/{other}"), bytes.clone()),
            None => _ = files.insert(name.into(), bytes.clone()),
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
    let built = report::build(&files, inputs.scratch)
        .map_err(|mistake| report::in_template(mistake, &pages, &templates))?;
    let pages = pages.into_iter().map(|(name, page)| (name, page.into_bytes()));
    Ok(pages
        .chain(built.into_iter().map(|(name, bytes)| (format!("book/{name}"), bytes)))
        .collect())
}

fn pictures<'a>(inputs: &'a Inputs) -> impl Iterator<Item = (&'a String, &'a Vec<u8>)> {
    inputs.artifacts.iter().filter(|(id, _)| id.starts_with("figures/")).flat_map(|(_, made)| made)
}

/// The versions of what shows in the book, as the build resolved them.
///
/// Cargo writes one field to a line, so that a run with nothing to do need not parse it all.
pub(crate) fn versions() -> Vec<(String, String)> {
    const SHOWN: [&str; 6] =
        ["mdbook-driver", "plotters", "polars", "pulldown-latex", "signorini", "tera"];
    let packages = include_str!("../../../Cargo.lock").split("[[package]]").skip(1);
    let field = |package: &str, key: &str| {
        let value = package.lines().find_map(|line| line.strip_prefix(key)?.strip_prefix(" = "));
        value.unwrap_or_default().trim_matches('"').to_owned()
    };
    packages
        .map(|package| (field(package, "name"), field(package, "version")))
        .filter(|(name, _)| SHOWN.contains(&name.as_str()))
        .collect()
}
