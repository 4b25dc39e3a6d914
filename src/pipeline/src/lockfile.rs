//! `pipeline/lock.toml`: the hashes that every run must reproduce, committed with the scenes.

use super::Hashes;
use super::change::changes;
use super::files::read_if_there;
use super::place::write_own;
use crate::error::{CONFLICT, Error, Result, SCHEMA, conflict, newer};
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

/// Returns, in words, what a lock file has that this program does not write, if there is such a thing. A lock file of
/// an older program has no number of format.
fn unknown(table: &toml::Table) -> Option<String> {
    match table.get("schema") {
        Some(toml::Value::Integer(found)) if *found > SCHEMA as i64 => {
            return Some(format!("schema {found}"));
        }
        _ => {}
    }
    let known = ["schema", "tasks", "exports"];
    table.keys().find(|key| !known.contains(&key.as_str())).map(|key| format!("a key `{key}`"))
}

/// Returns what follows these hashes in a text that begins with them.
fn after<'a>(mut text: &'a [u8], hashes: &Hashes) -> Option<&'a [u8]> {
    for (name, hash) in hashes {
        if name.contains('"') || name.contains('\\') {
            return None;
        }
        text = text.strip_prefix(b"\"")?.strip_prefix(name.as_bytes())?;
        text =
            text.strip_prefix(b"\" = \"")?.strip_prefix(hash.as_bytes())?.strip_prefix(b"\"\n")?;
    }
    Some(text)
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
        Self::read_expecting(project, &Self::default())
    }

    /// Reads the lock file, as [`LockFile::read`]; one that is as [`LockFile::write`] writes `expected` need not be
    /// parsed.
    ///
    /// # Errors
    /// As [`LockFile::read`].
    pub fn read_expecting(project: &Path, expected: &Self) -> Result<Self> {
        let path = Self::path(project);
        let Some(bytes) = read_if_there(&path)? else { return Ok(Self::default()) };
        if expected.is_written_as(&bytes) {
            return Ok(expected.clone());
        }
        if bytes.trim_ascii().is_empty() {
            return Ok(Self::default());
        }
        let path = path.display();
        if let Ok(table) = toml::from_str(&String::from_utf8_lossy(&bytes)) {
            if let Some(unknown) = unknown(&table) {
                return Err(newer(&path.to_string(), &unknown));
            }
            if let Ok(lock_file) = table.try_into() {
                return Ok(lock_file);
            }
        }
        Err(Error::input(match conflict(&bytes) {
            Some(_) => format!("{path} has a {CONFLICT}; delete it and run again"),
            None => format!(
                "{path} is damaged; restore it with `git checkout`, or delete it and run again"
            ),
        }))
    }

    /// Writes the lock file.
    ///
    /// # Errors
    /// [`Error::Io`].
    pub fn write(&self, project: &Path) -> Result<()> {
        write_own(project, PATH, self.to_text().as_bytes())
    }

    /// True if this is how [`LockFile::write`] writes these hashes; also false for names of which it escapes a part.
    fn is_written_as(&self, text: &[u8]) -> bool {
        let head = format!("{HEADER}schema = {SCHEMA}\n\n[tasks]\n");
        let tasks = text.strip_prefix(head.as_bytes()).and_then(|text| after(text, &self.tasks));
        let exports = tasks.and_then(|text| text.strip_prefix(b"\n[exports]\n"));
        exports.and_then(|text| after(text, &self.exports)).is_some_and(<[u8]>::is_empty)
    }

    fn to_text(&self) -> String {
        let hashes = toml::to_string(self).expect("hashes are plain data");
        format!("{HEADER}schema = {SCHEMA}\n\n{hashes}")
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
        for (line, unknown) in [
            ("schema = 2", "schema 2"),
            ("version = 3", "a key `version`"),
            ("[machine]\ncores = 2", "a key `machine`"),
        ] {
            let refusal = read(&format!("{line}\n{hashes}")).unwrap_err().to_string();
            assert!(
                refusal.contains(&format!("lock.toml has {unknown} that signorini "))
                    && refusal.ends_with(" does not know; was it written by a newer one?"),
                "{refusal}"
            );
        }
        let project = tempfile::tempdir().unwrap();
        fs::create_dir(project.path().join("pipeline")).unwrap();
        known.write(project.path()).unwrap();
        assert_eq!(LockFile::read(project.path()).unwrap(), known);
    }

    #[test]
    fn a_lock_file_as_it_would_be_written_is_told_by_its_bytes_and_no_other_is() {
        let hashes = |names: &[&str]| -> Hashes {
            names
                .iter()
                .map(|name| ((*name).to_owned(), super::super::hash(name.as_bytes())))
                .collect()
        };
        for (tasks, exports) in
            [(&["a/1", "b/2"][..], &["figures/a.svg"][..]), (&["a/1"], &[]), (&[], &[])]
        {
            let lock_file = LockFile { tasks: hashes(tasks), exports: hashes(exports) };
            let text = lock_file.to_text().into_bytes();
            assert!(lock_file.is_written_as(&text));
            for k in 0..text.len() {
                let mut other = text.clone();
                other[k] ^= 1;
                assert!(!lock_file.is_written_as(&other) && !lock_file.is_written_as(&text[..k]));
            }
            let mut other = lock_file.clone();
            other.exports.insert("figures/\"b\".svg".into(), "0".into());
            assert!(
                !other.is_written_as(&text) && !other.is_written_as(other.to_text().as_bytes())
            );
        }
    }
}
