//! The `report` stage: makes pages and a book of the artifacts of the other stages.

mod chapters;
mod findings;
mod notebook;
mod times;

use super::solutions::Solutions;
use super::{artifact, bench, figures, files_of, results, study};
use crate::pipeline::error::{CONFLICT, Failure, conflict};
use crate::pipeline::names::composed;
use crate::pipeline::{Artifacts, Inputs, Made, Task};
use crate::replication::project::{Project, TRUTH};
use crate::replication::scene::{Output, Scene};
use crate::replication::study::Study;
use crate::timing::recorded;
use notebook::NotebookCell;
use serde::{Deserialize, Serialize};
pub(crate) use signorini_book::TEMPLATE;
use signorini_mathematics::machine::memory::give_back;
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
    if first.grids() != second.grids() {
        return Some(format!("`{}` and `{}` must have the same grids", first.name, second.name));
    }
    if !project.files.contains_key(recorded::PATH) {
        return Some("they show recorded times; restore pipeline/timings.toml".into());
    }
    if !project.files.contains_key(TRUTH) {
        return Some(
            "they show true solutions; restore pipeline/truth.toml, or make it with benches/peers/truth.py".into(),
        );
    }
    problems.iter().find_map(|scene| {
        if scene.r() != project.paper.r {
            let (name, r) = (&scene.name, &project.paper.r);
            return Some(format!(
                "they show scene `{name}` for the paper's r; let it have r = {r:?}"
            ));
        }
        let missing = missing_setting(scene)?;
        Some(format!("they show scene `{}`; add {missing}", scene.name))
    })
}

/// True if a page shows numbers or a map of the solution of a scene; a study has its table and chart.
fn is_shown(scene: &Scene) -> bool {
    !scene.is_study && (scene.wants(Output::Table) || scene.wants(Output::Map))
}

