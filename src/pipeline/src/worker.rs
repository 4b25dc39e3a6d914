//! Runs of single tasks by several processes, on one machine or several, with one cache.
//!
//! All processes share the lock of the cache, which excludes whole runs and `gc`, and each task has a lock of its own:
//! a second process waits for it, and finds the task done. Only the cache is written, an object or manifest at a time;
//! a task whose process is killed has not run.

use super::execute::execute;
use super::store::Store;
use super::{Interrupt, Options, Plan, Progress, Summary};
use crate::error::{Error, Result};

/// Runs those tasks of the plan that are `asked` for and not up to date, one after the other: for each, under its
/// lock, [`execute`] walks the plan, and may run this task only.
///
/// # Errors
/// [`Error::Input`] with the command to run first if a task that they need is not up to date;
/// [`Error::Stage`] from the first task that fails; [`Error::Io`] from the cache; [`Error::Interrupted`].
pub fn work(
    plan: &Plan,
    asked: &[String],
    store: &Store,
    progress: &Progress,
    interrupt: &Interrupt,
) -> Result<Summary> {
    let _cache = store.share(&|holder| {
        progress.note(&format!("waiting for {holder}, at work in the cache"));
    })?;
    let mut all = Summary::default();
    let stamps = plan.stamps()?;
    for (k, task) in plan.tasks().iter().enumerate().filter(|(_, task)| asked.contains(&task.id)) {
        let id = &task.id;
        let _task = store.lock_task(id, &|holder| {
            progress.note(&format!("waiting for {holder}, at work on {id}"));
        })?;
        let jobs = rayon::current_num_threads();
        let options = Options { jobs, only: Some(k), ..Options::default() };
        let mut summary = execute(plan, store, options, progress, interrupt)?;
        if !summary.failed.is_empty() {
            return Err(Error::Stage(summary.failed));
        }
        store.stamp(&stamps[k], &summary.manifests[id])?;
        all.verdicts.push(summary.verdicts.swap_remove(k));
        all.ran.append(&mut summary.ran);
    }
    Ok(all)
}

#[cfg(test)]
mod tests;
