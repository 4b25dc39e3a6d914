//! The table of all results: every scene, rule, r and grid beside the published numbers, for other programs to
//! read, and the joins and aggregates of it that the book shows.

use super::from_json;
use super::solve::{self, OUTCOMES, Outcomes};
use crate::pipeline::{Artifacts, Inputs, Task, parameters};
use crate::replication::comparison::TableComparison;
use crate::replication::paper::{Paper, PublishedTable};
use crate::replication::project::Project;
use crate::replication::scene::{Output, Scene};
use polars::prelude::*;
use serde::Serialize;
use serde_json::{Value, json};
use signorini_mathematics::discrete::end::Outcome;
use signorini_mathematics::discrete::stop::Stop;
use signorini_mathematics::saddle::{StopRule, tolerance};
use std::io::Cursor;

pub(super) const ID: &str = "diff/results";
/// Artifact, and file under `report/`: all results, as CSV.
pub(super) const FILE: &str = "results.csv";

/// The task that joins the results of all scenes that ask for a table; none if no scene does.
pub(super) fn task(project: &Project) -> Option<Task> {
    let scenes = project.scenes.iter().filter(|scene| scene.wants(Output::Table));
    let parts: Vec<(Scene, StopRule)> =
        scenes.flat_map(|scene| scene.stop.iter().map(|&rule| (scene.clone(), rule))).collect();
    let needs = parts.iter().flat_map(|(scene, rule)| solve::ids(scene, *rule)).collect();
    let paper = project.paper.clone();
    let tables: Vec<_> = parts.iter().map(|(scene, _)| scene.paper_table).collect();
    let printed: Vec<_> =
        paper.table.iter().map(|table| (table.number, &table.counts, &table.delta_a)).collect();
    let parameters =
        parameters(&serde_json::json!({ "r": paper.r, "tables": tables, "published": printed }));
    let task = Task::new(ID, parameters, needs, move |inputs| {
        let results = joined(&solved(inputs, &parts)?, &paper)?;
        Ok(Artifacts::from([(FILE.into(), csv(results)?)]))
    });
    (!task.needs.is_empty()).then(|| Task { export: Some("report"), ..task })
}

/// Table with one row per problem, stopping rule, r and grid.
///
/// Columns: `problem` (the name of its scene), `rule`, `r`, `cells` (per side; empty on a mesh), `nodes` and
/// `tolerance` identify the solve.
/// `published` and `published_delta_a` are the published numbers, empty where the paper prints none: for Delta a, on
/// all grids but the finest. `stop` is the [end](Outcome::name) of the iteration as `solve` names it, and `met` is true
/// if its stopping rule was met, even without a solution. The other columns carry the names of the fields of
/// [`Outcome`].
#[derive(Clone, Debug)]
pub(super) struct Results(DataFrame);

/// Aggregate of a column of numbers.
#[derive(Clone, Debug, PartialEq, Serialize)]
struct Aggregate {
    cases: usize,
    sum: f64,
    /// `None` if there are no cases.
    least: Option<f64>,
    /// `None` if there are no cases.
    greatest: Option<f64>,
}

/// Columns with their types. CSV has no types, and names of scenes may look like numbers, or like no value.
const COLUMNS: [(&str, DataType); 22] = [
    ("problem", DataType::String),
    ("rule", DataType::String),
    ("r", DataType::Float64),
    ("cells", DataType::Int64),
    ("nodes", DataType::Int64),
    ("tolerance", DataType::Float64),
    ("iterations", DataType::Int64),
    ("stop", DataType::String),
    ("met", DataType::Boolean),
    ("gradient_signed", DataType::Float64),
    ("gradient_abs", DataType::Float64),
    ("delta_a", DataType::Float64),
    ("energy", DataType::Float64),
    ("sum_load", DataType::Float64),
    ("kkt_stationarity", DataType::Float64),
    ("kkt_min_y", DataType::Float64),
    ("kkt_min_lambda", DataType::Float64),
    ("kkt_complementarity", DataType::Float64),
    ("kkt_natural", DataType::Float64),
    ("kkt_relative", DataType::Float64),
    ("published", DataType::Int64),
    ("published_delta_a", DataType::Float64),
];

/// Columns that identify a row among those of one rule.
const KEYS: [&str; 3] = ["problem", "r", "cells"];

impl Results {
    /// Reads CSV with a header line.
    pub(super) fn read(bytes: &[u8]) -> PolarsResult<Self> {
        let options = CsvReadOptions::default().with_schema(Some(schema().into()));
        CsvReader::new(Cursor::new(bytes)).with_options(options).finish().map(Self)
    }

