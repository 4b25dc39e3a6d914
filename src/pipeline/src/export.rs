//! Copies of artifacts in the project folder, written so that a file edited by hand is never lost.

use super::files::{hash_if_there, is_plain, leftovers, read, remove_from};
use super::place::{INPUTS, is_no_link, own_place, write_own};
use super::{Hashes, Lock, LockFile, Manifest, Plan, Store, Task, hash};
use crate::error::{Error, Result, SCHEMA, conflict, refuse_newer};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Folders of the project that hold exports, beside files of the user.
const FOLDERS: [&str; 2] = ["figures", "report"];

/// Export that is not overwritten.
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
    /// Somebody put a link in its place, to bytes that are not this program's.
    Link,
    /// There is no record, as after `git clean`; this program may have written them.
    Unknown,
}

/// Results of a walk, to be exported.
pub struct WalkResults<'a> {
    /// Plan that was walked.
    pub plan: &'a Plan,
    /// Manifests of the tasks that are up to date.
    pub manifests: &'a BTreeMap<String, Manifest>,
    /// Cache with the artifacts.
    pub store: &'a Store,
}

/// Files that an export may change besides those that this program is on record to have written.
#[derive(Clone, Copy)]
pub struct Rights {
    /// True if every file but one to which a link leads may be overwritten.
    pub overwrite: bool,
    /// True if files of earlier plans may be removed: the plan is that of the whole project.
    pub remove: bool,
}

/// Copy of an artifact in the project.
struct Export<'a> {
    task: &'a Task,
    artifact: String,
    /// Path in the project.
    path: String,
    /// Hash of the artifact; none before the task has run.
    hash: Option<&'a String>,
}

impl<'a> WalkResults<'a> {
    /// Returns the lock file with these results.
    pub fn lock_file(&self) -> LockFile {
        let tasks =
            self.manifests.iter().map(|(id, manifest)| (id.clone(), manifest.digest.clone()));
        let exports = self.exports().into_iter();
        let exports = exports.filter_map(|export| Some((export.path, export.hash?.clone())));
        LockFile { tasks: tasks.collect(), exports: exports.collect() }
    }

    /// Returns the copies of all artifacts that are up to date and exported.
    fn exports(&self) -> Vec<Export<'a>> {
        let mut exports = Vec::new();
        for task in self.plan.tasks() {
            let (Some(folder), Some(manifest)) = (task.export, self.manifests.get(&task.id)) else {
                continue;
            };
            for (artifact, hash) in &manifest.outputs {
                exports.push(Export::new(task, (folder, artifact), Some(hash)));
            }
        }
        exports
    }

    /// Iterates over the tasks that are to run and have exports, each with the folder of these.
    fn to_run(&self) -> impl Iterator<Item = (&'a Task, &'static str)> {
        let left = self.plan.tasks().iter().filter(|task| !self.manifests.contains_key(&task.id));
        left.filter_map(|task| Some((task, task.export?)))
    }

    /// Returns the copies that tasks are expected to make which are to run: those of their last run.
    fn expected(&self) -> Vec<Export<'a>> {
        let mut expected = Vec::new();
        for (task, folder) in self.to_run() {
            if let Some(last) = self.store.manifests(&task.id).first() {
                for artifact in last.outputs.keys() {
                    expected.push(Export::new(task, (folder, artifact), None));
                }
            }
        }
        expected
    }

    /// True if the cache has a run that made this artifact with this hash.
    fn has_made(&self, export: &Export, hash: &str) -> bool {
        let runs = self.store.manifests(&export.task.id);
        runs.iter().any(|run| run.outputs.get(&export.artifact).is_some_and(|made| made == hash))
    }
}

impl<'a> Export<'a> {
    fn new(task: &'a Task, (folder, artifact): (&str, &str), hash: Option<&'a String>) -> Self {
        Self { task, artifact: artifact.into(), path: format!("{folder}/{artifact}"), hash }
    }
}

