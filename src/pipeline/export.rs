//! Copies of artifacts in the project folder, written so that a file edited by hand is never lost.

use super::store::write_atomically;
use super::{Manifest, Store, Task, hash};
use crate::pipeline::error::{Error, Result};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

/// Files to write and to remove so that the project folder shows what a task last computed.
#[derive(Debug, Default)]
pub(super) struct Exports {
    /// Path in the project -> hash of its artifact.
    write: BTreeMap<String, String>,
    remove: BTreeSet<String>,
}

impl Exports {
    /// What exporting `manifest` would change.
    ///
    /// `known` are hashes by path that an earlier run is on record to have written (the lock file).
    ///
    /// # Errors
    /// [`Error::Input`] if a file that would be overwritten is not one that signorini wrote,
    /// unless `force`.
    pub(super) fn plan(
        project: &Path,
        store: &Store,
        task: &Task,
        manifest: &Manifest,
        known: &BTreeMap<String, String>,
        force: bool,
    ) -> Result<Self> {
        let mut exports = Self::default();
        let Some(folder) = task.export else { return Ok(exports) };
        let path = |name: &str| format!("{folder}/{name}");
        // Only read when something differs: the usual run changes nothing.
        let mut earlier: Option<Vec<Manifest>> = None;
        let mut ours = |name: &str, found: &str| {
            known.get(&path(name)).is_some_and(|hash| hash == found)
                || earlier
                    .get_or_insert_with(|| store.manifests(&task.id))
                    .iter()
                    .any(|m| m.outputs.get(name).is_some_and(|hash| hash == found))
        };
        for (name, wanted) in &manifest.outputs {
            let found = fs::read(project.join(path(name))).ok().map(|bytes| hash(&bytes));
            match found {
                Some(found) if found == *wanted => continue,
                Some(found) if !force && !ours(name, &found) => {
                    return Err(Error::input(format!(
                        "{} was edited by hand; move it away, or overwrite it with --force",
                        path(name)
                    )));
                }
                _ => exports.write.insert(path(name), wanted.clone()),
            };
        }
        if manifest.outputs.len() > 1 {
            // A book's files have hashes in their names: those of earlier runs would pile up.
            for old in store.manifests(&task.id) {
                for (name, hash_then) in old.outputs {
                    let unedited =
                        || fs::read(project.join(path(&name))).is_ok_and(|b| hash(&b) == hash_then);
                    if !manifest.outputs.contains_key(&name) && unedited() {
                        exports.remove.insert(path(&name));
                    }
                }
            }
        }
        Ok(exports)
    }

    /// Whether the project folder already shows everything.
    pub(super) fn is_empty(&self) -> bool {
        self.write.is_empty() && self.remove.is_empty()
    }

    /// Writes and removes files; returns how many.
    ///
    /// # Errors
    /// [`Error::Io`], or [`Error::Input`] if an artifact vanished.
    pub(super) fn perform(&self, project: &Path, store: &Store) -> Result<usize> {
        for path in &self.remove {
            // Absent is what we want it to be.
            let _ = fs::remove_file(project.join(path));
        }
        for (path, hash) in &self.write {
            let bytes = store.get(hash).ok_or_else(|| {
                Error::input(format!(
                    "the artifact of {path} vanished while signorini ran; run again"
                ))
            })?;
            write_atomically(&project.join(path), &bytes)?;
        }
        Ok(self.write.len() + self.remove.len())
    }
}
