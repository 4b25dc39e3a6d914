//! Walks the plan stage by stage: looks each task up, runs what is stale in parallel, exports the results.

use super::export::Exports;
use super::manifest::{Manifest, Reason, Verdict};
use super::store::Store;
use super::times::Times;
use super::{Artifacts, Hashes, Inputs, LockFile, Progress, Stage, Task, hash, why};
use crate::pipeline::error::{Error, Result};
use rayon::prelude::*;
use serde_json::json;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// How to walk the plan.
#[derive(Clone, Copy, Debug, Default)]
pub struct Options {
    /// Run everything, and overwrite edited exports.
    pub force: bool,
    /// After a failure go on with what does not depend on it.
    pub keep_going: bool,
    /// Threads; 0 means one per core. Results do not depend on it.
    pub jobs: usize,
    /// Judge only; write nothing.
    pub dry_run: bool,
}

/// A task that ran.
#[derive(Clone, Debug)]
pub struct Ran {
    /// Task id.
    pub task: String,
    /// Its stage.
    pub stage: Stage,
    /// Why it ran.
    pub reason: Reason,
    /// How long its work took.
    pub time: Duration,
}

/// A task with its verdict.
#[derive(Clone, Debug)]
pub struct Judged {
    /// Task id.
    pub task: String,
    /// Its stage.
    pub stage: Stage,
    /// What is to become of it.
    pub verdict: Verdict,
}

/// What a walk found and did.
#[derive(Debug, Default)]
pub struct Summary {
    /// Verdict on every task as it was before the walk, in the plan's order.
    pub verdicts: Vec<Judged>,
    /// Tasks that ran, in the plan's order.
    pub ran: Vec<Ran>,
    /// Stages in which something ran, each with the time from its first task to its last.
    pub stages: Vec<(Stage, Duration)>,
    /// What the tasks were expected to take, before the first one ran; `None` if that is not known.
    pub expected: Option<Duration>,
    /// Threads that ran tasks.
    pub threads: usize,
    /// Files written to or removed from the project folder.
    pub exported: usize,
    /// Exports that were edited by hand, one message each; in a walk that writes they are an error.
    pub edited: Vec<String>,
    /// Tasks that failed or could not run because of one that did, each with its reason.
    pub failed: Vec<String>,
    /// Manifests of all tasks that are up to date now.
    pub manifests: BTreeMap<String, Manifest>,
    /// What is exported where, by hash.
    pub exports: Hashes,
}

impl Summary {
    /// Whether nothing was, or in a dry run would be, run or exported.
    pub fn nothing_to_do(&self) -> bool {
        self.exported == 0
            && self.edited.is_empty()
            && self.verdicts.iter().all(|judged| judged.verdict == Verdict::Fresh)
    }

    /// The lock file that this walk supports.
    pub fn lock_file(&self) -> LockFile {
        LockFile {
            tasks: self.manifests.iter().map(|(id, m)| (id.clone(), m.digest())).collect(),
            exports: self.exports.clone(),
        }
    }
}

