//! Cache on disk: artifacts by content under `objects/`, manifests under `tasks/`, a file for each task.

use super::change::changes;
use super::files::{hash_if_there, leftovers, read, read_if_there, write_by_way_of};
use super::manifest::{Manifest, Reason};
use super::{Artifacts, Hashes, Lock, hash};
use crate::error::{Error, Result};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Folder of this layout of the cache; another layout has another folder, so that versions do not collide.
const LAYOUT: &str = "v2";

/// Folder of the artifacts, in that of the layout.
pub(super) const OBJECTS: &str = "objects";

/// Folder of the manifests, in that of the layout.
pub(super) const TASKS: &str = "tasks";

/// Folder of the locks of single tasks, in that of the layout.
pub(super) const LOCKS: &str = "locks";

/// Folder of the stamps, in that of the layout.
pub(super) const STAMPS: &str = "stamps";

/// Ending of the files with the manifests of a task.
pub(super) const RUNS: &str = ".runs";

/// Cache folder.
#[derive(Debug)]
pub struct Store {
    pub(super) cache: PathBuf,
    pub(super) root: PathBuf,
}

/// Earlier run of a task with the inputs asked for and intact artifacts.
#[derive(Clone, Debug)]
pub struct Hit {
    /// Record of the run.
    pub manifest: Manifest,
    /// True if later runs had other inputs, so that this one has to become the latest.
    pub(super) reverted: bool,
}

impl Store {
    /// Returns the cache in folder `cache`, which need not exist yet.
    ///
    /// # Errors
    /// [`Error::Input`] if it is not a folder.
    pub fn new(cache: &Path) -> Result<Self> {
        if cache.exists() && !cache.is_dir() {
            return Err(Error::input(format!(
                "the cache {} is not a folder; move it away or give another with --cache-dir",
                cache.display()
            )));
        }
        Ok(Self { cache: cache.to_path_buf(), root: cache.join(LAYOUT) })
    }

    /// Returns the folder given to [`Store::new`].
    pub fn folder(&self) -> &Path {
        &self.cache
    }

    /// Takes the lock of the cache, which is created if need be.
    ///
    /// # Errors
    /// [`Error::Input`] naming the process that holds it; [`Error::Io`].
    pub fn lock(&self) -> Result<Lock> {
        Lock::take(&self.lock_file())
    }

    /// Returns the path of the lock of the cache; the file is written whenever the lock is taken.
    pub(super) fn lock_file(&self) -> PathBuf {
        self.cache.join("lock")
    }

    /// Takes the shared lock with which several processes may write single tasks to the cache; `busy` is told the
    /// holder for whom it waits.
    pub(super) fn share(&self, busy: &dyn Fn(&str)) -> Result<Lock> {
        Lock::share(&self.lock_file(), busy)
    }

    /// Takes the lock of one task, for a process that shares the lock of the cache; `busy` is told the holder for whom
    /// it waits.
    pub(super) fn lock_task(&self, task: &str, busy: &dyn Fn(&str)) -> Result<Lock> {
        Lock::wait(&self.root.join(LOCKS).join(hash(task.as_bytes())), busy)
    }

    /// Writes the stamp of a task, with the name of its run, so that an engine finds the task done.
    pub(super) fn stamp(&self, stamp: &str, manifest: &Manifest) -> Result<()> {
        let path = self.stamp_file(stamp);
        let text = manifest.seal() + "\n";
        if read_if_there(&path)?.is_some_and(|there| there == text.as_bytes()) {
            return Ok(());
        }
        self.write(&path, text.as_bytes())
    }

    /// Returns the path of a stamp, which exists after its task has run.
    pub fn stamp_file(&self, stamp: &str) -> PathBuf {
        self.stamp_folder().join(stamp)
    }

    /// Returns the folder of the stamps.
    pub(super) fn stamp_folder(&self) -> PathBuf {
        self.root.join(STAMPS)
    }

    /// Returns the temporary files and folders that killed runs left, if no run is at work.
    pub fn leftovers(&self) -> Vec<PathBuf> {
        leftovers([self.scratch().to_path_buf()])
    }

    /// Returns the folder of all temporary files, so that those of a killed run are found without a search.
    pub(super) fn scratch(&self) -> &Path {
        &self.root
    }

    /// Writes a file of the cache, whole or not at all.
    pub(super) fn write(&self, path: &Path, bytes: &[u8]) -> Result<()> {
        write_by_way_of(self.scratch(), path, bytes)
    }

    /// Returns all valid manifests of a task, latest first.
    pub fn manifests(&self, task: &str) -> Vec<Manifest> {
        believable(task, &self.runs(task)).collect()
    }

