//! `run`: brings everything up to date, and says what that took.

use super::pipeline::Workplace;
use super::{CacheArgs, say};
use crate::error::{Error, Result};
use crate::pipeline::{Options, Progress, Stage, Summary, Verdict};
use clap::Args;
use std::time::Duration;

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
        return Err(Error::input(
            "the scenes ask for nothing here; see `outputs` in the scene, or drop --only",
        ));
    }
    let options =
        Options { force: args.force, keep_going: args.keep_going, jobs: args.jobs, dry_run: false };
    let progress = Progress::new(args.verbose, args.quiet);
    if args.dry_run {
        return say(&verdicts(&workplace.judge(&tasks)?));
    }
    let summary = if args.locked {
        let (summary, differences) = workplace.run_locked(&tasks, options, &progress)?;
        if !differences.is_empty() {
            let lines = differences.join("\n  ");
            say(&format!("differs from pipeline/lock.toml:\n  {lines}\n"))?;
            return Ok(1);
        }
        summary
    } else {
        workplace.run(&tasks, options, &progress)?
    };
    if summary.nothing_to_do() {
        return say("nothing to do\n");
    }
    say(&account(&summary))
}

/// One line per stage that ran: how many tasks, how long, why.
fn account(summary: &Summary) -> String {
    let mut text = String::new();
    for stage in Stage::ALL {
        let ran: Vec<_> = summary.ran.iter().filter(|ran| ran.stage == stage).collect();
        let all = summary.verdicts.iter().filter(|judged| judged.stage == stage).count();
        let Some(first) = ran.first() else { continue };
        let time: Duration = ran.iter().map(|ran| ran.time).sum();
        let others = ran.iter().filter(|ran| ran.reason != first.reason).count();
        let more = if others > 0 { format!(" (others differ: {others})") } else { String::new() };
        text += &format!(
            "{:<9} {:>3} of {all:>3} ran  {:>7.3} s  {}{more}\n",
            stage.name(),
            ran.len(),
            time.as_secs_f64(),
            first.reason
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
