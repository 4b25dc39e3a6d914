//! Pictures of recorded times: figure tasks whose only input is `pipeline/timings.toml`.

use super::{cost, figures};
use crate::figures::Picture;
use crate::pipeline::error::Failure;
use crate::pipeline::{Artifacts, Inputs, Task};
use crate::replication::project::Project;
use crate::timing::recorded::{PATH, Timings};

type Draw = fn(&Timings) -> Picture;

/// Name, title, and how it is drawn.
const PICTURES: [(&str, &str, Draw); 2] = [
    ("cost", "Time per unknown against the number of unknowns", cost::cost),
    ("race", "Error against time, all solvers", cost::race),
];

/// The tasks that draw the pictures; none if nothing has been recorded.
pub fn pictures(project: &Project) -> Vec<Task> {
    let Some(text) = project.files.get(PATH) else { return Vec::new() };
    let task = |&(name, title, draw): &(&str, &str, Draw)| Task {
        files: Artifacts::from([(PATH.into(), text.clone())]),
        ..figures::drawing(name, title.into(), Vec::new(), move |inputs| {
            Ok(draw(&read(inputs)?.ok_or("nothing has been recorded")?))
        })
    };
    PICTURES.iter().map(task).collect()
}

/// The record among the files of a task, if it is there.
pub(super) fn read(inputs: &Inputs) -> Result<Option<Timings>, Failure> {
    let Some(text) = inputs.files.get(PATH) else { return Ok(None) };
    Ok(Some(Timings::parse(&String::from_utf8_lossy(text))?))
}
