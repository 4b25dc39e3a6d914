//! The cache on disk: artifacts by content under `objects/`, manifests by task under `tasks/`.

use super::files::{is_temporary, leftovers, write_atomically};
use super::manifest::{Manifest, Reason, changes, is_hash};
use super::{Artifacts, Hashes, Lock, hash};
use crate::pipeline::error::{Error, IoContext, Result};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

/// Layout of the cache; another layout lives in another folder, so that versions do not collide.
const LAYOUT: &str = "v1";

/// A cache folder.
#[derive(Debug)]
pub struct Store {
    cache: PathBuf,
    root: PathBuf,
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

/// What `gc` found that nothing refers to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Garbage {
    /// Files.
    pub files: usize,
    /// Their bytes.
    pub bytes: u64,
    /// Files that stay.
    pub kept_files: usize,
    /// Their bytes.
    pub kept_bytes: u64,
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

    /// What killed runs left behind, if none is at work.
    pub fn leftovers(&self) -> Vec<PathBuf> {
        leftovers([self.root.clone()])
    }

    /// Where tasks may write temporary files.
    pub(super) fn scratch(&self) -> &Path {
        &self.root
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
        let mut bytes = 0;
        for (name, hash) in &same.outputs {
            bytes += self.get(hash).ok_or_else(|| Reason::Damaged(name.clone()))?.len();
        }
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
        write_atomically(&self.manifest_file(&manifest), manifest.to_json().as_bytes())?;
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
                write_atomically(&self.object(&hash), bytes)?;
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
        write_atomically(&self.manifest_file(&manifest), manifest.to_json().as_bytes())?;
        Ok(manifest)
    }

    /// Removes what the `keep` latest generations of the tasks in `wanted` do not need.
    ///
    /// With `dry`, only counts. Temporary files left by killed runs and other layouts go as well;
    /// files that are none of ours stay, whatever folder was named as the cache.
    ///
    /// # Errors
    /// [`Error::Io`], also if a folder cannot be listed: what is needed may be in it.
    pub fn collect_garbage(
        &self,
        wanted: &BTreeSet<String>,
        keep: usize,
        dry: bool,
    ) -> Result<Garbage> {
        let mut needed = BTreeSet::new();
        for task in wanted {
            let folder = self.task_folder(task);
            list(&folder).context("list", &folder)?;
            for manifest in self.manifests(task).into_iter().take(keep) {
                needed.insert(self.manifest_file(&manifest));
                needed.extend(manifest.outputs.values().map(|hash| self.object(hash)));
            }
        }
        let mut garbage = Garbage::default();
        for path in self.ours()? {
            let bytes = fs::metadata(&path).map_or(0, |meta| meta.len());
            if needed.contains(&path) {
                garbage.kept_files += 1;
                garbage.kept_bytes += bytes;
                continue;
            }
            garbage.files += 1;
            garbage.bytes += bytes;
            if !dry {
                fs::remove_file(&path).context("remove", &path)?;
                // Fails, as it should, at the first folder that still holds something.
                let folders = path.ancestors().skip(1).take_while(|folder| *folder != self.cache);
                folders.map(fs::remove_dir).take_while(std::result::Result::is_ok).for_each(drop);
            }
        }
        Ok(garbage)
    }

    fn object(&self, hash: &str) -> PathBuf {
        self.root.join("objects").join(hash.get(..2).unwrap_or("xx")).join(hash)
    }

    fn task_folder(&self, task: &str) -> PathBuf {
        self.root.join("tasks").join(task)
    }

    fn manifest_file(&self, manifest: &Manifest) -> PathBuf {
        self.task_folder(&manifest.task).join(format!("{:06}.json", manifest.generation))
    }

    /// The files of this layout and of all others: what lies and is called as this program does it.
    fn ours(&self) -> Result<Vec<PathBuf>> {
        let is_layout = |path: &PathBuf| {
            let version = name(path).strip_prefix('v').unwrap_or_default();
            !version.is_empty() && version.bytes().all(|b| b.is_ascii_digit())
        };
        let mut ours = Vec::new();
        let layouts = list(&self.cache).context("list", &self.cache)?;
        for layout in layouts.into_iter().filter(is_layout) {
            walk(&layout.join("objects"), &mut ours, &|path| {
                is_hash(name(path))
                    && path.parent().is_some_and(|two| name(path).starts_with(name(two)))
            })?;
            walk(&layout.join("tasks"), &mut ours, &|path| {
                let generation = name(path).strip_suffix(".json").unwrap_or_default();
                generation.len() >= 6 && generation.bytes().all(|b| b.is_ascii_digit())
            })?;
        }
        Ok(ours)
    }
}

/// The last part of a path; empty if it is not UTF-8, as no name of ours is.
fn name(path: &Path) -> &str {
    path.file_name().and_then(|name| name.to_str()).unwrap_or_default()
}

/// What a folder holds; nothing if it is not there.
fn list(folder: &Path) -> io::Result<Vec<PathBuf>> {
    match fs::read_dir(folder) {
        Ok(entries) => entries.map(|entry| Ok(entry?.path())).collect(),
        Err(e) if e.kind() == ErrorKind::NotFound => Ok(Vec::new()),
        Err(e) => Err(e),
    }
}

/// Collects the temporary files and those that `is_ours` knows below a folder.
fn walk(folder: &Path, found: &mut Vec<PathBuf>, is_ours: &dyn Fn(&Path) -> bool) -> Result<()> {
    for path in list(folder).context("list", folder)? {
        if path.is_dir() && !path.is_symlink() {
            walk(&path, found, is_ours)?;
        } else if is_ours(&path) || is_temporary(path.file_name().unwrap_or_default()) {
            found.push(path);
        }
    }
    Ok(())
}
