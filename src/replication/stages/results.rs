//! The table of all results: every scene, rule, r and grid beside what the paper prints, for other programs to
//! read, and what the book says of it as joins and aggregates.

use super::from_json;
use super::solve::{self, OUTCOMES, Outcomes};
use crate::pipeline::{Artifacts, Inputs, Task, parameters};
use crate::replication::comparison::TableComparison;
use crate::replication::paper::Paper;
use crate::replication::project::Project;
use crate::replication::scene::{Output, Scene};
use crate::saddle::{Outcome, StopReason, StopRule, tolerance};
use polars::prelude::*;
use serde::Serialize;
use serde_json::{Value, json};
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
    let join = move |inputs: &Inputs| {
        let results = joined(&rows(inputs, &parts)?, &paper)?;
        Ok(Artifacts::from([(FILE.into(), csv(results)?)]))
    };
    let task = Task::new(ID, parameters, needs, join);
    (!task.needs.is_empty()).then(|| Task { export: Some("report"), ..task })
}

/// One row per problem, stopping rule, r and grid.
///
/// `problem` (the name of its scene), `rule`, `r`, `cells` (per side) and `tolerance` say what was
/// solved. `published` and `published_delta_a` are what the paper prints, empty where it prints
/// nothing, of Delta a on all but the finest grid. `stop` is the [end](Outcome::end) of the iteration as `solve` names
/// it, and `met` tells whether its stopping rule was met, which makes no solution. The other columns carry the names of
/// the fields of [`Outcome`].
#[derive(Clone, Debug)]
pub(super) struct Results(DataFrame);

#[derive(Clone, Debug, PartialEq, Serialize)]
struct Summary {
    cases: usize,
    sum: f64,
    least: f64,
    greatest: f64,
}

const KEYS: [&str; 3] = ["problem", "r", "cells"];

impl Results {
    pub(super) fn read(bytes: &[u8]) -> PolarsResult<Self> {
        read_csv(bytes).map(Self)
    }

    pub(super) fn of_problem(&self, name: &str) -> PolarsResult<Self> {
        self.0.filter(&self.0.column("problem")?.str()?.equal(name)).map(Self)
    }

    /// How these results agree with the paper's `tables`, and what the stopping rules leave and cost on the
    /// finest grid.
    pub(super) fn agreement(&self, tables: &[TableComparison]) -> PolarsResult<Value> {
        let exact = self.exact(StopRule::Signed)?;
        let signed = self.finest(StopRule::Signed)?;
        let on_finest = |column: &str| summary(&floats(&signed, column)?);
        let sum = |of: fn(&TableComparison) -> usize| tables.iter().map(of).sum::<usize>();
        Ok(json!({
            // Published counts; those that the signed rule gives, and (13) as printed.
            "cells": exact.cases,
            "exact": exact.sum as usize,
            "printed_exact": self.exact(StopRule::Printed)?.sum as usize,
            // Published values of Delta a; those to both digits, and within the declared tolerance.
            "deltas": sum(|table| table.rows.len()),
            "deltas_exact": sum(|table| table.delta_a_exact),
            "deltas_within": sum(|table| table.delta_a_within),
            // `max |dM/dy|` over the tolerance where the signed rule stops.
            "excess": summary(&(&floats(&signed, "gradient_abs")? / &floats(&signed, "tolerance")?)?)?,
            // Iterations under (13) as printed, and under the dual rule, over those under the signed rule.
            "printed": self.factor(StopRule::Printed)?,
            "dual": self.factor(StopRule::SignedDual)?,
            // Iterations and Delta a under the signed rule, and Delta a as published.
            "counts": on_finest("iterations")?,
            "delta": on_finest("delta_a")?,
            "paper_delta": on_finest("published_delta_a")?,
        }))
    }

    /// 1 for each published count that the rule gives and meets, else 0.
    fn exact(&self, rule: StopRule) -> PolarsResult<Summary> {
        let rows = self.under(rule)?;
        let rows = rows.filter(&rows.column("published")?.is_not_null())?;
        let same = floats(&rows, "iterations")?.equal(&floats(&rows, "published")?)?;
        let exact = same & rows.column("met")?.bool()?.clone();
        summary(&exact.into_series())
    }

    /// The iterations of a rule on the finest grid over those of the signed rule, for every r with
    /// which it is met.
    fn factor(&self, rule: StopRule) -> PolarsResult<Summary> {
        let rows = self.finest(StopRule::Signed)?.left_join(&self.finest(rule)?, KEYS, KEYS)?;
        let rows = rows.filter(rows.column("met_right")?.bool()?)?;
        summary(&(&floats(&rows, "iterations_right")? / &floats(&rows, "iterations")?)?)
    }

