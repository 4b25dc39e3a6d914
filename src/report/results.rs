//! Every result in one tidy table, and what the book says of them as joins and aggregates.

use crate::saddle::{StopRule, tolerance};
use polars::prelude::*;
use serde::Serialize;
use std::io::Cursor;

/// One row per problem, stopping rule, r and grid.
///
/// `problem` (the name of its scene), `rule`, `r`, `cells` (per side) and `tolerance` say what was
/// solved. `published` and `published_delta_a` are what the paper prints, empty where it prints
/// nothing. The other columns are those of [`Levels::csv`].
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
    /// CSV with columns `r`, `cells`, `iterations`, `stop`, `gradient_abs`, `delta_a` and others.
    pub csv: &'a [u8],
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
                let mut levels = read_csv(part.csv)?;
                let grids = add_keys(&mut levels, part)?;
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

/// Puts the keys in front, and returns the grids in cells per side.
fn add_keys(levels: &mut DataFrame, part: &Levels) -> PolarsResult<Vec<i64>> {
    let height = levels.height();
    let cells: Vec<i64> = levels.column("cells")?.i64()?.iter().flatten().collect();
    let mut grids = cells.clone();
    grids.sort_unstable();
    grids.dedup();
    let level = |n: &i64| grids.iter().position(|grid| grid == n).map_or(0, |k| k + 1);
    let tolerances: Vec<f64> = cells.iter().map(|n| tolerance(level(n))).collect();
    levels.insert_column(0, Column::new("problem".into(), vec![part.problem; height]))?;
    levels.insert_column(1, Column::new("rule".into(), vec![part.rule.to_string(); height]))?;
    levels.insert_column(4, Column::new("tolerance".into(), tolerances))?;
    Ok(grids)
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
