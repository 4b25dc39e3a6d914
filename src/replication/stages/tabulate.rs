//! The `tabulate` stage: the table of a scene, in CSV, Markdown and LaTeX.
//!
//! Central is [`task`]; [`remarks`] says on the terminal what stands below a table.

use super::from_json;
use super::members::{id_of, ids};
use super::solve::NUMBERS;
use crate::pipeline::{Artifacts, Inputs, Made, Task};
use crate::replication::columns::{in_words, shown};
use crate::replication::comparison::Row;
use crate::replication::fields::member::Member;
use crate::replication::numbers::Numbers;
use crate::replication::record::levels::LevelNumbers;
use crate::replication::scene::Scene;
use crate::replication::study::Study;
use crate::table::{Table, in_markdown};
use serde::{Deserialize, Serialize};
use signorini_mathematics::discrete::end::Stop;
use signorini_mathematics::problem::text::interval;
use signorini_mathematics::saddle::StopRule;
use signorini_mathematics::statement::{Domain, Statement};

/// Folder of the tables in the project.
pub(crate) const FOLDER: &str = "report/tables";
/// First column of the table of a saddle-point method.
const RULE: &str = "rule";
/// Columns of the table of a solver without r that a page has room for.
const USUAL: [&str; 6] = ["grid", "iterations", "stop", "energy", "error_relative", "kkt_relative"];
/// First words of the columns on the ends of runs of a saddle-point method, each in words.
const ENDS: [(&str, &str); 2] =
    [("capped ", "the limit on iterations"), ("stop ", "no solution of the discrete problem")];
