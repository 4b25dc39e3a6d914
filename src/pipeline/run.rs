//! Runs one task: reads what it needs from the store, and stores what it makes.

use super::manifest::{Manifest, PROGRAM};
use super::store::Store;
use super::{Artifacts, Hashes, Inputs, Task, hash};
use crate::pipeline::error::{Error, Result};
use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Runs a task; returns its record.
pub(super) fn run(
    task: &Task,
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
        files: &task.files,
        artifacts: &artifacts,
        digest: &digest,
        scratch: store.scratch(),
    };
    let failed = |reason: String| Error::Stage(vec![format!("{}: {reason}", task.id)]);
    // A panic must not take the other tasks with it; its own message has been printed.
    let made = catch_unwind(AssertUnwindSafe(|| (task.work)(&given)))
        .map_err(|_| failed("panicked, which is a fault of the program".into()))?;
    let made = made.map_err(|reason| failed(reason.to_string()))?;
    store.record(&task.id, inputs, &made)
}

/// Hash of the inputs without the program: with it, every change of code would redraw what shows it.
fn shown_digest(inputs: &BTreeMap<String, String>) -> String {
    let shown: BTreeMap<_, _> = inputs.iter().filter(|(input, _)| *input != PROGRAM).collect();
    hash(&serde_json::to_vec(&shown).expect("inputs are plain data"))
}