/// Walks `tasks`, which are in an order that respects their needs.
///
/// `interrupted` is looked at before each task starts; what has started is finished.
///
/// # Errors
/// [`Error::Input`] or [`Error::Io`] if the cache or the project folder refuses; [`Error::Interrupted`].
/// Tasks that fail are in the summary, not errors.
pub fn execute(
    tasks: &[Task],
    store: &Store,
    project: &Path,
    options: Options,
    progress: &Progress,
    interrupted: &AtomicBool,
) -> Result<Summary> {
    let known = LockFile::read(project)?.exports;
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(options.jobs)
        .build()
        .map_err(|e| Error::input(format!("cannot start threads: {e}; use fewer with -j")))?;
    let mut summary = Summary { threads: pool.current_num_threads(), ..Summary::default() };
    let mut outputs: BTreeMap<String, Hashes> = BTreeMap::new();
    // Tasks whose artifacts are not to be had: stale in a dry run, failed otherwise.
    let mut missing: BTreeSet<String> = BTreeSet::new();
    for stage in Stage::ALL {
        let started = Instant::now();
        let mut stale = Vec::new();
        let mut judge = |task: &Task, verdict| {
            summary.verdicts.push(Judged { task: task.id.clone(), stage, verdict });
        };
        for task in tasks.iter().filter(|task| task.stage == stage) {
            if let Some(on) = task.needs.iter().find(|need| missing.contains(*need)) {
                missing.insert(task.id.clone());
                judge(task, Verdict::Waits(on.clone()));
                if !options.dry_run {
                    summary.failed.push(format!("{}: not run, because {on} failed", task.id));
                }
                continue;
            }
            let start = Instant::now();
            let inputs = task.inputs(&outputs);
            let found = match store.lookup(&task.id, &inputs) {
                Ok(_) if options.force => Err(Reason::Forced),
                found => found,
            };
            progress.span("lookup", &task.id, start, || match &found {
                Ok(hit) => json!({ "verdict": "hit", "bytes": hit.bytes }),
                Err(reason) => json!({ "verdict": "miss", "reason": reason.to_string() }),
            });
            let verdict = match found {
                Ok(hit) => {
                    let manifest = if options.dry_run { hit.manifest } else { store.renew(hit)? };
                    outputs.insert(task.id.clone(), manifest.outputs.clone());
                    summary.manifests.insert(task.id.clone(), manifest);
                    Verdict::Fresh
                }
                Err(reason) => {
                    if options.dry_run {
                        missing.insert(task.id.clone());
                    }
                    stale.push((task, inputs, reason.clone()));
                    Verdict::Stale(reason)
                }
            };
            judge(task, verdict);
        }
        if !options.dry_run && !stale.is_empty() {
            let mut times = Times::read(store.folder());
            let ids = || stale.iter().map(|(task, ..)| task.id.as_str());
            let later = likely(tasks, stage, ids(), &outputs, store, options.force);
            let ahead = times.ahead(stage, ids(), later.into_iter(), summary.threads);
            if summary.stages.is_empty() {
                summary.expected = ahead.left();
            }
            let reasons: Vec<&Reason> = stale.iter().map(|(.., reason)| reason).collect();
            progress.begin(stage, stale.len(), &why(&reasons), ahead);
            let running = Instant::now();
            let failed = AtomicBool::new(false);
            let results = Mutex::new(Vec::new());
            pool.install(|| {
                stale.into_par_iter().enumerate().for_each(|(k, (task, inputs, reason))| {
                    let give_up = failed.load(Ordering::Relaxed) && !options.keep_going;
                    if give_up || interrupted.load(Ordering::Relaxed) {
                        return;
                    }
                    progress.start(&task.id);
                    let start = Instant::now();
                    let result = run(task, inputs, &outputs, store, progress);
                    failed.fetch_or(result.is_err(), Ordering::Relaxed);
                    progress.span("task", &task.id, start, || match &result {
                        Ok((_, bytes)) => {
                            json!({ "verdict": "ran", "reason": reason.to_string(), "bytes": bytes })
                        }
                        Err(e) => json!({ "verdict": "failed", "reason": e.to_string() }),
                    });
                    let ran = Ran { task: task.id.clone(), stage, reason, time: start.elapsed() };
                    progress.done(&ran, result.is_ok());
                    results.lock().expect("no panic above").push((k, ran, result));
                });
            });
            progress.end();
            summary.stages.push((stage, running.elapsed()));
            let mut results = results.into_inner().expect("no panic above");
            results.sort_by_key(|(k, ..)| *k);
            for (_, ran, result) in results {
                match result {
                    Ok((manifest, _)) => {
                        times.learn(&ran);
                        outputs.insert(ran.task.clone(), manifest.outputs.clone());
                        summary.manifests.insert(ran.task.clone(), manifest);
                        summary.ran.push(ran);
                    }
                    Err(Error::Stage(reasons)) => {
                        missing.insert(ran.task.clone());
                        summary.failed.extend(reasons);
                    }
                    Err(other) => return Err(other),
                }
            }
            times.save();
            if interrupted.load(Ordering::Relaxed) {
                return Err(Error::Interrupted);
            }
            if !summary.failed.is_empty() && !options.keep_going {
                return Ok(summary);
            }
        }
        for task in tasks.iter().filter(|task| task.stage == stage) {
            let Some(manifest) = summary.manifests.get(&task.id) else { continue };
            let exports = match Exports::plan(project, store, task, manifest, &known, options.force)
            {
                Err(edited @ Error::Input(_)) if options.dry_run => {
                    summary.edited.push(edited.to_string());
                    continue;
                }
                planned => planned?,
            };
            if let Some(folder) = task.export {
                let path =
                    |(name, hash): (&String, &String)| (format!("{folder}/{name}"), hash.clone());
                summary.exports.extend(manifest.outputs.iter().map(path));
            }
            if options.dry_run {
                summary.exported += usize::from(!exports.is_empty());
            } else if !exports.is_empty() {
                let start = Instant::now();
                let files = exports.perform(project, store)?;
                progress.span("export", &task.id, start, || json!({ "files": files }));
                summary.exported += files;
            }
        }
        progress.span("stage", stage.name(), started, || {
            let ran = summary.ran.iter().filter(|ran| ran.stage == stage).count();
            let tasks = tasks.iter().filter(|task| task.stage == stage).count();
            json!({ "tasks": tasks, "ran": ran })
        });
    }
    Ok(summary)
}

