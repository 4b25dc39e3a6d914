//! `identify`: the search for the right-hand sides of Figure 1, as the stage of that name makes it.

use super::interrupt::{at_work, interrupted};
use super::output::{say_json, talk, tell};
use super::project_root;
use crate::pipeline::error::{Error, Result, from_record};
use crate::replication::identified::IdentifiedRecord;
use crate::replication::project::{IDENTIFIED, Project};
use crate::table::Table;
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

/// Results for one table under one reading of the method.
#[derive(Debug, Serialize)]
struct Answer {
    /// Reading of the method, in words.
    reading: String,
    problem: u8,
    /// The f on record, run again.
    recorded: Vec<Found>,
    #[serde(flatten)]
    report: SearchReport,
}

const LEGEND: &str = "
counts      published counts that come out exactly
Delta a     values that agree to the two printed digits
integral    of f over the square; (2) asks for less than zero
";

pub(super) fn identify(args: &IdentifyArgs) -> Result<u8> {
    let answers = answers(&Project::read(project_root()?)?, args.variants)?;
    let shown = match (args.json, args.variants) {
        (true, _) => say_json(&serde_json::json!({ "schema": 1, "problems": answers })),
        (_, true) => tell(&extents(&answers)),
        (_, false) => tell(&(answers.iter().map(found).collect::<Vec<_>>().join("\n") + LEGEND)),
    };
    shown?;
    match interrupted().is_asked() {
        true => Ok(Error::Interrupted.exit_code()),
        false => Ok(0),
    }
}

/// Searches for f, reading by reading and table by table; however it is interrupted, what was found is kept.
fn answers(project: &Project, with_variants: bool) -> Result<Vec<Answer>> {
    // A search takes long: better in a project without mistakes.
    project.select(&[])?;
    if project.paper.table.is_empty() {
        return Err(Error::input("no published table is in pipeline/paper.toml; add one"));
    }
    let Some(file) = project.files.get(IDENTIFIED) else {
        return Err(Error::input(format!("{IDENTIFIED} is not there; restore it")));
    };
    let record: IdentifiedRecord = from_record(IDENTIFIED, file.bytes()?)?;
    let readings = if with_variants { Variant::neighbours() } else { vec![Variant::default()] };
    let (_at_work, mut answers) = (at_work(), Vec::new());
    for variant in readings.iter().take_while(|_| !interrupted().is_asked()) {
        let reading = variant.to_string();
        if with_variants {
            talk(&reading);
        }
        for problem in project.paper.table.iter().map(|table| table.number) {
            let target: Target = project.paper.target(problem)?;
            let known = if with_variants { &[][..] } else { record.alternatives(problem) };
            let recorded = target.found(variant, known);
            let stop = interrupted().flag();
            let report = target.searched(&record.questions.values, variant, stop);
            answers.push(Answer {
                reading: reading.clone(),
                problem,
                recorded: recorded.map_err(refused)?,
                report: report.map_err(refused)?,
            });
        }
    }
    Ok(answers)
}

fn refused(error: impl Display) -> Error {
    Error::input(format!("{IDENTIFIED}: values: {error}"))
}

/// The f on record and the f found for one table.
fn found(answer: &Answer) -> String {
    let report = &answer.report;
    let mut out = format!("Problem {}\n", answer.problem);
    if !answer.recorded.is_empty() {
        out += &format!("on record\n{}\n", table(&answer.recorded));
    }
    out += &format!("{} candidates tried", report.tried);
    for (level, runs) in report.reached.iter().enumerate().skip(1) {
        out += &format!(", {runs} reach grid {}", level + 1);
    }
    out += if report.complete { "\n" } else { "; stopped early\n" };
    if report.found.is_empty() {
        return out
            + "none gives all counts; a wider range `values`, or a smaller step, has more f\n";
    }
    out + &table(&report.found)
}

fn table(all: &[Found]) -> String {
    let mut table = Table::new(["counts", "Delta a", "integral", "f"], &[3]);
    for Found { f, integral, exact, cells, delta_a, delta_a_exact } in all {
        table.rows.push(vec![
            format!("{exact}/{cells}"),
            format!("{delta_a_exact}/{}", delta_a.len()),
            // No negative zero, from rounding or not.
            format!("{:.4}", if integral.abs() < 5e-5 { 0.0 } else { *integral }),
            f.clone(),
        ]);
    }
    table.text()
}

/// Number of f with all counts, on all grids or on as many as there are such f for, under each reading of the method.
fn extents(answers: &[Answer]) -> String {
    let mut table = Table::new(["problem", "f", "grids", "reading of the method"], &[3]);
    for Answer { reading, problem, report, .. } in answers {
        let (all, mut reached) = (report.reached.len(), report.reached[1..].to_vec());
        reached.push(report.exact);
        let grids = reached.iter().rposition(|f| *f > 0).map_or(0, |grids| grids + 1);
        let f = grids.checked_sub(1).map_or(0, |last| reached[last]);
        let cells = [problem.to_string(), f.to_string(), format!("{grids} of {all}")];
        table.rows.push([&cells[..], std::slice::from_ref(reading)].concat());
    }
    table.text() + "number of f with all counts on so many grids, the most on which there are any\n"
}
