//! The table of all results: every scene, rule, r and grid beside the published numbers, for other programs to
//! read, and the joins and aggregates of it that the book shows.

use super::from_json;
use super::members::id_of;
use super::solve::NUMBERS;
use crate::pipeline::{Artifacts, Inputs, Task};
use crate::replication::comparison::TableComparison;
use crate::replication::fields::member::Member;
use crate::replication::numbers::Numbers;
use crate::replication::paper::{Paper, PublishedTable};
use crate::replication::project::Project;
use crate::replication::record::levels::{LevelNumbers, Residuals};
use crate::replication::scene::{Output, Scene};
use polars::prelude::*;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use signorini_mathematics::discrete::end::Stop;
use signorini_mathematics::problem::law::Law;
use signorini_mathematics::saddle::{StopRule, tolerance};
use signorini_mathematics::solvers::SaddleSettings;
use signorini_mathematics::statement::Statement;
use std::io::Cursor;

pub(super) const ID: &str = "diff/results";
/// Artifact, and file under `report/`: all results, as CSV.
pub(super) const FILE: &str = "results.csv";

/// The task that joins the results of all scenes that ask for a table; none if no scene does.
pub(super) fn task(project: &Project) -> Option<Task> {
    let mut scenes: Vec<&Scene> = project.scenes.iter().collect();
    // A study has a table of its own.
    scenes.retain(|scene| scene.wants(Output::Table) && !scene.is_study);
    let joined = Joined {
        scenes: scenes.into_iter().map(Solves::of).collect(),
        paper: project.paper.clone(),
    };
    let runs = joined.scenes.iter().flat_map(|scene| &scene.runs);
    let needs: Vec<String> = runs.map(|run| run.task.clone()).collect();
    let is_empty = needs.is_empty();
    let task = Task::new(ID, &joined, needs, |Joined { scenes, paper }, inputs| {
        let results = table(&solved(inputs, scenes)?, paper)?;
        Ok(Artifacts::from([(FILE.into(), csv(results)?)]))
    });
    (!is_empty).then(|| task.exported_to("report"))
}

/// Scenes and published tables that are joined, in the order of the rows.
#[derive(Serialize, Deserialize)]
struct Joined {
    scenes: Vec<Solves>,
    paper: Paper,
}

/// Solves of one scene.
#[derive(Serialize, Deserialize)]
struct Solves {
    name: String,
    paper_table: Option<u8>,
    /// Number of grids of a published table.
    grids: Option<usize>,
    runs: Vec<SolveOfMember>,
}

/// Solve of a member of a scene.
#[derive(Serialize, Deserialize)]
pub(super) struct SolveOfMember {
    pub(super) task: String,
    statement: Statement,
}

impl SolveOfMember {
    pub(super) fn of(scene: &Scene, member: &Member) -> Self {
        Self { task: id_of(scene, member), statement: member.statement.clone() }
    }

    /// Settings of a saddle-point method; none of other solvers.
    pub(super) fn saddle(&self) -> Option<SaddleSettings> {
        self.statement.saddle
    }

    pub(super) fn numbers(&self, inputs: &Inputs) -> Result<Numbers, String> {
        from_json(inputs, &self.task, NUMBERS)
    }

    /// Laws on all parts of the boundary in words.
    fn laws(&self) -> String {
        let laws = self.statement.boundary.in_words().ok().flatten();
        laws.unwrap_or_else(|| Law::SIGNORINI.to_string())
    }
}

impl Solves {
    fn of(scene: &Scene) -> Self {
        Self {
            name: scene.name.clone(),
            paper_table: scene.paper_table,
            grids: scene.paper_table.map(|_| scene.grids().len()),
            runs: scene.study.members.iter().map(|of| SolveOfMember::of(scene, of)).collect(),
        }
    }
}