/// Files to write and to remove so that the project folder has the current artifacts.
#[derive(Debug, Default)]
pub struct Exports {
    /// Path in the project -> hash, of all exports.
    pub files: Hashes,
    /// Files with other bytes than this program wrote; they are neither written nor removed.
    pub edited: Vec<Edited>,
    write: Hashes,
    remove: BTreeSet<String>,
    written: Written,
}

impl Exports {
    /// Plans the export of these results; `locked` are the exports in the lock file.
    ///
    /// A file may be overwritten if it is empty, or if this program is on record to have written it: in the lock file,
    /// in the cache or in the record of exports; and as far as `rights` allow it. Of tasks that are to run, the files
    /// are looked at which they are expected to write, so that an edited one is told before any work.
    ///
    /// # Errors
    /// [`Error::Io`] if a file exists and cannot be read; [`Error::Input`] if a newer program has written the record,
    /// or a link leads out of the project.
    pub fn plan(
        project: &Path,
        results: &WalkResults,
        locked: &Hashes,
        rights: Rights,
    ) -> Result<Self> {
        let mut plan = Self { written: Written::read(project)?, ..Self::default() };
        let mut exports = results.exports();
        exports.extend(results.expected());
        for (_, folder) in results.to_run() {
            own_place(project, folder)?;
        }
        let there =
            exports.par_iter().map(|Export { path, .. }| hash_if_there(&project.join(path)));
        let there = there.collect::<Result<Vec<_>>>()?;
        for (export, found) in exports.into_iter().zip(there) {
            let path = export.path.clone();
            plan.files.extend(export.hash.map(|wanted| (path.clone(), wanted.clone())));
            if found.is_some() && found.as_ref() == export.hash {
                continue;
            }
            own_place(project, &path)?;
            let may_write = found.is_none_or(|found| {
                // An empty file holds nothing that could be lost.
                found == hash(&[])
                    || rights.overwrite && is_no_link(project, &path)
                    || plan.on_record(locked, &path, &found)
                    || results.has_made(&export, &found)
            });
            match export.hash {
                _ if !may_write => plan.edited.push(plan.edited(project, path)),
                Some(wanted) => _ = plan.write.insert(path, wanted.clone()),
                None => {}
            }
        }
        // If a task failed or waits, its earlier exports stay.
        if rights.remove && results.manifests.len() == results.plan.tasks().len() {
            plan.remove_old(project, results, locked)?;
        }
        Ok(plan)
    }

    /// Describes an export with bytes that are not on record.
    fn edited(&self, project: &Path, path: String) -> Edited {
        let text = read(&project.join(&path)).unwrap_or_default();
        let by = match () {
            () if !is_no_link(project, &path) => Editor::Link,
            () if conflict(&text).is_some() => Editor::Merge,
            () if self.written.0.is_empty() => Editor::Unknown,
            () => Editor::Hand,
        };
        Edited { path, by }
    }

    /// True if this program is on record to have written these bytes to this file.
    fn on_record(&self, locked: &Hashes, path: &str, found: &str) -> bool {
        locked.get(path).is_some_and(|hash| hash == found)
            || self.written.0.get(path).is_some_and(|hashes| hashes.contains(found))
    }

    /// Plans to remove the files that are on record and that no task makes any more. Somebody may have edited a record:
    /// files outside the folders of exports, those to which a link leads, and inputs stay.
    fn remove_old(&mut self, project: &Path, results: &WalkResults, locked: &Hashes) -> Result<()> {
        let mut remove = BTreeSet::new();
        // Nearly always the lock file has the exports of today.
        let old = locked.keys().ne(self.files.keys()).then(|| locked.keys());
        for path in old.into_iter().flatten().chain(self.written.0.keys()) {
            let folder = path.split('/').next().unwrap_or_default();
            if self.files.contains_key(path)
                || !FOLDERS.contains(&folder)
                || !is_plain(path)
                || !is_no_link(project, path)
                || INPUTS.iter().any(|inputs| Path::new(path).starts_with(inputs))
                || results.plan.tasks().iter().any(|task| task.files.contains_key(path))
            {
                continue;
            }
            let found = hash_if_there(&project.join(path))?;
            if found.is_some_and(|found| self.on_record(locked, path, &found)) {
                remove.insert(path.clone());
            }
        }
        self.remove = remove;
        Ok(())
    }

