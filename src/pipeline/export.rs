//! Copies of artifacts in the project folder, written so that a file edited by hand is never lost.

use super::files::{hash_if_there, is_plain, leftovers, read, remove_from, write_atomically};
use super::{Hashes, Lock, Manifest, Plan, Store, Task, hash};
use crate::pipeline::error::{Error, Result, conflict};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// The folders of the project in which exports lie, beside files of people's own.
const FOLDERS: [&str; 2] = ["figures", "report"];

/// An export that is not overwritten.
#[derive(Debug)]
pub struct Edited {
    /// Path in the project.
    pub path: String,
    /// Origin of the bytes.
    pub by: Editor,
}

/// Origin of bytes in an export that are not on record as written by this program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Editor {
    /// Somebody edited the file.
    Hand,
    /// `git merge` marked a conflict in it.
    Merge,
    /// There is no record, as after `git clean`: this program may have written them.
    Unknown,
}

/// Files to write and to remove so that the project folder shows what the tasks last computed.
#[derive(Debug, Default)]
pub struct Exports {
    /// Path in the project -> hash, of everything that is to be there.
    pub files: Hashes,
    /// Files with other bytes than this program wrote; they are neither written nor removed.
    pub edited: Vec<Edited>,
    write: Hashes,
    remove: BTreeSet<String>,
    written: Written,
    /// Hashes of what was there when it was looked ahead.
    there: BTreeMap<String, Option<String>>,
}

impl Exports {
    /// The record of exports, and what is there of the files that the plan is expected to name.
    pub fn look(project: &Path, expected: &Hashes) -> Self {
        let look = |path: &String| Some((path.clone(), hash_if_there(&project.join(path)).ok()?));
        let plain = expected.par_iter().map(|(path, _)| path).filter(|path| is_plain(path));
        let there = || plain.filter_map(look).collect();
        // What cannot be read is a mistake only if the plan does name it.
        let (written, there) = rayon::join(|| Written::read(project), there);
        Self { written, there, ..Self::default() }
    }

    /// What exporting these manifests would change.
    ///
    /// A file may be overwritten if it is empty, or signorini is on record to have written it: in the
    /// lock file, whose exports are `known`, in the cache or in the record of exports. With `force`, every file may be. If
    /// `whole`, the plan is all there is, and files of earlier plans are to go.
    ///
    /// # Errors
    /// [`Error::Io`] if a file is there and cannot be read.
    pub fn plan<'p>(
        mut self,
        project: &Path,
        plan: &'p Plan,
        manifests: &BTreeMap<String, Manifest>,
        store: &Store,
        known: &Hashes,
        [force, whole]: [bool; 2],
    ) -> Result<Self> {
        let exported =
            |task: &'p Task| Some((task, task.export?, &manifests.get(&task.id)?.outputs));
        // Task, name of the artifact, where its copy is to be, and its hash.
        let copies: Vec<(&Task, &String, String, &String)> = plan
            .tasks()
            .iter()
            .filter_map(exported)
            .flat_map(|(task, folder, made)| {
                made.iter().map(move |(name, hash)| (task, name, format!("{folder}/{name}"), hash))
            })
            .collect();
        let mut there = std::mem::take(&mut self.there);
        let unseen = copies.par_iter().filter(|(.., path, _)| !there.contains_key(path));
        let look = |path: &String| Ok((path.clone(), hash_if_there(&project.join(path))?));
        let unseen = unseen.map(|(.., path, _)| look(path));
        there.extend(unseen.collect::<Result<Vec<_>>>()?);
        for (task, name, path, wanted) in copies {
            let found = there.get(&path).and_then(Option::as_ref);
            self.files.insert(path.clone(), wanted.clone());
            if found == Some(wanted) {
                continue;
            }
            let in_cache = |found: &str| {
                let earlier = store.manifests(&task.id);
                earlier.iter().any(|then| then.outputs.get(name).is_some_and(|hash| hash == found))
            };
            // An empty file holds nothing that could be lost.
            let lost = found.filter(|found| !force && **found != hash(&[]));
            if lost.is_some_and(|found| !self.on_record(known, &path, found) && !in_cache(found)) {
                self.edited.push(self.edited(project, path));
            } else {
                self.write.insert(path, wanted.clone());
            }
        }
        // What a task that failed or waits made before is still wanted.
        if whole && manifests.len() == plan.tasks().len() {
            self.remove_old(project, plan, known)?;
        }
        Ok(self)
    }

    /// An export with bytes that nothing has on record.
    fn edited(&self, project: &Path, path: String) -> Edited {
        let text = read(&project.join(&path)).unwrap_or_default();
        let by = match () {
            () if conflict(&text).is_some() => Editor::Merge,
            () if self.written.0.is_empty() => Editor::Unknown,
            () => Editor::Hand,
        };
        Edited { path, by }
    }

    /// Whether this program wrote these bytes to this file.
    fn on_record(&self, known: &Hashes, path: &str, found: &str) -> bool {
        let written = || self.written.0.get(path).is_some_and(|hashes| hashes.contains(found));
        known.get(path).is_some_and(|hash| hash == found) || written()
    }

    /// Files that are on record and that no task makes any more are to go. People edit records too: what lies
    /// elsewhere than exports, or is an input, stays.
    fn remove_old(&mut self, project: &Path, plan: &Plan, known: &Hashes) -> Result<()> {
        let may_go = |path: &&String| {
            let folder = path.split('/').next().unwrap_or_default();
            FOLDERS.contains(&folder)
                && is_plain(path)
                && !self.files.contains_key(*path)
                && !plan.tasks().iter().any(|task| task.files.contains_key(*path))
        };
        let old = known.keys().chain(self.written.0.keys());
        let mut remove = BTreeSet::new();
        for path in old.filter(may_go) {
            let found = hash_if_there(&project.join(path))?;
            if found.is_some_and(|found| self.on_record(known, path, &found)) {
                remove.insert(path.clone());
            }
        }
        self.remove = remove;
        Ok(())
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
        let paths = self.files.keys().filter_map(|path| Path::new(path).parent());
        let folders: BTreeSet<&Path> = paths.chain([Path::new("pipeline")]).collect();
        leftovers(folders.into_iter().map(|folder| project.join(folder)))
    }

    /// How many files there are to write.
    pub fn to_write(&self) -> usize {
        self.write.len()
    }

    /// Paths of the files to remove.
    pub fn to_remove(&self) -> &BTreeSet<String> {
        &self.remove
    }

    /// Whether the project folder already shows everything, as far as it may be changed.
    pub fn is_empty(&self) -> bool {
        self.write.is_empty() && self.remove.is_empty()
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
            remove_from(project, &project.join(path))?;
            written.0.remove(path);
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
        let text = read(&Self::path(project)).unwrap_or_default();
        serde_json::from_slice(&text).unwrap_or_default()
    }

    fn save(&self, project: &Path) -> Result<()> {
        let text = serde_json::to_vec_pretty(self).expect("hashes are plain data");
        write_atomically(&Self::path(project), &text)
    }
}
