//! `bench`: run times of every solver on this machine; `--record` keeps them for the book.

use super::interrupt::{at_work, interrupted};
use super::output::{OutputFile, in_columns, say, say_json, talk};
use super::project_root;
use crate::pipeline::error::{Error, Result};
use crate::pipeline::files::read_if_there;
use crate::replication::fields::values::solver_parser;
use crate::replication::project::{Project, refuse_broken};
use crate::replication::scene::Scene;
use crate::replication::scenes::named_f;
use crate::table::Table;
use crate::timing::measure::{TimingPlan, measure, threads};
use crate::timing::recorded::{self, TABLES, Timings, number, text};

use clap::Args;
use serde_json::Value;
use signorini_mathematics::experiments::timed::TimedPlan;
use signorini_mathematics::experiments::{Row, Rows};
use signorini_mathematics::problem::text::plain;
use signorini_mathematics::solvers::{SOLVERS, Solver};
use std::collections::BTreeMap;
use std::sync::atomic::Ordering;

#[derive(Args)]
pub(super) struct BenchArgs {
    /// Print JSON
    #[arg(long)]
    json: bool,
    /// Coarse grids only: a few seconds, to see that it works
    #[arg(long)]
    quick: bool,
    /// Write pipeline/timings.toml, from which the book takes its times
    #[arg(long, conflicts_with_all = ["quick", "solver"])]
    record: bool,
    /// Runs per median [default: 9, with --quick 3]
    #[arg(long, value_name = "N")]
    repeats: Option<usize>,
    /// Only these solvers [default: all]
    #[arg(long, value_parser = solver_parser())]
    solver: Vec<Solver>,
    /// Cells per side of the finest grid, a power of two [default: 4096, with --quick 128]
    #[arg(long, value_name = "N")]
    finest: Option<usize>,
}

/// Finest grid of a run: 2 GB for the load vector and multigrid.
const FINEST: usize = 8192;

/// Scenes of the paper's problems, for a project without, by name.
const PAPER: [(&str, &str); 2] = [
    ("problem1", include_str!("../../pipeline/scenes/problem1.toml")),
    ("problem2", include_str!("../../pipeline/scenes/problem2.toml")),
];

pub(super) fn bench(args: &BenchArgs) -> Result<u8> {
    let repeats = args.repeats.unwrap_or(if args.quick { 3 } else { 9 });
    let finest = args.finest.unwrap_or(if args.quick { 128 } else { 4096 });
    if repeats == 0 {
        return Err(Error::input("--repeats 0: give at least 1"));
    }
    if !finest.is_power_of_two() || !(16..=FINEST).contains(&finest) {
        return Err(Error::input(format!(
            "--finest {finest}: give a power of two from 16 to {FINEST}, such as 1024"
        )));
    }
    let mut solvers = args.solver.clone();
    if solvers.is_empty() {
        solvers.extend(SOLVERS.map(|entry| entry.solver));
    }
    // However it is interrupted, the times measured until then are printed.
    let _at_work = at_work();
    let (problems, threads) = (paper_problems()?, threads());
    let timed = TimedPlan { solvers, finest, quick: args.quick, threads, problems };
    let plan = TimingPlan { timed, repeats, interrupted: interrupted().flag() };
    // Before the measurement, because an error after it would waste minutes.
    let record = args.record.then(RecordFile::open).transpose()?;
    let mut timings = measure(&plan, talk)?;
    if let Some(record) = &record {
        timings.peer.clone_from(&record.peers);
        timings.own_mesh.clone_from(&record.own_meshes);
    }
    if args.json { say_json(&timings) } else { say(&in_words(&timings)) }?;
    if plan.interrupted.load(Ordering::Relaxed) {
        let record = if args.record { "; nothing was recorded" } else { "" };
        talk(&format!("interrupted: these are the times measured until then{record}"));
        return Ok(Error::Interrupted.exit_code());
    }
    if let Some(record) = record {
        record.file.write(timings.to_toml().as_bytes())?;
        talk(&format!("wrote {}; `signorini` now builds the book with it", recorded::PATH));
    }
    Ok(0)
}

/// Returns names and f of the paper's problems, by the scenes of the project; of those that it lacks, or without a
/// project, by the scenes that the program contains.
fn paper_problems() -> Result<Vec<(String, String)>> {
    let mut own = Vec::new();
    if let Ok(root) = project_root() {
        let folder = Project::read_scenes(&root)?;
        refuse_broken(&folder.broken)?;
        own = folder.scenes;
    }
    for (name, text) in PAPER {
        own.push(Scene::parse(name, text)?);
    }
    // Of each problem the first.
    let mut scenes: Vec<Scene> = Vec::new();
    for scene in own {
        if scenes.iter().all(|other| other.paper_table != scene.paper_table) {
            scenes.push(scene);
        }
    }
    Ok(named_f(&scenes))
}

/// Record of times to be replaced.
struct RecordFile {
    file: OutputFile,
    /// Parts of the earlier record that are kept.
    peers: Rows,
    own_meshes: Rows,
}

impl RecordFile {
    fn open() -> Result<Self> {
        let root = project_root()?;
        let path = root.join(recorded::PATH);
        let (peers, own_meshes) = match read_if_there(&path)? {
            Some(text) => {
                let Timings { peer, own_mesh, .. } = Timings::parse(text)?;
                (peer, own_mesh)
            }
            None => Default::default(),
        };
        Ok(Self { file: OutputFile::own(&root, recorded::PATH)?, peers, own_meshes })
    }
}

