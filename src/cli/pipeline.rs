//! Walks of the project's plan, for all commands.

use super::interrupt::interrupted;
use super::output::{for_talk, refuse_tilde};
use super::{CacheArgs, current_folder, threads};
use crate::pipeline::error::{CONFLICT, Error, Result};
use crate::pipeline::files::{real, remove};
use crate::pipeline::{
    Edited, Editor, Exports, KnownHashes, LockFile, Manifest, Options, Plan, Progress, Rights,
    Store, Summary, WalkResults, execute, work,
};
use crate::replication::project::Project;
use crate::replication::stages::{Stage, plan, scene_of};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Default cache of a project.
pub(super) const CACHE: &str = ".signorini";

/// The project around the current folder, and its cache.
pub(super) struct Workplace {
    pub project: Project,
    pub store: Store,
}

/// Part of the project that a plan covers, and permission to change the lock file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scope {
    /// Some tasks.
    Part,
    /// All tasks.
    Whole,
    /// All tasks, and the lock file is to stay as it is.
    Locked,
}

/// Options of a walk that only judges.
const LOOK: Options =
    Options { dry_run: true, force: false, keep_going: false, jobs: 0, only: None };

impl Workplace {
    pub(super) fn open(cache: &CacheArgs) -> Result<Self> {
        Self::with(cache, Project::read)
    }

    /// Returns the workplace with the project that `read` reads.
    fn with(cache: &CacheArgs, read: impl FnOnce(PathBuf) -> Result<Project>) -> Result<Self> {
        cache.cache_dir.as_deref().map_or(Ok(()), refuse_tilde)?;
        let root = Project::find(&current_folder()?)?;
        let folder = cache.cache_dir.clone().unwrap_or_else(|| root.join(CACHE));
        outside_report(&root, &folder, "the cache")?;
        let mut project = read(root)?;
        project.commands = super::commands;
        let mut store = Store::new(&folder)?;
        store.known = KnownHashes::read(&project.root);
        Ok(Self { project, store })
    }

    /// Returns the workplace; if asked, one that reads all files, also those that have not changed for all that the
    /// file system tells.
    pub(super) fn verifying(mut self, asked: bool) -> Self {
        if asked {
            self.store.known = KnownHashes::default();
        }
        self
    }

    pub(super) fn tasks(&self, scenes: &[String], only: Option<Stage>) -> Result<Plan> {
        plan(&self.project, &self.project.select(scenes)?, only)
    }

    /// Returns a summary of what [`Workplace::run`] would do, with `force` or without; needs no lock and writes
    /// nothing.
    pub(super) fn judge(&self, plan: &Plan, scope: Scope, force: bool) -> Result<Summary> {
        let options = Options { force, ..LOOK };
        Ok(self.walk(plan, scope, options, &Progress::new(false, true))?.0)
    }

    /// Walks the plan under the locks of project and cache, exports, and brings the lock file up to date. If the lock
    /// file is to stay as it is, and the results differ from it, nothing outside the cache is written, and the summary
    /// lists the hashes that differ.
    pub(super) fn run(
        &mut self,
        plan: &Plan,
        scope: Scope,
        options: Options,
        progress: &Progress,
    ) -> Result<Summary> {
        // Judging needs no lock, writes nothing, and is enough if there is nothing to do.
        let look = Options { force: options.force, ..LOOK };
        let (summary, known) = self.walk(plan, scope, look, progress)?;
        if summary.nothing_to_do()
            && lock_file(scope, &summary, &known) == known
            && self.leftovers(&summary).is_empty()
        {
            if self.store.known.missed() {
                self.note(plan, scope, &summary);
            }
            return Ok(summary);
        }
        // Project and cache are written only if the project can be run.
        refuse_edited(&summary)?;
        self.check(&summary, progress)?;
        let _locks = [Exports::lock(&self.project.root)?, self.store.lock()?];
        // What is used is read.
        self.store.known = KnownHashes::default();
        let root = &self.project.root;
        let (mut summary, known) = self.walk(plan, scope, options, progress)?;
        if scope == Scope::Locked && summary.failed.is_empty() {
            summary.differences = known.differences(&summary.lock_file);
            if !summary.differences.is_empty() {
                return Ok(summary);
            }
        }
        // A run that fails keeps what the other tasks made, and names what failed.
        if summary.failed.is_empty() {
            refuse_edited(&summary)?;
        }
        if scope != Scope::Locked || summary.failed.is_empty() {
            remove(&self.leftovers(&summary));
            summary.exports.perform(root, &self.store)?;
        }
        if !summary.failed.is_empty() {
            return Err(Error::Stage(summary.failed));
        }
        let lock_file = lock_file(scope, &summary, &known);
        if lock_file != known {
            lock_file.write(root)?;
            summary.lock_file_changed = true;
        }
        self.note(plan, scope, &summary);
        Ok(summary)
    }

    /// Notes the hashes of all files for the next run; one of a part would lose those of the rest.
    fn note(&self, plan: &Plan, scope: Scope, summary: &Summary) {
        if scope != Scope::Part {
            // Without notes, the next run reads all files.
            let root = &self.project.root;
            let _ =
                self.store.known.note(root, &self.results(plan, &summary.manifests).paths(root));
        }
    }

