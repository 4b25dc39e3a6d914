//! What a walk of the plan is asked for, and what it tells.

use super::{Exports, LockFile, Manifest, Reason, Verdict};
use std::collections::BTreeMap;
use std::time::Duration;

/// How to walk the plan.
#[derive(Clone, Copy, Debug, Default)]
pub struct Options {
    /// Run everything.
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
    /// What is to become of it.
    pub verdict: Verdict,
}

/// What a walk found and did.
#[derive(Debug, Default)]
pub struct Summary {
    /// Verdict on every task before it ran, in the plan's order.
    pub verdicts: Vec<Judged>,
    /// Tasks that ran, in the plan's order.
    pub ran: Vec<Ran>,
    /// What is exported where, written and removed, or in a dry run would be.
    pub exports: Exports,
    /// Tasks that failed or could not run because of one that did, each with its reason.
    pub failed: Vec<String>,
    /// Manifests of all tasks that are up to date now.
    pub manifests: BTreeMap<String, Manifest>,
    /// Where the results differ from `pipeline/lock.toml`, of a run that must not change it.
    pub differences: Vec<String>,
    /// Whether `pipeline/lock.toml` was written anew.
    pub lock_file_changed: bool,
    /// Whether a run would have to note that an older result is in use again.
    pub reverted: bool,
}

impl Summary {
    /// Whether nothing was, or in a dry run would be, run or exported.
    pub fn nothing_to_do(&self) -> bool {
        self.exports.is_empty()
            && self.exports.edited.is_empty()
            && !self.reverted
            && self.not_fresh().next().is_none()
    }

    /// The tasks that are stale, or wait for those that are.
    pub fn not_fresh(&self) -> impl Iterator<Item = &Judged> {
        self.verdicts.iter().filter(|judged| judged.verdict != Verdict::Fresh)
    }

    /// The lock file that this walk supports.
    pub fn lock_file(&self) -> LockFile {
        LockFile {
            tasks: self.manifests.iter().map(|(id, m)| (id.clone(), m.digest())).collect(),
            exports: self.exports.files.clone(),
        }
    }
}
