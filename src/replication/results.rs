//! Every result in one tidy table, and what the book says of them as joins and aggregates.

use crate::saddle::{Outcome, StopRule, tolerance};
use polars::prelude::*;
use serde::Serialize;
use std::io::Cursor;

/// One row per problem, stopping rule, r and grid.
///
/// `problem` (the name of its scene), `rule`, `r`, `cells` (per side) and `tolerance` say what was
/// solved. `published` and `published_delta_a` are what the paper prints, empty where it prints
/// nothing. The other columns carry the names of the fields of [`Outcome`].
#[derive(Clone, Debug)]
pub struct Results(DataFrame);

/// The results of one scene under one rule.
pub struct Levels<'a> {
    /// Name of the scene.
    pub problem: &'a str,
    /// What the paper prints of it, if it does.
    pub published: Option<Published<'a>>,
    /// Stopping rule.
    pub rule: StopRule,
    /// For each r, the outcomes on all grids, coarsest first.
    pub columns: Vec<(f64, Vec<Outcome>)>,
}

/// A published table, row by row.
#[derive(Clone, Copy, Debug)]
pub struct Published<'a> {
    /// Duality parameters.
    pub r: &'a [f64],
    /// Iterations, one list per r, one count per grid.
    pub counts: &'a [Vec<usize>],
    /// Delta a on the finest grid, per r.
    pub delta_a: &'a [f64],
}

/// Some numbers of one problem.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Summary {
    /// Name of the problem.
    pub problem: String,
    /// How many numbers.
    pub cases: usize,
    /// Their sum.
    pub sum: f64,
    /// The least.
    pub least: f64,
    /// The greatest.
    pub greatest: f64,
}

impl Summary {
    /// The numbers of both.
    pub fn and(mut self, other: &Self) -> Self {
        self.cases += other.cases;
        self.sum += other.sum;
        self.least = self.least.min(other.least);
        self.greatest = self.greatest.max(other.greatest);
        self
    }
}

const KEYS: [&str; 3] = ["problem", "r", "cells"];

impl Results {
    /// The results of all scenes and rules, joined with the published tables.
    ///
    /// # Errors
    /// polars' words, if a table of levels cannot be read.
    pub fn of(parts: &[Levels]) -> Result<Self, String> {
        let join = || -> PolarsResult<DataFrame> {
            let (mut all, mut published) = (DataFrame::empty(), printed("", &[], NOTHING)?);
            for part in parts {
                let (levels, grids) = frame(part)?;
                if let Some(table) = part.published.filter(|_| part.rule == StopRule::Signed) {
                    published.vstack_mut(&printed(part.problem, &grids, table)?)?;
                }
                all.vstack_mut(&levels)?;
            }
            all.left_join(&published, KEYS, KEYS)
        };
        join().map(Self).map_err(words)
    }

    /// Reads what [`to_csv`](Self::to_csv) wrote.
    ///
    /// # Errors
    /// polars' words.
    pub fn read(bytes: &[u8]) -> Result<Self, String> {
        read_csv(bytes).map(Self).map_err(words)
    }

    /// CSV with a header line.
    ///
    /// # Errors
    /// polars' words.
    pub fn to_csv(&self) -> Result<Vec<u8>, String> {
        csv(self.0.clone()).map_err(words)
    }

    /// Per problem of the paper, 1 for each published count that the rule gives and meets, else 0.
    ///
    /// # Errors
    /// polars' words, if a column is missing.
    pub fn agreement(&self, rule: StopRule) -> Result<Vec<Summary>, String> {
        let count = || {
            let rows = self.under(rule)?;
            let rows = rows.filter(&rows.column("published")?.is_not_null())?;
            let same = floats(&rows, "iterations")?.equal(&floats(&rows, "published")?)?;
            let exact = same & rows.column("stop")?.str()?.equal("converged");
            per_problem(&rows, exact.into_series())
        };
        count().map_err(words)
    }

    /// Per problem of the paper, a column over the tolerance where the signed rule stops on the finest grid.
    ///
    /// # Errors
    /// polars' words, if a column is missing.
    pub fn excess(&self, column: &str) -> Result<Vec<Summary>, String> {
        let divide = || {
            let rows = self.finest(StopRule::Signed)?;
            per_problem(&rows, (&floats(&rows, column)? / &floats(&rows, "tolerance")?)?)
        };
        divide().map_err(words)
    }

