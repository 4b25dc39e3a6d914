//! The `tabulate` stage: the cells of one scene and stopping rule as the paper's table.

use super::from_json;
use super::results::csv;
use super::solve::{self, Outcomes};
use crate::pipeline::{Artifacts, Inputs, Task, parameters};
use crate::replication::comparison::Row;
use crate::replication::scene::Scene;
use polars::prelude::{Column, DataFrame, PolarsResult};
use signorini_mathematics::discrete::stop::Stop;
use signorini_mathematics::saddle::{Outcome, StopRule};

/// Artifact in the paper's layout.
pub(crate) const TABLE: &str = "table.csv";

pub(crate) fn id(scene: &Scene, stop: StopRule) -> String {
    format!("tabulate/{}/{stop}", scene.name)
}

pub(crate) fn task(scene: &Scene, stop: StopRule) -> Task {
    let needs: Vec<String> = solve::ids(scene, stop).collect();
    let grids = scene.problem.square().map_or(&[][..], |square| &square.grids);
    let cells: Vec<usize> = grids.iter().map(|grid| grid.cells()).collect();
    let parameters = parameters(&serde_json::json!({ "r": scene.r, "grids": cells }));
    let on_square = !cells.is_empty();
    Task::new(id(scene, stop), parameters, needs.clone(), move |inputs| {
        let names = match on_square {
            true => cells.iter().map(|n| format!("1/{n}")).collect(),
            false => meshes(inputs, &needs[0])?,
        };
        Ok(Artifacts::from([(
            TABLE.into(),
            csv(table(&rows(inputs, &needs)?, &ends(inputs, &needs)?, &names)?)?,
        )]))
    })
}

/// Names of the nested meshes of a solve: their numbers of nodes.
fn meshes(inputs: &Inputs, task: &str) -> Result<Vec<String>, String> {
    let Outcomes { levels, .. } = from_json(inputs, task, solve::OUTCOMES)?;
    Ok(levels.iter().map(|level| format!("{} nodes", level.nodes)).collect())
}

/// The rows of a table, one from each of the tasks `solves`.
pub(super) fn rows(inputs: &Inputs, solves: &[String]) -> Result<Vec<Row>, String> {
    solves.iter().map(|task| row(inputs, task)).collect()
}

fn row(inputs: &Inputs, task: &str) -> Result<Row, String> {
    let Outcomes { r, levels, .. } = from_json(inputs, task, solve::OUTCOMES)?;
    let finest = levels.last().ok_or_else(|| format!("{task} has solved on no grid"))?;
    Ok(Row {
        r,
        counts: levels.iter().map(|level| level.iterations).collect(),
        capped: levels.iter().map(|level| level.stop == Stop::IterationLimit).collect(),
        delta_a: finest.delta_a,
    })
}

/// Ends of the iterations on each grid, as `solve` names them; a list from each of the tasks `solves`.
fn ends(inputs: &Inputs, solves: &[String]) -> Result<Vec<Vec<&'static str>>, String> {
    let mut ends = Vec::new();
    for task in solves {
        let Outcomes { levels, .. } = from_json(inputs, task, solve::OUTCOMES)?;
        ends.push(levels.iter().map(Outcome::end).collect());
    }
    Ok(ends)
}

/// Table in the paper's layout: a row per r, a column of counts per grid (`1/4`, `1/8`, ..., or `25 nodes`, ...), and
/// `delta_a`.
///
/// If `max_iterations` cut off a count on a grid, a column `capped 1/4` marks those counts; if an iteration on a grid
/// ended without a solution of the discrete problem, a column `stop 1/4` holds the `ends`.
fn table(rows: &[Row], ends: &[Vec<&str>], grids: &[String]) -> PolarsResult<DataFrame> {
    let mut columns: Vec<Column> =
        vec![Column::new("r".into(), rows.iter().map(|row| row.r).collect::<Vec<_>>())];
    for (level, grid) in grids.iter().enumerate() {
        let counts: Vec<u64> = rows.iter().map(|row| row.counts[level] as u64).collect();
        columns.push(Column::new(grid.into(), counts));
    }
    let delta_a: Vec<f64> = rows.iter().map(|row| row.delta_a).collect();
    columns.push(Column::new("delta_a".into(), delta_a));
    for (level, grid) in grids.iter().enumerate() {
        let capped: Vec<bool> = rows.iter().map(|row| row.capped[level]).collect();
        if capped.contains(&true) {
            columns.push(Column::new(format!("capped {grid}").into(), capped));
        }
    }
    for (level, grid) in grids.iter().enumerate() {
        let ends: Vec<&str> = ends.iter().map(|ends| ends[level]).collect();
        if ends.iter().any(|end| ["no-solution", "not-solved"].contains(end)) {
            columns.push(Column::new(format!("stop {grid}").into(), ends));
        }
    }
    DataFrame::new(rows.len(), columns)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_has_all_digits_and_says_what_was_cut_off() {
        let ends = [vec!["no-solution", "converged"], vec!["converged", "iteration-limit"]];
        let rows = [
            Row { r: 1e6, counts: vec![1, 149], capped: vec![false; 2], delta_a: 1e-4 / 3.0 },
            Row { r: 0.5, counts: vec![3, 55], capped: vec![false, true], delta_a: 3.53e-4 },
        ];
        expect_test::expect![[r"
            r,1/4,1/8,delta_a,capped 1/8,stop 1/4
            1000000.0,1,149,0.000033333333333333335,false,no-solution
            0.5,3,55,0.000353,true,converged
        "]]
        .assert_eq(
            std::str::from_utf8(
                &csv(table(&rows, &ends, &["1/4".into(), "1/8".into()]).unwrap()).unwrap(),
            )
            .unwrap(),
        );
    }
}
