//! Garbage: files of the cache to which nothing refers.

use super::files::{if_there, is_temporary, read, read_if_there, remove_from};
use super::manifest::{Manifest, is_stamp};
use super::store::{LOCKS, OBJECTS, RUNS, STAMPS, Store, TASKS, believable};
use super::{Plan, is_hash};
use crate::error::Result;
use std::collections::{BTreeMap, BTreeSet};
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};

/// Numbers and sizes of the files that `gc` removes and keeps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Garbage {
    /// Number of files to which nothing refers.
    pub files: usize,
    /// Number of records of earlier runs in files that stay.
    pub records: usize,
    /// Bytes in these files and records.
    pub bytes: u64,
    /// Number of files that stay.
    pub kept_files: usize,
    /// Bytes that stay.
    pub kept_bytes: u64,
}

/// Files that the latest runs of tasks need, and those in use.
#[derive(Default)]
struct Needed {
    /// Files that stay, also if they become shorter.
    files: BTreeSet<PathBuf>,
    /// Files with manifests of earlier runs too.
    shorter: BTreeMap<PathBuf, Shortened>,
}

/// File of manifests without those of earlier runs.
struct Shortened {
    lines: String,
    /// Number of bytes that are removed.
    fewer: u64,
    /// Number of records that are removed.
    records: usize,
}

impl Store {
    /// Removes all files that neither the `keep` latest runs of the tasks in `plan` need nor those that a run of the
    /// plan would find.
    ///
    /// With `dry`, only counts. Removes also the temporary files of killed runs, and the locks of tasks, which nobody
    /// can hold while the caller holds the lock of the cache. Files of other programs stay, whatever folder was named
    /// as the cache.
    ///
    /// # Errors
    /// [`Error::Io`](crate::error::Error::Io), also if a folder or manifests cannot be read, because they
    /// determine which files are needed.
    pub fn collect_garbage(&self, plan: &Plan, keep: usize, dry: bool) -> Result<Garbage> {
        let Needed { files: needed, shorter } = self.needed(plan, keep)?;
        let superseded: u64 = shorter.values().map(|file| file.fewer).sum();
        let records = shorter.values().map(|file| file.records).sum();
        let mut garbage = Garbage { records, bytes: superseded, ..Garbage::default() };
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
                remove_from(&self.cache, &path)?;
            }
        }
        garbage.kept_bytes = garbage.kept_bytes.saturating_sub(superseded);
        if !dry {
            // Last: only now is there room for a new file on a disk that was full.
            for (file, Shortened { lines, .. }) in &shorter {
                let ended = fs::metadata(file).and_then(|file| file.modified());
                self.write(file, lines.as_bytes())?;
                // The time of a record is the end of its task; not every file system can keep it.
                if let (Ok(ended), Ok(file)) = (ended, File::options().append(true).open(file)) {
                    let _ = file.set_modified(ended);
                }
            }
        }
        Ok(garbage)
    }

    /// Returns the files that the `keep` latest runs of each of these tasks need, and those that a run would find.
    fn needed(&self, plan: &Plan, keep: usize) -> Result<Needed> {
        let (mut needed, mut runs) = (Needed::default(), BTreeSet::new());
        // Runs that a run of the plan finds.
        let mut in_use = BTreeMap::<&str, Manifest>::new();
        for task in plan.tasks() {
            let file = self.runs_file(&task.id);
            let stored = read_if_there(&file)?.unwrap_or_default();
            let all: Vec<Manifest> = believable(&task.id, &stored).collect();
            let mut kept: Vec<&Manifest> = all.iter().take(keep).collect();
            for run in &all {
                let known = |need: &str| in_use.get(need).map(|run| &run.outputs);
                // A file that cannot be read leaves a run without inputs, too.
                if !plan.has_inputs_of_today(task, run, known).unwrap_or(false) {
                    continue;
                }
                if !kept.contains(&run) {
                    kept.push(run);
                }
                if task.needs.iter().all(|need| in_use.contains_key(&**need)) {
                    in_use.insert(&task.id, run.clone());
                    break;
                }
            }
            for manifest in &kept {
                runs.insert(manifest.seal());
                needed.files.extend(manifest.outputs.values().map(|hash| self.object(hash)));
            }
            let lines: String = kept.iter().rev().map(|run| run.to_line()).collect();
            if lines.is_empty() {
                continue;
            }
            if lines.len() < stored.len() {
                let fewer = (stored.len() - lines.len()) as u64;
                let records = all.len() - kept.len();
                needed.shorter.insert(file.clone(), Shortened { lines, fewer, records });
            }
            needed.files.insert(file);
        }
        // A stamp is valid if the run that it names is kept.
        let mut stamps = list(&self.root.join(STAMPS))?;
        stamps.retain(|stamp| {
            let run = read(stamp).unwrap_or_default();
            runs.contains(String::from_utf8_lossy(&run).trim_end())
        });
        needed.files.extend(stamps);
        Ok(needed)
    }

    /// Returns the files with places and names that this program gives. A link may lead to other files, whatever their
    /// names.
    fn ours(&self) -> Result<Vec<PathBuf>> {
        let mut ours = Vec::new();
        if self.root.is_symlink() {
            return Ok(ours);
        }
        for path in list(&self.root)?.into_iter().filter(|path| !path.is_symlink()) {
            match name(&path) {
                OBJECTS => collect(&path, &mut ours, &|path| {
                    let two = path.parent().map_or("", name);
                    is_hash(name(path)) && name(path).starts_with(two)
                })?,
                TASKS => collect(&path, &mut ours, &|path| name(path).ends_with(RUNS))?,
                LOCKS => collect(&path, &mut ours, &|path| is_hash(name(path)))?,
                STAMPS => collect(&path, &mut ours, &|path| is_stamp(name(path)))?,
                other if is_temporary(other) && path.is_dir() => {
                    collect(&path, &mut ours, &|_| true)?;
                }
                other if is_temporary(other) => ours.push(path),
                _ => {}
            }
        }
        Ok(ours)
    }
}

/// Returns the last part of a path; empty if it is not UTF-8, unlike all names that this program gives.
fn name(path: &Path) -> &str {
    path.file_name().and_then(|name| name.to_str()).unwrap_or_default()
}

/// Returns the paths in a folder; none if it does not exist.
fn list(folder: &Path) -> Result<Vec<PathBuf>> {
    Ok(if_there(folder, paths_in(folder))?.unwrap_or_default())
}

fn paths_in(folder: &Path) -> io::Result<Vec<PathBuf>> {
    fs::read_dir(folder)?.map(|entry| Ok(entry?.path())).collect()
}

/// Collects, below a folder, the temporary files and those for which `is_ours` is true.
fn collect(folder: &Path, found: &mut Vec<PathBuf>, is_ours: &dyn Fn(&Path) -> bool) -> Result<()> {
    for path in list(folder)? {
        if path.is_dir() && !path.is_symlink() {
            collect(&path, found, is_ours)?;
        } else if is_ours(&path) || is_temporary(name(&path)) {
            found.push(path);
        }
    }
    Ok(())
}
