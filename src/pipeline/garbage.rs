//! What the cache holds and nothing refers to.

use super::files::{is_temporary, read_if_there, remove_from};
use super::manifest::{Manifest, is_hash, is_stamp};
use super::store::{LOCKS, RUNS, STAMPS, Store, believable, list};
use crate::pipeline::error::{IoContext, Result};
use std::collections::BTreeSet;
use std::fs;
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

impl Store {
    /// Removes what the `keep` latest runs of the tasks in `wanted` do not need.
    ///
    /// With `dry`, only counts. Temporary files left by killed runs, locks that nobody can hold
    /// while the caller holds that of the cache, and other layouts go as well;
    /// files that are none of ours stay, whatever folder was named as the cache.
    ///
    /// # Errors
    /// [`Error::Io`], also if a folder cannot be listed, or manifests not be read: they tell what is needed.
    pub fn collect_garbage(
        &self,
        wanted: &BTreeSet<String>,
        keep: usize,
        dry: bool,
    ) -> Result<Garbage> {
        let (mut garbage, mut superseded) = (Garbage::default(), 0);
        let (mut needed, mut runs) = (BTreeSet::new(), BTreeSet::new());
        for task in wanted {
            let file = self.runs_file(task);
            let stored = read_if_there(&file)?.unwrap_or_default();
            let kept: Vec<Manifest> = believable(task, &stored).take(keep).collect();
            for manifest in &kept {
                runs.insert(manifest.seal());
                needed.extend(manifest.outputs.values().map(|hash| self.object(hash)));
            }
            let lines: String = kept.iter().rev().map(Manifest::to_line).collect();
            if lines.is_empty() {
                continue;
            }
            if lines.len() < stored.len() {
                superseded += (stored.len() - lines.len()) as u64;
                if !dry {
                    self.write(&file, lines.as_bytes())?;
                }
            }
            needed.insert(file);
        }
        // A stamp is true as long as the run that it names is there.
        let folder = self.root.join(STAMPS);
        let mut stamps = list(&folder).context("list", &folder)?;
        stamps.retain(|stamp| {
            let run = fs::read_to_string(stamp).unwrap_or_default();
            runs.contains(run.trim_end())
        });
        needed.extend(stamps);
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
        garbage.bytes += superseded;
        if dry {
            garbage.kept_bytes -= superseded;
        }
        Ok(garbage)
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
                // In the first layout, a file for each run, by its number.
                let number = name(path).strip_suffix(".json").unwrap_or_default();
                name(path).ends_with(RUNS)
                    || number.len() >= 6 && number.bytes().all(|b| b.is_ascii_digit())
            })?;
            walk(&layout.join(LOCKS), &mut ours, &|path| is_hash(name(path)))?;
            walk(&layout.join(STAMPS), &mut ours, &|path| is_stamp(name(path)))?;
        }
        Ok(ours)
    }
}

/// The last part of a path; empty if it is not UTF-8, as no name of ours is.
fn name(path: &Path) -> &str {
    path.file_name().and_then(|name| name.to_str()).unwrap_or_default()
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
