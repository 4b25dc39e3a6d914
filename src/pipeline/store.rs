//! The cache on disk: artifacts by content under `objects/`, manifests under `tasks/`, a file for each task.

use super::files::{hash_if_there, leftovers, read, read_if_there, write_by_way_of};
use super::manifest::{Manifest, Reason, changes};
use super::{Artifacts, Hashes, Lock, hash};
use crate::pipeline::error::{Error, Result};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Layout of the cache; another layout lives in another folder, so that versions do not collide.
const LAYOUT: &str = "v2";

/// Folder of the artifacts, in that of the layout.
pub(super) const OBJECTS: &str = "objects";

/// Folder of the manifests, in that of the layout.
pub(super) const TASKS: &str = "tasks";

/// Folder of the locks of single tasks, in that of the layout.
pub(super) const LOCKS: &str = "locks";

/// Folder of the stamps, in that of the layout.
pub(super) const STAMPS: &str = "stamps";

/// How the names of the files end that hold the manifests of a task.
pub(super) const RUNS: &str = ".runs";

/// A cache folder.
#[derive(Debug)]
pub struct Store {
    pub(super) cache: PathBuf,
    pub(super) root: PathBuf,
}

/// An intact earlier run of a task with the inputs asked for.
#[derive(Clone, Debug)]
pub struct Hit {
    /// Its record.
    pub manifest: Manifest,
    /// Whether later runs had other inputs: it has to become the latest.
    pub(super) reverted: bool,
}

impl Store {
    /// The cache in folder `cache`, which need not exist yet.
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

    /// The folder given to [`Store::new`].
    pub fn folder(&self) -> &Path {
        &self.cache
    }

    /// Takes the lock of the cache, which is created if need be.
    ///
    /// # Errors
    /// [`Error::Input`] naming the process that holds it; [`Error::Io`].
    pub fn lock(&self) -> Result<Lock> {
        Lock::take(&self.cache.join("lock"))
    }

    /// The right to write single tasks to the cache, beside others that do the same.
    pub(super) fn share(&self, busy: &dyn Fn(&str)) -> Result<Lock> {
        Lock::share(&self.cache.join("lock"), busy)
    }

    /// The right to run this task, for one who shares the cache.
    pub(super) fn lock_task(&self, task: &str, busy: &dyn Fn(&str)) -> Result<Lock> {
        Lock::wait(&self.root.join(LOCKS).join(hash(task.as_bytes())), busy)
    }

    /// Notes for an engine that the task with this stamp is done, by which run.
    pub(super) fn stamp(&self, stamp: &str, manifest: &Manifest) -> Result<()> {
        let path = self.stamp_file(stamp);
        let text = manifest.seal() + "\n";
        if read_if_there(&path)?.is_some_and(|there| there == text.as_bytes()) {
            return Ok(());
        }
        self.write(&path, text.as_bytes())
    }

    /// The file that is there once the task with this stamp is done.
    pub fn stamp_file(&self, stamp: &str) -> PathBuf {
        self.stamp_folder().join(stamp)
    }

    /// The folder of the stamps.
    pub(super) fn stamp_folder(&self) -> PathBuf {
        self.root.join(STAMPS)
    }

    /// What killed runs left behind, if none is at work.
    pub fn leftovers(&self) -> Vec<PathBuf> {
        leftovers([self.scratch().to_path_buf()])
    }

    /// Where all temporary files are, so that those of a killed run are found at a glance.
    pub(super) fn scratch(&self) -> &Path {
        &self.root
    }

    /// Writes a file of the cache, whole or not at all.
    pub(super) fn write(&self, path: &Path, bytes: &[u8]) -> Result<()> {
        write_by_way_of(self.scratch(), path, bytes)
    }

    /// All believable manifests of a task, latest first.
    pub fn manifests(&self, task: &str) -> Vec<Manifest> {
        believable(task, &self.runs(task)).collect()
    }

    /// The stored manifests of a task, a line for each run, the latest last.
    fn runs(&self, task: &str) -> Vec<u8> {
        // Unreadable is as good as absent: the task runs, and writing reports what is wrong.
        read_if_there(&self.runs_file(task)).ok().flatten().unwrap_or_default()
    }

    /// The run of `task` with these inputs, if its artifacts are intact; otherwise why it must run.
    ///
    /// # Errors
    /// The reason for running the task.
    pub fn lookup(
        &self,
        task: &str,
        inputs: &BTreeMap<String, String>,
    ) -> std::result::Result<Hit, Reason> {
        let unreadable = |e: Error| Reason::Unreadable(e.to_string());
        let stored = read_if_there(&self.runs_file(task)).map_err(unreadable)?.unwrap_or_default();
        let mut runs = believable(task, &stored);
        let latest = runs.next().ok_or(Reason::NeverRan)?;
        let reverted = latest.inputs != *inputs;
        let manifest = if reverted {
            let same = runs.find(|run| run.inputs == *inputs);
            same.ok_or_else(|| Reason::Changed(changes(&latest.inputs, inputs)))?
        } else {
            latest
        };
        // Side by side, though tasks are looked up so too: one may have made more than all others.
        let damage = |(name, hash): (&String, &String)| match hash_if_there(&self.object(hash)) {
            Ok(found) if found.as_ref() == Some(hash) => None,
            Ok(_) => Some(Reason::Damaged(name.clone())),
            Err(e) => Some(unreadable(e)),
        };
        match manifest.outputs.par_iter().find_map_first(damage) {
            Some(reason) => Err(reason),
            None => Ok(Hit { manifest, reverted }),
        }
    }

    /// Makes this the latest run of its task, so that `gc` keeps what is in use, and the only one with
    /// its inputs.
    ///
    /// # Errors
    /// [`Error::Io`].
    pub fn renew(&self, manifest: &Manifest) -> Result<()> {
        let mut runs = self.manifests(&manifest.task);
        runs.retain(|run| run.inputs != manifest.inputs);
        let lines = runs.iter().rev().chain([manifest]).map(Manifest::to_line);
        self.write(&self.runs_file(&manifest.task), lines.collect::<String>().as_bytes())
    }

    /// The artifact with this hash, if it is stored and intact.
    pub fn get(&self, wanted: &str) -> Option<Vec<u8>> {
        let bytes = read(&self.object(wanted)).ok()?;
        (hash(&bytes) == wanted).then_some(bytes)
    }

    /// All artifacts of a manifest.
    ///
    /// # Errors
    /// [`Error::Input`] if one vanished since [`Store::lookup`] found it intact.
    pub fn artifacts(&self, task: &str, outputs: &Hashes) -> Result<Artifacts> {
        outputs
            .iter()
            .map(|(name, hash)| match self.get(hash) {
                Some(bytes) => Ok((name.clone(), bytes)),
                None => Err(Error::input(format!(
                    "artifact {name} of {task} was changed while signorini ran; run again"
                ))),
            })
            .collect()
    }

    /// Stores artifacts, then the manifest: killed in between, the task has simply not run.
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
        let manifest = Manifest { task: task.into(), inputs, outputs };
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

/// The believable among the stored manifests of a task, latest first, each read when it is asked for.
pub(super) fn believable(task: &str, stored: &[u8]) -> impl Iterator<Item = Manifest> {
    let lines = stored.split_inclusive(|byte| *byte == b'\n').rev();
    lines.filter_map(Manifest::from_line).filter(move |manifest| manifest.task == task)
}
