//! The `tabulate` stage: the cells of one scene and stopping rule as the paper's table.

use super::from_json;
use super::solve::{self, Outcomes};
use crate::pipeline::{Artifacts, Inputs, Task, parameters};
use crate::replication::comparison::Row;
use crate::replication::scene::Scene;
use crate::replication::table::table_csv;
use crate::saddle::{StopReason, StopRule};

/// Artifact in the paper's layout.
pub const TABLE: &str = "table.csv";

/// Id of the task that tabulates a scene under a stopping rule.
pub fn id(scene: &Scene, stop: StopRule) -> String {
    format!("tabulate/{}/{stop}", scene.name)
}

/// The task that tabulates a scene under a stopping rule.
pub fn task(scene: &Scene, stop: StopRule) -> Task {
    let needs: Vec<String> = solve::ids(scene, stop).collect();
    let cells: Vec<usize> = scene.grids.iter().map(|grid| grid.cells()).collect();
    let parameters = parameters(&serde_json::json!({ "r": scene.r, "grids": cells }));
    Task::new(id(scene, stop), parameters, needs.clone(), move |inputs| {
        Ok(Artifacts::from([(TABLE.into(), table_csv(&rows(inputs, &needs)?, &cells)?)]))
    })
}

/// The rows of a table, one from each of the tasks `solves`.
pub(super) fn rows(inputs: &Inputs, solves: &[String]) -> Result<Vec<Row>, String> {
    solves.iter().map(|task| row(inputs, task)).collect()
}

fn row(inputs: &Inputs, need: &str) -> Result<Row, String> {
    let Outcomes { r, levels, .. } = from_json(inputs, need, solve::OUTCOMES)?;
    Ok(Row {
        r,
        counts: levels.iter().map(|o| o.iterations).collect(),
        capped: levels.iter().map(|o| o.stop == StopReason::IterationLimit).collect(),
        delta_a: levels.last().map_or(f64::NAN, |o| o.delta_a),
    })
}