/// Most reasons, and most warnings, that stand below a table, and that a run tells of a scene.
const MOST_REMARKS: usize = 3;
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
fn files(name: &str, table: &Table, shown: &Table, note: &[String]) -> Artifacts {
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
    for line in note {
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
fn with_few_digits(table: &Table, given: usize, is_true: impl Fn(usize) -> bool) -> Table {
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

/// Table of a scene, whose rows are its members, or the levels of the only one.
#[derive(Serialize, Deserialize)]
struct Tabulated {
    /// Name of the scene.
    name: String,
    /// Members, without a chart.
    study: Study,
    /// Tasks that solve the members.
    tasks: Vec<String>,
    form: TableForm,
    /// True for a published table, whose warnings the book explains.
    is_papers: bool,
}

/// TableForm of the table of a scene.
#[derive(Clone, Copy, Serialize, Deserialize)]
enum TableForm {
    /// A row for each member with all its numbers.
    Members,
    /// The paper's form: a row for each rule and r with the counts on all grids.
    Counts,
    /// A row for each level.
    Levels,
}

pub(crate) fn task(scene: &Scene) -> Task {
    let tasks: Vec<String> = ids(scene).collect();
    let form = match scene.first_rule() {
        _ if scene.is_study => TableForm::Members,
        Some(_) => TableForm::Counts,
        None => TableForm::Levels,
    };
    let mut study = Study { chart: None, ..scene.study.clone() };
    // A table of counts or levels shows the rule and r of a member alone, and is not made anew for another f.
    for member in study.members.iter_mut().filter(|_| !scene.is_study) {
        let saddle = member.rule_and_r();
        *member = Statement { saddle, ..Statement::usual(Domain::square(), "") }.into();
    }
    let tabulated = Tabulated {
        name: scene.name.clone(),
        study,
        tasks: tasks.clone(),
        form,
        is_papers: scene.paper_table.is_some(),
    };
    Task::new(id(scene), &tabulated, tasks, Tabulated::made).exported_to(FOLDER)
}

impl Tabulated {
    fn made(&self, inputs: &Inputs) -> Made {
        let study = &self.study;
        let all = self.tasks.iter().map(|task| from_json(inputs, task, NUMBERS));
        let all = all.collect::<Result<Vec<Numbers>, _>>()?;
        let (table, given) = match self.form {
            TableForm::Members => (study.table(&all), study.names.len()),
            // The rule and r are as they are given.
            TableForm::Counts => (table_of_counts(&study.members, &all), 2),
            TableForm::Levels => (table_of_levels(&all[0].levels()), 0),
        };
        let counted = Study::counted(&table, &all);
        // All levels are of one member.
        let is_true = |row: usize| all[row.min(all.len() - 1)].has_true_energy();
        let few = with_few_digits(&counted, given, is_true);
        let (shown, mut note) = match self.form {
            TableForm::Members => (study.page(&few, &all), Vec::new()),
            TableForm::Counts => without_ends(&few),
            TableForm::Levels => (few.with_columns(|column| USUAL.contains(&column)), Vec::new()),
        };
        if !self.is_papers {
            note.extend(study.remarks(study.members.iter().zip(&all), MOST_REMARKS));
        }
        Ok(files(&self.name, &table, &shown, &note))
    }
}

/// Returns lines on the members of a scene after a run: those without a solution, and warnings; `artifact` reads the
/// [`NUMBERS`] of a task, or returns `None` for a task that is not concerned.
pub(crate) fn remarks(scene: &Scene, artifact: impl Fn(&str) -> Option<Vec<u8>>) -> Vec<String> {
    let mut found: Vec<(&Member, Numbers)> = Vec::new();
    for member in &scene.study.members {
        let numbers = artifact(&id_of(scene, member));
        let numbers = numbers.and_then(|bytes| serde_json::from_slice(&bytes).ok());
        found.extend(numbers.map(|numbers| (member, numbers)));
    }
    let found = found.iter().map(|(member, numbers)| (*member, numbers));
    let lines = scene.study.remarks(found, MOST_REMARKS).into_iter();
    lines.map(|line| format!("{}: {line}", scene.name)).collect()
}

/// Table of a solver without r: a row per level on which it ended, with the guaranteed bounds there; of the spectral
/// solver one row, without a grid.
fn table_of_levels(levels: &[LevelNumbers]) -> Table {
    let head = ["grid", "iterations", "stop", "energy"];
    let bounds = ["energy_lower", "energy_upper", "error_bound", "error_relative", "kkt_relative"];
    let mut table = Table::new(head.into_iter().chain(bounds).map(str::to_owned), &[]);
    for level in levels {
        let mut row = vec![level.label(), level.count().to_string(), level.end().to_owned()];
        let bracket = [level.energy, level.energy_lower, level.energy_upper];
        let kkt = level.kkt.as_ref().and_then(|kkt| kkt.relative);
        let errors = [level.error_bound, level.error_relative, kkt];
        row.extend(bracket.into_iter().chain(errors).map(|x| x.map_or(String::new(), decimal)));
        table.rows.push(row);
    }
    table
}

/// Returns a table without the columns on the ends of runs, and a line for each kind of them.
fn without_ends(table: &Table) -> (Table, Vec<String>) {
    let mut note = Vec::new();
    for (word, end) in ENDS {
        let grids = table.head.iter().filter_map(|column| column.strip_prefix(word));
        let grids: Vec<&str> = grids.collect();
        if !grids.is_empty() {
            note.push(format!("{end} in some runs on {}", grids.join(", ")));
        }
    }
    (table.with_columns(|column| !ENDS.iter().any(|(word, _)| column.starts_with(word))), note)
}

/// Computed row of a table, from a solve with this r.
pub(super) fn row(r: f64, levels: &[LevelNumbers]) -> Row {
    let own_stops = levels.iter().map(|level| level.own_stop);
    Row {
        r,
        counts: levels.iter().map(LevelNumbers::count).collect(),
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
fn table_of_counts(members: &[Member], all: &[Numbers]) -> Table {
    let levels: Vec<_> = all.iter().map(Numbers::levels).collect();
    let settings: Vec<_> = members.iter().filter_map(|member| member.statement.saddle).collect();
    let rows: Vec<Row> =
        settings.iter().zip(&levels).map(|(of, levels)| row(of.r, levels)).collect();
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
    let marks = [("capped", &capped), ("stop", &stopped)];
    let marks = marks.into_iter().flat_map(|(name, of)| {
        of.iter().map(|&level| format!("{name} {}", grids[level])).collect::<Vec<_>>()
    });
    let head = [RULE, "r"].map(str::to_owned).into_iter().chain(grids.clone());
    let mut table = Table::new(head.chain(["delta_a".to_owned()]).chain(marks), &[]);
    for ((of, row), levels) in settings.iter().zip(&rows).zip(&levels) {
        let mut cells = vec![of.stop.to_string(), decimal(row.r)];
        cells.extend(row.counts.iter().map(usize::to_string));
        cells.resize(2 + grids.len(), String::new());
        cells.push(if row.delta_a.is_nan() { String::new() } else { decimal(row.delta_a) });
        cells.extend(capped.iter().map(|&level| row.is_capped(level).to_string()));
        let ends = stopped.iter().map(|&level| levels.get(level).map_or("", LevelNumbers::end));
        cells.extend(ends.map(str::to_owned));
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
    use signorini_mathematics::solvers::SaddleSettings;

    #[test]
    fn a_table_has_all_digits_and_says_what_was_cut_off() {
        let level = |cells, iterations, stop: &str, own_stop| LevelNumbers {
            cells: Some(cells),
            iterations: Some(iterations),
            stop: Some(stop.into()),
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
        let members = runs.map(|(stop, r)| {
            let saddle = Some(SaddleSettings { stop, r, ..SaddleSettings::default() });
            Member::from(Statement { saddle, ..Statement::usual(Domain::square(), "else=-1") })
        });
        let numbers = levels.map(|levels| Numbers {
            details: [("grids".to_owned(), serde_json::json!(levels))].into_iter().collect(),
            ..Numbers::default()
        });
        let csv = table_of_counts(&members, &numbers).csv();
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