    fn results<'a>(
        &'a self,
        plan: &'a Plan,
        manifests: &'a BTreeMap<String, Manifest>,
    ) -> WalkResults<'a> {
        WalkResults { plan, manifests, store: &self.store }
    }

    /// Refuses what a run of the tasks that are not up to date would read and could not use, and warns of meshes whose
    /// parts touch without being joined.
    pub(super) fn check(&self, summary: &Summary, progress: &Progress) -> Result<()> {
        let at_work = summary.not_fresh().filter_map(|one| scene_of(&one.task)).collect();
        self.project.check(&at_work)?.iter().for_each(|warning| progress.note(&for_talk(warning)));
        Ok(())
    }

    /// Runs the stale tasks of a part of the plan; returns the manifests of all tasks of the part.
    pub(super) fn bring_up_to_date(&mut self, part: &Plan) -> Result<BTreeMap<String, Manifest>> {
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
        workplace.check(&workplace.judge(&plan, Scope::Part, false)?, progress)?;
        let workplace = workplace.verifying(true);
        work(&plan, asked, &workplace.store, progress, interrupted())
    }

    /// Returns a plan with the tasks `asked` for: that of their scenes alone if each task belongs to one scene, so that
    /// a task costs the same in a large project; else that of the whole project.
    fn with_tasks(cache: &CacheArgs, asked: &[String]) -> Result<(Self, Plan)> {
        if let Some(scenes) = asked.iter().map(|id| scene_of(id)).collect::<Option<Vec<_>>>() {
            let part = Self::with(cache, |root| Project::read_part(root, &scenes))?;
            let plan = part.tasks(&[], None)?;
            if asked.iter().all(|id| plan.task(id).is_some()) {
                return Ok((part, plan));
            }
        }
        let whole = Self::open(cache)?;
        let plan = whole.tasks(&[], None)?;
        match asked.iter().find(|id| plan.task(id).is_none()) {
            Some(id) => Err(Error::input(format!("no task `{id}`; `signorini dag` lists them"))),
            None => Ok((whole, plan)),
        }
    }

    /// Returns the temporary files that killed runs left in the cache and in the folders of exports.
    fn leftovers(&self, summary: &Summary) -> Vec<PathBuf> {
        [self.store.leftovers(), summary.exports.leftovers(&self.project.root)].concat()
    }

    /// Walks the plan and plans the exports; returns the summary, and the lock file as it was.
    fn walk(
        &self,
        plan: &Plan,
        scope: Scope,
        options: Options,
        progress: &Progress,
    ) -> Result<(Summary, LockFile)> {
        let options = Options { jobs: jobs(options.jobs), ..options };
        let root = &self.project.root;
        let mut summary = execute(plan, &self.store, options, progress, interrupted())?;
        let results = self.results(plan, &summary.manifests);
        let lock_file = results.lock_file();
        let known = LockFile::read_expecting(root, &lock_file)?;
        let rights = Rights { overwrite: options.force, remove: scope != Scope::Part };
        summary.exports = Exports::plan(root, &results, &known.exports, rights)?;
        summary.lock_file = lock_file;
        Ok((summary, known))
    }
}

/// Returns the lock file after a walk.
fn lock_file(scope: Scope, summary: &Summary, known: &LockFile) -> LockFile {
    match scope {
        Scope::Part => known.clone().updated(summary.lock_file.clone()),
        Scope::Whole | Scope::Locked => summary.lock_file.clone(),
    }
}

/// Returns the number of threads of a run with this value of `-j`, zero without one.
pub(super) fn jobs(asked: usize) -> usize {
    match asked {
        // Number of threads of the pool, which is bounded, unlike a number in the environment.
        0 => rayon::current_num_threads(),
        asked => threads("-j", asked),
    }
}

/// Refuses a place for files of this program in a folder with inputs or exports.
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
        Editor::LineEnds => format!(
            "{count} files have other line ends than signorini wrote, as git may change them: {}; {LINE_ENDS}",
            alike.join(", ")
        ),
        Editor::Unknown => format!(
            "nothing is on record of {count} files: {}; move them away, or overwrite them by `signorini run --force`",
            alike.join(", ")
        ),
    }))
}

/// Remedy for files whose line ends were changed.
const LINE_ENDS: &str = "clone again with `git clone -c core.autocrlf=false` (with `* -text` in .gitattributes \
    nobody need do so), or overwrite by `signorini run --force`";

/// Returns a line on a file that was not written.
pub(super) fn edited(file: &Edited) -> String {
    let path = &file.path;
    match file.by {
        Editor::Hand => format!(
            "{path} was edited by hand; move it away, or overwrite it by `signorini run --force`"
        ),
        Editor::Merge => format!("{path} has a {CONFLICT}; delete it and run again"),
        Editor::LineEnds => format!(
            "{path} has other line ends than signorini wrote, as git may change them; {LINE_ENDS}"
        ),
        Editor::Unknown => format!(
            "nothing is on record of {path}; move it away, or overwrite it by `signorini run --force`"
        ),
    }
}
