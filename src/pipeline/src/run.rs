//! Run of one task: reads the artifacts that it needs from the store, and stores those that it makes.

use super::manifest::Manifest;
use super::store::Store;
use super::{Artifacts, Hashes, Inputs, Interrupt, PROGRAM, Task, hash};
use crate::error::{Error, Result};
use std::any::Any;
use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Runs a task; returns its record.
pub(super) fn run(
    task: &Task,
    inputs: BTreeMap<String, String>,
    needed: Vec<(String, Hashes)>,
    (store, interrupt): (&Store, &Interrupt),
) -> Result<Manifest> {
    let mut artifacts = BTreeMap::<String, Artifacts>::new();
    for (need, outputs) in &needed {
        artifacts.insert(need.clone(), store.artifacts(need, outputs)?);
    }
    let digest = shown_digest(&inputs);
    let given = Inputs {
        task: &task.id,
        files: &task.files,
        artifacts: &artifacts,
        digest: &digest,
        scratch: store.scratch(),
        interrupted: interrupt.flag(),
    };
    // A panic must not end the other tasks; its own message has been printed.
    let reason = match catch_unwind(AssertUnwindSafe(|| task.make(&given))) {
        Ok(Ok(made)) => return store.record(&task.id, inputs, &made),
        Ok(Err(failure)) => match failure.downcast_ref() {
            Some(Error::Interrupted) => return Err(Error::Interrupted),
            _ => failure.to_string(),
        },
        Err(panic) => why(&*panic).to_owned(),
    };
    Err(Error::Stage(vec![format!("{}: {reason}", task.id)]))
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