    pub(super) fn of_problem(&self, name: &str) -> PolarsResult<Self> {
        self.0.filter(&self.0.column("problem")?.str()?.equal(name)).map(Self)
    }

    /// Returns the agreement of these results with the paper's `tables`, and the gradients and the costs of the
    /// stopping rules on the finest grid.
    pub(super) fn agreement(&self, tables: &[TableComparison]) -> PolarsResult<Value> {
        let exact = self.exact(StopRule::Signed)?;
        let signed = self.finest(StopRule::Signed)?;
        Ok(json!({
            // Published counts; those that the signed rule gives, and (13) as printed.
            "cells": exact.cases,
            "exact": exact.sum as usize,
            "printed_exact": self.exact(StopRule::Printed)?.sum as usize,
            // Published values of Delta a; those to both digits, and within the declared tolerance.
            "deltas": tables.iter().map(|table| table.rows.len()).sum::<usize>(),
            "deltas_exact": tables.iter().map(|table| table.delta_a_exact).sum::<usize>(),
            "deltas_within": tables.iter().map(|table| table.delta_a_within).sum::<usize>(),
            // `max |dM/dy|` over the tolerance where the signed rule stops.
            "excess": aggregate(&(&floats(&signed, "gradient_abs")? / &floats(&signed, "tolerance")?)?)?,
            // Iterations under (13) as printed, and under the dual rule, over those under the signed rule.
            "printed": self.factor(StopRule::Printed)?,
            "dual": self.factor(StopRule::SignedDual)?,
            // Iterations and Delta a under the signed rule, and Delta a as published.
            "counts": aggregate(&floats(&signed, "iterations")?)?,
            "delta": aggregate(&floats(&signed, "delta_a")?)?,
            "paper_delta": aggregate(&floats(&signed, "published_delta_a")?)?,
        }))
    }

    /// Aggregate of 1 for each published count that the rule gives and meets, and 0 for each other.
    fn exact(&self, rule: StopRule) -> PolarsResult<Aggregate> {
        let rows = self.under(rule)?;
        let rows = rows.filter(&rows.column("published")?.is_not_null())?;
        let same = floats(&rows, "iterations")?.equal(&floats(&rows, "published")?)?;
        let exact = same & rows.column("met")?.bool()?.clone();
        aggregate(&exact.into_series())
    }

    /// Iterations of a rule on the finest grid over those of the signed rule, for every r with which the rule is met.
    fn factor(&self, rule: StopRule) -> PolarsResult<Aggregate> {
        let rows = self.finest(StopRule::Signed)?.left_join(&self.finest(rule)?, KEYS, KEYS)?;
        let rows = rows.filter(rows.column("met_right")?.bool()?)?;
        aggregate(&(&floats(&rows, "iterations_right")? / &floats(&rows, "iterations")?)?)
    }

    /// Rows of one stopping rule.
    fn under(&self, rule: StopRule) -> PolarsResult<DataFrame> {
        self.0.filter(&self.0.column("rule")?.str()?.equal(rule.to_string().as_str()))
    }

    /// Rows of problems of the paper on the finest grid.
    fn finest(&self, rule: StopRule) -> PolarsResult<DataFrame> {
        let rows = self.under(rule)?;
        rows.filter(&rows.column("published_delta_a")?.is_not_null())
    }
}

fn schema() -> Schema {
    COLUMNS.into_iter().map(|(name, kind)| Field::new(name.into(), kind)).collect()
}

/// Solve on one grid.
struct GridSolve<'a> {
    scene: &'a Scene,
    rule: StopRule,
    r: f64,
    /// Number of the grid, from 1.
    level: usize,
    outcome: Outcome,
}

impl GridSolve<'_> {
    /// Place in the published table of the scene, if the paper prints r: the table and the number of its row.
    fn published_row<'p>(&self, paper: &'p Paper) -> Option<(&'p PublishedTable, usize)> {
        let table = paper.published(self.scene.paper_table?).ok()?;
        Some((table, paper.r.iter().position(|&printed| printed == self.r)?))
    }

    /// Published count, if the paper prints one.
    fn published_count(&self, paper: &Paper) -> Option<i64> {
        let (table, row) = self.published_row(paper)?;
        table.counts[row].get(self.level - 1).map(|&count| count as i64)
    }

    /// Published Delta a, which the paper prints for the finest grid.
    fn published_delta_a(&self, paper: &Paper) -> Option<f64> {
        self.published_count(paper)?;
        let (table, row) = self.published_row(paper)?;
        (self.level == self.scene.on_grids().grids.len()).then_some(table.delta_a[row])
    }
}

