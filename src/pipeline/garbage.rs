//! What the cache holds and nothing refers to.

use super::files::{if_there, is_temporary, read, read_if_there, remove_from};
use super::manifest::{Manifest, is_hash, is_stamp};
use super::store::{LOCKS, OBJECTS, RUNS, STAMPS, Store, TASKS, believable};
use crate::pipeline::error::Result;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

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

/// What the latest runs of tasks need.
#[derive(Default)]
struct Needed {
    /// Files that stay, but for those to be shortened.
    files: BTreeSet<PathBuf>,
    /// Manifests with earlier runs, by file: what is to be left of them, and how many bytes less that is.
    shorter: BTreeMap<PathBuf, (String, u64)>,
}

impl Store {
    /// Removes what the `keep` latest runs of the tasks in `wanted` do not need.
    ///
    /// With `dry`, only counts. Temporary files left by killed runs, locks that nobody can hold
    /// while the caller holds that of the cache, and other layouts go as well;
    /// files that are none of ours stay, whatever folder was named as the cache.
    ///
    /// # Errors
    /// [`Error::Io`](crate::pipeline::error::Error::Io), also if a folder or manifests cannot be read: they tell
    /// what is needed.
    pub fn collect_garbage(
        &self,
        wanted: &BTreeSet<String>,
        keep: usize,
        dry: bool,
    ) -> Result<Garbage> {
        let Needed { files: needed, shorter } = self.needed(wanted, keep)?;
        let superseded: u64 = shorter.values().map(|(_, fewer)| fewer).sum();
        let mut garbage = Garbage { bytes: superseded, ..Garbage::default() };
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
            // Last: on a full disk there is room for a new file only now.
            for (file, (lines, _)) in &shorter {
                self.write(file, lines.as_bytes())?;
            }
        }
        Ok(garbage)
    }

    /// What these tasks' latest runs need, as many of each.
    fn needed(&self, wanted: &BTreeSet<String>, keep: usize) -> Result<Needed> {
        let (mut needed, mut runs) = (Needed::default(), BTreeSet::new());
        for task in wanted {
            let file = self.runs_file(task);
            let stored = read_if_there(&file)?.unwrap_or_default();
            let kept: Vec<Manifest> = believable(task, &stored).take(keep).collect();
            for manifest in &kept {
                runs.insert(manifest.seal());
                needed.files.extend(manifest.outputs.values().map(|hash| self.object(hash)));
            }
            let lines: String = kept.iter().rev().map(Manifest::to_line).collect();
            if lines.is_empty() {
                continue;
            }
            if lines.len() < stored.len() {
                let fewer = (stored.len() - lines.len()) as u64;
                needed.shorter.insert(file.clone(), (lines, fewer));
            }
            needed.files.insert(file);
        }
        // A stamp is true as long as the run that it names is there.
        let mut stamps = list(&self.root.join(STAMPS))?;
        stamps.retain(|stamp| {
            let run = read(stamp).unwrap_or_default();
            runs.contains(String::from_utf8_lossy(&run).trim_end())
        });
        needed.files.extend(stamps);
        Ok(needed)
    }

    /// The files of this layout and of all others: what lies and is called as this program does it.
    fn ours(&self) -> Result<Vec<PathBuf>> {
        let is_layout = |path: &PathBuf| {
            let version = name(path).strip_prefix('v').unwrap_or_default();
            !version.is_empty() && version.bytes().all(|b| b.is_ascii_digit())
        };
        let mut ours = Vec::new();
        for layout in list(&self.cache)?.into_iter().filter(is_layout) {
            for path in list(&layout)? {
                match name(&path) {
                    OBJECTS => collect(&path, &mut ours, &|path| {
                        let two = path.parent().map_or("", name);
                        is_hash(name(path)) && name(path).starts_with(two)
                    })?,
                    TASKS => collect(&path, &mut ours, &|path| {
                        // In the first layout, a file for each run, by its number.
                        let number = name(path).strip_suffix(".json").unwrap_or_default();
                        name(path).ends_with(RUNS)
                            || number.len() >= 6 && number.bytes().all(|b| b.is_ascii_digit())
                    })?,
                    LOCKS => collect(&path, &mut ours, &|path| is_hash(name(path)))?,
                    STAMPS => collect(&path, &mut ours, &|path| is_stamp(name(path)))?,
                    other if is_temporary(other) && path.is_dir() => {
                        collect(&path, &mut ours, &|_| true)?;
                    }
                    other if is_temporary(other) => ours.push(path),
                    _ => {}
                }
            }
        }
        Ok(ours)
    }
}

/// The last part of a path; empty if it is not UTF-8, as no name of ours is.
fn name(path: &Path) -> &str {
    path.file_name().and_then(|name| name.to_str()).unwrap_or_default()
}

/// What a folder holds; nothing if it is not there.
fn list(folder: &Path) -> Result<Vec<PathBuf>> {
    let list = || fs::read_dir(folder)?.map(|entry| Ok(entry?.path())).collect::<io::Result<_>>();
    Ok(if_there(folder, list())?.unwrap_or_default())
}

/// Collects the temporary files and those that `is_ours` knows below a folder.
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
