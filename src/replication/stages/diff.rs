//! The `diff` stage: the table of one scene against the published one.

use super::{solve, tabulate, to_json};
use crate::pipeline::error::{Error, Result};
use crate::pipeline::{Artifacts, Task, parameters};
use crate::replication::paper::Paper;
use crate::replication::project::Project;
use crate::replication::scene::Scene;

/// Artifact with a [`crate::replication::comparison::TableComparison`].
pub(crate) const DIFF: &str = "diff.json";

pub(crate) fn id(scene: &Scene) -> String {
    format!("diff/{}", scene.name)
}

/// The task that compares a scene with the published table of this number.
pub(crate) fn task(project: &Project, scene: &Scene, number: u8) -> Result<Task> {
    let table = project
        .paper
        .published(number)
        .map_err(|e| Error::input(format!("scene `{}`: {e}; correct `paper_table`", scene.name)))?;
    let grids = scene.on_grids().grids.len();
    if let Some(other) = table.counts.iter().find(|counts| counts.len() != grids) {
        return Err(Error::input(format!(
            "scene `{}`: table {number} is on {} grids; let `grids` have as many, or leave out `paper_table`",
            scene.name,
            other.len()
        )));
    }
    let paper = Paper { r: project.paper.r.clone(), table: vec![table.clone()] };
    let needs: Vec<String> = solve::ids(scene, scene.first_rule()).collect();
    let name = scene.name.clone();
    let parameters = parameters(&serde_json::json!({ "r": paper.r, "table": table }));
    Ok(Task::new(id(scene), parameters, needs.clone(), move |inputs| {
        let diff = paper.compare(number, &name, &tabulate::rows(inputs, &needs)?)?;
        Ok(Artifacts::from([(DIFF.into(), to_json(&diff))]))
    }))
}
