//! `bench`: how long the members of a study take on this machine.

use super::interrupt::{at_work, interrupted};
use super::output::{in_columns, say, say_json, talk};
use super::solve::study::checked_csv;
use crate::pipeline::InputFiles;
use crate::pipeline::error::{Error, Result};
use crate::replication::fields::table::Voice;
use crate::replication::mesh_files::path_of;
use crate::replication::numbers::Numbers;
use crate::replication::scene::Scene;
use crate::replication::stages::solve::numbers;
use crate::replication::study::Study;
use crate::table::Table;
use crate::timing::median::{MedianTime, time};
use crate::timing::recorded::Machine;
use clap::Args;
use serde_json::{Map, Value, json};
use signorini_mathematics::levels::Problem;
use signorini_mathematics::problem::text::plain;
use signorini_mathematics::solvers::Memory;
use signorini_mathematics::statement::Statement;
use std::hint::black_box;
use std::path::PathBuf;

#[derive(Args)]
pub(super) struct BenchArgs {
    /// A scene that varies something [default: race]
    scene: Option<String>,
    /// Runs per median, fewer where they take long [default: 9]
    #[arg(long, value_name = "N")]
    repeats: Option<usize>,
    /// Print JSON
    #[arg(long)]
    json: bool,
    /// Write the table with all columns and digits
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
}

/// Study that is timed if no other is named, also without a project.
const RACE: &str = include_str!("../../pipeline/scenes/race.toml");
/// Columns of the times: the median of the solve alone, and the distance of the quartiles over it.
const TIMES: [&str; 2] = ["seconds", "spread"];

/// A member with its numbers and its time; no time without a solver that has run.
type Timed = (Numbers, Option<MedianTime>);

pub(super) fn bench(args: &BenchArgs) -> Result<u8> {
    let repeats = args.repeats.unwrap_or(9);
    if repeats == 0 {
        return Err(Error::input("--repeats 0: give at least 1"));
    }
    let file = args.csv.as_deref().map(checked_csv).transpose()?;
    let scene = match &args.scene {
        Some(name) => super::scene(name)?,
        None => super::scene("race").or_else(|_| Scene::parse("race", RACE))?,
    };
    if !scene.is_study {
        let text =
            format!("scene `{}` varies nothing; add `vary` to it, or name another", scene.name);
        return Err(Error::input(text));
    }
    let machine = Machine::here(repeats);
    if let Some(warning) = machine.busy() {
        talk(&warning);
    }
    let (study, timed) = measured(scene.study.clone(), &scene.files, repeats)?;
    if args.json {
        say_json(&json!({ "machine": machine, "rows": rows(&study, &timed) }))?;
    } else {
        let Machine { cpu, cores, caches, os, rustc, load, .. } = &machine;
        let head = format!("{cpu}, {cores} cores, {caches}\n{os}; {rustc}; load average {load}\n");
        say(&(head + &in_columns(&shown(&study, &timed))))?;
    }
    if let Some(file) = file {
        file.write(table(&study, &timed).csv().as_bytes())?;
        talk(&format!("wrote {}", file.path().display()));
    }
    if interrupted().is_asked() {
        talk("interrupted: these are the times measured until then");
        return Ok(Error::Interrupted.exit_code());
    }
    Ok(0)
}

/// Solves and times the members one after the other; after an interrupt, the study has those that were timed.
fn measured(mut study: Study, files: &InputFiles, repeats: usize) -> Result<(Study, Vec<Timed>)> {
    let (_at_work, interrupt) = (at_work(), interrupted());
    let mut timed = Vec::new();
    for member in &study.members {
        if interrupt.is_asked() {
            break;
        }
        let numbers = match numbers((&member.statement, Voice::Keys), files, interrupt.flag()) {
            Err(Error::Interrupted) => break,
            numbers => numbers?,
        };
        let path = path_of(&member.statement.domain);
        let file = path.and_then(|path| files.get(&path)).map(|file| file.bytes()).transpose()?;
        timed.push((numbers, median(&member.statement, file, repeats)));
    }
    study.members.truncate(timed.len());
    Ok((study, timed))
}

/// Times a solve, with mesh and load vector made before; of an accuracy, with all meshes on the way to it. None where
/// there is nothing to be solved.
fn median(statement: &Statement, file: Option<&[u8]>, repeats: usize) -> Option<MedianTime> {
    if statement.accuracy().is_some() {
        statement.solved(file).ok()?;
        return Some(time(repeats, || _ = black_box(statement.solved(file).is_ok())));
    }
    let problem = statement.problem(statement.mesh(file).ok()?.as_ref(), &|_| ()).ok()?;
    is_solved(statement, &problem)
        .then(|| time(repeats, || _ = black_box(is_solved(statement, &problem))))
}

/// True if the solver of a statement solves its problem.
fn is_solved(statement: &Statement, problem: &Problem) -> bool {
    statement.solve(problem.clone(), Memory::new(None), &mut (), &|_| ()).is_ok()
}

/// Table with all columns and digits.
fn table(study: &Study, timed: &[Timed]) -> Table {
    let all: Vec<Numbers> = timed.iter().map(|(numbers, _)| numbers.clone()).collect();
    let mut table = Study { columns: Vec::new(), ..study.clone() }.table(&all);
    table.head.extend(TIMES.map(String::from));
    for (row, (_, time)) in table.rows.iter_mut().zip(timed) {
        let time = time.as_ref().map(|time| [time.seconds, time.spread]);
        row.extend(time.map_or([const { String::new() }; 2], |time| time.map(|x| x.to_string())));
    }
    table
}

/// Table of what varies, of the columns of the scene, and of the times, with few digits.
fn shown(study: &Study, timed: &[Timed]) -> Table {
    let mut table = table(study, timed);
    for cell in table.rows.iter_mut().flat_map(|row| &mut row[study.names.len()..]) {
        if let Ok(number) = cell.parse::<f64>() {
            *cell = plain(number, 3);
        }
    }
    table.with_columns(|column| study.shows(column) || TIMES.contains(&column))
}

/// Rows of JSON.
fn rows(study: &Study, timed: &[Timed]) -> Vec<Map<String, Value>> {
    let all: Vec<Numbers> = timed.iter().map(|(numbers, _)| numbers.clone()).collect();
    let mut rows = study.rows(&all);
    for (row, (_, time)) in rows.iter_mut().zip(timed) {
        let time = time.as_ref().map(|time| [time.seconds, time.spread]);
        for (k, name) in TIMES.iter().enumerate() {
            row.insert((*name).into(), json!(time.map(|time| time[k])));
        }
    }
    rows
}