/// Table with one row per problem, stopping rule, r and grid on which the solver ended.
///
/// Columns: `problem` (the name of its scene), `solver`, `rule`, `r`, `cells` (per side; empty on a mesh), `nodes` and
/// `tolerance` identify the solve; `rule`, `r` and `tolerance` are empty for solvers without. `energy_lower`,
/// `energy_upper` and `error_bound` are guaranteed, but for what `reserve` says, and empty where no bounds were
/// computed; `error_relative` is that bound over the norm of the solution.
/// `energy` is that of v or, with an accuracy of the energy, the number between these ends that is nearest to it.
/// `domain`, `f` and `law`, in words, are those of the scene.
/// `published` and `published_delta_a` are the published numbers, empty where the paper prints none: for Delta a, on
/// all grids but the finest. `warnings` are those of `solve`, on the finest grid.
/// `stop` is the [end](Outcome::name) of the iteration as `solve` names it, and `met` is true
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

impl Results {
    /// Reads CSV with a header line.
    pub(super) fn read(bytes: &[u8]) -> PolarsResult<Self> {
        let options = CsvReadOptions::default().with_schema(Some(schema()?));
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
        let signed = self.iterations(StopRule::Signed)?;
        let factors = self.iterations(rule)?.into_iter().filter_map(|(of, iterations)| {
            let (_, signed) = signed.iter().find(|(key, _)| *key == of)?;
            Some(iterations / signed)
        });
        aggregate(&Series::new("factor".into(), factors.collect::<Vec<_>>()))
    }

    /// Iterations on the finest grid where the rule is met, by problem and r.
    fn iterations(&self, rule: StopRule) -> PolarsResult<Vec<((String, f64), f64)>> {
        let rows = self.finest(rule)?;
        let rows = rows.filter(rows.column("met")?.bool()?)?;
        let [r, iterations] = [floats(&rows, "r")?, floats(&rows, "iterations")?];
        let problems = rows.column("problem")?.str()?.iter().flatten().map(str::to_owned);
        let keys = problems.zip(r.f64()?.iter().flatten());
        Ok(keys.zip(iterations.f64()?.iter().flatten()).collect())
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

/// Columns with their types, which CSV does not have: names of scenes may look like numbers, or like no value.
fn schema() -> PolarsResult<SchemaRef> {
    Ok(table(&[], &Paper::default())?.schema().clone())
}

/// Solve on one grid, or without a grid.
struct GridSolve<'a> {
    scene: &'a Solves,
    solve: &'a SolveOfMember,
    /// Number of the grid among those where the solver ended, from 1.
    level: usize,
    found: LevelNumbers,
    /// Approximations that the bounds leave out.
    reserve: Option<String>,
    /// Warnings that `solve` gives, on the last grid.
    warnings: String,
}

impl GridSolve<'_> {
    /// Place in the published table of the scene, if the paper prints r: the table and the number of its row.
    fn published_row<'p>(&self, paper: &'p Paper) -> Option<(&'p PublishedTable, usize)> {
        let table = paper.published(self.scene.paper_table?).ok()?;
        let r = self.solve.saddle()?.r;
        Some((table, paper.r.iter().position(|&printed| printed == r)?))
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
        (Some(self.level) == self.scene.grids).then_some(table.delta_a[row])
    }

    /// True if the stopping rule was met; none for a solver without.
    fn met(&self) -> Option<bool> {
        self.solve.saddle()?;
        Some(self.found.own_stop? == Stop::Converged)
    }

    /// One of the bounds; none under a rule, which stops where it says.
    fn bound(&self, bound: Option<f64>) -> Option<f64> {
        bound.filter(|_| self.solve.saddle().is_none())
    }

    /// One of the residuals.
    fn kkt(&self, residual: fn(&Residuals) -> Option<f64>) -> Option<f64> {
        residual(self.found.kkt.as_ref()?)
    }
}

fn solved<'a>(inputs: &Inputs, scenes: &'a [Solves]) -> Result<Vec<GridSolve<'a>>, String> {
    let mut solves = Vec::new();
    for scene in scenes {
        for solve in &scene.runs {
            let numbers = solve.numbers(inputs)?;
            let levels = numbers.levels();
            let finest = levels.len();
            for (level, found) in (1..).zip(levels) {
                solves.push(GridSolve {
                    scene,
                    solve,
                    level,
                    found,
                    reserve: numbers.reserve.clone(),
                    warnings: match level == finest {
                        true => numbers.warnings.join("; "),
                        false => String::new(),
                    },
                });
            }
        }
    }
    Ok(solves)
}

