//! The stages of the replication, and the plan that ties them together.

pub mod bench;
mod cost;
pub mod diff;
pub mod figures;
pub mod identify;
pub mod report;
pub mod results;
pub mod solve;
pub mod tabulate;
pub mod timings;

use crate::pipeline::error::Result;
use crate::pipeline::{Inputs, Stage, Task};
use crate::replication::project::Project;
use crate::replication::scene::{Output, Scene};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::collections::BTreeSet;

/// The tasks that `scenes` ask for, in running order; with `only`, those of one stage and what they need.
///
/// Figures that show several scenes together, and the book, belong to the project as a whole: they
/// are planned when all scenes concerned are among `scenes`.
///
/// # Errors
/// [`Error::Input`](crate::pipeline::error::Error::Input) if the book lacks something that only a scene can ask for,
/// or a scene asks for what the project lacks.
pub fn plan(project: &Project, scenes: &[&Scene], only: Option<Stage>) -> Result<Vec<Task>> {
    let mut tasks = Vec::new();
    for scene in scenes {
        for &stop in &scene.stop {
            tasks.extend(solve::tasks(scene, stop));
            if scene.wants(Output::Table) {
                tasks.push(tabulate::task(scene, stop));
            }
        }
        if let Some(number) = scene.paper_table.filter(|_| scene.wants(Output::Table)) {
            tasks.push(diff::task(project, scene, number)?);
        }
    }
    tasks.extend(identify::tasks(project, scenes)?);
    tasks.extend(figures::tasks(project, scenes));
    if scenes.len() == project.scenes.len() && !project.templates.is_empty() {
        tasks.extend(results::task(project));
        tasks.extend(bench::tasks(project));
        tasks.extend(bench::pictures());
        tasks.extend(timings::pictures(project));
        tasks.push(report::task(project, &tasks)?);
    }
    tasks.sort_by_key(|task| task.stage);
    if let Some(stage) = only {
        let mut wanted: BTreeSet<String> =
            tasks.iter().filter(|task| task.stage == stage).map(|task| task.id.clone()).collect();
        // Needs are of earlier stages, so that one walk from the end finds them all.
        for task in tasks.iter().rev() {
            if wanted.contains(&task.id) {
                wanted.extend(task.needs.iter().cloned());
            }
        }
        tasks.retain(|task| wanted.contains(&task.id));
    }
    Ok(tasks)
}

/// Pretty JSON with a final newline.
fn to_json(value: &impl Serialize) -> Vec<u8> {
    let mut bytes = serde_json::to_vec_pretty(value).expect("artifacts are plain data");
    bytes.push(b'\n');
    bytes
}

fn artifact<'a>(
    inputs: &'a Inputs,
    task: &str,
    name: &str,
) -> std::result::Result<&'a [u8], String> {
    let found = inputs.artifacts.get(task).and_then(|artifacts| artifacts.get(name));
    found.map(Vec::as_slice).ok_or_else(|| format!("{task} has no artifact {name}"))
}

fn from_json<T: DeserializeOwned>(
    inputs: &Inputs,
    task: &str,
    name: &str,
) -> std::result::Result<T, String> {
    serde_json::from_slice(artifact(inputs, task, name)?)
        .map_err(|e| format!("{name} of {task} is not what this version writes: {e}"))
}
