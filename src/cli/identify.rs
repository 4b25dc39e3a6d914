//! `identify`: the search for the right-hand sides of Figure 1, as the stage of that name makes it.

mod table;

use super::interrupt::{at_work, interrupted};
use super::output::{say_json, talk, tell};
use super::project_root;
use crate::pipeline::error::{Error, Result, from_record};
use crate::replication::identified::IdentifiedRecord;
use crate::replication::project::{IDENTIFIED, Project};
use clap::Args;
use serde::Serialize;
use signorini_mathematics::identify::{Found, SearchReport, Target, Variant};
use std::fmt::Display;

/// End of `identify --help`.
pub(super) const EXAMPLES: &str = "\
How it works: f takes one value on a quadrant, any of the four, and one elsewhere, decimals from the range \
`values` of pipeline/identified.toml, and every such f with a negative integral is tried, grid by grid: nearly \
all miss a count on the two coarsest, where a run costs microseconds.\n\n\
Before that, the f in pipeline/identified.toml are run. Found are at most twenty f with all counts: first \
those with the most values of Delta a to both printed digits, and of these those that are the shortest to \
write. The same range finds the same f whatever the threads.\n\n\
Exit codes: 0 done, 2 wrong input, 130 interrupted (what was found is shown).";

#[derive(Args, Debug)]
pub(super) struct IdentifyArgs {
    /// Repeat the search under every reading of the method that differs in one choice
    #[arg(long)]
    variants: bool,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

/// Published tables, and what is asked about them.
struct Search {
    /// Range of the values of f, `MIN:MAX:STEP`.
    values: String,
    tables: Vec<Published>,
}

/// A published table, and the f that are on record for it.
struct Published {
    number: u8,
    target: Target,
    /// By their values on the quadrants.
    recorded: Vec<[f64; 4]>,
}

/// Results for one table.
#[derive(Debug, Serialize)]
struct Answer {
    problem: u8,
    /// The f on record, run again.
    recorded: Vec<Found>,
    #[serde(flatten)]
    report: SearchReport,
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
    let search = Search::read(&Project::read(project_root()?)?)?;
    // However it is interrupted, what was found is shown.
    let _at_work = at_work();
    if args.variants {
        search.compare(args.json)?;
    } else {
        search.find(args.json)?;
    }
    match interrupted().is_asked() {
        true => Ok(Error::Interrupted.exit_code()),
        false => Ok(0),
    }
}

impl Search {
    /// Reads the tables of the paper, and the questions about them.
    fn read(project: &Project) -> Result<Self> {
        // A search takes long: better in a project without mistakes.
        project.select(&[])?;
        if project.paper.table.is_empty() {
            return Err(Error::input("no published table is in pipeline/paper.toml; add one"));
        }
        let Some(file) = project.files.get(IDENTIFIED) else {
            return Err(Error::input(format!("{IDENTIFIED} is not there; restore it")));
        };
        let record: IdentifiedRecord = from_record(IDENTIFIED, file.bytes()?)?;
        let mut tables = Vec::new();
        for number in project.paper.table.iter().map(|table| table.number) {
            let recorded = record.alternatives(number).to_vec();
            tables.push(Published { number, target: project.paper.target(number)?, recorded });
        }
        Ok(Self { values: record.questions.values, tables })
    }

    /// Runs the f on record and searches, for each table in turn, and shows what was found.
    fn find(&self, json: bool) -> Result<()> {
        let mut answers = Vec::new();
        for table in &self.tables {
            let recorded = table.target.found(&Variant::default(), &table.recorded);
            let recorded = recorded.map_err(refused)?;
            let report = self.searched(table, &Variant::default())?;
            answers.push(Answer { problem: table.number, recorded, report });
        }
        if json {
            return say_json(&serde_json::json!({ "schema": 1, "problems": answers })).map(drop);
        }
        let parts: Vec<_> = answers.iter().map(table::found).collect();
        tell(&(parts.join("\n") + table::LEGEND)).map(drop)
    }

    /// Repeats the search under each reading of the method, and shows how far it comes in each.
    fn compare(&self, json: bool) -> Result<()> {
        let numbers: Vec<u8> = self.tables.iter().map(|table| table.number).collect();
        let mut readings = Vec::new();
        for variant in Variant::neighbours() {
            let searches: Result<Vec<_>> =
                self.tables.iter().map(|table| self.searched(table, &variant)).collect();
            if interrupted().is_asked() {
                break;
            }
            let description = variant.to_string();
            talk(&description);
            readings.push(Reading { variant, description, searches: searches? });
        }
        if json {
            let json =
                serde_json::json!({ "schema": 1, "problems": numbers, "readings": readings });
            return say_json(&json).map(drop);
        }
        tell(&table::readings(&readings, &numbers)).map(drop)
    }

    fn searched(&self, table: &Published, variant: &Variant) -> Result<SearchReport> {
        let stop = interrupted().flag();
        table.target.searched(&self.values, variant, stop).map_err(refused)
    }
}

fn refused(error: impl Display) -> Error {
    Error::input(format!("{IDENTIFIED}: values: {error}"))
}
