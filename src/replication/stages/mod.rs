//! The stages of the replication, and the plan of their tasks.
//!
//! Central is [`plan`], which turns the scenes of a project into tasks.

mod bench;
mod cost;
pub(crate) mod diff;
mod figures;
mod identify;
mod members;
pub(crate) mod report;
mod results;
mod solutions;
pub(crate) mod solve;
pub(crate) mod study;
pub(crate) mod tabulate;

use crate::pipeline::error::Result;
use crate::pipeline::{InputFiles, Inputs, Plan, Task, stage};
use crate::replication::project::Project;
use crate::replication::scene::{Output, Scene};
use clap::ValueEnum;
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::fmt;

/// The kinds of task, in the order in which they follow from each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Stage {
    /// One problem by its solver; by a saddle-point method one column of a rule and an r, over all grids.
    Solve,
    /// One table per scene.
    Tabulate,
    /// Tables against the published ones.
    Diff,
    /// Right-hand sides that agree with a published table, and a search for one.
    Identify,
    /// What no study can say: verdicts on claims, noise of loads, spectral radii, true solutions.
    Bench,
    /// SVG pictures.
    Figures,
    /// Markdown pages and the book.
    Report,
}

impl Stage {
    /// The stage of the task with this id.
    pub(crate) fn of(id: &str) -> Option<Self> {
        Self::from_str(stage(id), false).ok()
    }
}

/// Writes the name on the command line and in task ids.
impl fmt::Display for Stage {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.serialize(out)
    }
}

/// Digest of the sources of this program, made by the build script: an input of every task.
const PROGRAM: &str = env!("SIGNORINI_PROGRAM");

/// Returns the tasks for which `scenes` ask, in running order; with `only`, those of one stage and all they need.
///
/// Figures that show several scenes together, and the book, belong to the project as a whole: they
/// are planned when all scenes concerned are among `scenes`.
pub(crate) fn plan(project: &Project, scenes: &[&Scene], only: Option<Stage>) -> Result<Plan> {
    let mut tasks: Vec<Task> = Vec::new();
    for scene in scenes {
        tasks.extend(solve::tasks(scene));
        if scene.wants(Output::Table) {
            tasks.push(tabulate::task(scene));
        }
        if let Some(number) = scene.paper_table.filter(|_| scene.wants(Output::Table)) {
            tasks.push(diff::task(project, scene, number)?);
        }
    }
    tasks.extend(identify::tasks(project, scenes)?);
    tasks.extend(figures::tasks(project, scenes));
    let all = !project.partial && scenes.len() == project.scenes.len();
    let whole = all && !project.templates.is_empty();
    if whole {
        tasks.extend(results::task(project));
        if report::left_out(project).is_none() {
            tasks.extend(bench::tasks(project));
        }
    }
    tasks.sort_by_cached_key(|task| Stage::of(&task.id));
    if whole {
        tasks.push(report::task(project, &tasks));
    }
    let plan = Plan::new(PROGRAM, tasks)?;
    Ok(match only {
        Some(stage) => plan.only(|id| Stage::of(id) == Some(stage)),
        None => plan,
    })
}

/// Returns the name of the scene to which a task with this id belongs, if it belongs to a single one; the scene need
/// not exist.
pub(crate) fn scene_of(id: &str) -> Option<&str> {
    let (_, rest) = id.split_once('/')?;
    match Stage::of(id)? {
        Stage::Solve | Stage::Tabulate | Stage::Diff | Stage::Identify => rest.split('/').next(),
        Stage::Figures => figures::scene_of(rest),
        Stage::Bench | Stage::Report => None,
    }
}

/// Returns all files that a run of these tasks reads, by path: those of the project, and those of single tasks.
pub(crate) fn files_of(project: &Project, tasks: &[Task]) -> InputFiles {
    let mut files = project.files.clone();
    for task in tasks {
        files.extend(task.files.iter().map(|(path, file)| (path.clone(), file.clone())));
    }
    files
}

/// Returns those of `scenes` that share a figure of this output; none if one of the project's scenes that share it is
/// missing.
fn sharing<'a>(project: &Project, scenes: &[&'a Scene], output: Output) -> Vec<&'a Scene> {
    if project.partial {
        return Vec::new();
    }
    let mut shared = scenes.to_vec();
    shared.retain(|scene| scene.is_problem() && scene.wants(output));
    let mut all: Vec<&Scene> = project.scenes.iter().collect();
    all.retain(|scene| scene.is_problem() && scene.wants(output));
    if shared.len() == all.len() { shared } else { Vec::new() }
}

/// Returns JSON in one line: with a line for each number, findings would be twice as large in the cache.
fn to_json(value: &impl Serialize) -> Vec<u8> {
    let mut bytes = serde_json::to_vec(value).expect("artifacts are plain data");
    bytes.push(b'\n');
    bytes
}

/// Returns an artifact of a task by its name.
fn artifact<'a>(
    inputs: &'a Inputs,
    task: &str,
    name: &str,
) -> std::result::Result<&'a [u8], String> {
    let found = inputs.artifacts.get(task).and_then(|artifacts| artifacts.get(name));
    found.map(Vec::as_slice).ok_or_else(|| format!("{task} has no artifact {name}"))
}

/// Parses an artifact of a task as JSON.
fn from_json<T: DeserializeOwned>(
    inputs: &Inputs,
    task: &str,
    name: &str,
) -> std::result::Result<T, String> {
    serde_json::from_slice(artifact(inputs, task, name)?)
        .map_err(|e| format!("{name} of {task} is not what this version writes: {e}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;
    use std::path::Path;

    /// The stamps of the tasks in a plan, by id.
    fn stamps(plan: &Plan) -> BTreeMap<String, String> {
        let ids = plan.tasks().iter().map(|task| task.id.clone());
        ids.zip(plan.stamps().unwrap()).collect()
    }

    #[test]
    fn a_task_of_one_scene_is_the_same_without_the_others() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).to_path_buf();
        let project = Project::read(root.clone()).unwrap();
        let whole = stamps(&plan(&project, &project.select(&[]).unwrap(), None).unwrap());
        let mut alone = 0;
        for scene in &project.scenes {
            let part = Project::read_part(root.clone(), &[&scene.name]).unwrap();
            for (id, stamp) in stamps(&plan(&part, &part.select(&[]).unwrap(), None).unwrap()) {
                assert_eq!(whole.get(&id), Some(&stamp), "{id}");
                assert_eq!(scene_of(&id), Some(&*scene.name), "{id}");
                alone += 1;
            }
        }
        let mut of_single_scenes = 0;
        for id in whole.keys() {
            let scene = project.scenes.iter().find(|scene| scene_of(id) == Some(&scene.name));
            let shared = Stage::of(id) == Some(Stage::Identify);
            if scene.is_some_and(|scene| !(shared && scene.is_problem())) {
                of_single_scenes += 1;
            }
        }
        assert_eq!(alone, of_single_scenes);
    }
}
