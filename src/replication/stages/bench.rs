//! The `bench` stage: experiments on accuracy, claims and stability, and the pictures of their results.

mod claims;
mod stability;

use super::{cost, figures, to_json};
use crate::experiments::problems::Problem;
use crate::experiments::{self, accuracy, strips, truth};
use crate::figures::{Caption, Drawing, StripsPanel};
use crate::pipeline::error::Failure;
use crate::pipeline::{Artifacts, Inputs, Task, parameters};
use crate::replication::project::Project;
use crate::replication::scene::Scene;
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::collections::BTreeMap;

/// Artifact with what an experiment found.
const RESULT: &str = "result.json";

/// The experiments, as tasks; they need the whole project, as the book does.
pub fn tasks(project: &Project) -> Vec<Task> {
    let problems: Vec<Problem> = project.problems().into_iter().filter_map(problem).collect();
    let named = |problem: &Problem| (format!("problem {}", problem.number), problem.f.clone());
    let truth = truth::Plan::new(problems.iter().map(named));
    let strips = strips::Plan { problems: problems.clone() };
    let plan = experiments::claims::Plan::new(problems);
    let mut tasks = vec![
        task("accuracy", accuracy::Plan::default(), accuracy::accuracy),
        task("claims", plan, experiments::claims::claims),
        task("cube", experiments::cube::Plan::default(), experiments::cube::cube),
        task("truth", truth, truth::truth),
        task("strips", strips, strips::strips),
    ];
    tasks.extend(stability::tasks(project));
    tasks
}

/// The problem of a scene as experiments take it, if it belongs to a published table.
pub fn problem(scene: &Scene) -> Option<Problem> {
    Some(Problem {
        number: scene.paper_table?,
        f: scene.f.to_string(),
        load: scene.load,
        prolongation: scene.prolongation,
        grids: scene.grids.iter().map(|grid| grid.cells()).collect(),
        r: scene.r.clone(),
        max_iterations: scene.max_iterations,
    })
}

/// A picture of what experiments found.
struct Picture {
    /// Name of the file, without ending, and in the book.
    name: &'static str,
    /// Experiments it is drawn from.
    experiments: &'static [&'static str],
    /// Its title for readers who cannot see it.
    title: &'static str,
    draw: fn(&Inputs, Caption) -> Result<Drawing, Failure>,
}

/// The pictures of the chapters on experiments.
const PICTURES: &[Picture] = &[
    Picture {
        name: "accuracy",
        experiments: &["accuracy"],
        title: "Errors against the width of the grid, problems with known solutions",
        draw: |inputs, caption| Ok(cost::accuracy(caption, &result(inputs, "accuracy")?)?),
    },
    Picture {
        name: "work",
        experiments: &["accuracy"],
        title: "Residual, error and cost of three methods in sweeps and visits of unknowns",
        draw: |inputs, caption| Ok(cost::work(caption, &result(inputs, "accuracy")?)?),
    },
    Picture {
        name: "ends",
        experiments: &["truth"],
        title: "Error of the ends of contact and of the energy against the width of the grid",
        draw: |inputs, caption| Ok(cost::ends(caption, &result(inputs, "truth")?)?),
    },
    Picture {
        name: "strips",
        experiments: &["strips"],
        title: "Contact along the boundary, iteration by iteration, for both problems and every r",
        draw: draw_strips,
    },
    Picture {
        name: "sweep",
        experiments: &["claims"],
        title: "Iterations of both problems against the duality parameter, three ways of stopping",
        draw: claims::sweep,
    },
    Picture {
        name: "uzawa",
        experiments: &["claims"],
        title: "Sweeps of Arrow-Hurwicz and of Uzawa's algorithm to equal residual against the duality parameter",
        draw: claims::uzawa,
    },
    Picture {
        name: "rounding",
        experiments: &["rounding"],
        title: "The least relative disturbance that changes each published count",
        draw: stability::draw_rounding,
    },
    Picture {
        name: "duality",
        experiments: &["stress"],
        title: "KKT residual and iterations of the paper's method over r",
        draw: stability::draw_duality,
    },
    Picture {
        name: "tolerances",
        experiments: &["stress"],
        title: "KKT residual reached against the tolerance asked for",
        draw: stability::draw_tolerances,
    },
    Picture {
        name: "deficits",
        experiments: &["stress"],
        title: "Work and contact as the integral of f tends to zero",
        draw: stability::draw_deficits,
    },
    Picture {
        name: "precision",
        experiments: &["stress"],
        title: "KKT residual that rounding leaves, over the grids",
        draw: stability::draw_precision,
    },
];

/// The contact of both problems, a strip for each r.
fn draw_strips(inputs: &Inputs, caption: Caption) -> Result<Drawing, Failure> {
    let found: Vec<strips::Strips> = result(inputs, "strips")?;
    let titles: Vec<String> = found
        .iter()
        .map(|problem| format!("Problem {}, h = 1/{}", problem.number, problem.cells))
        .collect();
    let panels: Vec<_> = found
        .iter()
        .zip(&titles)
        .map(|(problem, title)| {
            let strips = problem.strips.iter().map(|s| (format!("r = {}", s.r), s.contact.clone()));
            StripsPanel {
                title,
                cells: problem.cells,
                strips: strips.collect(),
                truth: &problem.truth,
            }
        })
        .collect();
    Ok(crate::figures::strips(caption, &panels)?)
}

/// The tasks that draw [`PICTURES`].
pub fn pictures() -> impl Iterator<Item = Task> {
    PICTURES.iter().map(|picture| {
        let needs = picture.experiments.iter().map(|name| id(name)).collect();
        figures::drawing(picture.name, picture.title.into(), needs, picture.draw)
    })
}

fn id(experiment: &str) -> String {
    format!("bench/{experiment}")
}

/// The task of an experiment: everything that it depends on is in `plan`.
fn task<P, R>(name: &str, plan: P, run: fn(&P) -> Result<R, String>) -> Task
where
    P: Serialize + Send + Sync + 'static,
    R: Serialize + 'static,
{
    Task::new(id(name), parameters(&plan), Vec::new(), move |_| {
        Ok(Artifacts::from([(RESULT.into(), to_json(&run(&plan)?))]))
    })
}

/// What an experiment found.
pub(super) fn result<T: DeserializeOwned>(inputs: &Inputs, experiment: &str) -> Result<T, String> {
    super::from_json(inputs, &id(experiment), RESULT)
}

/// What all experiments found, by name, for the templates.
pub(super) fn results(inputs: &Inputs) -> Result<BTreeMap<String, serde_json::Value>, String> {
    let mut results = BTreeMap::new();
    for task in inputs.artifacts.keys() {
        if let Some(name) = task.strip_prefix("bench/") {
            results.insert(name.to_owned(), super::from_json(inputs, task, RESULT)?);
        }
    }
    Ok(results)
}
