//! `diff`: comparison of our tables with the published ones.

use super::CacheArgs;
use super::output::{in_columns, paragraph, say, say_json, styled};
use super::pipeline::Workplace;
use crate::pipeline::Manifest;
use crate::pipeline::error::{Error, Result};
use crate::replication::comparison::{RowComparison, TableComparison, Tables};
use crate::replication::project::Project;
use crate::replication::stages::Stage;
use crate::replication::stages::diff::DIFF;
use crate::table::{Table, in_markdown};
use anstyle::AnsiColor;
use clap::Args;
use serde::Serialize;
use std::collections::BTreeMap;

#[derive(Args)]
pub(super) struct DiffArgs {
    /// Print JSON
    #[arg(long, conflicts_with_all = ["md", "tex"])]
    json: bool,
    /// Print Markdown, for a pull request
    #[arg(long, conflicts_with = "tex")]
    md: bool,
    /// Print LaTeX, for a paper; the tables need the package booktabs
    #[arg(long)]
    tex: bool,
    #[command(flatten)]
    cache: CacheArgs,
}

/// Object that `--json` prints.
#[derive(Serialize)]
struct DiffJson<'a> {
    schema: u8,
    tables: &'a [TableComparison],
}

pub(super) fn diff(args: &DiffArgs) -> Result<u8> {
    let mut workplace = Workplace::open(&args.cache)?;
    workplace.project.select(&[])?;
    // The table of the results of all scenes is not asked for.
    workplace.project.partial = true;
    let compared = workplace.project.scenes.iter().filter(|scene| scene.paper_table.is_some());
    let names: Vec<String> = compared.map(|scene| scene.name.clone()).collect();
    let tables = match names.is_empty() {
        true => Vec::new(),
        false => {
            let tasks = workplace.tasks(&names, Some(Stage::Diff))?;
            let manifests = workplace.compute(&tasks)?;
            comparisons(&workplace, &manifests)?
        }
    };
    if tables.is_empty() {
        return Err(Error::input(
            "no scene has a `paper_table`; add one to compare with the paper",
        ));
    }
    if args.json {
        say_json(&DiffJson { schema: 1, tables: &tables })?;
    } else {
        say(&match (args.md, args.tex) {
            (true, _) => in_markdown_with_total(&workplace.project, &tables),
            (_, true) => {
                shown(&workplace.project, &tables, tex) + &format!("% {}\n", total(&tables))
            }
            _ => shown(&workplace.project, &tables, text) + &legend(&tables),
        })?;
    }
    Ok(u8::from(!Tables(&tables).hold()))
}

/// Returns the comparisons among the outputs of these runs, by number of table.
pub(super) fn comparisons(
    workplace: &Workplace,
    manifests: &BTreeMap<String, Manifest>,
) -> Result<Vec<TableComparison>> {
    let mut tables = Vec::new();
    for manifest in manifests.values().filter(|manifest| manifest.outputs.contains_key(DIFF)) {
        let artifacts = workplace.store.artifacts(&manifest.task, &manifest.outputs)?;
        let table: TableComparison = serde_json::from_slice(&artifacts[DIFF]).map_err(|e| {
            Error::input(format!("{}: {e}; do `signorini run --force`", manifest.task))
        })?;
        tables.push(table);
    }
    tables.sort_by_key(|table| table.table);
    Ok(tables)
}

/// Returns the tables, each as `print` has it with the names of its grids, with an empty line behind each.
fn shown(
    project: &Project,
    tables: &[TableComparison],
    print: fn(&TableComparison, &[String]) -> String,
) -> String {
    tables.iter().map(|table| print(table, &grids(project, table)) + "\n").collect()
}

/// Returns the tables in Markdown, and how many numbers agree.
pub(super) fn in_markdown_with_total(project: &Project, tables: &[TableComparison]) -> String {
    shown(project, tables, markdown) + &total(tables) + "\n"
}

/// Returns the names of the grids of a table, coarsest first.
fn grids(project: &Project, table: &TableComparison) -> Vec<String> {
    let scene = project.scenes.iter().find(|scene| scene.name == table.scene);
    scene.map_or(Vec::new(), |scene| {
        scene.grids().iter().map(|grid| format!("1/{}", grid.cells())).collect()
    })
}

/// Returns how many numbers agree, and whether all are within their tolerances.
pub(super) fn total(tables: &[TableComparison]) -> String {
    let verdict = match Tables(tables).hold() {
        true => "every number is within the tolerance of its table",
        false => "not every number is within the tolerance of its table",
    };
    format!("{}; {verdict}", Tables(tables))
}

/// Returns the meaning of the marks, and the total.
fn legend(tables: &[TableComparison]) -> String {
    let any_capped =
        tables.iter().flat_map(|table| &table.rows).any(|row| row.capped.contains(&true));
    let capped = if any_capped { ", > cut off by max_iterations" } else { "" };
    let marks = paragraph(&format!("= exact, ~ within tolerance, ! outside{capped}"));
    let marks = coloured(&marks);
    format!("{marks}\n{}\n", paragraph(&total(tables).replace("; ", "\n")))
}