/// The table of [`Results`], made from solves and published numbers.
fn table(solves: &[GridSolve], paper: &Paper) -> PolarsResult<DataFrame> {
    df!(
        "problem" => column(solves, |solve| &*solve.scene.name),
        "solver" => column(solves, |solve| solve.solve.statement.solver.entry().name),
        "rule" => column(solves, |of| of.solve.saddle().map(|of| of.stop.name())),
        "r" => column(solves, |of| of.solve.saddle().map(|of| of.r)),
        "cells" => column(solves, |solve| solve.found.cells.map(|cells| cells as i64)),
        "nodes" => column(solves, |solve| solve.found.nodes.map(|nodes| nodes as i64)),
        "tolerance" => column(solves, |of| of.solve.saddle().map(|_| tolerance(of.level))),
        "iterations" => column(solves, |solve| solve.found.iterations.map(|count| count as i64)),
        "stop" => column(solves, |solve| solve.found.stop.as_deref()),
        "met" => column(solves, GridSolve::met),
        "gradient_signed" => column(solves, |solve| solve.found.gradient_signed),
        "gradient_abs" => column(solves, |solve| solve.found.gradient_abs),
        "delta_a" => column(solves, |solve| solve.found.delta_a),
        "energy" => column(solves, |solve| solve.found.energy),
        "energy_lower" => column(solves, |solve| solve.bound(solve.found.energy_lower)),
        "energy_upper" => column(solves, |solve| solve.bound(solve.found.energy_upper)),
        "error_bound" => column(solves, |solve| solve.bound(solve.found.error_bound)),
        "error_relative" => column(solves, |solve| solve.bound(solve.found.error_relative)),
        "reserve" => column(solves, |solve| {
            solve.reserve.as_deref().filter(|_| solve.bound(solve.found.error_bound).is_some())
        }),
        "v_least" => column(solves, |solve| solve.found.v_least),
        "v_greatest" => column(solves, |solve| solve.found.v_greatest),
        "sum_load" => column(solves, |solve| solve.found.sum_load),
        "kkt_stationarity" => column(solves, |solve| solve.kkt(|kkt| kkt.stationarity)),
        "kkt_min_y" => column(solves, |solve| solve.kkt(|kkt| kkt.min_y)),
        "kkt_min_lambda" => column(solves, |solve| solve.kkt(|kkt| kkt.min_lambda)),
        "kkt_complementarity" => column(solves, |solve| solve.kkt(|kkt| kkt.max_min)),
        "kkt_natural" => column(solves, |solve| solve.kkt(|kkt| kkt.natural)),
        "kkt_relative" => column(solves, |solve| solve.kkt(|kkt| kkt.relative)),
        "published" => column(solves, |solve| solve.published_count(paper)),
        "published_delta_a" => column(solves, |solve| solve.published_delta_a(paper)),
        "warnings" => column(solves, |solve| {
            (!solve.warnings.is_empty()).then_some(&*solve.warnings)
        }),
        "domain" => column(solves, |of| &*of.solve.statement.domain.name),
        "f" => column(solves, |of| &*of.solve.statement.f),
        "law" => column(solves, |of| of.solve.laws()),
    )
}

/// Values of one column, a row per solve.
fn column<'s, 'a, T>(
    solves: &'s [GridSolve<'a>],
    value: impl Fn(&'s GridSolve<'a>) -> T,
) -> Vec<T> {
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
        let columns: Vec<_> = schema().unwrap().iter_names().map(ToString::to_string).collect();
        let mut csv = columns.join(",") + "\n";
        for name in names {
            let name = name.replace('"', "\"\"");
            let rest = ",".repeat(columns.len() - 10);
            csv += &format!("\"{name}\",uzawa,signed,1.0,,25,0.1,7,converged,true{rest}\n");
        }
        let results = Results::read(csv.as_bytes()).unwrap();
        for name in names {
            let found = results.of_problem(name).unwrap();
            assert_eq!(found.0.height(), 1, "{name}");
            assert_eq!(aggregate(&floats(&found.0, "iterations").unwrap()).unwrap().sum, 7.0);
        }
    }
}