    /// Takes the lock with which a process may write to the project.
    ///
    /// # Errors
    /// [`Error::Input`] naming the process that holds it, or a link that leads out of the project; [`Error::Io`].
    pub fn lock(project: &Path) -> Result<Lock> {
        Lock::take(&own_place(project, "pipeline/.lock")?)
    }

    /// Returns the temporary files and folders that killed runs left, if no run is at work.
    pub fn leftovers(&self, project: &Path) -> Vec<PathBuf> {
        let paths = self.files.keys().filter_map(|path| Path::new(path).parent());
        let mut folders: BTreeSet<&Path> = paths.chain([Path::new("pipeline")]).collect();
        folders
            .retain(|folder| folder.to_str().is_some_and(|path| own_place(project, path).is_ok()));
        leftovers(folders.into_iter().map(|folder| project.join(folder)))
    }

    /// Files to write, by path.
    pub fn to_write(&self) -> &Hashes {
        &self.write
    }

    /// Paths of the files to remove.
    pub fn to_remove(&self) -> &BTreeSet<String> {
        &self.remove
    }

    /// True if the project folder needs no change, or none that is allowed.
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
        // Saved before and after the files: even if a run is killed in between, all that it wrote is on record.
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
            write_own(project, path, &bytes)?;
            written.0.insert(path.clone(), BTreeSet::from([hash.clone()]));
        }
        written.save(project)
    }
}

/// Record of the exports of this copy of the project: hashes of the bytes that were written, by path.
///
/// The lock file has the hashes at its commit, and the cache may be removed: neither has those of a run whose lock file
/// was reverted.
#[derive(Clone, Debug, Default, PartialEq)]
struct Written(BTreeMap<String, BTreeSet<String>>);

/// Record of the exports, as it is stored.
#[derive(Serialize, Deserialize)]
struct StoredRecord {
    /// Number of the format.
    schema: u64,
    #[serde(default)]
    files: BTreeMap<String, BTreeSet<String>>,
}

impl Written {
    /// Path in the project.
    const PATH: &str = "pipeline/.exported.json";

    /// Reads the record; one that is missing or damaged counts as empty.
    fn read(project: &Path) -> Result<Self> {
        let path = project.join(Self::PATH);
        let text = read(&path).unwrap_or_default();
        let Ok(StoredRecord { schema, files }) = serde_json::from_slice(&text) else {
            return Ok(Self::default());
        };
        refuse_newer(&path.display().to_string(), schema)?;
        Ok(Self(files))
    }

    fn save(&self, project: &Path) -> Result<()> {
        let stored = StoredRecord { schema: SCHEMA, files: self.0.clone() };
        let text = serde_json::to_vec_pretty(&stored).expect("hashes are plain data");
        write_own(project, Self::PATH, &text)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn the_record_is_read_back_unless_it_is_newer() {
        let project = tempfile::tempdir().unwrap();
        fs::create_dir(project.path().join("pipeline")).unwrap();
        let file = project.path().join(Written::PATH);
        let record = Written(BTreeMap::from([("a.svg".into(), BTreeSet::from([hash(b"a")]))]));
        assert_eq!(Written::read(project.path()).unwrap(), Written::default());
        record.save(project.path()).unwrap();
        assert_eq!(Written::read(project.path()).unwrap(), record);
        fs::write(&file, "{\"a.svg\": [\"").unwrap();
        assert_eq!(Written::read(project.path()).unwrap(), Written::default());
        fs::write(&file, "{\"schema\": 2, \"paths\": {}}").unwrap();
        let refusal = Written::read(project.path()).unwrap_err().to_string();
        assert!(refusal.contains("schema 2") && refusal.contains("a newer one?"), "{refusal}");
    }
}