    fn under(&self, rule: StopRule) -> PolarsResult<DataFrame> {
        self.0.filter(&self.0.column("rule")?.str()?.equal(rule.to_string().as_str()))
    }

    /// Rows of problems of the paper on the finest grid.
    fn finest(&self, rule: StopRule) -> PolarsResult<DataFrame> {
        let rows = self.under(rule)?;
        rows.filter(&rows.column("published_delta_a")?.is_not_null())
    }
}

/// What was solved on a grid.
struct Row<'a> {
    scene: &'a Scene,
    rule: StopRule,
    r: f64,
    /// The number of the grid, from 1.
    level: usize,
    outcome: Outcome,
}

fn rows<'a>(inputs: &Inputs, parts: &'a [(Scene, StopRule)]) -> Result<Vec<Row<'a>>, String> {
    let mut rows = Vec::new();
    for (scene, rule) in parts {
        for &r in &scene.r {
            let solved: Outcomes = from_json(inputs, &solve::id(scene, *rule, r), OUTCOMES)?;
            let levels = (1..).zip(solved.levels);
            let row = |(level, outcome)| Row { scene, rule: *rule, r, level, outcome };
            rows.extend(levels.map(row));
        }
    }
    Ok(rows)
}

/// The rows of [`Results`].
fn joined(rows: &[Row], paper: &Paper) -> PolarsResult<DataFrame> {
    let float =
        |of: fn(&Outcome) -> f64| rows.iter().map(|row| of(&row.outcome)).collect::<Vec<_>>();
    let count = |of: fn(&Outcome) -> usize| {
        rows.iter().map(|row| of(&row.outcome) as i64).collect::<Vec<_>>()
    };
    let published = rows.iter().map(|&Row { scene, r, level, .. }| {
        let table = paper.published(scene.paper_table?).ok()?;
        let k = paper.r.iter().position(|&printed| printed == r)?;
        let count = *table.counts[k].get(level - 1)? as i64;
        Some((count, (level == scene.grids.len()).then_some(table.delta_a[k])))
    });
    let published: Vec<_> = published.collect();
    df!(
        "problem" => rows.iter().map(|row| &*row.scene.name).collect::<Vec<_>>(),
        "rule" => rows.iter().map(|row| row.rule.name()).collect::<Vec<_>>(),
        "r" => rows.iter().map(|row| row.r).collect::<Vec<_>>(),
        "cells" => count(|o| o.cells),
        "tolerance" => rows.iter().map(|row| tolerance(row.level)).collect::<Vec<_>>(),
        "iterations" => count(|o| o.iterations),
        "stop" => rows.iter().map(|row| row.outcome.end()).collect::<Vec<_>>(),
        "met" => rows.iter().map(|row| row.outcome.stop == StopReason::Converged).collect::<Vec<_>>(),
        "gradient_signed" => float(|o| o.gradient_signed),
        "gradient_abs" => float(|o| o.gradient_abs),
        "delta_a" => float(|o| o.delta_a),
        "energy" => float(|o| o.energy),
        "sum_load" => float(|o| o.sum_load),
        "kkt_stationarity" => float(|o| o.kkt.stationarity),
        "kkt_min_y" => float(|o| o.kkt.min_y),
        "kkt_min_lambda" => float(|o| o.kkt.min_lambda),
        "kkt_complementarity" => float(|o| o.kkt.complementarity),
        "kkt_natural" => float(|o| o.kkt.natural),
        "kkt_relative" => float(|o| o.kkt.relative),
        "published" => published.iter().map(|row| Some(row.as_ref()?.0)).collect::<Vec<_>>(),
        "published_delta_a" => published.iter().map(|row| row.as_ref()?.1).collect::<Vec<_>>(),
    )
}

fn floats(rows: &DataFrame, column: &str) -> PolarsResult<Series> {
    rows.column(column)?.as_materialized_series().cast(&DataType::Float64)
}

fn summary(values: &Series) -> PolarsResult<Summary> {
    let values = values.cast(&DataType::Float64)?;
    Ok(Summary {
        cases: values.len(),
        sum: values.sum::<f64>()?,
        least: values.min::<f64>()?.unwrap_or(f64::NAN),
        greatest: values.max::<f64>()?.unwrap_or(f64::NAN),
    })
}

/// CSV with a header line.
pub(super) fn csv(mut frame: DataFrame) -> PolarsResult<Vec<u8>> {
    let mut bytes = Vec::new();
    CsvWriter::new(&mut bytes).finish(&mut frame)?;
    Ok(bytes)
}

/// Reads CSV with a header line.
pub(super) fn read_csv(bytes: &[u8]) -> PolarsResult<DataFrame> {
    // Types from all rows: a column may begin with whole numbers, or with nothing.
    let options = CsvReadOptions::default().with_infer_schema_length(None);
    CsvReader::new(Cursor::new(bytes)).with_options(options).finish()
}
