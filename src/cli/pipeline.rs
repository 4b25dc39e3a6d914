//! The project as the commands work on it, and `report`, `gc`.

use super::interrupt::interrupted;
use super::output::say;
use super::{CacheArgs, current_folder, threads};
use crate::pipeline::error::{CONFLICT, Error, Result};
use crate::pipeline::files::{real, remove};
use crate::pipeline::{
    Edited, Editor, Exports, Hashes, LockFile, Manifest, Options, Plan, Progress, Store, Summary,
    Times, execute, work,
};
use crate::replication::project::Project;
use crate::replication::stages::{Stage, plan, scene_of};
use clap::Args;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::Command;

/// The cache of a project, if no other is named.
pub(super) const CACHE: &str = ".signorini";

#[derive(Args)]
pub(super) struct ReportArgs {
    /// Open the book in the browser
    #[arg(long)]
    open: bool,
    #[command(flatten)]
    cache: CacheArgs,
}

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

/// How much of the project a plan is, and what its results may change.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scope {
    /// Some tasks.
    Part,
    /// All tasks.
    Whole,
    /// All tasks, and the lock file is to stay as it is.
    Locked,
}

/// How to walk a plan without doing anything.
const LOOK: Options = Options { dry_run: true, force: false, keep_going: false, jobs: 0 };

impl Workplace {
    pub(super) fn open(cache: &CacheArgs) -> Result<Self> {
        Self::with(cache, Project::read)
    }

    /// The place with what `read` reads of the project.
    fn with(cache: &CacheArgs, read: impl FnOnce(PathBuf) -> Result<Project>) -> Result<Self> {
        let root = Project::find(&current_folder()?)?;
        let folder = cache.cache_dir.clone().unwrap_or_else(|| root.join(CACHE));
        outside_report(&root, &folder, "the cache")?;
        let mut project = read(root)?;
        project.commands = super::commands;
        Ok(Self { store: Store::new(&folder)?, project })
    }

    pub(super) fn tasks(&self, scenes: &[String], only: Option<Stage>) -> Result<Plan> {
        plan(&self.project, &self.project.select(scenes)?, only)
    }

    /// What [`Workplace::run`] would do, with `force` or without; needs no lock and writes nothing.
    pub(super) fn judge(&self, plan: &Plan, scope: Scope, force: bool) -> Result<Summary> {
        let options = Options { force, ..LOOK };
        Ok(self.walk(plan, scope, options, &Progress::new(false, true))?.0)
    }

    /// Walks the plan under the locks of project and cache, exports, and brings the lock file up to
    /// date. If this is not in the `scope`, and the results differ from it, nothing outside the cache
    /// is written, and the summary tells in which hashes they differ.
    pub(super) fn run(
        &self,
        plan: &Plan,
        scope: Scope,
        options: Options,
        progress: &Progress,
    ) -> Result<Summary> {
        let root = &self.project.root;
        let lock_file = |summary: &Summary, known: &LockFile| match scope {
            Scope::Part => known.clone().updated(summary.lock_file()),
            Scope::Whole | Scope::Locked => summary.lock_file(),
        };
        // Looking needs no lock and no writing, and is enough when nothing is to do.
        if !options.force && progress.trace().is_none() {
            let (summary, known) = self.walk(plan, scope, LOOK, progress)?;
            if summary.nothing_to_do()
                && lock_file(&summary, &known) == known
                && self.leftovers(&summary).is_empty()
            {
                return Ok(summary);
            }
        }
        // To write to project and cache is only for a project that can be run.
        self.project.check()?;
        let _locks = [Exports::lock(root)?, self.store.lock()?];
        let (mut summary, known) = self.walk(plan, scope, options, progress)?;
        if scope == Scope::Locked && summary.failed.is_empty() {
            summary.differences = known.differences(&summary.lock_file());
            if !summary.differences.is_empty() {
                return Ok(summary);
            }
        }
        if scope != Scope::Locked || summary.failed.is_empty() {
            remove(&self.leftovers(&summary));
            summary.exports.perform(root, &self.store)?;
        }
        if !summary.failed.is_empty() {
            return Err(Error::Stage(summary.failed));
        }
        let lock_file = lock_file(&summary, &known);
        if lock_file != known {
            lock_file.write(root)?;
            summary.lock_file_changed = true;
        }
        refuse_edited(&summary)?;
        Ok(summary)
    }

    /// Runs what is stale among a part of the tasks; their manifests.
    pub(super) fn bring_up_to_date(&self, part: &Plan) -> Result<BTreeMap<String, Manifest>> {
        let progress = Progress::new(false, false);
        Ok(self.run(part, Scope::Part, Options::default(), &progress)?.manifests)
    }

    /// Runs single tasks beside other processes; only the cache is written.
    pub(super) fn work(
        cache: &CacheArgs,
        asked: &[String],
        progress: &Progress,
    ) -> Result<Summary> {
        let (workplace, plan) = Self::with_tasks(cache, asked)?;
        let plan = plan.only(|id| asked.iter().any(|asked| asked == id));
        work(&plan, asked, &workplace.store, progress)
    }

