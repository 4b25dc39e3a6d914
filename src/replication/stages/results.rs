//! The table of all results: every scene, rule, r and grid beside what the paper prints, for other programs to read.

use super::from_json;
use super::solve::{self, Outcomes};
use crate::pipeline::{Artifacts, Task, parameters};
use crate::replication::project::Project;
use crate::replication::scene::{Output, Scene};
use crate::report::results::{Levels, Published, Results};
use crate::saddle::StopRule;

/// Id of the task.
pub const ID: &str = "diff/results";
/// Artifact, and file under `report/`: a [`Results`].
pub const FILE: &str = "results.csv";

/// The task that joins the results of all scenes that ask for a table; none if no scene does.
pub fn task(project: &Project) -> Option<Task> {
    let scenes = project.scenes.iter().filter(|scene| scene.wants(Output::Table));
    let parts: Vec<(Scene, StopRule)> =
        scenes.flat_map(|scene| scene.stop.iter().map(|&rule| (scene.clone(), rule))).collect();
    let ids = |(scene, rule): &(Scene, StopRule)| {
        scene.r.iter().map(|&r| solve::id(scene, *rule, r)).collect::<Vec<_>>()
    };
    let needs: Vec<String> = parts.iter().flat_map(ids).collect();
    let paper = project.paper.clone();
    let tables: Vec<_> = parts.iter().map(|(scene, _)| scene.paper_table).collect();
    let printed: Vec<_> =
        paper.table.iter().map(|table| (table.number, &table.counts, &table.delta_a)).collect();
    let parameters =
        parameters(&serde_json::json!({ "r": paper.r, "tables": tables, "published": printed }));
    (!needs.is_empty()).then(|| Task {
        id: ID.into(),
        parameters,
        files: Artifacts::new(),
        needs,
        export: Some("report"),
        work: Box::new(move |inputs| {
            let published = |number: u8| {
                let table = paper.table.iter().find(|table| table.number == number)?;
                Some(Published { r: &paper.r, counts: &table.counts, delta_a: &table.delta_a })
            };
            let levels = parts.iter().map(|part| {
                let outcomes = |id: &String| {
                    let column: Outcomes = from_json(inputs, id, solve::OUTCOMES)?;
                    Ok((column.r, column.levels))
                };
                let columns = ids(part).iter().map(outcomes).collect::<Result<_, String>>()?;
                let (scene, rule) = part;
                let published = scene.paper_table.and_then(published);
                Ok(Levels { problem: &scene.name, published, rule: *rule, columns })
            });
            let levels = levels.collect::<Result<Vec<_>, String>>()?;
            Ok(Artifacts::from([(FILE.into(), Results::of(&levels)?.to_csv()?)]))
        }),
    })
}
