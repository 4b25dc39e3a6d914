//! `identify`: the search for the right-hand sides of Figure 1.

mod args;
mod table;
mod watch;

use super::interrupt::{at_work, interrupted};
use super::output::{say_json, tell};
use super::project_root;
use crate::pipeline::error::{Error, Result};
use crate::replication::project::Project;
pub(super) use args::{EXAMPLES, IdentifyArgs};
use args::{Published, Search};
use serde::Serialize;
use signorini_mathematics::identify::{
    Evaluator, Found, Geometry, IdentifyError, SearchReport, Variant, found, search,
};
use std::time::Instant;
use watch::Watch;

/// Results for one table.
#[derive(Debug, Serialize)]
struct Answer {
    problem: u8,
    /// The f on record, run again.
    recorded: Vec<Found>,
    #[serde(flatten)]
    report: SearchReport,
    seconds: f64,
}

/// Results of the search under one reading of the method.
#[derive(Debug, Serialize)]
struct Reading {
    variant: Variant,
    description: String,
    /// In the order of the tables.
    searches: Vec<SearchReport>,
}

pub(super) fn identify(args: &IdentifyArgs) -> Result<u8> {
    let project = Project::read(project_root()?)?;
    // A search takes long: better in a project without mistakes.
    project.select(&[])?;
    let asked = Search::read(args, &project)?;
    // However it is interrupted, what was found is shown.
    let _at_work = at_work();
    let answer = || if args.variants { compare(args, &asked) } else { find(args, &asked) };
    match &asked.pool {
        Some(pool) => pool.install(answer)?,
        None => answer()?,
    }
    match interrupted().is_asked() {
        true => Ok(Error::Interrupted.exit_code()),
        false => Ok(0),
    }
}

/// Runs the f on record and searches, for each table in turn, and shows what was found.
fn find(args: &IdentifyArgs, asked: &Search) -> Result<()> {
    let mut answers = Vec::new();
    for table in &asked.tables {
        if interrupted().is_asked() {
            break;
        }
        let recorded = verify(table)?;
        let (began, name) = (Instant::now(), format!("problem {}", table.number));
        let report = searched(asked, table, &Variant::default(), &mut Watch::new(&name))?;
        let seconds = began.elapsed().as_secs_f64();
        answers.push(Answer { problem: table.number, recorded, report, seconds });
    }
    if args.json {
        say_json(&serde_json::json!({ "schema": 1, "problems": answers }))?;
    } else {
        let parts: Vec<_> = answers.iter().map(table::found).collect();
        tell(&(parts.join("\n") + table::LEGEND))?;
    }
    Ok(())
}

/// Runs the f that are on record for a table.
fn verify(table: &Published) -> Result<Vec<Found>> {
    let quadrants = [Geometry::quadrants()];
    let evaluator = Evaluator::new(&table.target, &Variant::default(), &quadrants);
    let mut evaluator = evaluator.map_err(refused)?;
    let recorded = table.recorded.iter();
    Ok(recorded.map(|values| found(&mut evaluator, 0, &quadrants[0], values)).collect())
}

fn searched(
    asked: &Search,
    table: &Published,
    variant: &Variant,
    watch: &mut Watch,
) -> Result<SearchReport> {
    let mut observe = |share: f64, report: &SearchReport| watch.show(share, report);
    let report = search(&asked.lattice, variant, &table.target, interrupted().flag(), &mut observe);
    watch.end();
    report.map_err(refused)
}

/// Repeats the search under each reading of the method, and shows how far it comes in each.
fn compare(args: &IdentifyArgs, asked: &Search) -> Result<()> {
    let mut readings = Vec::new();
    for variant in Variant::neighbours() {
        let description = variant.to_string();
        let mut searches = Vec::new();
        for table in &asked.tables {
            if interrupted().is_asked() {
                break;
            }
            let mut watch = Watch::new(&format!("problem {}, {description}", table.number));
            searches.push(searched(asked, table, &variant, &mut watch)?);
        }
        if searches.len() == asked.tables.len() {
            readings.push(Reading { variant, description, searches });
        }
    }
    let numbers: Vec<u8> = asked.tables.iter().map(|table| table.number).collect();
    if args.json {
        say_json(&serde_json::json!({ "schema": 1, "problems": numbers, "readings": readings }))?;
    } else {
        tell(&table::readings(&readings, &numbers))?;
    }
    Ok(())
}

fn refused(error: IdentifyError) -> Error {
    Error::input(error.to_string())
}
