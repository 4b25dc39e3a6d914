//! `pipeline/lock.toml`: the hashes that everyone's run must reproduce, committed with the scenes.

use super::Hashes;
use super::files::{read_if_there, write_atomically};
use super::manifest::changes;
use crate::pipeline::error::{CONFLICT, Error, Result, conflict};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

const HEADER: &str = "# Hashes (blake3) of what each task wrote, and of the committed figures.\n\
    # Written by `signorini run`; `signorini run --locked` fails when a run differs.\n\n";

/// The committed record of a full run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LockFile {
    /// Task id -> hash of all its artifacts.
    pub tasks: Hashes,
    /// Exported file -> hash.
    pub exports: Hashes,
}

impl LockFile {
    /// Path in the project.
    pub fn path(project: &Path) -> PathBuf {
        project.join("pipeline").join("lock.toml")
    }

    /// Reads the lock file; an absent one is empty.
    ///
    /// # Errors
    /// [`Error::Input`] if it is damaged.
    pub fn read(project: &Path) -> Result<Self> {
        let path = Self::path(project);
        let Some(bytes) = read_if_there(&path)? else { return Ok(Self::default()) };
        toml::from_str(&String::from_utf8_lossy(&bytes)).map_err(|_| {
            let path = path.display();
            Error::input(match conflict(&bytes) {
                Some(_) => format!("{path} has a {CONFLICT}; delete it and run again"),
                None => format!(
                    "{path} is damaged; restore it with `git checkout`, or delete it and run again"
                ),
            })
        })
    }

    /// Writes the lock file.
    ///
    /// # Errors
    /// [`Error::Io`].
    pub fn write(&self, project: &Path) -> Result<()> {
        let text = HEADER.to_owned() + &toml::to_string(self).expect("hashes are plain data");
        write_atomically(&Self::path(project), text.as_bytes())
    }

    /// This record with the entries of a later, partial run.
    pub fn updated(mut self, later: Self) -> Self {
        self.tasks.extend(later.tasks);
        self.exports.extend(later.exports);
        self
    }

    /// One line for each entry of `self` that `other` lacks or has differently, and vice versa.
    pub fn differences(&self, other: &Self) -> Vec<String> {
        let both = [(&self.tasks, &other.tasks), (&self.exports, &other.exports)];
        let changes = both.into_iter().flat_map(|(ours, theirs)| changes(ours, theirs));
        changes.map(|change| change.to_string()).collect()
    }
}