/// The tasks of later stages that are likely to run when the tasks `running` of this stage do.
fn likely<'a>(
    tasks: &'a [Task],
    stage: Stage,
    running: impl Iterator<Item = &'a str>,
    outputs: &BTreeMap<String, Hashes>,
    store: &Store,
    force: bool,
) -> Vec<(Stage, &'a str)> {
    let mut running: BTreeSet<&str> = running.collect();
    let mut later = Vec::new();
    for task in tasks.iter().filter(|task| task.stage > stage) {
        let stirred = task.needs.iter().any(|need| running.contains(need.as_str()));
        let stale = || {
            task.needs.iter().all(|need| outputs.contains_key(need))
                && store.lookup(&task.id, &task.inputs(outputs)).is_err()
        };
        if force || stirred || stale() {
            running.insert(&task.id);
            later.push((task.stage, task.id.as_str()));
        }
    }
    later
}

/// Runs a task; returns its record and the size of what it made.
fn run(
    task: &Task,
    inputs: BTreeMap<String, String>,
    outputs: &BTreeMap<String, Hashes>,
    store: &Store,
    progress: &Progress,
) -> Result<(Manifest, usize)> {
    let start = Instant::now();
    let mut artifacts = BTreeMap::<String, Artifacts>::new();
    for need in &task.needs {
        artifacts.insert(need.clone(), store.artifacts(need, &outputs[need])?);
    }
    progress.span("step", "read", start, || json!({ "artifacts": task.needs.len() }));
    let digest = hash(&serde_json::to_vec(&inputs).expect("inputs are plain data"));
    let start = Instant::now();
    let made = (task.work)(&Inputs { files: &task.files, artifacts: &artifacts, digest: &digest });
    progress.span("step", "work", start, || json!({}));
    let made = made.map_err(|reason| Error::Stage(vec![format!("{}: {reason}", task.id)]))?;
    let bytes = made.values().map(Vec::len).sum();
    let start = Instant::now();
    let manifest = store.record(&task.id, inputs, &made)?;
    progress.span("step", "store", start, || json!({ "bytes": bytes }));
    Ok((manifest, bytes))
}
