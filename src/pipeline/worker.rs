//! Runs of single tasks by several processes, on one machine or several, with one cache.
//!
//! All processes share the lock of the cache, which excludes whole runs and `gc`, and each task has a lock of its own:
//! a second process waits for it, and finds the task done. Only the cache is written, an object or manifest at a time;
//! a task whose process is killed has not run.

use super::manifest::{Manifest, Verdict};
use super::run::run;
use super::store::Store;
use super::{Hashes, Judged, Plan, Progress, Ran, Summary, Task};
use crate::pipeline::error::{Error, Result};
use std::collections::BTreeMap;
use std::time::Instant;

/// Runs those tasks of the plan that are `asked` for and not up to date, one after the other.
///
/// # Errors
/// [`Error::Input`] with the command to run first if a task that they need is not up to date;
/// [`Error::Stage`] from the first task that fails; [`Error::Io`] from the cache.
pub fn work(plan: &Plan, asked: &[String], store: &Store, progress: &Progress) -> Result<Summary> {
    let _cache = store.share(&|holder| {
        progress.note(&format!("waiting for {holder}, at work in the cache"));
    })?;
    let mut worker = Worker { store, progress, summary: Summary::default() };
    for (task, stamp) in plan.tasks().iter().zip(plan.stamps()?) {
        let inputs = plan.inputs(task, |need| &worker.summary.manifests[need].outputs)?;
        let manifest = if asked.contains(&task.id) {
            worker.bring_up_to_date(task, inputs, &stamp)?
        } else {
            let hit = store.lookup(&task.id, &inputs).map_err(|reason| {
                let id = &task.id;
                Error::input(format!(
                    "{id} is needed and not up to date ({reason}); first `signorini run --task {id}`"
                ))
            })?;
            hit.manifest
        };
        worker.summary.manifests.insert(task.id.clone(), manifest);
    }
    Ok(worker.summary)
}

struct Worker<'a> {
    store: &'a Store,
    progress: &'a Progress,
    summary: Summary,
}

impl Worker<'_> {
    /// Runs a task under its lock, unless it turns out to be done.
    fn bring_up_to_date(
        &mut self,
        task: &Task,
        inputs: BTreeMap<String, String>,
        stamp: &str,
    ) -> Result<Manifest> {
        let id = &task.id;
        let _task = self.store.lock_task(id, &|holder| {
            self.progress.note(&format!("waiting for {holder}, at work on {id}"));
        })?;
        let (manifest, verdict) = match self.store.lookup(id, &inputs) {
            Ok(hit) => {
                if hit.reverted {
                    self.store.renew(&hit.manifest)?;
                }
                (hit.manifest, Verdict::Fresh)
            }
            Err(reason) => {
                self.progress.begin(1, &reason.to_string());
                self.progress.start(id);
                let mut needed: Vec<(String, Hashes)> = Vec::new();
                for need in &task.needs {
                    needed.push((need.clone(), self.summary.manifests[need].outputs.clone()));
                }
                let start = Instant::now();
                let made = run(task, inputs, needed, self.store);
                let ran = Ran { task: id.clone(), reason: reason.clone(), time: start.elapsed() };
                self.progress.done(&ran, made.is_ok());
                self.progress.end();
                self.summary.ran.push(ran);
                (made?, Verdict::Stale(reason))
            }
        };
        self.store.stamp(stamp, &manifest)?;
        self.summary.verdicts.push(Judged { task: id.clone(), verdict });
        Ok(manifest)
    }
}

#[cfg(test)]
mod tests;
