//! Ids of the tasks that solve the members of scenes.

use crate::pipeline::hash;
use crate::replication::fields::member::Member;
use crate::replication::scene::Scene;
use crate::replication::study::Study;
use serde_json::json;
use signorini_mathematics::saddle::StopRule;
use signorini_mathematics::solvers::SaddleSettings;

/// Id of the task of a member of a scene.
pub(super) fn id_of(scene: &Scene, member: &Member) -> String {
    match member.statement.saddle {
        _ if scene.is_study => id_in_study(&scene.name, &scene.study, member),
        Some(SaddleSettings { stop, r, .. }) => id(scene, stop, r),
        None => format!("solve/{}", scene.name),
    }
}

/// Id of the task of a saddle-point method under a rule with this r.
pub(super) fn id(scene: &Scene, rule: StopRule, r: f64) -> String {
    format!("solve/{}/{rule}/r={r}", scene.name)
}

/// Ids of the tasks of all members of a scene.
pub(super) fn ids(scene: &Scene) -> impl Iterator<Item = String> {
    scene.study.members.iter().map(|member| id_of(scene, member))
}

/// Most bytes of the names and values in the id of a task, which names files.
const MOST_BYTES: usize = 120;

/// Id of the task of a member: with its values, so that it stays when others are added, and no other member has it.
pub(super) fn id_in_study(scene: &str, study: &Study, member: &Member) -> String {
    let mut pairs = Vec::new();
    for (name, value) in study.names.iter().zip(study.values(member)) {
        // A digest begins with what no other name has.
        let shown =
            value.file_name().unwrap_or_else(|| format!("~{}", digest(&json!(value).to_string())));
        pairs.push(format!("{name}={shown}"));
    }
    let pairs = pairs.join(",");
    let pairs = if pairs.len() <= MOST_BYTES { pairs } else { digest(&pairs) };
    format!("solve/{scene}/{pairs}")
}

/// Returns some digits of the hash of a text.
fn digest(text: &str) -> String {
    hash(text.as_bytes())[..16].to_owned()
}
