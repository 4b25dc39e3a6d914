//! `run`: brings everything up to date, and says what that took.

use super::CacheArgs;
use super::output::{OutputFile, say, talk};
use super::pipeline::Workplace;
use crate::pipeline::error::{Error, Result};
use crate::pipeline::{Options, Progress, Stage, Summary, Times, Verdict, brief, why};
use crate::timing::machine;
use clap::Args;
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// Arguments of `run`.
#[derive(Args, Clone, Debug)]
pub(super) struct RunArgs {
    /// Scenes to run [default: all, and the book]
    #[arg(value_name = "SCENE")]
    pub scenes: Vec<String>,
    /// Only this stage, and what it needs
    #[arg(long, value_name = "STAGE")]
    only: Option<Stage>,
    /// Say what would run, and why; change nothing
    #[arg(short = 'n', long)]
    dry_run: bool,
    /// Run everything again, and overwrite figures and pages edited by hand
    #[arg(short, long)]
    force: bool,
    /// After a failure, go on with what does not depend on it
    #[arg(short, long)]
    keep_going: bool,
    /// Threads [default: one per core]; results do not depend on it
    #[arg(short, long, value_name = "N", default_value_t = 0, hide_default_value = true)]
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
    let workplace = Workplace::open(&args.cache)?;
    let tasks = workplace.tasks(&args.scenes, args.only)?;
    if tasks.is_empty() {
        let remedy = match args.scenes.is_empty() {
            true => "see `outputs` in the scenes, or drop --only",
            false => {
                "figures show all published problems together, and the book all scenes: name none, or see `outputs`"
            }
        };
        return Err(Error::input(format!("there is nothing of this kind to make; {remedy}")));
    }
    let options =
        Options { force: args.force, keep_going: args.keep_going, jobs: args.jobs, dry_run: false };
    if args.dry_run {
        let summary = workplace.judge(&tasks)?;
        if let Some(time) = expected(&workplace, &summary, args.jobs) {
            talk(&format!("about {}, if all that waits has to run", brief(time)));
        }
        return say(&verdicts(&summary));
    }
    let trace_file = args.trace.as_deref().map(OutputFile::check).transpose()?;
    let mut progress = Progress::new(args.verbose, args.quiet);
    if args.trace.is_some() {
        progress = progress.traced();
    }
    let start = Instant::now();
    let ran = if args.locked {
        workplace.run_locked(&tasks, options, &progress)
    } else {
        workplace.run(&tasks, options, &progress).map(|summary| (summary, Vec::new()))
    };
    // A run that failed is worth looking at too.
    if let (Some(file), Some(trace)) = (&trace_file, progress.trace()) {
        file.write(trace.to_json().as_bytes())?;
    }
    let (summary, differences) = ran?;
    if !args.quiet && !summary.stages.is_empty() {
        talk(&clock(&summary, start.elapsed()));
    }
    if !differences.is_empty() {
        let lines = differences.join("\n  ");
        say(&format!("differs from pipeline/lock.toml:\n  {lines}\n"))?;
        return Ok(1);
    }
    if summary.nothing_to_do() {
        return say("nothing to do\n");
    }
    say(&account(&summary))
}

/// How long a run of what is stale, or waits for what is, may take.
fn expected(workplace: &Workplace, summary: &Summary, jobs: usize) -> Option<Duration> {
    let threads = if jobs > 0 { jobs } else { machine::cores() };
    let stale = summary.verdicts.iter().filter(|j| j.verdict != Verdict::Fresh);
    let tasks: Vec<_> = stale.map(|j| (j.stage, j.task.as_str())).collect();
    let times = Times::read(workplace.store.folder());
    times.expect(tasks.iter().copied(), threads).filter(|_| !tasks.is_empty())
}

/// By the clock: the whole run, and each stage, which may keep several threads busy.
fn clock(summary: &Summary, whole: Duration) -> String {
    let expected = summary.expected.map(|time| format!(" ({} expected)", brief(time)));
    let stages =
        summary.stages.iter().map(|(stage, time)| format!("{} {}", stage.name(), brief(*time)));
    format!(
        "took {}{}: {}",
        brief(whole),
        expected.unwrap_or_default(),
        stages.collect::<Vec<_>>().join(", ")
    )
}

/// One line per stage that ran: how many tasks, how long, why.
fn account(summary: &Summary) -> String {
    let mut text = String::new();
    for stage in Stage::ALL {
        let ran: Vec<_> = summary.ran.iter().filter(|ran| ran.stage == stage).collect();
        let all = summary.verdicts.iter().filter(|judged| judged.stage == stage).count();
        if ran.is_empty() {
            continue;
        }
        let time: Duration = ran.iter().map(|ran| ran.time).sum();
        let reasons: Vec<_> = ran.iter().map(|ran| &ran.reason).collect();
        text += &format!(
            "{:<9} {:>3} of {all:>3} ran  {:>7.3} s  {}\n",
            stage.name(),
            ran.len(),
            time.as_secs_f64(),
            why(&reasons)
        );
    }
    if summary.exported > 0 {
        text += &format!("{} files written to figures/ and report/\n", summary.exported);
    }
    if summary.exports.contains_key("report/book/index.html") {
        text += "the book: report/book/index.html\n";
    }
    text
}

fn verdicts(summary: &Summary) -> String {
    if summary.nothing_to_do() {
        return "nothing to do\n".into();
    }
    let stale = summary.verdicts.iter().filter(|j| j.verdict != Verdict::Fresh);
    let text: String =
        stale.map(|judged| format!("{}: {}\n", judged.task, judged.verdict)).collect();
    text + &exports(summary)
}

/// What is to be said about the files in the project folder.
pub(super) fn exports(summary: &Summary) -> String {
    let mut text = String::new();
    if summary.exported > 0 {
        text += "files in figures/ or report/ are missing or old\n";
    }
    summary.edited.iter().for_each(|edited| text += &format!("{edited}\n"));
    text
}