    /// A plan with the tasks `asked` for: of their scenes alone if each belongs to one, so that a task costs the
    /// same in a large project; else of the whole project.
    fn with_tasks(cache: &CacheArgs, asked: &[String]) -> Result<(Self, Plan)> {
        if let Some(scenes) = asked.iter().map(|id| scene_of(id)).collect::<Option<Vec<_>>>() {
            let part = Self::with(cache, |root| Project::read_part(root, &scenes))?;
            let plan = part.tasks(&[], None)?;
            if asked.iter().all(|id| plan.task(id).is_some()) {
                return Ok((part, plan));
            }
        }
        let whole = Self::open(cache)?;
        whole.project.check()?;
        let plan = whole.tasks(&[], None)?;
        match asked.iter().find(|id| plan.task(id).is_none()) {
            Some(id) => Err(Error::input(format!("no task `{id}`; `signorini dag` lists them"))),
            None => Ok((whole, plan)),
        }
    }

    /// What killed runs left behind, in the cache and where exports go.
    fn leftovers(&self, summary: &Summary) -> Vec<PathBuf> {
        [self.store.leftovers(), summary.exports.leftovers(&self.project.root)].concat()
    }

    /// What there is to do and to say, and the lock file as it was.
    fn walk(
        &self,
        plan: &Plan,
        scope: Scope,
        options: Options,
        progress: &Progress,
    ) -> Result<(Summary, LockFile)> {
        let options = Options { jobs: jobs(options.jobs), ..options };
        let root = &self.project.root;
        // People may edit files while tasks run; where none does, what is there now is what counts.
        let ahead = options.dry_run && scope != Scope::Part;
        let none = Hashes::new();
        let look = || {
            let known = LockFile::read(root)?;
            let exports = Exports::look(root, if ahead { &known.exports } else { &none });
            Ok((known, exports))
        };
        let walk = || execute(plan, &self.store, options, progress, interrupted());
        let ((known, exports), mut summary) = if ahead {
            let (looked, walked) = rayon::join(look, walk);
            (looked?, walked?)
        } else {
            (look()?, walk()?)
        };
        let may = [options.force, scope != Scope::Part];
        let made = &summary.manifests;
        summary.exports = exports.plan(root, plan, made, &self.store, &known.exports, may)?;
        Ok((summary, known))
    }
}

/// The threads of a run that is told `-j`, or not told any (zero).
pub(super) fn jobs(asked: usize) -> usize {
    match asked {
        // The pool's, which has a bound that the environment has not.
        0 => rayon::current_num_threads(),
        asked => threads("-j", asked),
    }
}

/// Refuses a place for files of ours in a folder whose files are inputs or exports.
pub(super) fn outside_report(root: &Path, path: &Path, what: &str) -> Result<()> {
    let (root, path) = (real(root), real(path));
    let inside = ["report", "figures", "pipeline"];
    match inside.into_iter().find(|folder| path.starts_with(root.join(folder))) {
        Some(folder) => Err(Error::input(format!(
            "{what} would lie in {folder}/, which a run reads and writes; choose another place"
        ))),
        None => Ok(()),
    }
}

/// Names the files that were not written because they have other bytes than signorini wrote.
fn refuse_edited(summary: &Summary) -> Result<()> {
    let Some(first) = summary.exports.edited.first() else { return Ok(()) };
    let alike: Vec<&str> = summary
        .exports
        .edited
        .iter()
        .filter(|file| file.by == first.by)
        .map(|file| &*file.path)
        .collect();
    let count = alike.len();
    Err(Error::input(match first.by {
        _ if count == 1 => edited(first),
        Editor::Hand => format!(
            "{count} files were edited by hand: {}; move them away, or overwrite them by `signorini run --force`",
            alike.join(", ")
        ),
        Editor::Merge => format!(
            "{count} files have a {CONFLICT}: {}; delete them and run again",
            alike.join(", ")
        ),
        Editor::Unknown => format!(
            "nothing is on record of {count} files: {}; move them away, or overwrite them by `signorini run --force`",
            alike.join(", ")
        ),
    }))
}

/// A line on a file that was not written.
pub(super) fn edited(file: &Edited) -> String {
    let path = &file.path;
    match file.by {
        Editor::Hand => format!(
            "{path} was edited by hand; move it away, or overwrite it by `signorini run --force`"
        ),
        Editor::Merge => format!("{path} has a {CONFLICT}; delete it and run again"),
        Editor::Unknown => format!(
            "nothing is on record of {path}; move it away, or overwrite it by `signorini run --force`"
        ),
    }
}

pub(super) fn report(args: &ReportArgs) -> Result<u8> {
    let workplace = Workplace::open(&args.cache)?;
    let tasks = workplace.tasks(&[], Some(Stage::Report))?;
    workplace.bring_up_to_date(&tasks)?;
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
    let plan = workplace.tasks(&[], None)?;
    let wanted: BTreeSet<String> = plan.tasks().iter().map(|task| task.id.clone()).collect();
    // To count needs no lock, and no cache: a folder that was misspelt is not made.
    let there = workplace.store.folder().is_dir();
    let _lock = if args.dry_run || !there { None } else { Some(workplace.store.lock()?) };
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
