//! The `diff` stage: the table of one scene against the published one.

use super::results::SolveOfMember;
use super::{tabulate, to_json};
use crate::pipeline::error::{Error, Result};
use crate::pipeline::{Artifacts, Task};
use crate::replication::paper::Paper;
use crate::replication::project::Project;
use crate::replication::scene::Scene;
use serde::{Deserialize, Serialize};

/// Artifact with a [`crate::replication::comparison::TableComparison`].
pub(crate) const DIFF: &str = "diff.json";

pub(crate) fn id(scene: &Scene) -> String {
    format!("diff/{}", scene.name)
}

/// Scene that is compared with a published table.
#[derive(Serialize, Deserialize)]
struct Compared {
    scene: String,
    /// Solves whose counts are compared.
    solves: Vec<SolveOfMember>,
    /// The published table alone.
    paper: Paper,
}

/// The task that compares a scene with the published table of this number.
pub(crate) fn task(project: &Project, scene: &Scene, number: u8) -> Result<Task> {
    let table = project
        .paper
        .published(number)
        .map_err(|e| Error::input(format!("scene `{}`: {e}; correct `paper_table`", scene.name)))?;
    let grids = scene.grids().len();
    if let Some(other) = table.counts.iter().find(|counts| counts.len() != grids) {
        return Err(Error::input(format!(
            "scene `{}`: table {number} is on {} grids; let `grids` have as many, or leave out `paper_table`",
            scene.name,
            other.len()
        )));
    }
    let paper = Paper { r: project.paper.r.clone(), table: vec![table.clone()] };
    let solves = scene.under(scene.first_rule()).map(|member| SolveOfMember::of(scene, member));
    let solves: Vec<_> = solves.collect();
    let needs = solves.iter().map(|solve| solve.task.clone()).collect();
    let name = scene.name.clone();
    let compared = Compared { scene: name, solves, paper };
    Ok(Task::new(id(scene), &compared, needs, |Compared { scene, solves, paper }, inputs| {
        let number = paper.table[0].number;
        let mut rows = Vec::new();
        for solve in solves {
            let levels = solve.numbers(inputs)?.levels();
            rows.extend(solve.saddle().map(|of| tabulate::row(of.r, &levels)));
        }
        let diff = paper.compare(number, scene, &rows)?;
        Ok(Artifacts::from([(DIFF.into(), to_json(&diff))]))
    }))
}
