//! The `identify` stage: what else explains a scene's table, how far its f may move, and a blind search for it.

use super::{figures, to_json};
use crate::identify::record::Record;
use crate::identify::{Questions, Target, Variant, findings};
use crate::pipeline::error::{Error, Result, from_toml};
use crate::pipeline::{Artifacts, Task, parameters};
use crate::replication::project::{IDENTIFIED, Project};
use crate::replication::scene::{Output, Scene};
use serde::Serialize;

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
    let own = |scene: &&&Scene| !project.is_problem(scene) && scene.wants(Output::Identify);
    let asking = asking.into_iter().chain(scenes.iter().filter(own).copied());
    asking.map(|scene| task(project, scene)).collect()
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
    let text = String::from_utf8_lossy(text);
    let record: Record = from_toml(IDENTIFIED, &text)?;
    let question = Question {
        f: scene.f.to_string(),
        variant,
        target: project.paper.target(table)?,
        alternatives: record.alternatives(table).to_vec(),
        questions: record.questions,
    };
    let f = scene.f.clone();
    Ok(Task {
        id: id(scene),
        parameters: parameters(&question),
        files: Artifacts::new(),
        needs: Vec::new(),
        export: None,
        work: Box::new(move |_| {
            let Question { target, variant, alternatives, questions, .. } = &question;
            let threads = rayon::current_num_threads();
            let found = findings(target, variant, &f, alternatives, questions, threads);
            Ok(Artifacts::from([(FINDINGS.into(), to_json(&found.map_err(|e| e.to_string())?))]))
        }),
    })
}

/// Everything that the findings depend on: of the files that hold it, the rest may change freely.
#[derive(Serialize)]
struct Question {
    f: String,
    variant: Variant,
    target: Target,
    alternatives: Vec<String>,
    questions: Questions,
}
