//! The `tabulate` stage: the cells of one scene as a table, for each stopping rule in the layout of the paper.

use super::solve::NUMBERS;
use super::{from_json, members};
use crate::pipeline::{Artifacts, Inputs, Made, Task};
use crate::replication::columns::{in_words, shown};
use crate::replication::comparison::Row;
use crate::replication::fields::member::Member;
use crate::replication::numbers::Numbers;
use crate::replication::record::Grouped;
use crate::replication::record::levels::LevelNumbers;
use crate::replication::scene::Scene;
use crate::table::{Table, in_markdown};
use serde::{Deserialize, Serialize};
use signorini_mathematics::discrete::stop::Stop;
use signorini_mathematics::problem::text::interval;
use signorini_mathematics::saddle::StopRule;
use signorini_mathematics::solvers::SaddleSettings;

/// Folder of the tables in the project.
pub(crate) const FOLDER: &str = "report/tables";
/// First column of the table of a saddle-point method.
const RULE: &str = "rule";
/// Columns of the table of a solver without r that a page has room for.
const USUAL: [&str; 6] = ["grid", "iterations", "stop", "energy", "error_relative", "kkt_relative"];
/// First words of the columns on the ends of runs of a saddle-point method, each in words.
const ENDS: [(&str, &str); 2] =
    [("capped ", "the limit on iterations"), ("stop ", "no solution of the discrete problem")];
/// Columns of the guaranteed bracket of the energy.
const BRACKET: [&str; 2] = ["energy_lower", "energy_upper"];

/// Id of the task that makes the table of a scene.
pub(crate) fn id(scene: &Scene) -> String {
    format!("tabulate/{}", scene.name)
}

/// Artifact with the table of a scene.
pub(crate) fn file(scene: &Scene) -> String {
    format!("{}.csv", scene.name)
}

/// Returns the rows of a table that are under a rule, without the column of the rules.
pub(crate) fn under(table: &str, rule: StopRule) -> String {
    let mut rows = String::new();
    for line in table.lines() {
        match line.split_once(',') {
            Some((first, rest)) if first == RULE || first == rule.name() => {
                rows += &format!("{rest}\n");
            }
            _ => (),
        }
    }
    rows
}

/// Returns the files of a table: in CSV, and as it is `shown` in Markdown and LaTeX, each with a `note` below.
pub(super) fn files(name: &str, table: &Table, shown: &Table, note: &str) -> Artifacts {
    let head = shown.head.iter().map(|column| in_words(column)).collect();
    let mut tex = Table { head, ..shown.clone() }.tex();
    let mut markdown = shown.markdown(in_markdown);
    let left_out: Vec<&str> = table
        .head
        .iter()
        .map(String::as_str)
        .filter(|name| !shown.head.iter().any(|one| one == name))
        .collect();
    if !left_out.is_empty() {
        tex += &format!(
            "% {name}.csv has all columns that the scene keeps; not here: {}.\n",
            left_out.join(", ")
        );
    }
    for line in note.lines() {
        markdown += &format!("\n{}\n", in_markdown(line));
        tex += &format!("% {line}\n");
    }
    let texts = [("csv", table.csv()), ("md", markdown), ("tex", tex)];
    let files =
        texts.into_iter().map(|(ending, text)| (format!("{name}.{ending}"), text.into_bytes()));
    files.collect()
}

/// Returns a table with as many digits as are read behind the first columns, which are as they are `given`, and as are
/// known in rows for whose number `is_true` holds; a bracket is rounded outwards.
pub(super) fn with_few_digits(
    table: &Table,
    given: usize,
    is_true: impl Fn(usize) -> bool,
) -> Table {
    /// Digits of a number that is not whole.
    const SIX: usize = 6;
    let mut table = table.clone();
    let head = table.head.clone();
    for (k, row) in table.rows.iter_mut().enumerate() {
        let all = row.clone();
        let number = |name: &str| {
            let place = head.iter().position(|column| column == name)?;
            all[place].parse::<f64>().ok().filter(|number| number.is_finite())
        };
        for (cell, column) in row.iter_mut().zip(&head).skip(given) {
            if cell.contains(['.', 'e']) {
                *cell = shown((column, SIX), is_true(k), number).unwrap_or_else(|| cell.clone());
            }
        }
        if let [Some(low), Some(high)] = BRACKET.map(number) {
            let text = interval([low, high]);
            for (name, end) in BRACKET.into_iter().zip(text[1..text.len() - 1].split(", ")) {
                let columns = row.iter_mut().zip(&head).filter(|(_, column)| *column == name);
                columns.for_each(|(cell, _)| *cell = end.into());
            }
        }
    }
    table
}