fn solved<'a>(
    inputs: &Inputs,
    parts: &'a [(Scene, StopRule)],
) -> Result<Vec<GridSolve<'a>>, String> {
    let mut solves = Vec::new();
    for (scene, rule) in parts {
        for &r in &scene.r {
            let solved: Outcomes = from_json(inputs, &solve::id(scene, *rule, r), OUTCOMES)?;
            for (level, outcome) in (1..).zip(solved.levels) {
                solves.push(GridSolve { scene, rule: *rule, r, level, outcome });
            }
        }
    }
    Ok(solves)
}

/// The table of [`Results`], made from solves and published numbers.
fn joined(solves: &[GridSolve], paper: &Paper) -> PolarsResult<DataFrame> {
    df!(
        "problem" => column(solves, |solve| &*solve.scene.name),
        "rule" => column(solves, |solve| solve.rule.name()),
        "r" => column(solves, |solve| solve.r),
        "cells" => column(solves, |solve| solve.outcome.cells.map(|cells| cells as i64)),
        "nodes" => column(solves, |solve| solve.outcome.nodes as i64),
        "tolerance" => column(solves, |solve| tolerance(solve.level)),
        "iterations" => column(solves, |solve| solve.outcome.end.iterations as i64),
        "stop" => column(solves, |solve| solve.outcome.name()),
        "met" => column(solves, |solve| solve.outcome.end.stop == Stop::Converged),
        "gradient_signed" => column(solves, |solve| solve.outcome.gradient_signed),
        "gradient_abs" => column(solves, |solve| solve.outcome.gradient_abs),
        "delta_a" => column(solves, |solve| solve.outcome.end.delta_a),
        "energy" => column(solves, |solve| solve.outcome.energy),
        "sum_load" => column(solves, |solve| solve.outcome.sum_load),
        "kkt_stationarity" => column(solves, |solve| solve.outcome.kkt.stationarity),
        "kkt_min_y" => column(solves, |solve| solve.outcome.kkt.min_y),
        "kkt_min_lambda" => column(solves, |solve| solve.outcome.kkt.min_lambda),
        "kkt_complementarity" => column(solves, |solve| solve.outcome.kkt.complementarity),
        "kkt_natural" => column(solves, |solve| solve.outcome.kkt.natural),
        "kkt_relative" => column(solves, |solve| solve.outcome.kkt.relative),
        "published" => column(solves, |solve| solve.published_count(paper)),
        "published_delta_a" => column(solves, |solve| solve.published_delta_a(paper)),
    )
}

/// Values of one column, a row per solve.
fn column<'a, T>(solves: &'a [GridSolve], value: impl Fn(&'a GridSolve) -> T) -> Vec<T> {
    solves.iter().map(value).collect()
}

/// Column of numbers, as floating-point numbers.
fn floats(rows: &DataFrame, column: &str) -> PolarsResult<Series> {
    rows.column(column)?.as_materialized_series().cast(&DataType::Float64)
}

fn aggregate(values: &Series) -> PolarsResult<Aggregate> {
    let values = values.cast(&DataType::Float64)?;
    Ok(Aggregate {
        cases: values.len(),
        sum: values.sum::<f64>()?,
        least: values.min::<f64>()?,
        greatest: values.max::<f64>()?,
    })
}

/// Writes CSV with a header line.
pub(super) fn csv(mut frame: DataFrame) -> PolarsResult<Vec<u8>> {
    let mut bytes = Vec::new();
    CsvWriter::new(&mut bytes).finish(&mut frame)?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_have_the_types_with_which_they_are_written() {
        let written = joined(&[], &Paper::default()).unwrap();
        assert_eq!(**written.schema(), schema());
    }

    #[test]
    fn a_scene_is_found_whatever_it_is_called() {
        let names = [
            "1",
            "2.50",
            "1e5",
            "true",
            "NA",
            "null",
            "NaN",
            "inf",
            "2026-11-26",
            "-",
            "a,b",
            "\"q\"",
        ];
        let mut csv = COLUMNS.map(|(name, _)| name).join(",") + "\n";
        for name in names {
            let name = name.replace('"', "\"\"");
            csv += &format!("\"{name}\",signed,1.0,,25,0.1,7,converged,true{}\n", ",".repeat(13));
        }
        let results = Results::read(csv.as_bytes()).unwrap();
        for name in names {
            let found = results.of_problem(name).unwrap();
            assert_eq!(found.0.height(), 1, "{name}");
            assert_eq!(aggregate(&floats(&found.0, "iterations").unwrap()).unwrap().sum, 7.0);
        }
    }
}