    /// Returns the stored manifests of a task, a line for each run, the latest last.
    fn runs(&self, task: &str) -> Vec<u8> {
        // Unreadable counts as absent: the task runs, and writing reports the error.
        read_if_there(&self.runs_file(task)).ok().flatten().unwrap_or_default()
    }

    /// Returns the run of `task` with these inputs if its artifacts are intact, otherwise the reason to run the task.
    ///
    /// # Errors
    /// The reason for running the task.
    pub fn lookup(
        &self,
        task: &str,
        inputs: &BTreeMap<String, String>,
    ) -> std::result::Result<Hit, Reason> {
        let stored = read_if_there(&self.runs_file(task))
            .map_err(|e| Reason::Unreadable(e.to_string()))?
            .unwrap_or_default();
        let mut runs = believable(task, &stored);
        let latest = runs.next().ok_or(Reason::NeverRan)?;
        let (manifest, reverted) = match latest.inputs == *inputs {
            true => (latest, false),
            false => match runs.find(|run| run.inputs == *inputs) {
                Some(same) => (same, true),
                None => return Err(Reason::Changed(changes(&latest.inputs, inputs))),
            },
        };
        // In parallel, like the look-ups of several tasks: one task may have more artifacts than all others.
        let outputs = manifest.outputs.par_iter();
        match outputs.find_map_first(|(name, hash)| self.damage(name, hash)) {
            Some(reason) => Err(reason),
            None => Ok(Hit { manifest, reverted }),
        }
    }

    /// Returns the reason to run a task again if this artifact is not intact.
    fn damage(&self, name: &str, hash: &String) -> Option<Reason> {
        match hash_if_there(&self.object(hash)) {
            Ok(found) if found.as_ref() == Some(hash) => None,
            Ok(_) => Some(Reason::Damaged(name.into())),
            Err(e) => Some(Reason::Unreadable(e.to_string())),
        }
    }

    /// Makes this run the latest of its task, so that `gc` keeps it, and the only one with its inputs.
    ///
    /// # Errors
    /// [`Error::Io`].
    pub fn renew(&self, manifest: &Manifest) -> Result<()> {
        let mut runs = self.manifests(&manifest.task);
        runs.retain(|run| run.inputs != manifest.inputs);
        let lines = runs.iter().rev().chain([manifest]).map(Manifest::to_line);
        self.write(&self.runs_file(&manifest.task), lines.collect::<String>().as_bytes())
    }

    /// Returns the artifact with this hash, if it is stored and intact.
    pub fn get(&self, wanted: &str) -> Option<Vec<u8>> {
        let bytes = read(&self.object(wanted)).ok()?;
        (hash(&bytes) == wanted).then_some(bytes)
    }

    /// Returns all artifacts of a manifest.
    ///
    /// # Errors
    /// [`Error::Input`] if an artifact was changed since [`Store::lookup`] found it intact.
    pub fn artifacts(&self, task: &str, outputs: &Hashes) -> Result<Artifacts> {
        let mut artifacts = Artifacts::new();
        for (name, hash) in outputs {
            let bytes = self.get(hash).ok_or_else(|| {
                Error::input(format!(
                    "artifact {name} of {task} was changed while signorini ran; run again"
                ))
            })?;
            artifacts.insert(name.clone(), bytes);
        }
        Ok(artifacts)
    }

    /// Stores artifacts, then the manifest, so that a task has not run if its process is killed in between.
    ///
    /// # Errors
    /// [`Error::Io`].
    pub fn record(
        &self,
        task: &str,
        inputs: BTreeMap<String, String>,
        artifacts: &Artifacts,
    ) -> Result<Manifest> {
        let mut outputs = Hashes::new();
        for (name, bytes) in artifacts {
            let hash = hash(bytes);
            if self.get(&hash).is_none() {
                self.write(&self.object(&hash), bytes)?;
            }
            outputs.insert(name.clone(), hash);
        }
        let manifest = Manifest::new(task.into(), inputs, outputs);
        self.renew(&manifest)?;
        Ok(manifest)
    }

    pub(super) fn object(&self, hash: &str) -> PathBuf {
        self.root.join(OBJECTS).join(hash.get(..2).unwrap_or("xx")).join(hash)
    }

    pub(super) fn runs_file(&self, task: &str) -> PathBuf {
        self.root.join(TASKS).join(format!("{task}{RUNS}"))
    }
}

/// Returns the valid ones of the stored manifests of a task, latest first; each is parsed when the iterator reaches it.
pub(super) fn believable(task: &str, stored: &[u8]) -> impl Iterator<Item = Manifest> {
    let lines = stored.split_inclusive(|byte| *byte == b'\n').rev();
    lines.filter_map(Manifest::from_line).filter(move |manifest| manifest.task == task)
}
