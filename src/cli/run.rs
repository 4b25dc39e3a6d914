//! `run`: brings everything up to date, and says what that took.

use super::CacheArgs;
use super::output::{OutputFile, say, talk, warn_of_outside};
use super::pipeline::{Scope, Workplace, edited, jobs, outside_report};
use crate::pipeline::error::{Error, Result};
use crate::pipeline::{Options, Plan, Progress, Ran, Summary, Times, brief, why};
use crate::replication::project::Project;
use crate::replication::stages::{Stage, report};
use clap::{Args, ValueEnum};
use std::path::PathBuf;
use std::time::{Duration, Instant};

#[derive(Args, Clone, Debug)]
pub(super) struct RunArgs {
    /// Scenes to run [default: all, and the book]
    #[arg(value_name = "SCENE")]
    pub scenes: Vec<String>,
    /// Only this stage, and what it needs
    #[arg(long, value_name = "STAGE")]
    only: Option<Stage>,
    /// Only this task, for which all it needs must be there; writes to the cache alone, beside other
    /// processes that do the same. May be given several times
    #[arg(long, value_name = "ID", conflicts_with_all = [
        "scenes", "only", "dry_run", "force", "keep_going", "jobs", "locked", "trace",
    ])]
    task: Vec<String>,
    /// Say what would run, and why; change nothing
    #[arg(short = 'n', long)]
    dry_run: bool,
    /// Run everything again, and overwrite figures and pages edited by hand
    #[arg(short, long)]
    force: bool,
    /// After a failure, go on with what does not depend on it
    #[arg(short, long)]
    keep_going: bool,
    /// Threads; 0 is one per core. Results do not depend on it
    #[arg(short, long, value_name = "N", default_value_t = 0)]
    jobs: usize,
    /// Fail if the results differ from pipeline/lock.toml, instead of updating it
    #[arg(long, conflicts_with_all = ["scenes", "only", "dry_run"])]
    locked: bool,
    /// Write what each thread did when, for chrome://tracing or Perfetto
    #[arg(long, value_name = "FILE", conflicts_with = "dry_run")]
    trace: Option<PathBuf>,
    /// A line for every task that runs, with the reason
    #[arg(short, long)]
    verbose: bool,
    /// No progress
    #[arg(short, long)]
    quiet: bool,
    #[command(flatten)]
    cache: CacheArgs,
}

pub(super) fn run(args: &RunArgs) -> Result<u8> {
    if !args.task.is_empty() {
        let progress = Progress::new(args.verbose, args.quiet);
        let ran = Workplace::work(&args.cache, &args.task, &progress)?;
        return say(&if ran.ran.is_empty() { "nothing to do\n".into() } else { what_ran(&ran) });
    }
    let workplace = Workplace::open(&args.cache)?;
    let tasks = workplace.tasks(&args.scenes, args.only)?;
    if tasks.tasks().is_empty() {
        let remedy = match args.scenes.is_empty() {
            true => "see `outputs` in the scenes, or drop --only",
            false => {
                "figures show all published problems together, and the book all scenes: name none, or see `outputs`"
            }
        };
        return Err(Error::input(format!("there is nothing of this kind to make; {remedy}")));
    }
    if !args.quiet {
        for scene in workplace.project.select(&args.scenes)? {
            warn_of_outside(Some(&scene.name), &scene.f.outside());
        }
    }
    let options =
        Options { force: args.force, keep_going: args.keep_going, jobs: args.jobs, dry_run: false };
    let scope = match args.scenes.is_empty() && args.only.is_none() {
        true if args.locked => Scope::Locked,
        true => Scope::Whole,
        false => Scope::Part,
    };
    if args.dry_run {
        return dry_run(&workplace, &tasks, scope, options);
    }
    let trace_file = args.trace.as_deref().map(OutputFile::check).transpose()?;
    if let Some(file) = &trace_file {
        outside_report(&workplace.project.root, file.path(), "the trace")?;
    }
    let mut progress = Progress::new(args.verbose, args.quiet);
    if args.trace.is_some() {
        progress = progress.traced();
    }
    let start = Instant::now();
    let ran = workplace.run(&tasks, scope, options, &progress);
    // A run that failed is worth looking at too.
    if let (Some(file), Some(trace)) = (&trace_file, progress.trace()) {
        file.write(trace.to_json().as_bytes())?;
    }
    let summary = ran?;
    if !args.quiet && !summary.ran.is_empty() {
        let expected = summary.expected.map(|time| format!(" ({} expected)", brief(time)));
        talk(&format!("took {}{}", brief(start.elapsed()), expected.unwrap_or_default()));
    }
    if !summary.differences.is_empty() {
        let lines = summary.differences.join("\n  ");
        say(&format!("differs from pipeline/lock.toml:\n  {lines}\n"))?;
        return Ok(1);
    }
    if summary.nothing_to_do() && !summary.lock_file_changed {
        // The process ends; freeing its memory first would be a noticeable part of so short a run.
        std::mem::forget((workplace, tasks, summary));
        return say("nothing to do\n");
    }
    let mut text = left_out(&workplace.project, &tasks) + &what_ran(&summary);
    let tabulated = |ran: &Ran| Stage::of(&ran.task) == Some(Stage::Tabulate);
    if !args.scenes.is_empty() && summary.ran.iter().any(tabulated) {
        text += "a run that names no scene writes all counts to report/results.csv\n";
    }
    say(&text)
}

