//! The `bench` stage: experiments on accuracy, claims and stability, and the pictures of their results and of
//! recorded times.

mod claims;
mod stability;

use super::figures::drawing;
use super::{cost, to_json};
use crate::figures::Picture;
use crate::pipeline::error::Failure;
use crate::pipeline::{Artifacts, Inputs, Task, parameters};
use crate::replication::project::Project;
use crate::replication::scene::Scene;
use crate::timing::recorded::{PATH, Timings};
use serde::Serialize;
use serde::de::DeserializeOwned;
use signorini_mathematics::experiments::accuracy::AccuracyFindings;
use signorini_mathematics::experiments::claims::ClaimsPlan;
use signorini_mathematics::experiments::problems::TableProblem;
use signorini_mathematics::experiments::{self, accuracy, adapted, sticking, stress, truth};
use stability::{duality, tolerances};
use std::collections::BTreeMap;

/// Artifact with the findings of an experiment.
const RESULT: &str = "result.json";

/// The tasks of the experiments; they need the whole project, as the book does.
pub(super) fn tasks(project: &Project) -> Vec<Task> {
    let problems: Vec<TableProblem> =
        project.problems().into_iter().filter_map(Scene::table_problem).collect();
    let named = problems.iter().map(|problem| {
        let name = format!("problem {}", problem.number);
        (name, problem.f.clone())
    });
    let truth = truth::TruthPlan::new(named);
    let stress = stress::StressPlan::new(problems.clone());
    let plan = ClaimsPlan::new(problems);
    vec![
        task("accuracy", accuracy::AccuracyPlan::default(), accuracy::accuracy),
        task("adapted", adapted::AdaptedPlan::default(), adapted::adapted),
        task("claims", plan, experiments::claims::claims),
        task("friction", ClaimsPlan::friction(), experiments::claims::claims),
        task(
            "domains",
            experiments::domains::DomainsPlan::default(),
            experiments::domains::domains,
        ),
        task("sticking", sticking::StickingPlan::default(), sticking::sticking),
        task("truth", truth, truth::truth),
        task("stress", stress, stress::stress),
    ]
}

/// The tasks that draw the pictures of the chapters on experiments.
pub(super) fn pictures(project: &Project) -> Vec<Task> {
    vec![
        rules(project),
        picture::<AccuracyFindings>(
            "accuracy",
            "accuracy",
            "Errors against the width of the grid, problems with known solutions",
            cost::accuracy,
        ),
        picture(
            "adapted",
            "adapted",
            "Guaranteed error against the number of nodes, adaptive and uniform refinement",
            cost::adapted,
        ),
        picture(
            "truth",
            "ends",
            "Error of the ends of contact and of the energy against the width of the grid",
            cost::ends,
        ),
        picture(
            "claims",
            "sweep",
            "Iterations of both problems against the duality parameter, three ways of stopping",
            claims::sweep,
        ),
        picture(
            "claims",
            "uzawa",
            "Sweeps of Arrow-Hurwicz and of Uzawa's algorithm to equal residual against the duality parameter",
            claims::uzawa,
        ),
        picture(
            "sticking",
            "sticking",
            "Length of the arcs that stick against one over the bound of the friction",
            claims::sticking,
        ),
        picture(
            "stress",
            "duality",
            "KKT residual at the stop of the paper's method over r",
            duality,
        ),
        picture(
            "stress",
            "tolerances",
            "KKT residual reached against the tolerance asked for",
            tolerances,
        ),
    ]
}

/// The task that draws the counts of three rules on the finest grid beside the published ones.
fn rules(project: &Project) -> Task {
    let paper = project.paper.clone();
    let published = serde_json::json!({ "published": paper });
    let title = "Counts on the finest grid: printed rule, signed rule, published".to_owned();
    let task = drawing("rules", title, vec![id("claims")], move |inputs| {
        Ok(claims::rules(&result(inputs, "claims")?, &paper))
    });
    Task { parameters: parameters(&published), ..task }
}

/// The task that draws the findings of an `experiment`; the `title` is for readers who cannot see the picture.
fn picture<T: DeserializeOwned + 'static>(
    experiment: &'static str,
    name: &str,
    title: &str,
    draw: fn(&T) -> Picture,
) -> Task {
    drawing(name, title.into(), vec![id(experiment)], move |inputs| {
        Ok(draw(&result(inputs, experiment)?))
    })
}

/// The tasks that draw recorded times, their only input; none if nothing has been recorded.
pub(super) fn pictures_of_times(project: &Project) -> Vec<Task> {
    let Some(file) = project.files.get(PATH) else { return Vec::new() };
    let cost = drawing(
        "cost",
        "Time per unknown against the number of unknowns".into(),
        Vec::new(),
        |inputs| Ok(cost::cost(&times(inputs)?)),
    );
    let race = drawing("race", "Error against time, all solvers".into(), Vec::new(), |inputs| {
        Ok(cost::race(&times(inputs)?))
    });
    let mut tasks = vec![cost, race];
    for task in &mut tasks {
        task.files.insert(PATH.into(), file.clone());
    }
    tasks
}

/// Parses the record of times among the files of a task.
pub(super) fn times(inputs: &Inputs) -> Result<Timings, Failure> {
    Ok(Timings::parse(inputs.file(PATH)?.ok_or("nothing has been recorded")?)?)
}

fn id(experiment: &str) -> String {
    format!("bench/{experiment}")
}

/// The task of an experiment, whose findings depend on `plan` alone.
fn task<P, R>(name: &str, plan: P, run: fn(&P) -> Result<R, String>) -> Task
where
    P: Serialize + Send + Sync + 'static,
    R: Serialize + 'static,
{
    Task::new(id(name), parameters(&plan), Vec::new(), move |_| {
        Ok(Artifacts::from([(RESULT.into(), to_json(&run(&plan)?))]))
    })
}

pub(super) fn result<T: DeserializeOwned>(inputs: &Inputs, experiment: &str) -> Result<T, String> {
    super::from_json(inputs, &id(experiment), RESULT)
}

/// Returns the findings of all experiments, by name, for the templates.
pub(super) fn results(inputs: &Inputs) -> Result<BTreeMap<String, serde_json::Value>, String> {
    let mut results = BTreeMap::new();
    for task in inputs.artifacts.keys() {
        if let Some(name) = task.strip_prefix("bench/") {
            results.insert(name.to_owned(), super::from_json(inputs, task, RESULT)?);
        }
    }
    Ok(results)
}
