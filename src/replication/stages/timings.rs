//! Pictures of recorded times: figure tasks whose only input is `pipeline/timings.toml`.

use super::bench::Drawn;
use super::{cost, figures};
use crate::figures::Caption;
use crate::pipeline::{Artifacts, Inputs, Task};
use crate::replication::project::Project;
use crate::timing::recorded::{PATH, Timings};

type Draw = fn(Caption, &Timings) -> Drawn;

/// Name, title, and how it is drawn.
const PICTURES: [(&str, &str, Draw); 2] = [
    ("cost", "Time per unknown against the number of unknowns", cost::cost),
    ("race", "Error against time, all solvers", cost::race),
];

/// The names of the pictures.
pub fn names() -> impl Iterator<Item = &'static str> {
    PICTURES.iter().map(|(name, ..)| *name)
}

/// The tasks that draw the pictures; none if nothing has been recorded.
pub fn pictures(project: &Project) -> Vec<Task> {
    let Some(text) = &project.timings_text else { return Vec::new() };
    let task = |&(name, title, draw): &(&str, &str, Draw)| Task {
        files: Artifacts::from([(PATH.into(), text.clone())]),
        ..figures::drawing(name, title.into(), Vec::new(), move |inputs, caption| {
            draw(caption, &read(inputs)?.ok_or("nothing has been recorded")?)
        })
    };
    PICTURES.iter().map(task).collect()
}

/// The record among the files of a task, if it is there.
pub(super) fn read(inputs: &Inputs) -> Result<Option<Timings>, String> {
    let Some(text) = inputs.files.get(PATH) else { return Ok(None) };
    Timings::parse(&String::from_utf8_lossy(text)).map(Some).map_err(|e| e.to_string())
}
