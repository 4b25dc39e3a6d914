//! `identify`: the search for the right-hand sides of Figure 1.

mod args;
mod table;
mod watch;

use super::interrupt::interrupted;
use super::output::{OutputFile, say, say_json, talk};
use super::{current_folder, threads};
use crate::identify::{
    Budget, Checkpoint, IdentifyError, Progress, Report, Request, Selection, Target, Variant,
    merge, search, select,
};
use crate::pipeline::error::{Error, Result};
use crate::pipeline::files::read_if_there;
use crate::replication::project::Project;
use crate::timing;
use args::request;
pub(super) use args::{EXAMPLES, IdentifyArgs};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};
use watch::Watch;

/// What was found for one table, and how fast.
#[derive(Debug, Serialize)]
struct Answer {
    problem: u8,
    #[serde(skip)]
    target: Target,
    #[serde(flatten)]
    report: Report,
    /// Time this command spent on it; less than all of it if the search was resumed.
    seconds: f64,
    /// Runs per second that entered each grid during that time.
    rates: Vec<f64>,
}

/// The file of `--checkpoint`: the state of the search for each table begun.
#[derive(Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct States {
    schema: u8,
    problems: BTreeMap<u8, Checkpoint>,
}

/// Of the file of `--checkpoint`.
const SCHEMA: u8 = 1;

/// Time between two writings of the checkpoint.
const SAVE: Duration = Duration::from_secs(2);

pub(super) fn identify(args: &IdentifyArgs) -> Result<u8> {
    if !args.merge.is_empty() {
        return together(args);
    }
    let project = Project::read(Project::find(&current_folder()?)?)?;
    let numbers: Vec<u8> = match args.problem.parse() {
        Ok(number) => vec![number],
        Err(_) => project.paper.table.iter().map(|table| table.number).collect(),
    };
    if numbers.is_empty() {
        return Err(Error::input(
            "no published table is in pipeline/paper.toml; add one to explain",
        ));
    }
    let target = |number: u8| Ok((number, project.paper.target(number)?));
    let problems = numbers.into_iter().map(target).collect::<Result<Vec<_>>>()?;
    let grids = problems.iter().map(|(_, target)| target.levels()).min();
    let request = request(args, grids.expect("at least one table"))?;
    if args.threads == Some(0) {
        return Err(Error::input("--threads must be at least 1; leave it out for one per core"));
    }
    let budget = Budget {
        time: args.budget.map(seconds).transpose()?,
        threads: args.threads.map(|count| threads("--threads", count)),
        clock: timing::clock,
    };
    let answer = if args.variants { compare } else { find };
    answer(args, problems, &request, budget)
}

/// The tables to explain, with their numbers.
type Problems = Vec<(u8, Target)>;

/// The searches for each table in turn.
fn find(args: &IdentifyArgs, problems: Problems, request: &Request, budget: Budget) -> Result<u8> {
    let states = args.checkpoint.as_deref().map(read_states).transpose()?;
    let mut states = states.flatten().unwrap_or_default();
    states.schema = SCHEMA;
    let file = args.checkpoint.as_deref().map(OutputFile::check).transpose()?;
    let mut failure = None;
    let stop = interrupted();
    let began = Instant::now();
    let mut answers = Vec::new();
    let count = problems.len();
    for (k, (number, target)) in problems.into_iter().enumerate() {
        if stop.load(Ordering::Relaxed) {
            break;
        }
        let left = (count - k) as u32;
        let time = budget.time.map(|all| all.saturating_sub(began.elapsed()) / left);
        let from = states.problems.get(&number).cloned();
        let mut watch = Watch::new(&format!("problem {number}"));
        let mut saved = Instant::now();
        let mut observe = |progress: &Progress, state: Option<&Checkpoint>| {
            watch.show(progress);
            let (Some(state), Some(file)) = (state, &file) else { return };
            states.problems.insert(number, state.clone());
            if saved.elapsed() > SAVE && failure.is_none() {
                failure = write_states(file, &states).err();
                saved = Instant::now();
            }
        };
        let budget = Budget { time, ..budget };
        let report = search(request, &target, budget, from, stop, &mut observe);
        watch.end();
        let report = match report {
            Ok(report) => report,
            Err(e) if answers.is_empty() => return Err(refused(e)),
            Err(e) => {
                failure = failure.or(Some(refused(e)));
                break;
            }
        };
        if let (None, Some(file)) = (&failure, &file) {
            failure = write_states(file, &states).err();
        }
        let (seconds, rates) = watch.rates();
        answers.push(Answer { problem: number, target, report, seconds, rates });
    }
    show(args, &answers)?;
    // What was found is shown even where its checkpoint cannot be written, or the next table's search not go on.
    failure.map_or_else(|| ended(args), Err)
}

