//! The `tabulate` stage: the cells of one scene and stopping rule as the paper's table.

use super::from_json;
use super::solve::{self, Outcomes, WithoutGrid};
use crate::pipeline::{Artifacts, Inputs, Task};
use crate::replication::comparison::Row;
use crate::replication::scene::Scene;
use crate::table::Table;
use serde::{Deserialize, Serialize};
use signorini_mathematics::discrete::end::Outcome;
use signorini_mathematics::discrete::stop::Stop;
use signorini_mathematics::saddle::StopRule;

/// Artifact in the paper's layout.
pub(crate) const TABLE: &str = "table.csv";

/// Id of the task that makes the table of a scene, under a rule if its solver has one.
pub(crate) fn id(scene: &Scene, rule: Option<StopRule>) -> String {
    let name = &scene.name;
    rule.map_or_else(|| format!("tabulate/{name}"), |rule| format!("tabulate/{name}/{rule}"))
}

/// Solves from which a table is made.
#[derive(Serialize, Deserialize)]
struct Tabulated {
    /// Ids of the tasks, in the order of the rows.
    solves: Vec<String>,
}

pub(crate) fn task(scene: &Scene, rule: Option<StopRule>) -> Task {
    let solves: Vec<String> = solve::ids(scene, rule).collect();
    let needs = solves.clone();
    Task::new(id(scene, rule), &Tabulated { solves }, needs, |Tabulated { solves }, inputs| {
        let first: Outcomes = from_json(inputs, &solves[0], solve::OUTCOMES)?;
        let table = match first.r {
            Some(_) => {
                let names: Vec<_> = first.levels.iter().map(Outcome::label).collect();
                table(&rows(inputs, solves)?, &ends(inputs, solves)?, &names)
            }
            None => table_of_levels(&first),
        };
        Ok(Artifacts::from([(TABLE.into(), table.csv().into_bytes())]))
    })
}

/// Table of a solver without r: a row per level on which it ended, with the guaranteed bounds there; of the spectral
/// solver one row, without a grid.
fn table_of_levels(outcomes: &Outcomes) -> Table {
    let head = ["grid", "iterations", "stop", "energy"];
    let bounds = ["energy_lower", "energy_upper", "error_bound", "error_relative", "kkt_relative"];
    let mut table = Table::new(head.into_iter().chain(bounds).map(str::to_owned), &[]);
    if let Some(WithoutGrid { steps, energy }) = outcomes.without_grid {
        let row = [String::new(), steps.to_string(), outcomes.end().into(), decimal(energy)];
        table.rows.push(row.into_iter().chain(bounds.map(|_| String::new())).collect());
    }
    for (number, (level, bounds)) in outcomes.levels.iter().zip(&outcomes.bounds).enumerate() {
        let iterations = level.end.iterations.to_string();
        let energy = outcomes.energy(number);
        let mut row = vec![level.label(), iterations, level.name().into(), decimal(energy)];
        row.extend(match bounds {
            Some(bounds) => {
                let ([low, high], [_, most]) = (bounds.energy, bounds.error);
                [low, high, most, bounds.relative()].map(decimal)
            }
            None => Default::default(),
        });
        row.push(decimal(level.kkt.relative));
        table.rows.push(row);
    }
    table
}

/// The rows of a table, one from each of the tasks `solves`.
pub(super) fn rows(inputs: &Inputs, solves: &[String]) -> Result<Vec<Row>, String> {
    solves.iter().map(|task| row(inputs, task)).collect()
}

fn row(inputs: &Inputs, task: &str) -> Result<Row, String> {
    let Outcomes { r, levels, .. } = from_json(inputs, task, solve::OUTCOMES)?;
    let r = r.ok_or_else(|| format!("{task} has no r"))?;
    let finest = levels.last().ok_or_else(|| format!("{task} has solved on no grid"))?;
    Ok(Row {
        r,
        counts: levels.iter().map(|level| level.end.iterations).collect(),
        capped: levels.iter().map(|level| level.end.stop == Stop::IterationLimit).collect(),
        delta_a: finest.end.change(),
    })
}

/// Ends of the iterations on each grid, as `solve` names them; a list from each of the tasks `solves`.
fn ends(inputs: &Inputs, solves: &[String]) -> Result<Vec<Vec<&'static str>>, String> {
    let mut ends = Vec::new();
    for task in solves {
        let Outcomes { levels, .. } = from_json(inputs, task, solve::OUTCOMES)?;
        ends.push(levels.iter().map(Outcome::name).collect());
    }
    Ok(ends)
}

/// Table in the paper's layout: a row per r, a column of counts per grid (`1/4`, `1/8`, ..., or `25 nodes`, ...), and
/// `delta_a`.
///
/// If `max_iterations` cut off a count on a grid, a column `capped 1/4` marks those counts; if an iteration on a grid
/// ended without a solution of the discrete problem, a column `stop 1/4` holds the `ends`.
fn table(rows: &[Row], ends: &[Vec<&str>], grids: &[String]) -> Table {
    let (mut capped, mut stopped) = (Vec::new(), Vec::new());
    for level in 0..grids.len() {
        if rows.iter().any(|row| row.capped[level]) {
            capped.push(level);
        }
        if ends.iter().any(|ends| ["no-solution", "not-solved"].contains(&ends[level])) {
            stopped.push(level);
        }
    }
    let named = |name: &str, levels: &[usize]| -> Vec<String> {
        levels.iter().map(|&level| format!("{name} {}", grids[level])).collect()
    };
    let counts_and_change = [&["r".to_owned()][..], grids, &["delta_a".to_owned()]].concat();
    let marks = [named("capped", &capped), named("stop", &stopped)].concat();
    let mut table = Table::new(counts_and_change.into_iter().chain(marks), &[]);
    for (row, ends) in rows.iter().zip(ends) {
        let mut cells = vec![decimal(row.r)];
        cells.extend(row.counts.iter().map(usize::to_string));
        cells.push(decimal(row.delta_a));
        cells.extend(capped.iter().map(|&level| row.capped[level].to_string()));
        cells.extend(stopped.iter().map(|&level| ends[level].to_owned()));
        table.rows.push(cells);
    }
    table
}

/// Returns a number with all digits, in the form that the table of results has.
fn decimal(x: f64) -> String {
    match x.is_finite() {
        true => serde_json::json!(x).to_string(),
        false => x.to_string(),
    }
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
        .assert_eq(&table(&rows, &ends, &["1/4".into(), "1/8".into()]).csv());
    }

    #[test]
    fn numbers_are_written_as_in_the_table_of_results() {
        use crate::replication::stages::results::csv;
        use polars::prelude::df;
        let numbers = [1e6, 0.5, 0.0, -2.0, 1e-4 / 3.0, 1e15, 1e-12, f64::NAN, f64::INFINITY];
        let frame = df!("x" => numbers.to_vec()).unwrap();
        let written = String::from_utf8(csv(frame).unwrap()).unwrap();
        assert!(written.lines().skip(1).eq(numbers.map(decimal)), "{written}");
    }
}
