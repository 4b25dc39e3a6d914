//! The `identify` stage: what else explains a scene's table, how far its f may move, and a blind search for it.

use super::{sharing, to_json};
use crate::pipeline::error::{Error, Result, from_record};
use crate::pipeline::{Artifacts, Task};
use crate::replication::identified::IdentifiedRecord;
use crate::replication::project::{IDENTIFIED, Project};
use crate::replication::scene::{Output, Scene};
use serde::{Deserialize, Serialize};
use signorini_mathematics::identify::{Questions, Target, Variant};
use signorini_mathematics::problem::source::Source;

/// Artifact with [`signorini_mathematics::identify::Findings`].
pub(super) const FINDINGS: &str = "findings.json";

pub(super) fn id(scene: &Scene) -> String {
    format!("identify/{}", scene.name)
}

/// The tasks that `scenes` ask for: none unless all scenes that ask are among them, as for shared figures.
pub(super) fn tasks(project: &Project, scenes: &[&Scene]) -> Result<Vec<Task>> {
    let own = |scene: &&Scene| !scene.is_problem() && scene.wants(Output::Identify);
    let mut asking = sharing(project, scenes, Output::Identify);
    asking.extend(scenes.iter().copied().filter(own));
    let file = project.files.get(IDENTIFIED).filter(|_| !asking.is_empty());
    let record = file.map(|file| from_record(IDENTIFIED, file.bytes()?));
    let record: Option<IdentifiedRecord> = record.transpose()?;
    asking.into_iter().map(|scene| task(project, scene, record.as_ref())).collect()
}

/// Questions on a published table. Of the files that hold them, the rest may change freely.
#[derive(Serialize, Deserialize)]
struct Asked {
    f: Source,
    variant: Variant,
    target: Target,
    alternatives: Vec<[f64; 4]>,
    questions: Questions,
}

fn task(project: &Project, scene: &Scene, record: Option<&IdentifiedRecord>) -> Result<Task> {
    let (Some(table), Some(record)) = (scene.paper_table, record) else {
        return Err(Error::input(format!(
            "scene `{}` asks for `identify`, which needs {}; restore it, or drop the output",
            scene.name, IDENTIFIED
        )));
    };
    let variant = Variant {
        load: scene.load(),
        prolongation: scene.saddle().prolongation,
        ..Variant::default()
    };
    let asked = Asked {
        f: scene.source(),
        variant,
        target: project.paper.target(table)?,
        alternatives: record.alternatives(table).to_vec(),
        questions: record.questions.clone(),
    };
    Ok(Task::new(id(scene), &asked, Vec::new(), |asked, _| {
        let Asked { f, variant, target, alternatives, questions } = asked;
        let found = target
            .findings(variant, f, alternatives, questions)
            .map_err(|e| format!("{e}; correct it, or drop `identify` from the scene's outputs"))?;
        Ok(Artifacts::from([(FINDINGS.into(), to_json(&found))]))
    }))
}