    /// Per problem of the paper, the iterations of a rule on the finest grid over those of the signed
    /// rule, for every r with which it is met.
    ///
    /// # Errors
    /// polars' words, if a column is missing.
    pub fn factor(&self, rule: StopRule) -> Result<Vec<Summary>, String> {
        let divide = || {
            let rows = self.finest(StopRule::Signed)?.left_join(&self.finest(rule)?, KEYS, KEYS)?;
            let rows = rows.filter(&rows.column("stop_right")?.str()?.equal("converged"))?;
            let ratio = (&floats(&rows, "iterations_right")? / &floats(&rows, "iterations")?)?;
            per_problem(&rows, ratio)
        };
        divide().map_err(words)
    }

    /// Per problem of the paper, a column on the finest grid under a rule, over all r.
    ///
    /// # Errors
    /// polars' words, if there is no such column.
    pub fn on_finest(&self, rule: StopRule, column: &str) -> Result<Vec<Summary>, String> {
        let take = || {
            let rows = self.finest(rule)?;
            per_problem(&rows, floats(&rows, column)?)
        };
        take().map_err(words)
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

/// One row per r and grid, and the grids in cells per side.
fn frame(part: &Levels) -> PolarsResult<(DataFrame, Vec<i64>)> {
    let rows: Vec<(f64, usize, &Outcome)> = part
        .columns
        .iter()
        .flat_map(|(r, levels)| levels.iter().zip(1..).map(move |(o, level)| (*r, level, o)))
        .collect();
    let float = |of: fn(&Outcome) -> f64| rows.iter().map(|row| of(row.2)).collect::<Vec<_>>();
    let count =
        |of: fn(&Outcome) -> usize| rows.iter().map(|row| of(row.2) as i64).collect::<Vec<_>>();
    let mut grids = count(|o| o.cells);
    grids.sort_unstable();
    grids.dedup();
    let frame = df!(
        "problem" => vec![part.problem; rows.len()],
        "rule" => vec![part.rule.to_string(); rows.len()],
        "r" => rows.iter().map(|row| row.0).collect::<Vec<_>>(),
        "cells" => count(|o| o.cells),
        "tolerance" => rows.iter().map(|row| tolerance(row.1)).collect::<Vec<_>>(),
        "iterations" => count(|o| o.iterations),
        "stop" => rows.iter().map(|row| row.2.stop.to_string()).collect::<Vec<_>>(),
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
    );
    Ok((frame?, grids))
}

const NOTHING: Published = Published { r: &[], counts: &[], delta_a: &[] };

/// What the paper prints for a problem.
fn printed(problem: &str, grids: &[i64], table: Published) -> PolarsResult<DataFrame> {
    let (mut r, mut cells) = (Vec::new(), Vec::new());
    let (mut counts, mut deltas) = (Vec::new(), Vec::new());
    for (row, x) in table.r.iter().enumerate() {
        for (level, (&n, &count)) in grids.iter().zip(&table.counts[row]).enumerate() {
            r.push(*x);
            cells.push(n);
            counts.push(count as i64);
            deltas.push((level + 1 == grids.len()).then_some(table.delta_a[row]));
        }
    }
    df!(
        "problem" => vec![problem; r.len()],
        "r" => r,
        "cells" => cells,
        "published" => counts,
        "published_delta_a" => deltas,
    )
}

/// CSV with a header line.
///
/// # Errors
/// polars' own.
pub fn csv(mut frame: DataFrame) -> PolarsResult<Vec<u8>> {
    let mut bytes = Vec::new();
    CsvWriter::new(&mut bytes).finish(&mut frame)?;
    Ok(bytes)
}

/// Reads what [`csv`] wrote.
///
/// # Errors
/// polars' own.
pub fn read_csv(bytes: &[u8]) -> PolarsResult<DataFrame> {
    // Types from all rows: a column may begin with whole numbers, or with nothing.
    let options = CsvReadOptions::default().with_infer_schema_length(None);
    CsvReader::new(Cursor::new(bytes)).with_options(options).finish()
}

fn floats(rows: &DataFrame, column: &str) -> PolarsResult<Series> {
    rows.column(column)?.as_materialized_series().cast(&DataType::Float64)
}

/// Summaries of `values`, one for each row, by problem.
fn per_problem(rows: &DataFrame, values: Series) -> PolarsResult<Vec<Summary>> {
    let values = values.cast(&DataType::Float64)?;
    let problems = rows.column("problem")?.as_materialized_series();
    let summary = |problem: &str| -> PolarsResult<Summary> {
        let mine = values.f64()?.filter(&problems.str()?.equal(problem))?;
        Ok(Summary {
            problem: problem.into(),
            cases: mine.len(),
            sum: mine.sum().unwrap_or(0.0),
            least: mine.min().unwrap_or(f64::NAN),
            greatest: mine.max().unwrap_or(f64::NAN),
        })
    };
    problems.unique_stable()?.str()?.iter().flatten().map(summary).collect()
}

fn words(error: PolarsError) -> String {
    format!("table of results: {error}")
}
