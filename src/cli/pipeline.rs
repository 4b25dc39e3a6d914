//! The project as the commands work on it, and `dag`, `report`, `gc`.

use super::interrupt::interrupted;
use super::output::say;
use super::{CacheArgs, current_folder, threads};
use crate::pipeline::error::{Error, Result};
use crate::pipeline::{
    CacheLock, Graph, LockFile, Manifest, Node, Options, Progress, Stage, Store, Summary, Task,
    Times, execute,
};
use crate::replication::project::Project;
use crate::replication::stages::plan;
use clap::Args;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::process::Command;

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
    pub fn run_locked(
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
        // Zero would ask the environment, without a bound.
        let jobs = match options.jobs {
            0 => rayon::current_num_threads(),
            jobs => threads("-j", jobs),
        };
        let options = Options { jobs, ..options };
        execute(tasks, &self.store, &self.project.root, options, progress, interrupted())
    }
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
    let why = match Command::new(opener).arg(page).status() {
        Ok(status) if status.success() => return Ok(()),
        Ok(status) => format!("`{opener}` failed ({status})"),
        Err(e) => format!("`{opener}` cannot be started ({e})"),
    };
    Err(Error::input(format!("{why}; open {} by hand", page.display())))
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
    if !args.dry_run && garbage.files > 0 {
        let mut times = Times::read(workplace.store.folder());
        times.keep(&wanted);
        times.save();
    }
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
