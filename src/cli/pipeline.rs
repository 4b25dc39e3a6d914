//! Walks of the project's plan, for all commands.

use super::interrupt::interrupted;
use super::output::{for_talk, refuse_tilde};
use super::{CacheArgs, project_root, threads};
use crate::pipeline::error::{CONFLICT, Error, Result};
use crate::pipeline::files::remove;
use crate::pipeline::place::{TAKEN, place};
use crate::pipeline::{
    Editor, Exports, Interrupt, LockFile, Manifest, Options, Plan, Progress, Rights, Store,
    Summary, WalkResults, execute, work,
};
use crate::replication::project::{Project, refuse_broken};
use crate::replication::stages::{Stage, plan, scene_of};
use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

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

    /// As [`Workplace::open`], with the project only as far as tasks of these scenes depend on it.
    pub(super) fn open_for(cache: &CacheArgs, scenes: &[String]) -> Result<Self> {
        Self::with(cache, |root| Project::read_for(root, scenes))
    }

    /// Returns the workplace with the project that `read` reads.
    fn with(cache: &CacheArgs, read: impl FnOnce(PathBuf) -> Result<Project>) -> Result<Self> {
        cache.cache_dir.as_deref().map_or(Ok(()), refuse_tilde)?;
        let root = project_root()?;
        let folder = cache.cache_dir.clone().unwrap_or_else(|| root.join(CACHE));
        place(&root, &folder, "the cache", &TAKEN)?;
        Ok(Self { project: read(root)?, store: Store::new(&folder)? })
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

    /// As [`Workplace::judge`], and refuses what a run with these options would refuse; tasks that could not do their
    /// work are made to fail, where the run is to go on.
    pub(super) fn rehearse(
        &self,
        plan: &mut Plan,
        scope: Scope,
        options: Options,
        progress: &Progress,
    ) -> Result<Summary> {
        let mut summary = self.judge(plan, scope, options.force)?;
        if !summary.nothing_to_do() {
            refuse_edited(&summary)?;
            let refused = self.check(plan, &summary, progress)?;
            if !options.keep_going {
                refuse_broken(&refused)?;
            }
            plan.refuse(|id| scene_of(id).and_then(|scene| refused.get(scene)).cloned());
            summary.failed = refused.into_values().collect();
        }
        Ok(summary)
    }

    /// Walks the plan under the locks of project and cache, exports, and brings the lock file up to date. If the lock
    /// file is to stay as it is, and the results differ from it, nothing outside the cache is written, and the summary
    /// lists the hashes that differ.
    pub(super) fn run(
        &mut self,
        plan: &mut Plan,
        scope: Scope,
        options: Options,
        progress: &Progress,
    ) -> Result<Summary> {
        // Judging needs no lock, writes nothing, and is enough if there is nothing to do. Project and cache are written
        // only if the project can be run.
        let summary = self.rehearse(plan, scope, options, progress)?;
        if summary.nothing_to_do() && self.leftovers(&summary).is_empty() {
            return Ok(summary);
        }
        let _locks = [Exports::lock(&self.project.root)?, self.store.lock()?];
        let root = &self.project.root;
        // All is run again, and overwritten, that does not depend on a task that fails.
        let options = Options { keep_going: options.keep_going || options.force, ..options };
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
        if summary.lock_file_changed {
            recorded(scope, &summary, &known).write(root)?;
        }
        Ok(summary)
    }

    fn results<'a>(
        &'a self,
        plan: &'a Plan,
        manifests: &'a BTreeMap<String, Manifest>,
    ) -> WalkResults<'a> {
        WalkResults { plan, manifests, store: &self.store }
    }

    /// Checks what a run of the tasks that are not up to date would read, and warns of meshes whose parts touch without
    /// being joined. Returns the scenes that cannot be run, each with the error.
    fn check(
        &self,
        plan: &Plan,
        summary: &Summary,
        progress: &Progress,
    ) -> Result<BTreeMap<String, String>> {
        let (mut at_work, mut files) = (BTreeSet::new(), BTreeSet::new());
        for one in summary.not_fresh() {
            at_work.extend(scene_of(&one.task));
            let task = plan.task(&one.task);
            files.extend(task.iter().flat_map(|task| task.files.keys().map(String::as_str)));
        }
        let checked = self.project.check(&at_work, &files)?;
        if checked.refused.is_empty() {
            checked.warnings.iter().for_each(|warning| progress.note(&for_talk(warning)));
        }
        Ok(checked.refused)
    }

    /// Runs the stale tasks of a part of the plan, exports, and records; returns the manifests of all tasks of the
    /// part.
    pub(super) fn bring_up_to_date(
        &mut self,
        part: &mut Plan,
    ) -> Result<BTreeMap<String, Manifest>> {
        let progress = Progress::new(false, false);
        Ok(self.run(part, Scope::Part, Options::default(), &progress)?.manifests)
    }

    /// Runs the stale tasks of a part of the plan, and writes to the cache alone; returns the manifests of all tasks of
    /// the part.
    pub(super) fn compute(&mut self, part: &Plan) -> Result<BTreeMap<String, Manifest>> {
        let progress = Progress::new(false, false);
        let look = self.execute(part, LOOK, &progress)?;
        if look.not_fresh().next().is_none() {
            return Ok(look.manifests);
        }
        refuse_broken(&self.check(part, &look, &progress)?)?;
        let _lock = self.store.lock()?;
        let options = Options { jobs: jobs(0), ..Options::default() };
        let summary = self.execute(part, options, &progress)?;
        match summary.failed.is_empty() {
            true => Ok(summary.manifests),
            false => Err(Error::Stage(summary.failed)),
        }
    }

    /// Runs single tasks beside other processes; only the cache is written.
    pub(super) fn work(
        cache: &CacheArgs,
        asked: &[String],
        progress: &Progress,
    ) -> Result<Summary> {
        let (workplace, plan) = Self::with_tasks(cache, asked)?;
        let plan = plan.only(|id| asked.iter().any(|asked| asked == id));
        let summary = workplace.execute(&plan, LOOK, progress)?;
        refuse_broken(&workplace.check(&plan, &summary, progress)?)?;
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
        let mut summary = self.execute(plan, options, progress)?;
        let results = self.results(plan, &summary.manifests);
        let lock_file = results.lock_file();
        let known = LockFile::read(root)?;
        let rights = Rights { overwrite: options.force, remove: scope != Scope::Part };
        summary.exports = Exports::plan(root, &results, &known.exports, rights)?;
        summary.lock_file = lock_file;
        // Before all tasks are done, nobody knows what they make.
        summary.lock_file_changed = summary.manifests.len() == plan.tasks().len()
            && recorded(scope, &summary, &known) != known;
        Ok((summary, known))
    }

    fn execute(&self, plan: &Plan, options: Options, progress: &Progress) -> Result<Summary> {
        // What only looks ends at once, without a handler.
        let never = Interrupt::new();
        let interrupt = if options.dry_run { &never } else { interrupted() };
        execute(plan, &self.store, options, progress, interrupt)
    }
}

