//! Options of a walk of the plan, and its summary.

use super::{Exports, LockFile, Manifest, Reason, Verdict};
use std::collections::BTreeMap;
use std::time::Duration;

/// Options of a walk of the plan.
#[derive(Clone, Copy, Debug, Default)]
pub struct Options {
    /// Run everything.
    pub force: bool,
    /// After a failure, go on with tasks that do not depend on the one that failed.
    pub keep_going: bool,
    /// Threads; 0 means one per core. Results do not depend on it.
    pub jobs: usize,
    /// Judge only; write nothing.
    pub dry_run: bool,
    /// Number of the one task that may run; without it, all may.
    pub only: Option<usize>,
}

/// Task that ran.
#[derive(Clone, Debug)]
pub struct Ran {
    /// Task id.
    pub task: String,
    /// Reason for running it.
    pub reason: Reason,
    /// Time that its work took; of tasks side by side an equal share.
    pub time: Duration,
}

/// Task with its verdict.
#[derive(Clone, Debug)]
pub struct Judged {
    /// Task id.
    pub task: String,
    /// Verdict before it ran.
    pub verdict: Verdict,
}

/// Summary of a walk.
#[derive(Debug, Default)]
pub struct Summary {
    /// Verdict on every task before it ran, in the plan's order.
    pub verdicts: Vec<Judged>,
    /// Tasks that ran, in the plan's order.
    pub ran: Vec<Ran>,
    /// Files exported and removed, or in a dry run to be exported and removed.
    pub exports: Exports,
    /// Lock file with the results of this walk.
    pub lock_file: LockFile,
    /// Tasks that failed, and tasks that could not run because another failed, each with its reason; before a run, the
    /// scenes that cannot be run.
    pub failed: Vec<String>,
    /// Manifests of all tasks that are up to date now.
    pub manifests: BTreeMap<String, Manifest>,
    /// Differences of the results from `pipeline/lock.toml`, of a run that must not change that file.
    pub differences: Vec<String>,
    /// True if `pipeline/lock.toml` was missing or old: it was written anew or, in a dry run, has to be.
    pub lock_file_changed: bool,
    /// True if a run has to record that an older result is in use again.
    pub reverted: bool,
}

impl Summary {
    /// True if no task was run and no file written, or in a dry run none has to be.
    pub fn nothing_to_do(&self) -> bool {
        self.exports.is_empty()
            && self.exports.edited.is_empty()
            && !self.reverted
            && !self.lock_file_changed
            && self.not_fresh().next().is_none()
    }

    /// Tasks that are stale, or wait for a stale one.
    pub fn not_fresh(&self) -> impl Iterator<Item = &Judged> {
        self.verdicts.iter().filter(|judged| judged.verdict != Verdict::Fresh)
    }
}