fn show(args: &IdentifyArgs, answers: &[Answer]) -> Result<u8> {
    if args.json {
        return say_json(&serde_json::json!({ "schema": 1, "problems": answers }));
    }
    let parts: Vec<_> = answers.iter().map(table::found).collect();
    say(&(parts.join("\n") + table::LEGEND))
}

/// What the parts of a search have found together.
fn together(args: &IdentifyArgs) -> Result<u8> {
    let mut problems = BTreeMap::<u8, Vec<Checkpoint>>::new();
    for path in &args.merge {
        let wrong = |why: &str| Error::input(format!("{} {why}", path.display()));
        let states = read_states(path)?.ok_or_else(|| wrong("is not there; name a checkpoint"))?;
        if states.problems.is_empty() {
            return Err(wrong("holds no search yet; let its part run to the end first"));
        }
        for (number, state) in states.problems {
            problems.entry(number).or_default().push(state);
        }
    }
    let mut answers = Vec::new();
    for (problem, parts) in problems {
        let (target, report) = merge(&parts).map_err(refused)?;
        answers.push(Answer { problem, target, report, seconds: 0.0, rates: Vec::new() });
    }
    show(args, &answers)
}

/// The model selection: every variant against every table.
fn compare(
    args: &IdentifyArgs,
    problems: Problems,
    request: &Request,
    budget: Budget,
) -> Result<u8> {
    let (numbers, targets): (Vec<u8>, Vec<Target>) = problems.into_iter().unzip();
    let variants = Variant::neighbours();
    let tables: Vec<_> = targets.into_iter().map(|t| (t, request.clone())).collect();
    let each = budget.time.map(|all| all / (variants.len() * tables.len()).max(1) as u32);
    let mut watch = Watch::new("variants");
    let mut done = 0;
    let mut observe = |selection: &Selection| {
        done += 1;
        watch.line(&format!("{done}/{}: {}", variants.len(), table::one_line(selection)));
    };
    let budget = Budget { time: each, ..budget };
    let all = select(&variants, &tables, budget, interrupted(), &mut observe).map_err(refused)?;
    watch.end();
    if args.json {
        say_json(&serde_json::json!({
            "schema": 1, "problems": numbers, "request": request, "selection": all,
        }))?;
    } else {
        say(&table::selection(&all, &numbers))?;
    }
    ended(args)
}

/// Exit code after what was found has been shown.
fn ended(args: &IdentifyArgs) -> Result<u8> {
    match (interrupted().load(Ordering::Relaxed), &args.checkpoint) {
        (false, _) => Ok(0),
        (true, Some(_)) => Err(Error::Interrupted),
        (true, None) => {
            talk(match args.variants {
                true => "interrupted; each variant has had less time than its share",
                false => "interrupted; with --checkpoint FILE the search could be resumed",
            });
            Ok(Error::Interrupted.exit_code())
        }
    }
}

fn refused(e: IdentifyError) -> Error {
    Error::input(e.to_string())
}

/// The longest budget in seconds, a century: a deadline much further off would overflow the clock.
const LONGEST: f64 = 3.2e9;

fn seconds(budget: f64) -> Result<Duration> {
    if (0.0..=LONGEST).contains(&budget) {
        return Ok(Duration::from_secs_f64(budget));
    }
    Err(Error::input(format!("--budget {budget} is no time; give seconds, such as 60")))
}

fn read_states(path: &Path) -> Result<Option<States>> {
    let Some(text) = read_if_there(path)? else { return Ok(None) };
    let read = serde_json::from_slice(&text).map_err(|e| e.to_string());
    let known = read.and_then(|states: States| match states.schema {
        SCHEMA => Ok(states),
        other => Err(format!("its schema is {other}, not {SCHEMA}")),
    });
    known.map(Some).map_err(|why| {
        let path = path.display();
        Error::input(format!("{path} is no checkpoint ({why}); delete it or name another file"))
    })
}

fn write_states(file: &OutputFile, states: &States) -> Result<()> {
    file.write(&serde_json::to_vec(states).expect("plain data"))
}
