//! `run`, `status`, `explain`, `dag`, `report`, `gc`: the commands that walk the plan.

use super::interrupt::interrupted;
use super::{CacheArgs, current_folder, say, say_json, styled};
use crate::error::{Error, IoContext, Result};
use crate::pipeline::{
    CacheLock, Graph, LockFile, Manifest, Node, Options, Progress, Reason, Stage, Store, Summary,
    Task, Verdict, execute,
};
use crate::project::Project;
use crate::stages::plan;
use anstyle::AnsiColor;
use clap::Args;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::process::Command;
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

/// Arguments of `status`.
#[derive(Args)]
pub(super) struct StatusArgs {
    /// Scenes to look at [default: all]
    #[arg(value_name = "SCENE")]
    scenes: Vec<String>,
    /// Exit with 1 if anything is stale
    #[arg(long)]
    exit_code: bool,
    /// Print JSON
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    cache: CacheArgs,
}

/// Arguments of `explain`.
#[derive(Args)]
pub(super) struct ExplainArgs {
    /// A stage (solve, tabulate, diff, identify, figures, report) or the beginning of a task's id
    stage: String,
    /// Print JSON
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    cache: CacheArgs,
}

/// Arguments of `dag`.
#[derive(Args)]
pub(super) struct DagArgs {
    /// For Mermaid, which draws it in Markdown
    #[arg(long, conflicts_with = "dot")]
    mermaid: bool,
    /// For Graphviz
    #[arg(long)]
    dot: bool,
}

/// Arguments of `report`.
#[derive(Args)]
pub(super) struct ReportArgs {
    /// Open the book in the browser
    #[arg(long)]
    open: bool,
    #[command(flatten)]
    cache: CacheArgs,
}

/// Arguments of `gc`.
#[derive(Args)]
pub(super) struct GcArgs {
    /// Count only; remove nothing
    #[arg(short = 'n', long)]
    dry_run: bool,
    /// Keep this many latest runs of each task
    #[arg(long, value_name = "N", default_value_t = 1)]
    keep: usize,
    #[command(flatten)]
    cache: CacheArgs,
}

/// The project around the current folder, and its cache.
pub(super) struct Workplace {
    pub project: Project,
    pub store: Store,
}

impl Workplace {
    pub fn open(cache: &CacheArgs) -> Result<Self> {
        let mut project = Project::read(Project::find(&current_folder()?)?)?;
        project.commands = super::commands();
        let folder = cache.cache_dir.clone().unwrap_or_else(|| project.root.join(".signorini"));
        Ok(Self { store: Store::new(&folder)?, project })
    }

    pub fn tasks(&self, scenes: &[String], only: Option<Stage>) -> Result<Vec<Task>> {
        plan(&self.project, &self.project.select(scenes)?, only)
    }

    /// What a run would do; needs no lock and writes nothing.
    pub fn judge(&self, tasks: &[Task]) -> Result<Summary> {
        let options = Options { dry_run: true, ..Options::default() };
        self.walk(tasks, options, &Progress::new(false, true))
    }

    /// Walks the tasks under the lock of the cache, and brings the lock file up to date.
    pub fn run(&self, tasks: &[Task], options: Options, progress: &Progress) -> Result<Summary> {
        let _lock = CacheLock::take(self.store.folder())?;
        let summary = self.walk(tasks, options, progress)?;
        if !summary.failed.is_empty() {
            return Err(Error::Stage(summary.failed));
        }
        let root = &self.project.root;
        let ours = summary.lock_file();
        let whole = plan(&self.project, &self.project.select(&[])?, None)?.len() == tasks.len();
        if whole { ours } else { LockFile::read(root)?.updated(ours) }.write(root)?;
        Ok(summary)
    }

    /// The same without touching the lock file; returns in which hashes the run differs from it.
    fn run_locked(
        &self,
        tasks: &[Task],
        options: Options,
        progress: &Progress,
    ) -> Result<(Summary, Vec<String>)> {
        let _lock = CacheLock::take(self.store.folder())?;
        let found = LockFile::read(&self.project.root)?;
        let summary = self.walk(tasks, options, progress)?;
        if !summary.failed.is_empty() {
            return Err(Error::Stage(summary.failed));
        }
        let differences = found.differences(&summary.lock_file());
        Ok((summary, differences))
    }

