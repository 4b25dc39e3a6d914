//! The `bench` stage: what no study can say, and the pictures of its results and of recorded times.

mod claims;
mod noise;
mod radius;
mod truth;

use super::cost;
use super::figures::{Draw, Drawing, drawing};
use crate::pipeline::error::Failure;
use crate::pipeline::{Artifacts, InputFiles, Inputs, Made, Task};
use crate::replication::project::Project;
use crate::replication::scene::Scene;
use crate::timing::recorded::{PATH, Timings};
use noise::AskedNoise;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use signorini_mathematics::experiments::{EXPERIMENTS, Rows};
use std::collections::BTreeMap;
use truth::AskedTruth;

/// Artifact with the findings of an experiment.
const RESULT: &str = "result.json";

/// The tasks of the experiments; they need the whole project, as the book does.
pub(super) fn tasks(project: &Project) -> Vec<Task> {
    let problems: Vec<_> =
        project.problems().into_iter().filter_map(Scene::table_problem).collect();
    let mut tasks = claims::tasks(project);
    tasks.push(AskedNoise::task(project));
    tasks.extend(AskedTruth::task(project));
    for experiment in &EXPERIMENTS {
        let plan = (experiment.plan)(&problems);
        let asked = Asked { experiment: experiment.name.into(), plan };
        tasks.push(Task::new(id(experiment.name), &asked, Vec::new(), |asked, _| asked.found()));
    }
    tasks
}

/// Experiment by its name, with its plan, on which alone the findings depend.
#[derive(Serialize, Deserialize)]
struct Asked {
    experiment: String,
    plan: Value,
}

impl Asked {
    /// Artifacts with the findings.
    fn found(&self) -> Made {
        let named = EXPERIMENTS.iter().find(|one| one.name == self.experiment);
        let experiment = named.ok_or_else(|| format!("no experiment {}", self.experiment))?;
        let mut found = json!((experiment.run)(&self.plan)?);
        // Pages have the plan beside the tables.
        found["plan"] = self.plan.clone();
        Ok(Artifacts::from([(RESULT.into(), super::to_json(&found))]))
    }
}

/// The tasks that draw the pictures of the chapters on experiments.
pub(super) fn pictures() -> Vec<Task> {
    vec![picture(
        ["radius", "radius"],
        "Distance of the spectral radius of one iteration from one against the duality parameter",
        |it, inputs| {
            let [radii, measured] = ["radii", "measured"].map(|name| table(inputs, "radius", name));
            it.made(inputs, radius::radius(&radii?, &measured?)?)
        },
    )]
}

/// The task that draws the findings of an experiment as a picture, by the names of both; the `title` is for readers who
/// cannot see it.
fn picture([experiment, name]: [&str; 2], title: &str, draw: Draw) -> Task {
    drawing(name, &Drawing::new(title), vec![id(experiment)], draw)
}

/// The tasks that draw recorded times, their only input; none if nothing has been recorded.
pub(super) fn pictures_of_times(project: &Project) -> Vec<Task> {
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

fn id(experiment: &str) -> String {
    format!("bench/{experiment}")
}

/// Returns a table of the findings of an experiment.
pub(super) fn table(inputs: &Inputs, experiment: &str, name: &str) -> Result<Rows, String> {
    let mut findings: BTreeMap<String, Value> = super::from_json(inputs, &id(experiment), RESULT)?;
    let rows = findings.remove(name).ok_or_else(|| format!("{experiment} has no table {name}"))?;
    serde_json::from_value(rows).map_err(|e| format!("{name} of {experiment} is no table: {e}"))
}

/// Returns the findings of all experiments, by name, for the templates.
pub(super) fn results(inputs: &Inputs) -> Result<BTreeMap<String, Value>, String> {
    let mut results = BTreeMap::new();
    for task in inputs.artifacts.keys() {
        if let Some(name) = task.strip_prefix("bench/") {
            results.insert(name.to_owned(), super::from_json(inputs, task, RESULT)?);
        }
    }
    Ok(results)
}