/// Solves from which a table is made.
#[derive(Serialize, Deserialize)]
struct Tabulated {
    /// Name of the scene.
    name: String,
    /// In the order of the rows.
    solves: Vec<SolveOfRun>,
    /// True for a published table, whose warnings the book explains.
    is_papers: bool,
}

/// Solve of which a table has a row, or each level one.
#[derive(Serialize, Deserialize)]
pub(super) struct SolveOfRun {
    pub(super) task: String,
    /// Rule and r of a saddle-point method; none of other solvers.
    pub(super) saddle: Option<SaddleSettings>,
}

impl SolveOfRun {
    /// Solve of a member of a scene.
    pub(super) fn of(scene: &Scene, member: &Member) -> Self {
        Self { task: members::id_of(scene, member), saddle: member.rule_and_r() }
    }

    /// Solves of a scene, in the order of the rows.
    pub(super) fn all(scene: &Scene) -> Vec<Self> {
        scene.study.members.iter().map(|member| Self::of(scene, member)).collect()
    }

    pub(super) fn numbers(&self, inputs: &Inputs) -> Result<Numbers, String> {
        from_json(inputs, &self.task, NUMBERS)
    }
}

pub(crate) fn task(scene: &Scene) -> Task {
    let solves = SolveOfRun::all(scene);
    let needs = solves.iter().map(|solve| solve.task.clone()).collect();
    let is_papers = scene.paper_table.is_some();
    let tabulated = Tabulated { name: scene.name.clone(), solves, is_papers };
    Task::new(id(scene), &tabulated, needs, Tabulated::made).exported_to(FOLDER)
}

impl Tabulated {
    fn made(&self, inputs: &Inputs) -> Made {
        let (mut levels, mut warned, mut is_true) = (Vec::new(), Grouped::default(), false);
        for solve in &self.solves {
            let numbers = solve.numbers(inputs)?;
            levels.push(numbers.levels());
            is_true = numbers.has_true_energy();
            let run = solve.saddle.map(|SaddleSettings { stop, r, .. }| format!("{stop}, r = {r}"));
            for warning in numbers.warnings.into_iter().filter(|_| !self.is_papers) {
                warned.add(warning, run.clone().unwrap_or_default());
            }
        }
        let runs: Option<Vec<_>> = self.solves.iter().map(|solve| solve.saddle).collect();
        let table = match &runs {
            Some(runs) => table(runs, &levels),
            None => table_of_levels(&levels[0]),
        };
        let few = with_few_digits(&table, 0, |_| is_true);
        let (shown, mut note) = match runs {
            Some(_) => without_ends(&few),
            None => (few.with_columns(|column| USUAL.contains(&column)), String::new()),
        };
        for (warning, whom) in warned.first(usize::MAX) {
            note += &match &whom[0][..] {
                "" => format!("warning: {warning}\n"),
                _ => format!("warning ({}): {warning}\n", whom.join("; ")),
            };
        }
        Ok(files(&self.name, &table, &shown, &note))
    }
}

/// Table of a solver without r: a row per level on which it ended, with the guaranteed bounds there; of the spectral
/// solver one row, without a grid.
fn table_of_levels(levels: &[LevelNumbers]) -> Table {
    let head = ["grid", "iterations", "stop", "energy"];
    let bounds = ["energy_lower", "energy_upper", "error_bound", "error_relative", "kkt_relative"];
    let mut table = Table::new(head.into_iter().chain(bounds).map(str::to_owned), &[]);
    for level in levels {
        let mut row = vec![level.label(), level.iterations.to_string(), level.stop.clone()];
        let bracket = [level.energy, level.energy_lower, level.energy_upper];
        let errors = [level.error_bound, level.error_relative, level.kkt.relative];
        row.extend(bracket.into_iter().chain(errors).map(|x| x.map_or(String::new(), decimal)));
        table.rows.push(row);
    }
    table
}

/// Returns a table without the columns on the ends of runs, and a line for each kind of them.
fn without_ends(table: &Table) -> (Table, String) {
    let mut note = String::new();
    for (word, end) in ENDS {
        let grids = table.head.iter().filter_map(|column| column.strip_prefix(word));
        let grids: Vec<&str> = grids.collect();
        if !grids.is_empty() {
            note += &format!("{end} in some runs on {}\n", grids.join(", "));
        }
    }
    (table.with_columns(|column| !ENDS.iter().any(|(word, _)| column.starts_with(word))), note)
}

/// Computed row of a table, from a solve with this r.
pub(super) fn row(r: f64, levels: &[LevelNumbers]) -> Row {
    let own_stops = levels.iter().map(|level| level.own_stop);
    Row {
        r,
        counts: levels.iter().map(|level| level.iterations).collect(),
        capped: own_stops.map(|stop| stop == Some(Stop::IterationLimit)).collect(),
        delta_a: levels.last().and_then(|finest| finest.delta_a).unwrap_or(f64::NAN),
    }
}