    fn walk(&self, tasks: &[Task], options: Options, progress: &Progress) -> Result<Summary> {
        execute(tasks, &self.store, &self.project.root, options, progress, interrupted())
    }
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
fn exports(summary: &Summary) -> String {
    let mut text = String::new();
    if summary.exported > 0 {
        text += "files in figures/ or report/ are missing or old\n";
    }
    summary.edited.iter().for_each(|edited| text += &format!("{edited}\n"));
    text
}

pub(super) fn status(args: &StatusArgs) -> Result<u8> {
    let workplace = Workplace::open(&args.cache)?;
    let summary = workplace.judge(&workplace.tasks(&args.scenes, None)?)?;
    let stale = !summary.nothing_to_do();
    if args.json {
        let tasks: BTreeMap<_, _> =
            summary.verdicts.iter().map(|j| (&j.task, &j.verdict)).collect();
        say_json(&serde_json::json!({ "schema": 1, "stale": stale, "tasks": tasks }))?;
    } else {
        let mut text = String::new();
        for stage in Stage::ALL {
            let of: Vec<_> = summary.verdicts.iter().filter(|j| j.stage == stage).collect();
            let stale: Vec<_> = of.iter().filter(|j| j.verdict != Verdict::Fresh).collect();
            let Some(first) = stale.first() else {
                if !of.is_empty() {
                    let state = styled("up to date", AnsiColor::Green);
                    text += &format!("{:<9} {state}  {} tasks\n", stage.name(), of.len());
                }
                continue;
            };
            let state = styled("stale", AnsiColor::Yellow);
            text += &format!(
                "{:<9} {state}       {} of {} tasks, e.g. {}: {}\n",
                stage.name(),
                stale.len(),
                of.len(),
                first.task,
                first.verdict
            );
        }
        text += &exports(&summary);
        say(&text)?;
    }
    Ok(u8::from(args.exit_code && stale))
}

pub(super) fn explain(args: &ExplainArgs) -> Result<u8> {
    let workplace = Workplace::open(&args.cache)?;
    let summary = workplace.judge(&workplace.tasks(&[], None)?)?;
    let prefix = format!("{}/", args.stage);
    let asked: Vec<_> = summary
        .verdicts
        .iter()
        .filter(|j| j.task == args.stage || j.task.starts_with(&prefix))
        .collect();
    if asked.is_empty() {
        let names = Stage::ALL.map(Stage::name).join(", ");
        return Err(Error::input(format!(
            "no stage or task `{}`; stages are {names}, `signorini dag` lists the tasks",
            args.stage
        )));
    }
    if args.json {
        let tasks: BTreeMap<_, _> = asked.into_iter().map(|j| (&j.task, &j.verdict)).collect();
        return say_json(&serde_json::json!({ "schema": 1, "tasks": tasks }));
    }
    let mut text = String::new();
    for judged in asked {
        match &judged.verdict {
            Verdict::Stale(Reason::Changed(changes)) => {
                text += &format!("{}: stale\n", judged.task);
                changes.iter().for_each(|change| text += &format!("  {change}\n"));
            }
            other => text += &format!("{}: {other}\n", judged.task),
        }
    }
    say(&text)
}

pub(super) fn dag(args: &DagArgs) -> Result<u8> {
    let project = Project::read(Project::find(&current_folder()?)?)?;
    let tasks = plan(&project, &project.select(&[])?, None)?;
    let graph = || Graph::new(tasks.iter().map(Node::of).collect());
    let mut text = String::new();
    if args.mermaid {
        text = graph().mermaid();
    } else if args.dot {
        text = graph().dot();
    } else {
        for task in &tasks {
            let needs = if task.needs.is_empty() {
                String::new()
            } else {
                format!(" <- {}", task.needs.join(", "))
            };
            text += &format!("{}{needs}\n", task.id);
        }
    }
    say(&text)
}

pub(super) fn report(args: &ReportArgs) -> Result<u8> {
    let workplace = Workplace::open(&args.cache)?;
    let tasks = workplace.tasks(&[], Some(Stage::Report))?;
    workplace.run(&tasks, Options::default(), &Progress::new(false, false))?;
    let book = workplace.project.root.join("report/book/index.html");
    if args.open {
        open(&book)?;
    }
    say(&format!("{}\n", book.display()))
}

fn open(page: &Path) -> Result<()> {
    let opener = if cfg!(target_os = "macos") { "open" } else { "xdg-open" };
    let status = Command::new(opener).arg(page).status().context("open", page)?;
    if status.success() {
        return Ok(());
    }
    Err(Error::input(format!("`{opener}` did not open {0}; open it by hand", page.display())))
}

pub(super) fn gc(args: &GcArgs) -> Result<u8> {
    if args.keep == 0 {
        return Err(Error::input(
            "--keep must be at least 1; to drop everything, remove the cache folder",
        ));
    }
    let workplace = Workplace::open(&args.cache)?;
    let wanted: BTreeSet<String> = workplace.tasks(&[], None)?.into_iter().map(|t| t.id).collect();
    let _lock = CacheLock::take(workplace.store.folder())?;
    let garbage = workplace.store.collect_garbage(&wanted, args.keep, args.dry_run)?;
    let verb = if args.dry_run { "would remove" } else { "removed" };
    say(&format!(
        "{verb} {} files, {}; kept {} files, {}\n",
        garbage.files,
        size(garbage.bytes),
        garbage.kept_files,
        size(garbage.kept_bytes)
    ))
}

fn size(bytes: u64) -> String {
    match bytes {
        0..10_000 => format!("{bytes} B"),
        10_000..10_000_000 => format!("{} kB", bytes / 1000),
        _ => format!("{} MB", bytes / 1_000_000),
    }
}

/// The manifests of tasks, run if need be.
pub(super) fn bring_up_to_date(
    workplace: &Workplace,
    tasks: &[Task],
) -> Result<BTreeMap<String, Manifest>> {
    // Looking needs no lock and no writing, and is enough when nothing is stale.
    let mut summary = workplace.judge(tasks)?;
    if !summary.nothing_to_do() {
        summary = workplace.run(tasks, Options::default(), &Progress::new(false, false))?;
    }
    Ok(summary.manifests)
}
