//! The cache on disk: artifacts by content under `objects/`, manifests by task under `tasks/`.

use super::manifest::{Manifest, Reason, changes};
use super::{Artifacts, Hashes, hash};
use crate::pipeline::error::{Error, IoContext, Result};
use std::collections::{BTreeMap, BTreeSet};
use std::fs::{self, File};
use std::io::{ErrorKind, Write};
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

    /// All believable manifests of a task, latest first.
    pub fn manifests(&self, task: &str) -> Vec<Manifest> {
        let mut found: Vec<Manifest> = list(&self.task_folder(task))
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

    /// Makes a hit the latest generation of its task, so that `gc` keeps what is in use.
    ///
    /// # Errors
    /// [`Error::Io`].
    pub fn renew(&self, hit: Hit) -> Result<Manifest> {
        let Hit { mut manifest, latest, .. } = hit;
        if manifest.generation < latest {
            let old = self.manifest_file(&manifest);
            manifest.generation = latest + 1;
            write_atomically(&self.manifest_file(&manifest), manifest.to_json().as_bytes())?;
            fs::remove_file(&old).context("remove", &old)?;
        }
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
    /// [`Error::Io`].
    pub fn collect_garbage(
        &self,
        wanted: &BTreeSet<String>,
        keep: usize,
        dry: bool,
    ) -> Result<Garbage> {
        let mut needed = BTreeSet::new();
        for task in wanted {
            for manifest in self.manifests(task).into_iter().take(keep) {
                needed.insert(self.manifest_file(&manifest));
                needed.extend(manifest.outputs.values().map(|hash| self.object(hash)));
            }
        }
        let mut garbage = Garbage::default();
        for path in self.layouts().iter().flat_map(|folder| walk(folder)) {
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

    /// The folders of this layout and of all others.
    fn layouts(&self) -> Vec<PathBuf> {
        let ours = |path: &PathBuf| {
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            let version = name.strip_prefix('v').unwrap_or_default();
            !version.is_empty() && version.bytes().all(|b| b.is_ascii_digit())
        };
        let versions = list(&self.cache).into_iter().filter(ours);
        versions.flat_map(|version| ["objects", "tasks"].map(|part| version.join(part))).collect()
    }
}

/// Writes a whole file or nothing: to a temporary name in the same folder, synced, then renamed.
///
/// # Errors
/// [`Error::Io`].
pub(crate) fn write_atomically(path: &Path, bytes: &[u8]) -> Result<()> {
    let folder = path.parent().expect("a file lies in a folder");
    fs::create_dir_all(folder).context("create", folder)?;
    // Unique among threads, the same in every process: what a killed run leaves behind is
    // overwritten and renamed by the next.
    let thread = rayon::current_thread_index().map_or(0, |index| index + 1);
    let name = path.file_name().expect("a file has a name").to_string_lossy();
    let temporary = folder.join(format!(".{name}.tmp{thread}"));
    let written = (|| {
        let mut file = File::create(&temporary)?;
        file.write_all(bytes)?;
        file.sync_all()?;
        fs::rename(&temporary, path)
    })();
    if written.is_err() {
        // Best effort: the error that matters is the one above.
        let _ = fs::remove_file(&temporary);
    }
    written.context("write", path)
}

fn list(folder: &Path) -> Vec<PathBuf> {
    match fs::read_dir(folder) {
        Ok(entries) => entries.filter_map(|entry| Some(entry.ok()?.path())).collect(),
        Err(e) if e.kind() == ErrorKind::NotFound => Vec::new(),
        // Unreadable is as good as absent: the task runs, and writing reports what is wrong.
        Err(_) => Vec::new(),
    }
}

fn walk(folder: &Path) -> Vec<PathBuf> {
    let (folders, mut files): (Vec<_>, Vec<_>) =
        list(folder).into_iter().partition(|path| path.is_dir() && !path.is_symlink());
    files.extend(folders.iter().flat_map(|folder| walk(folder)));
    files
}
