//! Run of one task: reads the artifacts that it needs from the store, and stores those that it makes.

use super::manifest::Manifest;
use super::store::Store;
use super::{Artifacts, Hashes, Inputs, PROGRAM, Plan, Task, hash};
use crate::pipeline::error::{Error, Result};
use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Runs a task of a plan; returns its record.
pub(super) fn run(
    (plan, task): (&Plan, &Task),
    inputs: BTreeMap<String, String>,
    needed: Vec<(String, Hashes)>,
    store: &Store,
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
        program: &plan.program,
    };
    // A panic must not end the other tasks; its own message has been printed.
    let reason = match catch_unwind(AssertUnwindSafe(|| task.make(&given))) {
        Ok(Ok(made)) => return store.record(&task.id, inputs, &made),
        Ok(Err(failure)) => failure.to_string(),
        Err(_) => "panicked, which is a fault of the program".to_owned(),
    };
    Err(Error::Stage(vec![format!("{}: {reason}", task.id)]))
}

/// Returns the hash of the inputs without the program: with it, every change of code would change the figures, which
/// show this hash.
fn shown_digest(inputs: &BTreeMap<String, String>) -> String {
    let shown: BTreeMap<_, _> = inputs.iter().filter(|(input, _)| *input != PROGRAM).collect();
    hash(&serde_json::to_vec(&shown).expect("inputs are plain data"))
}
