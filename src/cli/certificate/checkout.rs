//! The commit that a project is checked out from, by git's own word, and which of its files are that commit's.

use serde::Serialize;
use std::collections::BTreeMap;
use std::path::Path;
use std::process::{Command, Stdio};

/// A commit, and how the files of a project compare with it.
#[derive(Serialize)]
pub(super) struct Checkout {
    /// The folder of the repository.
    folder: String,
    commit: String,
    /// Whether files of the project that git keeps differ from the commit.
    edited: bool,
    /// Number of the files asked about that are in the commit as they are here.
    as_committed: usize,
    lock_file: Committed,
}

/// How a file compares with a commit.
#[derive(Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
enum Committed {
    Same,
    Other,
    Absent,
}

impl Checkout {
    /// The checkout that `project` lies in; `files` and `lock_file` are paths from there.
    ///
    /// # Errors
    /// Why no commit can be named, in git's words where it has any.
    pub(super) fn of(project: &Path, files: &[&str], lock_file: &str) -> Result<Self, String> {
        let folder = git(project, &["rev-parse", "--show-toplevel"])?;
        let commit = git(project, &["rev-parse", "--verify", "--quiet", "HEAD^{commit}"])
            .map_err(|_| format!("the repository in {folder} has no commit yet"))?;
        let status = ["status", "--porcelain", "--untracked-files=no", "--", "."];
        let edited = !git(project, &status)?.is_empty();
        // Contents and not the index: a file may be marked there as one that is not to be looked at.
        let tree = git(project, &["ls-tree", "-r", "-z", &commit])?;
        let committed: BTreeMap<&str, &str> = tree.split('\0').filter_map(entry).collect();
        let all: Vec<&str> = files.iter().copied().chain([lock_file]).collect();
        let hashes = git(project, &[&["hash-object", "--"], &all[..]].concat())?;
        let compared =
            all.iter().zip(hashes.lines()).map(|(path, hash)| match committed.get(path) {
                Some(committed) if *committed == hash => Committed::Same,
                Some(_) => Committed::Other,
                None => Committed::Absent,
            });
        let compared: Vec<Committed> = compared.collect();
        let (&lock_file, files) = compared.split_last().ok_or("git names no hashes")?;
        let as_committed = files.iter().filter(|file| **file == Committed::Same).count();
        Ok(Self { folder, commit, edited, as_committed, lock_file })
    }
}

/// Path and hash of a line of `git ls-tree`.
fn entry(line: &str) -> Option<(&str, &str)> {
    let (about, path) = line.split_once('\t')?;
    Some((path, about.rsplit(' ').next()?))
}

/// Output of git in `project`, or why there is none.
fn git(project: &Path, args: &[&str]) -> Result<String, String> {
    let mut command = Command::new("git");
    // Looking must write nothing and start no service.
    command.args(["--no-optional-locks", "-c", "core.fsmonitor=false", "-C"]).arg(project);
    command.args(args).stdin(Stdio::null()).env("LC_ALL", "C");
    // A hook of another repository, from which this program may be called, names that repository in them.
    let names = std::env::vars_os().map(|(name, _)| name);
    let of_git = names.filter(|name| name.as_encoded_bytes().starts_with(b"GIT_"));
    of_git.for_each(|name| _ = command.env_remove(name));
    let said = command.output().map_err(|e| format!("git cannot be started ({e})"))?;
    if said.status.success() {
        let text = String::from_utf8_lossy(&said.stdout);
        return Ok(text.trim_end_matches('\n').to_owned());
    }
    let text = String::from_utf8_lossy(&said.stderr);
    let why = text.lines().next().unwrap_or_default().trim_start_matches("fatal: ");
    Err(format!("git refuses: {why}"))
}
