//! `identify`: the search for the right-hand sides of Figure 1.

mod args;
mod table;
mod watch;

use super::current_folder;
use super::interrupt::interrupted;
use super::output::{say, say_json};
use crate::pipeline::error::{Error, Result};
use crate::replication::project::Project;
use args::Search;
pub(super) use args::{EXAMPLES, IdentifyArgs};
use serde::Serialize;
use signorini_mathematics::identify::{
    Found, IdentifyError, Request, SearchProgress, SearchReport, Target, Variant, search,
};
use std::sync::atomic::Ordering;
use watch::Watch;

/// Result of the search for one table, and its speed.
#[derive(Debug, Serialize)]
struct Answer {
    problem: u8,
    #[serde(skip)]
    target: Target,
    #[serde(flatten)]
    report: SearchReport,
    seconds: f64,
    /// Runs per second that entered each grid.
    rates: Vec<f64>,
}

/// Best candidate for each table under one reading of the method.
#[derive(Debug, Serialize)]
struct Selection {
    variant: Variant,
    description: String,
    /// In the order of the tables; `None` if the search was stopped before it had one.
    best: Vec<Option<Found>>,
    tried: u64,
}

impl Selection {
    /// Sum of the objectives: one reading must explain all tables.
    fn total(&self) -> f64 {
        let mut total = 0.0;
        for best in &self.best {
            total += best.as_ref().map_or(f64::INFINITY, |found| found.score.total());
        }
        total
    }
}

pub(super) fn identify(args: &IdentifyArgs) -> Result<u8> {
    let project = Project::read(Project::find(&current_folder()?)?)?;
    // A search takes long: better in a project without mistakes.
    project.select(&[])?;
    let asked = Search::read(args, &project)?;
    let answer = || if args.variants { compare(args, &asked) } else { find(args, &asked) };
    match &asked.pool {
        Some(pool) => pool.install(answer)?,
        None => answer()?,
    }
    match interrupted().load(Ordering::Relaxed) {
        true => Ok(Error::Interrupted.exit_code()),
        false => Ok(0),
    }
}

/// Searches for each table in turn, and shows what was found.
fn find(args: &IdentifyArgs, asked: &Search) -> Result<()> {
    let mut answers = Vec::new();
    for (problem, target) in &asked.tables {
        if interrupted().load(Ordering::Relaxed) {
            break;
        }
        let mut watch = Watch::new(&format!("problem {problem}"));
        let mut observe = |progress: &SearchProgress| watch.show(progress);
        let report = search(&asked.request, target, interrupted(), &mut observe);
        watch.end();
        let report = report.map_err(|e| refused(&e))?;
        let (seconds, rates) = watch.rates();
        answers.push(Answer { problem: *problem, target: target.clone(), report, seconds, rates });
    }
    if args.json {
        say_json(&serde_json::json!({ "schema": 1, "problems": answers }))?;
    } else {
        let parts: Vec<_> = answers.iter().map(table::found).collect();
        say(&(parts.join("\n") + table::LEGEND))?;
    }
    Ok(())
}

/// Repeats the search under each reading of the method, and shows the best of each, the best reading first.
fn compare(args: &IdentifyArgs, asked: &Search) -> Result<()> {
    let variants = Variant::neighbours();
    let mut watch = Watch::new("variants");
    let mut all = Vec::new();
    for (done, &variant) in variants.iter().enumerate() {
        if interrupted().load(Ordering::Relaxed) {
            break;
        }
        let selection = select(asked, variant)?;
        let line = table::one_line(&selection);
        watch.line(&format!("{}/{}: {line}", done + 1, variants.len()));
        all.push(selection);
    }
    watch.end();
    all.sort_by(|a, b| a.total().total_cmp(&b.total()));
    let numbers: Vec<u8> = asked.tables.iter().map(|(number, _)| *number).collect();
    if args.json {
        say_json(&serde_json::json!({
            "schema": 1, "problems": numbers, "request": asked.request, "selection": all,
        }))?;
    } else {
        say(&table::selection(&all, &numbers))?;
    }
    Ok(())
}

/// Searches for each table under one reading of the method.
fn select(asked: &Search, variant: Variant) -> Result<Selection> {
    let request = Request { variant, top: 1, ..asked.request.clone() };
    let (mut best, mut tried) = (Vec::new(), 0);
    for (_, target) in &asked.tables {
        let report =
            search(&request, target, interrupted(), &mut |_| ()).map_err(|e| refused(&e))?;
        tried += report.tried;
        best.push(report.found.into_iter().next());
    }
    Ok(Selection { variant, description: variant.to_string(), best, tried })
}

/// Error of a search, with the option that it is about.
fn refused(error: &IdentifyError) -> Error {
    let option = match error {
        IdentifyError::EmptyLattice(_)
        | IdentifyError::LargeLattice(_)
        | IdentifyError::Values(_)
        | IdentifyError::ValueCount { .. }
        | IdentifyError::TooMany => "--values: ",
        _ => "",
    };
    Error::input(format!("{option}{error}"))
}
