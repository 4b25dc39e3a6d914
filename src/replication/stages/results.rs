//! The table of all results: every scene, rule, r and grid beside what the paper prints, for other programs to
//! read, and what the book says of it as joins and aggregates.

use super::from_json;
use super::solve::{self, OUTCOMES, Outcomes};
use crate::pipeline::error::Failure;
use crate::pipeline::{Artifacts, Inputs, Task, parameters};
use crate::replication::paper::Paper;
use crate::replication::project::Project;
use crate::replication::scene::{Output, Scene};
use crate::replication::table::{csv, read_csv};
use crate::saddle::{Outcome, StopRule, tolerance};
use polars::prelude::*;
use serde::Serialize;

/// Id of the task.
pub const ID: &str = "diff/results";
/// Artifact, and file under `report/`: all results, as CSV.
pub const FILE: &str = "results.csv";

/// The task that joins the results of all scenes that ask for a table; none if no scene does.
pub fn task(project: &Project) -> Option<Task> {
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
        let results = levels(inputs, &parts)?.left_join(&published(&parts, &paper)?, KEYS, KEYS)?;
        Ok(Artifacts::from([(FILE.into(), csv(results)?)]))
    };
    let task = Task::new(ID, parameters, needs, join);
    (!task.needs.is_empty()).then(|| Task { export: Some("report"), ..task })
}

/// One row per problem, stopping rule, r and grid.
///
/// `problem` (the name of its scene), `rule`, `r`, `cells` (per side) and `tolerance` say what was
/// solved. `published` and `published_delta_a` are what the paper prints, empty where it prints
/// nothing. The other columns carry the names of the fields of [`Outcome`].
#[derive(Clone, Debug)]
pub(super) struct Results(DataFrame);

#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct Summary {
    pub(super) cases: usize,
    pub(super) sum: f64,
    pub(super) least: f64,
    pub(super) greatest: f64,
}

const KEYS: [&str; 3] = ["problem", "r", "cells"];

impl Results {
    pub(super) fn read(bytes: &[u8]) -> PolarsResult<Self> {
        read_csv(bytes).map(Self)
    }

    pub(super) fn of_problem(&self, name: &str) -> PolarsResult<Self> {
        self.0.filter(&self.0.column("problem")?.str()?.equal(name)).map(Self)
    }

    /// 1 for each published count that the rule gives and meets, else 0.
    pub(super) fn agreement(&self, rule: StopRule) -> PolarsResult<Summary> {
        let rows = self.under(rule)?;
        let rows = rows.filter(&rows.column("published")?.is_not_null())?;
        let same = floats(&rows, "iterations")?.equal(&floats(&rows, "published")?)?;
        let exact = same & rows.column("stop")?.str()?.equal("converged");
        summary(&exact.into_series())
    }

    /// `max |dM/dy|` over the tolerance where the signed rule stops on the finest grid.
    pub(super) fn excess(&self) -> PolarsResult<Summary> {
        let rows = self.finest(StopRule::Signed)?;
        summary(&(&floats(&rows, "gradient_abs")? / &floats(&rows, "tolerance")?)?)
    }

    /// The iterations of a rule on the finest grid over those of the signed rule, for every r with
    /// which it is met.
    pub(super) fn factor(&self, rule: StopRule) -> PolarsResult<Summary> {
        let rows = self.finest(StopRule::Signed)?.left_join(&self.finest(rule)?, KEYS, KEYS)?;
        let rows = rows.filter(&rows.column("stop_right")?.str()?.equal("converged"))?;
        summary(&(&floats(&rows, "iterations_right")? / &floats(&rows, "iterations")?)?)
    }

    /// A column on the finest grid under the signed rule, over all r.
    pub(super) fn on_finest(&self, column: &str) -> PolarsResult<Summary> {
        summary(&floats(&self.finest(StopRule::Signed)?, column)?)
    }

    fn under(&self, rule: StopRule) -> PolarsResult<DataFrame> {
        self.0.filter(&self.0.column("rule")?.str()?.equal(rule.to_string().as_str()))
    }

    /// Rows of problems of the paper on the finest grid.
    fn finest(&self, rule: StopRule) -> PolarsResult<DataFrame> {
        let signed = self.under(StopRule::Signed)?;
        let signed = signed.filter(&signed.column("published_delta_a")?.is_not_null())?;
        let keys = signed.select(KEYS)?;
        let rows = self.under(rule)?;
        keys.left_join(&rows, KEYS, KEYS)
    }
}

/// What was solved: one row per scene, rule, r and grid.
fn levels(inputs: &Inputs, parts: &[(Scene, StopRule)]) -> Result<DataFrame, Failure> {
    let mut rows: Vec<(&Scene, StopRule, f64, usize, Outcome)> = Vec::new();
    for (scene, rule) in parts {
        for &r in &scene.r {
            let solved: Outcomes = from_json(inputs, &solve::id(scene, *rule, r), OUTCOMES)?;
            rows.extend((1..).zip(solved.levels).map(|(level, o)| (scene, *rule, r, level, o)));
        }
    }
    let float = |of: fn(&Outcome) -> f64| rows.iter().map(|row| of(&row.4)).collect::<Vec<_>>();
    let count =
        |of: fn(&Outcome) -> usize| rows.iter().map(|row| of(&row.4) as i64).collect::<Vec<_>>();
    Ok(df!(
        "problem" => rows.iter().map(|row| &*row.0.name).collect::<Vec<_>>(),
        "rule" => rows.iter().map(|row| row.1.name()).collect::<Vec<_>>(),
        "r" => rows.iter().map(|row| row.2).collect::<Vec<_>>(),
        "cells" => count(|o| o.cells),
        "tolerance" => rows.iter().map(|row| tolerance(row.3)).collect::<Vec<_>>(),
        "iterations" => count(|o| o.iterations),
        "stop" => rows.iter().map(|row| row.4.stop.to_string()).collect::<Vec<_>>(),
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
    )?)
}

/// What the paper prints of the scenes, of Delta a only on the finest grid.
fn published(parts: &[(Scene, StopRule)], paper: &Paper) -> PolarsResult<DataFrame> {
    let mut rows = Vec::new();
    for (scene, _) in parts.iter().filter(|(_, rule)| *rule == StopRule::Signed) {
        let Some(Ok(table)) = scene.paper_table.map(|number| paper.published(number)) else {
            continue;
        };
        for (k, &r) in paper.r.iter().enumerate() {
            for (&grid, &count) in scene.grids.iter().zip(&table.counts[k]) {
                let delta_a = (grid == scene.finest()).then_some(table.delta_a[k]);
                rows.push((&*scene.name, r, grid.cells() as i64, count as i64, delta_a));
            }
        }
    }
    df!(
        "problem" => rows.iter().map(|row| row.0).collect::<Vec<_>>(),
        "r" => rows.iter().map(|row| row.1).collect::<Vec<_>>(),
        "cells" => rows.iter().map(|row| row.2).collect::<Vec<_>>(),
        "published" => rows.iter().map(|row| row.3).collect::<Vec<_>>(),
        "published_delta_a" => rows.iter().map(|row| row.4).collect::<Vec<_>>(),
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