/// Returns a rule or an output that the chapters show and the scene does not ask for, if there is one.
fn missing_setting(scene: &Scene) -> Option<String> {
    if let Some(rule) = chapters::RULES.iter().find(|rule| !scene.rules().contains(&Some(**rule))) {
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

/// Scenes and tasks that the pages show, besides artifacts and files.
#[derive(Serialize, Deserialize)]
struct BookParts {
    /// The paper's problems.
    problems: Vec<Scene>,
    /// The other scenes with a table.
    others: Vec<Scene>,
    /// Studies, by the names of their scenes.
    studies: BTreeMap<String, Study>,
    /// Cells of the notebook, if the page that shows them is among the templates.
    notebook: Vec<NotebookCell>,
    /// Reason for which pages made from templates are left out, if there is one.
    left_out: Option<String>,
}

/// The task that writes the pages and builds the book, from the artifacts of all `earlier` tasks.
pub(crate) fn task(project: &Project, earlier: &[Task]) -> Task {
    let mut others = project.scenes.clone();
    others.retain(|scene| !scene.is_problem() && is_shown(scene));
    let mut files = files_of(project, earlier);
    for (name, file) in &project.templates {
        files.insert(format!("report/{name}"), file.clone());
    }
    let needs: Vec<String> = earlier.iter().map(|task| task.id.clone()).collect();
    let has_notebook = project.templates.contains_key("templates/studies.md.tera");
    let studies = project.scenes.iter();
    let studies = studies.filter(|scene| scene.is_study);
    let pages = BookParts {
        problems: project.problems().into_iter().cloned().collect(),
        others,
        studies: studies.map(|scene| (scene.name.clone(), scene.study.clone())).collect(),
        notebook: if has_notebook { notebook::cells() } else { Vec::new() },
        left_out: left_out(project),
    };
    Task::new(ID, &pages, needs, made).with_files(files).exported_to("report")
}

/// Makes the pages and the book.
fn made(pages: &BookParts, inputs: &Inputs) -> Made {
    // The book takes the most memory of all tasks: what those before have left would add to it.
    give_back();
    let BookParts { problems, others, studies, notebook, left_out } = pages;
    if let Some(reason) = left_out {
        return book(inputs, Artifacts::new(), |templates| {
            Ok(signorini_book::stubs(templates, reason)?)
        });
    }
    let Solutions { listed, mut files } = Solutions::of(inputs, problems, others)?;
    for picture in notebook.iter().filter_map(|cell| cell.picture.as_ref()) {
        files.insert("notebook.svg".into(), picture.clone().into_bytes());
    }
    let files = files.into_iter().map(|(name, bytes)| (format!("src/data/{name}"), bytes));
    book(inputs, files.collect(), |templates| {
        let mut context = chapters::context(inputs, problems, others)?;
        let mut rows = BTreeMap::new();
        for (name, of_scene) in studies {
            rows.insert(&name[..], study::rows(inputs, name, of_scene)?);
        }
        let truths = bench::table(inputs, "truth", "solutions")?;
        context.insert("findings", &findings::findings(&rows, &truths)?);
        context.insert("studies", &rows);
        context.insert("notebook", notebook);
        context.insert("solutions", &listed);
        Ok(signorini_book::pages(templates, &context)?)
    })
}

/// Makes the pages from the templates, and the book from the pages and from what is `made` for it; all are files by
/// name.
fn book(
    inputs: &Inputs,
    mut made: Artifacts,
    pages: impl Fn(&BTreeMap<String, String>) -> Result<BTreeMap<String, String>, Failure>,
) -> Result<Artifacts, Failure> {
    let mut templates = BTreeMap::new();
    let mut files = Artifacts::new();
    for (path, file) in inputs.files {
        let bytes = file.bytes()?;
        let Some(name) = path.strip_prefix("report/") else {
            // BookParts may include files of the project.
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
    for (_, pictures) in inputs.artifacts.iter().filter(|(id, _)| id.starts_with("figures/")) {
        for (name, bytes) in pictures {
            made.insert(format!("src/figures/{name}"), bytes.clone());
        }
    }
    for (_, tables) in inputs.artifacts.iter().filter(|(id, _)| id.starts_with("tabulate/")) {
        // Pages link to all digits, and include the table with fewer.
        for (name, bytes) in tables.iter().filter(|(name, _)| !name.ends_with(".tex")) {
            made.insert(format!("src/tables/{name}"), bytes.clone());
        }
    }
    if let Ok(csv) = artifact(inputs, results::ID, results::FILE) {
        made.insert(format!("src/{}", results::FILE), csv.into());
    }
    refuse_replaced(&files, &templates, made.keys().chain(pages.keys()))?;
    files.extend(made);
    files.extend(pages.iter().map(|(name, page)| (name.clone(), page.clone().into_bytes())));
    let built = signorini_book::build(&files, inputs.scratch).map_err(|mistake| {
        signorini_book::in_template(mistake, &pages, &templates).replace(['\n', '\r'], " ")
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

/// Refuses a file of the user, among `files` or `templates`, with the name of one that the run has `made`.
fn refuse_replaced<'a>(
    files: &Artifacts,
    templates: &BTreeMap<String, String>,
    made: impl Iterator<Item = &'a String>,
) -> Result<(), Failure> {
    // A page is made of its template.
    let mut made: BTreeSet<&str> = made.filter_map(|name| name.strip_prefix("src/")).collect();
    made.retain(|&name| {
        !templates.contains_key(name) && !templates.contains_key(&format!("{name}.tera"))
    });
    let users = files.keys().filter_map(|name| name.strip_prefix("src/"));
    match users.chain(templates.keys().map(String::as_str)).find(|name| made.contains(name)) {
        None => Ok(()),
        Some(name) => Err(format!(
            "report/templates/{name}: a run makes a file of this name; rename this one"
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::replication::stages::plan;
    use std::path::Path;

    #[test]
    fn the_book_is_made_anew_when_any_file_of_any_task_changes() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).to_path_buf();
        let project = Project::read(root).unwrap();
        let plan = plan(&project, &project.select(&[]).unwrap(), None).unwrap();
        let book = plan.task(ID).unwrap();
        let mut files = plan.tasks().iter().flat_map(|task| task.files.keys());
        assert!(files.all(|path| book.files.contains_key(path)));
        assert!(book.files.contains_key(recorded::PATH));
        assert!(book.files.contains_key("pipeline/meshes/gear.msh"));
    }
}
