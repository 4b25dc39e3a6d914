//! The `bench` stage: what no study can say, and the pictures of its results and of recorded times.

mod claims;
mod noise;
mod radius;
mod truth;

use super::cost;
use super::figures::{Drawing, drawing};
use crate::pipeline::error::Failure;
use crate::pipeline::{InputFiles, Inputs, Task};
use crate::replication::project::Project;
use crate::table::rows::Rows;
use crate::timing::recorded::{PATH, Timings};
use noise::AskedNoise;
use radius::AskedRadius;
use serde_json::Value;
use std::collections::BTreeMap;
use truth::AskedTruth;

/// Artifact with what was found.
const RESULT: &str = "result.json";

/// The tasks, with those of their pictures; they need the whole project, as the book does.
pub(super) fn tasks(project: &Project) -> Vec<Task> {
    let mut tasks = claims::tasks(project);
    tasks.extend([AskedNoise::task(project), AskedRadius::task(project)]);
    tasks.extend(AskedTruth::task(project));
    let title =
        "Distance of the spectral radius of one iteration from one against the duality parameter";
    tasks.push(drawing("radius", &Drawing::new(title), vec![id("radius")], |it, inputs| {
        let [radii, measured] = ["radii", "measured"].map(|name| table(inputs, "radius", name));
        it.made(inputs, radius::radius(&radii?, &measured?)?)
    }));
    tasks.extend(pictures_of_times(project));
    tasks
}

/// The tasks that draw recorded times, their only input; none if nothing has been recorded.
fn pictures_of_times(project: &Project) -> Vec<Task> {
    let Some(file) = project.files.get(PATH) else { return Vec::new() };
    let [cost, race] =
        ["Time per unknown against the number of unknowns", "Error against time, all solvers"]
            .map(Drawing::new);
    let tasks = [
        drawing("cost", &cost, Vec::new(), |it, inputs| {
            it.made(inputs, cost::cost(&times(inputs)?)?)
        }),
        drawing("race", &race, Vec::new(), |it, inputs| {
            it.made(inputs, cost::race(&times(inputs)?)?)
        }),
    ];
    let files = InputFiles::from([(PATH.to_owned(), file.clone())]);
    tasks.map(|task| task.with_files(files.clone())).into()
}

/// Parses the record of times among the files of a task.
pub(super) fn times(inputs: &Inputs) -> Result<Timings, Failure> {
    Ok(Timings::parse(inputs.file(PATH)?.ok_or("nothing has been recorded")?)?)
}

fn id(name: &str) -> String {
    format!("bench/{name}")
}

/// Returns a table of what a task has found.
pub(super) fn table(inputs: &Inputs, task: &str, name: &str) -> Result<Rows, String> {
    let mut found: BTreeMap<String, Value> = super::from_json(inputs, &id(task), RESULT)?;
    let rows = found.remove(name).ok_or_else(|| format!("{task} has no table {name}"))?;
    serde_json::from_value(rows).map_err(|e| format!("{name} of {task} is no table: {e}"))
}

/// Returns what all tasks have found, by name, for the templates.
pub(super) fn results(inputs: &Inputs) -> Result<BTreeMap<String, Value>, String> {
    let mut results = BTreeMap::new();
    for task in inputs.artifacts.keys() {
        if let Some(name) = task.strip_prefix("bench/") {
            results.insert(name.to_owned(), super::from_json(inputs, task, RESULT)?);
        }
    }
    Ok(results)
}
