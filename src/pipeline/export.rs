//! Copies of artifacts in the project folder, written so that a file edited by hand is never lost.

use super::files::{is_plain, leftovers, read_if_there, write_atomically};
use super::{Hashes, Lock, Manifest, Plan, Store, hash};
use crate::pipeline::error::{Error, IoContext, Result};
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// Files to write and to remove so that the project folder shows what the tasks last computed.
#[derive(Debug, Default)]
pub struct Exports {
    /// Path in the project -> hash, of everything that is to be there.
    pub files: Hashes,
    /// Paths of files that somebody edited; they are neither written nor removed.
    pub edited: Vec<String>,
    write: Hashes,
    remove: BTreeSet<String>,
    written: Written,
}

impl Exports {
    /// What exporting these manifests would change.
    ///
    /// A file may be overwritten if it is empty, or signorini is on record to have written it: in the
    /// lock file, whose exports are `known`, in the cache or in the record of exports. With `force`, every file may be. If
    /// `whole`, the plan is all there is, and files of earlier plans are to go.
    ///
    /// # Errors
    /// [`Error::Io`] if a file is there and cannot be read.
    pub fn plan(
        project: &Path,
        plan: &Plan,
        manifests: &BTreeMap<String, Manifest>,
        store: &Store,
        known: &Hashes,
        [force, whole]: [bool; 2],
    ) -> Result<Self> {
        let mut exports = Self { written: Written::read(project), ..Self::default() };
        let on_record = |exports: &Self, path: &str, found: &str| {
            known.get(path).is_some_and(|hash| hash == found) || exports.written.knows(path, found)
        };
        for task in plan.tasks() {
            let (Some(folder), Some(manifest)) = (task.export, manifests.get(&task.id)) else {
                continue;
            };
            // Only read when something differs: the usual run changes nothing.
            let mut earlier: Option<Vec<Manifest>> = None;
            for (name, wanted) in &manifest.outputs {
                let path = format!("{folder}/{name}");
                exports.files.insert(path.clone(), wanted.clone());
                let there = read_if_there(&project.join(&path))?;
                let found = there.as_deref().map(hash);
                if found.as_ref() == Some(wanted) {
                    continue;
                }
                let mut in_cache = |found: &String| {
                    let earlier = earlier.get_or_insert_with(|| store.manifests(&task.id));
                    earlier.iter().any(|then| then.outputs.get(name) == Some(found))
                };
                // An empty file holds nothing that could be lost.
                let edited = found.filter(|_| there.is_some_and(|bytes| !bytes.is_empty()));
                match edited {
                    Some(found)
                        if !force && !on_record(&exports, &path, &found) && !in_cache(&found) =>
                    {
                        exports.edited.push(path);
                    }
                    _ => {
                        exports.write.insert(path, wanted.clone());
                    }
                }
            }
        }
        // What a task that failed or waits made before is still wanted.
        if whole && manifests.len() == plan.tasks().len() {
            let old = known.keys().chain(exports.written.0.keys());
            for path in old.filter(|path| !exports.files.contains_key(*path) && is_plain(path)) {
                let found = read_if_there(&project.join(path))?;
                if found.is_some_and(|bytes| on_record(&exports, path, &hash(&bytes))) {
                    exports.remove.insert(path.clone());
                }
            }
        }
        Ok(exports)
    }

    /// The right to write to the project.
    ///
    /// # Errors
    /// [`Error::Input`] naming the process that holds it; [`Error::Io`].
    pub fn lock(project: &Path) -> Result<Lock> {
        Lock::take(&project.join("pipeline/.lock"))
    }

    /// What killed runs left behind, if none is at work.
    pub fn leftovers(&self, project: &Path) -> Vec<PathBuf> {
        let mut folders: BTreeSet<&str> =
            self.files.keys().filter_map(|path| path.split('/').next()).collect();
        folders.insert("pipeline");
        leftovers(folders.into_iter().map(|folder| project.join(folder)))
    }

    /// How many files there are to write, and how many to remove.
    pub fn counts(&self) -> (usize, usize) {
        (self.write.len(), self.remove.len())
    }

    /// Whether the project folder already shows everything, as far as it may be changed.
    pub fn is_empty(&self) -> bool {
        self.counts() == (0, 0)
    }

    /// Writes and removes files; the caller holds the lock of the project.
    ///
    /// # Errors
    /// [`Error::Io`], or [`Error::Input`] if an artifact vanished.
    pub fn perform(&self, project: &Path, store: &Store) -> Result<()> {
        if self.is_empty() {
            return Ok(());
        }
        // Before and after: a run killed in between has put nothing there that is not on record.
        let mut written = self.written.clone();
        for (path, hash) in &self.write {
            written.0.entry(path.clone()).or_default().insert(hash.clone());
        }
        written.save(project)?;
        for path in &self.remove {
            let path = project.join(path);
            fs::remove_file(&path).context("remove", &path)?;
            // Fails, as it should, at the first folder that still holds something.
            let folders = path.ancestors().skip(1).take_while(|folder| *folder != project);
            folders.map(fs::remove_dir).take_while(std::result::Result::is_ok).for_each(drop);
            written.0.retain(|known, _| project.join(known) != path);
        }
        for (path, hash) in &self.write {
            let bytes = store.get(hash).ok_or_else(|| {
                Error::input(format!(
                    "the artifact of {path} vanished while signorini ran; run again"
                ))
            })?;
            write_atomically(&project.join(path), &bytes)?;
            written.0.insert(path.clone(), BTreeSet::from([hash.clone()]));
        }
        written.save(project)
    }
}

/// Which bytes this copy of the project was given, by path and hash; not for other copies.
///
/// The lock file says what they were when it was committed, and the cache may be removed: neither
/// knows of a run whose lock file was reverted.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Written(BTreeMap<String, BTreeSet<String>>);

impl Written {
    fn path(project: &Path) -> PathBuf {
        project.join("pipeline/.exported.json")
    }

    /// What is on record; a record that is missing or damaged is as good as empty.
    fn read(project: &Path) -> Self {
        let text = fs::read(Self::path(project)).unwrap_or_default();
        serde_json::from_slice(&text).unwrap_or_default()
    }

    fn knows(&self, path: &str, hash: &str) -> bool {
        self.0.get(path).is_some_and(|hashes| hashes.contains(hash))
    }

    fn save(&self, project: &Path) -> Result<()> {
        let text = serde_json::to_vec_pretty(self).expect("hashes are plain data");
        write_atomically(&Self::path(project), &text)
    }
}
