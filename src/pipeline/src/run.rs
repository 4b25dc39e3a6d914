//! Run of tasks: reads the artifacts that they need from the store, and stores those that they make.

use super::manifest::Manifest;
use super::store::Store;
use super::{Artifacts, Hashes, Inputs, Interrupt, PROGRAM, Task, hash};
use crate::error::{Error, Result};
use std::any::Any;
use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Task that is to be run.
pub(super) struct PreparedTask<'a> {
    pub(super) task: &'a Task,
    pub(super) inputs: BTreeMap<String, String>,
    /// Artifacts of the tasks that it needs.
    pub(super) needed: Vec<(String, Hashes)>,
}

/// Runs tasks of one group, or one alone, by the function of the first; returns the record of each.
pub(super) fn run(
    jobs: Vec<PreparedTask<'_>>,
    store: &Store,
    interrupt: &Interrupt,
) -> Vec<Result<Manifest>> {
    let mut read = Vec::new();
    for PreparedTask { task, inputs, needed } in &jobs {
        match artifacts(needed, store) {
            Ok(artifacts) => read.push((*task, artifacts, shown_digest(inputs))),
            Err(e) => return vec![Err(e)],
        }
    }
    let inputs = read.iter().map(|(task, artifacts, digest)| Inputs {
        task: &task.id,
        files: &task.files,
        artifacts,
        digest,
        scratch: store.scratch(),
        interrupted: interrupt.flag(),
    });
    let inputs: Vec<_> = inputs.collect();
    let given: Vec<_> = jobs.iter().map(|job| &job.task.value).zip(&inputs).collect();
    // A panic must not end the other tasks; its own message has been printed.
    let made = catch_unwind(AssertUnwindSafe(|| (jobs[0].task.work)(&given)));
    let made = match made {
        Ok(made) => made,
        Err(panic) if jobs.len() == 1 => vec![Err(why(&*panic).into())],
        // Of the others, which may be without fault, each is run alone.
        Err(_) => {
            let alone = jobs.into_iter().flat_map(|job| run(vec![job], store, interrupt));
            return alone.collect();
        }
    };
    let mut records = Vec::new();
    for (made, PreparedTask { task, inputs, .. }) in made.into_iter().zip(jobs) {
        records.push(match made {
            Ok(made) => store.record(&task.id, inputs, &made),
            Err(failure) => Err(match failure.downcast_ref() {
                Some(Error::Interrupted) => Error::Interrupted,
                _ => Error::Stage(vec![format!("{}: {failure}", task.id)]),
            }),
        });
    }
    records
}

/// Reads the artifacts of the tasks that a task needs.
fn artifacts(needed: &[(String, Hashes)], store: &Store) -> Result<BTreeMap<String, Artifacts>> {
    let mut artifacts = BTreeMap::new();
    for (need, outputs) in needed {
        artifacts.insert(need.clone(), store.artifacts(need, outputs)?);
    }
    Ok(artifacts)
}

/// Returns in words why a task panicked: libraries that get no thread or memory do so.
fn why(panic: &(dyn Any + Send)) -> &'static str {
    let said = panic.downcast_ref::<String>().map(String::as_str);
    let said = said.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or_default();
    let refused =
        ["Resource temporarily unavailable", "Cannot allocate memory", "WouldBlock", "OutOfMemory"];
    match refused.iter().any(|refused| said.contains(refused)) {
        true => "the system refuses threads or memory; raise the limit (`ulimit -u`, `ulimit -v`)",
        false => "panicked, which is a fault of the program",
    }
}

/// Returns the hash of the inputs without the program: with it, every change of code would change the figures, which
/// show this hash.
fn shown_digest(inputs: &BTreeMap<String, String>) -> String {
    let shown: BTreeMap<_, _> = inputs.iter().filter(|(input, _)| *input != PROGRAM).collect();
    hash(&serde_json::to_vec(&shown).expect("inputs are plain data"))
}
