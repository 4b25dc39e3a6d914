//! The `identify` stage: what else explains a scene's table, how far its f may move, and a blind search for it.

use super::{figures, to_json};
use crate::identify::record::Record;
use crate::identify::{Variant, findings};
use crate::pipeline::error::{Error, Result, from_toml};
use crate::pipeline::{Artifacts, Stage, Task, parameters};
use crate::replication::paper::Paper;
use crate::replication::project::{IDENTIFIED, Project};
use crate::replication::scene::{Output, Scene};

/// Artifact with [`crate::identify::Findings`].
pub const FINDINGS: &str = "findings.json";

/// Id of the task that looks into a scene's f.
pub fn id(scene: &Scene) -> String {
    format!("identify/{}", scene.name)
}

/// The tasks that `scenes` ask for: none unless all scenes that ask are among them, as for shared figures.
///
/// # Errors
/// [`Error::Input`] if the record of the search is missing.
pub fn tasks(project: &Project, scenes: &[&Scene]) -> Result<Vec<Task>> {
    let asking = figures::sharing(project, scenes, Output::Identify);
    asking.into_iter().map(|scene| task(project, scene)).collect()
}

fn task(project: &Project, scene: &Scene) -> Result<Task> {
    let (Some(table), Some(text)) = (scene.paper_table, &project.record_text) else {
        return Err(Error::input(format!(
            "scene `{}` asks for `identify`, which needs {}; restore it, or drop the output",
            scene.name, IDENTIFIED
        )));
    };
    let variant =
        Variant { load: scene.load, prolongation: scene.prolongation, ..Variant::default() };
    let f = scene.f.clone();
    let value = serde_json::json!({ "f": f.to_string(), "table": table, "variant": variant });
    Ok(Task {
        id: id(scene),
        stage: Stage::Identify,
        parameters: parameters(&value),
        files: Artifacts::from([
            (PAPER.into(), project.paper_text.clone().into_bytes()),
            (IDENTIFIED.into(), text.clone()),
        ]),
        needs: Vec::new(),
        export: None,
        work: Box::new(move |inputs| {
            let text = |name: &str| String::from_utf8_lossy(&inputs.files[name]);
            let paper = Paper::parse(&text(PAPER)).map_err(|e| e.to_string())?;
            let record =
                from_toml::<Record>(IDENTIFIED, &text(IDENTIFIED)).map_err(|e| e.to_string())?;
            let target = paper.target(table).map_err(|e| e.to_string())?;
            let alternatives = record.alternatives(table);
            let threads = rayon::current_num_threads();
            let found = findings(&target, &variant, &f, alternatives, &record.questions, threads);
            let found = found.map_err(|e| e.to_string())?;
            Ok(Artifacts::from([(FINDINGS.into(), to_json(&found))]))
        }),
    })
}

const PAPER: &str = "pipeline/paper.toml";
