//! Pictures of recorded times: figure tasks whose only input is `pipeline/timings.toml`.

use super::cost;
use crate::draw::Caption;
use crate::pipeline::{Artifacts, Inputs, Stage, Task};
use crate::project::Project;
use crate::timings::{PATH, Timings};
use std::collections::BTreeMap;

type Draw = fn(Caption, &Timings) -> Result<String, String>;

/// Name, title, and how it is drawn.
const PICTURES: [(&str, &str, Draw); 2] = [
    ("cost", "Time per unknown against the number of unknowns", cost::cost),
    ("race", "Error against time, all solvers", cost::race),
];

/// The names of the pictures and the ids of their tasks.
pub fn names() -> impl Iterator<Item = (&'static str, String)> {
    PICTURES.iter().map(|(name, ..)| (*name, format!("figures/{name}")))
}

/// The tasks that draw the pictures; none if nothing has been recorded.
pub fn pictures(project: &Project) -> Vec<Task> {
    let Some(text) = &project.timings_text else { return Vec::new() };
    let task = |(name, title, draw): &(&'static str, &'static str, Draw)| {
        let (name, title, draw) = (*name, *title, *draw);
        Task {
            id: format!("figures/{name}"),
            stage: Stage::Figures,
            parameters: BTreeMap::from([("title".into(), title.into())]),
            files: Artifacts::from([(PATH.into(), text.clone())]),
            needs: Vec::new(),
            export: Some("figures"),
            work: Box::new(move |inputs| {
                let timings = read(inputs)?.ok_or("nothing has been recorded")?;
                let description = format!(
                    "Made by `signorini run --only figures` from inputs {} (blake3).",
                    &inputs.digest[..12]
                );
                let svg = draw(Caption { title, description: &description }, &timings)?;
                Ok(Artifacts::from([(format!("{name}.svg"), svg.into_bytes())]))
            }),
        }
    };
    PICTURES.iter().map(task).collect()
}

/// The record among the files of a task, if it is there.
pub(super) fn read(inputs: &Inputs) -> Result<Option<Timings>, String> {
    let Some(text) = inputs.files.get(PATH) else { return Ok(None) };
    Timings::parse(&String::from_utf8_lossy(text)).map(Some).map_err(|e| e.to_string())
}
