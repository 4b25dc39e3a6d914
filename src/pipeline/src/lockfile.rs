//! `pipeline/lock.toml`: the hashes that every run must reproduce, committed with the scenes.

use super::Hashes;
use super::change::changes;
use super::files::read_if_there;
use super::place::write_own;
use crate::error::{Error, Result, SCHEMA, from_record};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

const HEADER: &str = "# Hashes (blake3) of what each task wrote, and of the committed figures.\n\
    # Written by `signorini run`; `signorini run --locked` fails when a run differs.\n\n";

/// Path of the lock file in the project.
const PATH: &str = "pipeline/lock.toml";

/// Committed record of a full run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct LockFile {
    /// Task id -> hash of all its artifacts.
    pub tasks: Hashes,
    /// Exported file -> hash.
    pub exports: Hashes,
}

/// Lock file as it is stored. That of an older program has no number of format.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Stored {
    #[serde(rename = "schema")]
    _schema: Option<u64>,
    tasks: Hashes,
    exports: Hashes,
}

impl LockFile {
    /// Returns the path of the lock file in a project.
    pub fn path(project: &Path) -> PathBuf {
        project.join(PATH)
    }

    /// Reads the lock file; an absent one is empty, as is one that a crash has left without contents.
    ///
    /// # Errors
    /// [`Error::Input`] if it is damaged.
    pub fn read(project: &Path) -> Result<Self> {
        let path = Self::path(project);
        let bytes = read_if_there(&path)?.unwrap_or_default();
        if bytes.trim_ascii().is_empty() {
            return Ok(Self::default());
        }
        let remedy = "restore it with `git checkout`, or delete it and run again";
        let stored = from_record(&path.display().to_string(), &bytes);
        let Stored { tasks, exports, .. } = stored.map_err(|error| match error.to_string() {
            // A conflict, or a newer program.
            text if text.contains("; ") => error,
            text => Error::input(format!("{text}; {remedy}")),
        })?;
        Ok(Self { tasks, exports })
    }

    /// Writes the lock file.
    ///
    /// # Errors
    /// [`Error::Io`].
    pub fn write(&self, project: &Path) -> Result<()> {
        let hashes = toml::to_string(self).expect("hashes are plain data");
        let text = format!("{HEADER}schema = {SCHEMA}\n\n{hashes}");
        write_own(project, PATH, text.as_bytes())
    }

    /// Returns this record with the entries of a later, partial run.
    pub fn updated(mut self, later: Self) -> Self {
        self.tasks.extend(later.tasks);
        self.exports.extend(later.exports);
        self
    }

    /// Returns a line for each entry that only one of both records has, or that differs.
    pub fn differences(&self, other: &Self) -> Vec<String> {
        let both = [(&self.tasks, &other.tasks), (&self.exports, &other.exports)];
        let changes = both.into_iter().flat_map(|(ours, theirs)| changes(ours, theirs));
        changes.map(|change| change.to_string()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    /// Lock file with this text.
    fn read(text: &str) -> Result<LockFile> {
        let project = tempfile::tempdir().unwrap();
        fs::create_dir(project.path().join("pipeline")).unwrap();
        fs::write(LockFile::path(project.path()), text).unwrap();
        LockFile::read(project.path())
    }

    #[test]
    fn a_lock_file_of_an_older_program_is_read_and_one_of_a_newer_program_is_recognised() {
        let hashes = "[tasks]\n\"solve/a\" = \"0\"\n\n[exports]\n";
        let known = read(hashes).unwrap();
        assert_eq!(known.tasks["solve/a"], "0");
        assert_eq!(read(&format!("schema = 1\n{hashes}")).unwrap(), known);
        for line in ["schema = 2", "version = 3", "[machine]\ncores = 2"] {
            let refusal = read(&format!("{line}\n{hashes}")).unwrap_err().to_string();
            assert!(refusal.contains("was it written by a newer one?"), "{line}: {refusal}");
        }
        let project = tempfile::tempdir().unwrap();
        fs::create_dir(project.path().join("pipeline")).unwrap();
        known.write(project.path()).unwrap();
        assert_eq!(LockFile::read(project.path()).unwrap(), known);
    }
}
