//! Time of a run, from the times of the cache's files: no record has the time of a clock in it.

use super::store::Store;
use crate::pipeline::error::{IoContext, Result};
use std::fs;
use std::path::Path;
use std::time::SystemTime;

/// Time from the start of the first of some tasks to the end of the last.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Span {
    /// Start of the first task.
    pub start: SystemTime,
    /// End of the last task.
    pub end: SystemTime,
}

impl Store {
    /// Returns the time in which these tasks ran.
    ///
    /// A task ends when its record is written. The first task starts when the lock of the cache is taken; if the lock
    /// was taken again after the tasks, its first time is lost, and the end of the first task stands for the start.
    ///
    /// # Errors
    /// [`Error::Io`](crate::pipeline::error::Error::Io) if a task has no record.
    ///
    /// # Panics
    /// If there is no task.
    pub fn span<'a>(&self, tasks: impl Iterator<Item = &'a String>) -> Result<Span> {
        let ends = tasks.map(|task| modified(&self.runs_file(task))).collect::<Result<Vec<_>>>()?;
        let first = *ends.iter().min().expect("a run has tasks");
        let end = *ends.iter().max().expect("a run has tasks");
        let locked = modified(&self.lock_file()).unwrap_or(first);
        Ok(Span { start: first.min(locked), end })
    }
}

fn modified(path: &Path) -> Result<SystemTime> {
    fs::metadata(path).and_then(|file| file.modified()).context("read the time of", path)
}