fn in_words(timings: &Timings) -> String {
    let timings = &timings.extended();
    let Timings { machine, bandwidth, .. } = timings;
    let mut text = format!(
        "{}, {} cores, {}\n{}\n{}; load average {}\n",
        machine.cpu, machine.cores, machine.caches, machine.os, machine.rustc, machine.load
    );
    text += "spread: distance of the quartiles of a time over its median\n";
    text += &format!("memory, one thread: in-place update {bandwidth:.1} GB/s\n");
    for (rows, (table, columns)) in timings.tables().into_iter().zip(TABLES) {
        if !rows.is_empty() {
            text += &format!("\n{table}\n{}", shown(rows, columns));
        }
    }
    text + &summary(timings)
}

/// Returns these columns of a table of the record, parted by blanks.
fn shown(rows: &Rows, columns: &str) -> String {
    let columns: Vec<&str> = columns.split(' ').collect();
    let is_text =
        |column: &str| rows.iter().any(|row| row.get(column).is_some_and(Value::is_string));
    let left: Vec<usize> = (0..columns.len()).filter(|&k| is_text(columns[k])).collect();
    let mut table = Table::new(columns.iter().copied(), &left);
    for row in rows.iter() {
        let values = columns.iter().map(|column| match row.get(*column).unwrap_or(&Value::Null) {
            Value::String(text) => text.clone(),
            number if number.is_f64() => plain(number.as_f64().unwrap_or_default(), 3),
            other => other.to_string(),
        });
        table.rows.push(values.collect());
    }
    in_columns(&table)
}

/// Problems on which solvers on grids were timed, in their order.
fn problems(timings: &Timings) -> Vec<&str> {
    timings.solver.texts("problem").unwrap_or_default()
}

/// Returns for each problem the factors by which the fastest solver is faster than the others on the finest grid that
/// all of them solved to the discretisation error: each in its fastest run.
fn summary(timings: &Timings) -> String {
    let mut all = String::new();
    for problem in problems(timings) {
        let Some(fastest) = fastest_on_common_grid(timings, problem) else { continue };
        let [first, others @ ..] = &fastest[..] else { continue };
        all += &format!(
            "\n{}, grid 1/{}: {} took {} s to the discretisation error\n",
            text(first, "problem"),
            first["cells"],
            text(first, "solver"),
            plain(number(first, "seconds"), 3)
        );
        for other in others {
            let ratio = number(other, "seconds") / number(first, "seconds");
            // Quartiles of a quotient, as if both times were off by half the distance of their quartiles.
            let spread = 0.5 * ratio * (number(first, "spread") + number(other, "spread"));
            let solver = text(other, "solver");
            all += &format!("{ratio:8.1} +- {spread:.1} times faster than {solver}\n");
        }
    }
    all
}

/// Returns the fastest run of each solver on the finest grid that all solvers solved, fastest first; none without such
/// a grid.
fn fastest_on_common_grid<'a>(timings: &'a Timings, problem: &str) -> Option<Vec<&'a Row>> {
    let mut by_grid: Vec<BTreeMap<u64, &Row>> = Vec::new();
    for solver in Solver::on_grids() {
        let mut fastest = BTreeMap::new();
        for row in timings.solver.iter().filter(|row| row["reached"] == true) {
            if row["solver"] == solver.entry().name && row["problem"] == problem {
                let known = fastest.entry(row["cells"].as_u64()?).or_insert(row);
                if number(row, "seconds") < number(known, "seconds") {
                    *known = row;
                }
            }
        }
        by_grid.push(fastest);
    }
    by_grid.retain(|runs| !runs.is_empty());
    let mut grids = by_grid.first()?.keys().rev();
    let grid = grids.find(|&grid| by_grid.iter().all(|runs| runs.contains_key(grid)))?;
    let mut fastest: Vec<_> = by_grid.iter().map(|runs| runs[grid]).collect();
    fastest.sort_by(|a, b| number(a, "seconds").total_cmp(&number(b, "seconds")));
    Some(fastest)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_without_lines_is_left_out() {
        let mut timings = Timings::parse(include_str!("../../pipeline/timings.toml")).unwrap();
        let row =
            r#"{ "problem": "a", "unknowns": 9, "error": 0.1, "seconds": 1.0, "spread": 0.1 }"#;
        timings.spectral = Rows(vec![serde_json::from_str(row).unwrap()]);
        assert_eq!(heads(&timings), [true; 3]);
        timings.multigrid = Rows::default();
        timings.solver = Rows::default();
        assert_eq!(heads(&timings), [false, false, true]);
        timings.spectral = Rows::default();
        assert_eq!(heads(&timings), [false; 3]);
    }

    #[test]
    fn the_summary_names_the_fastest_solver_of_each_problem_and_fits_the_terminal() {
        let timings = Timings::parse(include_str!("../../pipeline/timings.toml")).unwrap();
        let summary = summary(&timings.extended());
        assert!(summary.contains("multigrid took") && summary.contains(" times faster than "));
        // Tables leave out columns for which a terminal has no room.
        for line in summary.lines() {
            assert!(line.chars().count() <= 80, "{line}");
        }
    }

    /// Presence of the tables of multigrid, of the solvers on grids, and of the spectral solver.
    fn heads(timings: &Timings) -> [bool; 3] {
        let text = in_words(timings);
        ["multigrid", "solver", "spectral"].map(|table| text.contains(&format!("\n{table}\n")))
    }
}
