//! The table of all results: every scene, rule, r and grid beside what the paper prints, for other programs to read.

use super::{artifact, tabulate};
use crate::pipeline::{Artifacts, Stage, Task};
use crate::replication::paper::Paper;
use crate::replication::project::Project;
use crate::replication::scene::Output;
use crate::report::results::{Levels, Published, Results};

/// Id of the task.
pub const ID: &str = "diff/results";
/// Artifact, and file under `report/`: a [`Results`].
pub const FILE: &str = "results.csv";

/// The task that joins all tables of a project; none if no scene asks for one.
pub fn task(project: &Project) -> Option<Task> {
    let scenes = project.scenes.iter().filter(|scene| scene.wants(Output::Table));
    let parts: Vec<_> = scenes
        .flat_map(|scene| {
            scene.stop.iter().map(|&rule| {
                (tabulate::id(scene, rule), scene.name.clone(), scene.paper_table, rule)
            })
        })
        .collect();
    let needs: Vec<String> = parts.iter().map(|part| part.0.clone()).collect();
    (!needs.is_empty()).then(|| Task {
        id: ID.into(),
        stage: Stage::Diff,
        parameters: parts
            .iter()
            .map(|(id, .., table, _)| {
                (id.clone(), table.map_or("no table".into(), |n| format!("table {n}")))
            })
            .collect(),
        files: Artifacts::from([(PAPER.into(), project.paper_text.clone().into_bytes())]),
        needs,
        export: Some("report"),
        work: Box::new(move |inputs| {
            let paper = Paper::parse(&String::from_utf8_lossy(&inputs.files[PAPER]));
            let paper = paper.map_err(|e| e.to_string())?;
            let published = |number: u8| {
                let table = paper.table.iter().find(|table| table.number == number)?;
                Some(Published { r: &paper.r, counts: &table.counts, delta_a: &table.delta_a })
            };
            let levels = parts
                .iter()
                .map(|(id, problem, table, rule)| {
                    let csv = artifact(inputs, id, tabulate::LEVELS)?;
                    Ok(Levels { problem, published: table.and_then(published), rule: *rule, csv })
                })
                .collect::<Result<Vec<_>, String>>()?;
            let results = Results::of(&levels)?;
            Ok(Artifacts::from([(FILE.into(), results.to_csv()?)]))
        }),
    })
}

const PAPER: &str = "pipeline/paper.toml";
