//! The `diff` stage: the table of one scene against the published one.

use super::tabulate;
use super::{artifact, to_json};
use crate::pipeline::error::{Error, Result};
use crate::pipeline::{Artifacts, Stage, Task};
use crate::replication::paper::Paper;
use crate::replication::project::Project;
use crate::replication::scene::Scene;
use crate::replication::table::read_table;
use std::collections::BTreeMap;

/// Artifact with a [`crate::replication::paper::TableComparison`].
pub const DIFF: &str = "diff.json";

/// Id of the task that compares a scene with the paper.
pub fn id(scene: &Scene) -> String {
    format!("diff/{}", scene.name)
}

/// The task that compares a scene with the published table of this number.
///
/// # Errors
/// [`Error::Input`] if there is no such table.
pub fn task(project: &Project, scene: &Scene, number: u8) -> Result<Task> {
    let of_scene = |e| Error::input(format!("scene `{}`: {e}; correct `paper_table`", scene.name));
    project.paper.published(number).map_err(of_scene)?;
    let need = tabulate::id(scene, scene.stop[0]);
    let name = scene.name.clone();
    Ok(Task {
        id: id(scene),
        stage: Stage::Diff,
        parameters: BTreeMap::from([("table".into(), number.to_string())]),
        files: Artifacts::from([(PAPER.into(), project.paper_text.clone().into_bytes())]),
        needs: vec![need.clone()],
        export: None,
        work: Box::new(move |inputs| {
            let text = String::from_utf8_lossy(&inputs.files[PAPER]);
            let paper = Paper::parse(&text).map_err(|e| e.to_string())?;
            let rows = read_table(artifact(inputs, &need, tabulate::TABLE)?)?;
            let diff = paper.compare(number, &name, &rows).map_err(|e| e.to_string())?;
            Ok(Artifacts::from([(DIFF.into(), to_json(&diff))]))
        }),
    })
}

const PAPER: &str = "pipeline/paper.toml";
