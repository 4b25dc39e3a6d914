//! The cache on disk: artifacts by content under `objects/`, manifests by task under `tasks/`.

use super::files::{find, leftovers, read_if_there, write_by_way_of};
use super::manifest::{Manifest, Reason, changes};
use super::{Artifacts, Hashes, Lock, hash};
use crate::pipeline::error::{Error, IoContext, Result};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::fs;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

/// Layout of the cache; another layout lives in another folder, so that versions do not collide.
const LAYOUT: &str = "v1";

/// Folder of the locks of single tasks, in that of the layout.
pub(super) const LOCKS: &str = "locks";

/// Folder of the stamps, in that of the layout.
pub(super) const STAMPS: &str = "stamps";

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
    /// Size of its artifacts.
    pub(super) bytes: usize,
    /// Latest generation of the task; higher if an edit was reverted.
    latest: u64,
}

impl Hit {
    /// Whether later runs had other inputs: it has to become the latest generation.
    pub(super) fn is_reverted(&self) -> bool {
        self.manifest.generation < self.latest
    }
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
    ///
    /// # Errors
    /// [`Error::Input`] where the file system has no locks; [`Error::Io`].
    pub(super) fn share(&self, busy: &dyn Fn(&str)) -> Result<Lock> {
        Lock::share(&self.cache.join("lock"), busy)
    }

    /// The right to run this task, for one who shares the cache.
    ///
    /// # Errors
    /// As [`Store::share`].
    pub(super) fn lock_task(&self, task: &str, busy: &dyn Fn(&str)) -> Result<Lock> {
        Lock::wait(&self.root.join(LOCKS).join(hash(task.as_bytes())), busy)
    }

    /// Notes for an engine that the task with this stamp is done, by which run.
    ///
    /// # Errors
    /// [`Error::Io`].
    pub(super) fn stamp(&self, stamp: &str, manifest: &Manifest) -> Result<()> {
        let path = self.stamp_file(stamp);
        let run = self.manifest_file(manifest);
        let run = run.strip_prefix(&self.root).expect("manifests lie in the cache");
        let text = format!("{}\n", run.display());
        if read_if_there(&path)?.is_some_and(|there| there == text.as_bytes()) {
            return Ok(());
        }
        self.write(&path, text.as_bytes())
    }

    /// The file that is there once the task with this stamp is done.
    pub fn stamp_file(&self, stamp: &str) -> PathBuf {
        self.root.join(STAMPS).join(stamp)
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
    fn write(&self, path: &Path, bytes: &[u8]) -> Result<()> {
        write_by_way_of(self.scratch(), path, bytes)
    }

    /// All believable manifests of a task, latest first.
    pub fn manifests(&self, task: &str) -> Vec<Manifest> {
        // Unreadable is as good as absent: the task runs, and writing reports what is wrong.
        let mut found: Vec<Manifest> = list(&self.task_folder(task))
            .unwrap_or_default()
            .iter()
            .filter_map(|path| {
                let manifest = Manifest::from_json(&fs::read_to_string(path).ok()?)?;
                // Not one under another name: a run killed before it renamed has not recorded.
                (manifest.task == task && *path == self.manifest_file(&manifest))
                    .then_some(manifest)
            })
            .collect();
        found.sort_by_key(|manifest| std::cmp::Reverse(manifest.generation));
        found
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
        let manifests = self.manifests(task);
        let Some(latest) = manifests.first() else { return Err(Reason::NeverRan) };
        let Some(same) = manifests.iter().find(|manifest| manifest.inputs == *inputs) else {
            return Err(Reason::Changed(changes(&latest.inputs, inputs)));
        };
        // Side by side: a task may have most of all artifacts, and nobody else may be left to look at.
        let sizes = same.outputs.par_iter().map(|(name, hash)| {
            // Unreadable is as good as absent.
            let there = find(&self.object(hash)).ok().flatten();
            let intact = there.filter(|found| found.hash == *hash);
            intact.map(|found| found.size).ok_or(name)
        });
        let sizes: Vec<std::result::Result<usize, &String>> = sizes.collect();
        let bytes = sizes.into_iter().sum::<std::result::Result<usize, _>>();
        let bytes = bytes.map_err(|name| Reason::Damaged(name.clone()))?;
        Ok(Hit { manifest: same.clone(), bytes, latest: latest.generation })
    }

    /// Makes a reverted hit the latest generation of its task, so that `gc` keeps what is in use.
    ///
    /// # Errors
    /// [`Error::Io`].
    pub fn renew(&self, hit: Hit) -> Result<Manifest> {
        let Hit { mut manifest, latest, .. } = hit;
        let old = self.manifest_file(&manifest);
        manifest.generation = latest + 1;
        self.write(&self.manifest_file(&manifest), manifest.to_json().as_bytes())?;
        fs::remove_file(&old).context("remove", &old)?;
        Ok(manifest)
    }

    /// The artifact with this hash, if it is stored and intact.
    pub fn get(&self, wanted: &str) -> Option<Vec<u8>> {
        let bytes = fs::read(self.object(wanted)).ok()?;
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
        // A repaired run replaces its old record; otherwise each run is a generation of its own.
        let manifests = self.manifests(task);
        let generation = match manifests.iter().find(|manifest| manifest.inputs == inputs) {
            Some(same) if manifests[0] == *same => same.generation,
            _ => manifests.first().map_or(1, |latest| latest.generation + 1),
        };
        let manifest = Manifest { task: task.into(), generation, inputs, outputs };
        self.write(&self.manifest_file(&manifest), manifest.to_json().as_bytes())?;
        Ok(manifest)
    }

    pub(super) fn object(&self, hash: &str) -> PathBuf {
        self.root.join("objects").join(hash.get(..2).unwrap_or("xx")).join(hash)
    }

    pub(super) fn task_folder(&self, task: &str) -> PathBuf {
        self.root.join("tasks").join(task)
    }

    pub(super) fn manifest_file(&self, manifest: &Manifest) -> PathBuf {
        self.task_folder(&manifest.task).join(format!("{:06}.json", manifest.generation))
    }
}

/// What a folder holds; nothing if it is not there.
pub(super) fn list(folder: &Path) -> io::Result<Vec<PathBuf>> {
    match fs::read_dir(folder) {
        Ok(entries) => entries.map(|entry| Ok(entry?.path())).collect(),
        Err(e) if e.kind() == ErrorKind::NotFound => Ok(Vec::new()),
        Err(e) => Err(e),
    }
}