/// Returns the lock file after a walk.
fn recorded(scope: Scope, summary: &Summary, known: &LockFile) -> LockFile {
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

/// Names the files that were not written because they have other bytes than signorini wrote.
fn refuse_edited(summary: &Summary) -> Result<()> {
    let Some(first) = summary.exports.edited.first() else { return Ok(()) };
    let alike = summary.exports.edited.iter().filter(|file| file.by == first.by);
    let alike: Vec<&str> = alike.map(|file| &*file.path).collect();
    Err(Error::input(edited(first.by, &alike)))
}

/// Returns a line on files that were not written because of this editor.
pub(super) fn edited(by: Editor, paths: &[&str]) -> String {
    let (files, was, has, it, names) = match paths {
        [path] => ((*path).to_owned(), "was", "has", "it", String::new()),
        _ => {
            let names = format!(": {}", paths.join(", "));
            (format!("{} files", paths.len()), "were", "have", "them", names)
        }
    };
    let force = format!("move {it} away, or overwrite {it} by `signorini run --force`");
    match by {
        Editor::Hand => format!("{files} {was} edited by hand{names}; {force}"),
        Editor::Merge => {
            format!("{files} {has} a {CONFLICT}{names}; delete {it} and run again")
        }
        Editor::Link => {
            format!("a link is in the place of {files}{names}; remove {it} and run again")
        }
        Editor::Unknown => format!("nothing is on record of {files}{names}; {force}"),
    }
}