/// Returns text with its marks in colours.
fn coloured(text: &str) -> String {
    let mut shown = String::new();
    for letter in text.chars() {
        match Mark::ALL.into_iter().find(|mark| mark.sign() == letter) {
            Some(mark) => shown += &styled(&letter.to_string(), mark.color()),
            None => shown.push(letter),
        }
    }
    shown
}

/// Mark of a number of ours beside the published one.
#[derive(Clone, Copy, PartialEq)]
enum Mark {
    Exact,
    Within,
    Outside,
    CutOff,
}

impl Mark {
    const ALL: [Self; 4] = [Self::Exact, Self::Within, Self::Outside, Self::CutOff];

    fn of_count(row: &RowComparison, level: usize) -> Self {
        match (row.count_exact(level), row.within[level], row.is_capped(level)) {
            (true, ..) => Self::Exact,
            (false, true, _) => Self::Within,
            (false, false, false) => Self::Outside,
            (false, false, true) => Self::CutOff,
        }
    }

    /// Returns the mark of Delta a, which is exact if it agrees to the two printed digits.
    fn of_delta_a(row: &RowComparison) -> Self {
        match (row.delta_a_exact(), row.delta_a_within) {
            (true, _) => Self::Exact,
            (false, true) => Self::Within,
            (false, false) => Self::Outside,
        }
    }

    fn color(self) -> AnsiColor {
        match self {
            Self::Exact => AnsiColor::Green,
            Self::Within => AnsiColor::Yellow,
            Self::Outside | Self::CutOff => AnsiColor::Red,
        }
    }

    fn sign(self) -> char {
        match self {
            Self::Exact => '=',
            Self::Within => '~',
            Self::Outside => '!',
            Self::CutOff => '>',
        }
    }
}

/// Returns three statements: on the counts, on Delta a, and on the tolerance of both.
fn summary(table: &TableComparison) -> [String; 3] {
    let TableComparison { exact, cells, within_tolerance, .. } = table;
    [
        format!("{exact} of {cells} counts exact, {within_tolerance} within tolerance"),
        format!(
            "Delta a: {} of {} to the printed digits, {} within tolerance",
            table.delta_a_exact,
            table.rows.len(),
            table.delta_a_within
        ),
        format!("tolerance: {}", table.tolerance),
    ]
}

/// Returns a table with r, the counts, and ours and the published Delta a; `shown` writes each number of ours with its
/// mark, and a count with the published one.
fn marked(
    table: &TableComparison,
    grids: &[String],
    shown: impl Fn(String, Mark, Option<usize>) -> String,
) -> Table {
    let head = ["r"].into_iter().chain(grids.iter().map(String::as_str));
    let mut marked = Table::new(head.chain(["Δa ours", "Δa paper"]), &[]);
    for row in &table.rows {
        let mut cells = vec![row.r.to_string()];
        for (level, (ours, paper)) in row.ours.iter().zip(&row.paper).enumerate() {
            cells.push(shown(ours.to_string(), Mark::of_count(row, level), Some(*paper)));
        }
        cells.push(shown(format!("{:.2e}", row.delta_a_ours), Mark::of_delta_a(row), None));
        cells.push(format!("{:.1e}", row.delta_a_paper));
        marked.rows.push(cells);
    }
    marked
}

fn text(table: &TableComparison, grids: &[String]) -> String {
    let shown = marked(table, grids, |ours, mark, paper| {
        let paper = paper.map_or(String::new(), |paper| format!(" {paper:>3}"));
        format!("{ours}{}{paper}", mark.sign())
    });
    let title = styled(&format!("Table {} ({})", table.table, table.scene), AnsiColor::Cyan);
    let summary = paragraph(&summary(table).join("\n"));
    let title = paragraph(&format!("{title}: ours, then the paper's"));
    format!("{title}\n{}{summary}\n", coloured(&in_columns(&shown)))
}

/// Returns a table in LaTeX: ours, and where a count is another the published one behind its mark.
fn tex(table: &TableComparison, grids: &[String]) -> String {
    let shown = marked(table, grids, |ours, mark, paper| match paper {
        Some(paper) if mark != Mark::Exact => format!("{ours} {} {paper}", mark.sign()),
        _ => ours,
    });
    let TableComparison { table: number, scene, .. } = table;
    format!("% Table {number} ({scene}): {}\n{}", summary(table).join("; "), shown.tex())
}

fn markdown(table: &TableComparison, grids: &[String]) -> String {
    let shown = marked(table, grids, |ours, mark, paper| match mark {
        Mark::Exact => ours,
        _ => {
            let paper = paper.map_or(String::new(), |paper| format!(" {paper}"));
            format!("**{ours}** {}{paper}", mark.sign())
        }
    });
    let TableComparison { table: number, scene, .. } = table;
    let (scene, summary) = (in_markdown(scene), summary(table).join("; "));
    format!("**Table {number}** ({scene}): {summary}\n\n{}", shown.markdown(str::to_owned))
}