/// A line that says what the book leaves out and why, if it is among the tasks and leaves anything out.
fn left_out(project: &Project, tasks: &Plan) -> String {
    let may = |name: &String| name.ends_with(report::TEMPLATE) && tasks.task(report::ID).is_some();
    let reason = report::left_out(project).filter(|_| project.templates.keys().any(may));
    let line = |why| format!("the book leaves out all pages from *{}: {why}\n", report::TEMPLATE);
    reason.map_or(String::new(), line)
}

/// Says what a run would do, and about how long it would take.
fn dry_run(workplace: &Workplace, tasks: &Plan, scope: Scope, options: Options) -> Result<u8> {
    let summary = workplace.judge(tasks, scope, options.force)?;
    let late = summary.not_fresh().map(|judged| judged.task.as_str());
    let times = Times::read(workplace.store.folder());
    if let Some(time) = times.ahead(late, jobs(options.jobs)).left() {
        talk(&format!("about {}, if all that waits has to run", brief(time)));
    }
    say(&(left_out(&workplace.project, tasks) + &verdicts(&summary)))
}

/// The first page of the book.
const BOOK: &str = "report/book/index.html";

/// One line per stage that ran: how many tasks, how long, why.
fn what_ran(summary: &Summary) -> String {
    let mut text = String::new();
    for stage in Stage::value_variants() {
        let of_stage = |task: &str| Stage::of(task) == Some(*stage);
        let ran: Vec<_> = summary.ran.iter().filter(|ran| of_stage(&ran.task)).collect();
        let all = summary.verdicts.iter().filter(|judged| of_stage(&judged.task)).count();
        if ran.is_empty() {
            continue;
        }
        let time: Duration = ran.iter().map(|ran| ran.time).sum();
        let reasons: Vec<_> = ran.iter().map(|ran| &ran.reason).collect();
        text += &format!(
            "{stage:<9} {:>3} of {all:>3} ran  {:>7.3} s  {}\n",
            ran.len(),
            time.as_secs_f64(),
            why(&reasons)
        );
    }
    match summary.exports.to_write() {
        0 => {}
        1 => text += "1 file written to figures/ and report/\n",
        count => text += &format!("{count} files written to figures/ and report/\n"),
    }
    if let Some(files) = to_remove(summary) {
        text += &format!("removed {files}\n");
    }
    if summary.lock_file_changed && summary.ran.is_empty() {
        text += "pipeline/lock.toml brought up to date\n";
    }
    if summary.exports.files.contains_key(BOOK) {
        text += &format!("the book: {BOOK}\n");
    }
    text
}

fn verdicts(summary: &Summary) -> String {
    if summary.nothing_to_do() {
        return "nothing to do\n".into();
    }
    let stale = summary.not_fresh();
    let text: String =
        stale.map(|judged| format!("{}: {}\n", judged.task, judged.verdict)).collect();
    text + &exports(summary)
}

/// The files that belong to nothing any more, if there are any: those that may be committed by their names.
fn to_remove(summary: &Summary) -> Option<String> {
    let is_figure = |path: &&String| path.starts_with("figures/");
    let (mut files, others): (Vec<_>, Vec<_>) =
        summary.exports.to_remove().iter().partition(is_figure);
    let others = match others.len() {
        0 => None,
        1 => Some("1 file of report/".into()),
        count => Some(format!("{count} files of report/")),
    };
    files.extend(&others);
    (!files.is_empty())
        .then(|| files.iter().map(|file| file.as_str()).collect::<Vec<_>>().join(", "))
}

pub(super) fn exports(summary: &Summary) -> String {
    let mut text = String::new();
    if summary.exports.to_write() > 0 {
        text += "files in figures/ or report/ are missing or old\n";
    }
    if let Some(files) = to_remove(summary) {
        text += &format!("to be removed: {files}\n");
    }
    summary.exports.edited.iter().for_each(|file| text += &(edited(file) + "\n"));
    text
}
