//! Commit from which a project is checked out, and comparison of its files with that commit, by git itself.

use serde::Serialize;
use std::collections::BTreeMap;
use std::path::Path;
use std::process::{Command, Stdio};

/// Commit, and comparison of the files of a project with it.
#[derive(Serialize)]
pub(super) struct Checkout {
    /// Folder of the repository.
    folder: String,
    commit: String,
    /// True if files of the project that git tracks differ from the commit.
    edited: bool,
    /// Number of the files asked about that are equal in the commit.
    as_committed: usize,
    lock_file: Committed,
}

/// State of a file in a commit.
#[derive(Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
enum Committed {
    Same,
    Other,
    Absent,
}

impl Checkout {
    /// Returns the checkout that contains `project`; `files` and `lock_file` are paths in the project.
    ///
    /// # Errors
    /// The reason why no commit can be named, if possible in the words of git.
    pub(super) fn of(project: &Path, files: &[&str], lock_file: &str) -> Result<Self, String> {
        let folder = git(project, &["rev-parse", "--show-toplevel"])?;
        let commit = git(project, &["rev-parse", "--verify", "--quiet", "HEAD^{commit}"])
            .map_err(|_| format!("the repository in {folder} has no commit yet"))?;
        let status = ["status", "--porcelain", "--untracked-files=no", "--", "."];
        let edited = !git(project, &status)?.is_empty();
        // Contents are compared, not the index, in which a file may be marked as one to ignore.
        let tree = git(project, &["ls-tree", "-r", "-z", &commit])?;
        let committed: BTreeMap<&str, &str> = tree.split('\0').filter_map(entry).collect();
        let all: Vec<&str> = files.iter().copied().chain([lock_file]).collect();
        let hashes = git(project, &[&["hash-object", "--"], &all[..]].concat())?;
        let mut compared = Vec::new();
        for (path, hash) in all.iter().zip(hashes.lines()) {
            compared.push(match committed.get(path) {
                Some(committed) if *committed == hash => Committed::Same,
                Some(_) => Committed::Other,
                None => Committed::Absent,
            });
        }
        let (&lock_file, files) = compared.split_last().ok_or("git names no hashes")?;
        let as_committed = files.iter().filter(|file| **file == Committed::Same).count();
        Ok(Self { folder, commit, edited, as_committed, lock_file })
    }
}

/// Returns path and hash of a line of `git ls-tree`.
fn entry(line: &str) -> Option<(&str, &str)> {
    let (about, path) = line.split_once('\t')?;
    Some((path, about.rsplit(' ').next()?))
}

/// Runs git in `project`, and returns its output.
///
/// # Errors
/// The first line of git's message.
fn git(project: &Path, args: &[&str]) -> Result<String, String> {
    let mut command = Command::new("git");
    // These options keep git from writing to the repository and from starting a service.
    command.args(["--no-optional-locks", "-c", "core.fsmonitor=false", "-C"]).arg(project);
    command.args(args).stdin(Stdio::null()).env("LC_ALL", "C");
    // If a hook of another repository calls this program, these variables name that repository.
    for (name, _) in std::env::vars_os() {
        if name.as_encoded_bytes().starts_with(b"GIT_") {
            command.env_remove(name);
        }
    }
    let said = command.output().map_err(|e| format!("git cannot be started ({e})"))?;
    if said.status.success() {
        let text = String::from_utf8_lossy(&said.stdout);
        return Ok(text.trim_end_matches('\n').to_owned());
    }
    let text = String::from_utf8_lossy(&said.stderr);
    let why = text.lines().next().unwrap_or_default().trim_start_matches("fatal: ");
    // Git also lists the folders in which it looked for a repository.
    let why = why.split(" (or any ").next().unwrap_or_default();
    Err(format!("git refuses: {why}"))
}