/// Table in the paper's layout: a row per rule and r, a column of counts per grid (`1/4`, `1/8`, ..., or `25 nodes`,
/// ...), and `delta_a`.
///
/// If `max_iterations` cut off a count on a grid, a column `capped 1/4` marks those counts; if an iteration on a grid
/// ended without a solution of the discrete problem, a column `stop 1/4` holds the ends. Where it diverged, counts on
/// finer grids are empty.
fn table(runs: &[SaddleSettings], levels: &[Vec<LevelNumbers>]) -> Table {
    let rows: Vec<Row> = runs.iter().zip(levels).map(|(run, of)| row(run.r, of)).collect();
    // A run that diverged has no finer levels.
    let grids = levels.iter().max_by_key(|of| of.len()).into_iter().flatten();
    let grids: Vec<String> = grids.map(LevelNumbers::label).collect();
    let (mut capped, mut stopped) = (Vec::new(), Vec::new());
    for level in 0..grids.len() {
        if rows.iter().any(|row| row.is_capped(level)) {
            capped.push(level);
        }
        if levels.iter().filter_map(|of| of.get(level)).any(LevelNumbers::is_no_solution) {
            stopped.push(level);
        }
    }
    let named = |name: &str, levels: &[usize]| -> Vec<String> {
        levels.iter().map(|&level| format!("{name} {}", grids[level])).collect()
    };
    let keys = [RULE, "r"].map(str::to_owned);
    let counts_and_change = [&keys[..], &grids, &["delta_a".to_owned()]].concat();
    let marks = [named("capped", &capped), named("stop", &stopped)].concat();
    let mut table = Table::new(counts_and_change.into_iter().chain(marks), &[]);
    for ((run, row), levels) in runs.iter().zip(&rows).zip(levels) {
        let mut cells = vec![run.stop.to_string(), decimal(row.r)];
        cells.extend(row.counts.iter().map(usize::to_string));
        cells.resize(2 + grids.len(), String::new());
        cells.push(if row.delta_a.is_nan() { String::new() } else { decimal(row.delta_a) });
        cells.extend(capped.iter().map(|&level| row.is_capped(level).to_string()));
        let stop = |level: &usize| levels.get(*level).map_or(String::new(), |of| of.stop.clone());
        cells.extend(stopped.iter().map(stop));
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
        let level = |cells, iterations, stop: &str, own_stop| LevelNumbers {
            cells: Some(cells),
            iterations,
            stop: stop.into(),
            own_stop: Some(own_stop),
            ..LevelNumbers::default()
        };
        let (met, limit) = (Stop::Converged, Stop::IterationLimit);
        let mut levels = [
            vec![level(4, 2, "diverged", Stop::Diverged)],
            vec![level(4, 1, "no-solution", met), level(8, 149, "converged", met)],
            vec![level(4, 3, "converged", met), level(8, 55, "iteration-limit", limit)],
        ];
        levels[1][1].delta_a = Some(1e-4 / 3.0);
        levels[2][1].delta_a = Some(3.53e-4);
        let runs = [(StopRule::Signed, 1e12), (StopRule::Signed, 1e6), (StopRule::Printed, 0.5)];
        let runs = runs.map(|(stop, r)| SaddleSettings { stop, r, ..SaddleSettings::default() });
        let csv = table(&runs, &levels).csv();
        expect_test::expect![[r"
            rule,r,1/4,1/8,delta_a,capped 1/8,stop 1/4
            signed,1000000000000.0,2,,,false,diverged
            signed,1000000.0,1,149,0.000033333333333333335,false,no-solution
            printed,0.5,3,55,0.000353,true,converged
        "]]
        .assert_eq(&csv);
        expect_test::expect![[r"
            r,1/4,1/8,delta_a,capped 1/8,stop 1/4
            0.5,3,55,0.000353,true,converged
        "]]
        .assert_eq(&under(&csv, StopRule::Printed));
    }

    #[test]
    fn a_page_has_few_digits_and_a_bracket_that_holds() {
        let head = ["grid", "energy_lower", "energy_upper", "error_bound", "stop"];
        let mut table = Table::new(head, &[]);
        table.rows = vec![
            ["1/4", "-0.12345678901234", "-0.1234567812345", "0.012345678", "converged"]
                .map(str::to_owned)
                .into(),
            ["1/8", "", "", "", "not-solved"].map(str::to_owned).into(),
        ];
        expect_test::expect![[r"
            | grid | energy_lower | energy_upper | error_bound | stop |
            |---:|---:|---:|---:|---:|
            | 1/4 | -0.1234567891 | -0.1234567812 | 0.0123457 | converged |
            | 1/8 |  |  |  | not-solved |
        "]]
        .assert_eq(&with_few_digits(&table, 0, |_| true).markdown(in_markdown));
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
