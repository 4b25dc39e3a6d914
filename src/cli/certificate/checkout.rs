//! Commit from which a project is checked out, and comparison of its files with that commit, by git itself.

use regex::Regex;
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::Path;
use std::process::{Command, Stdio};

/// Commit, and comparison of the files of a project with it.
#[derive(Serialize)]
pub(super) struct Checkout {
    /// Folder of the project in the repository; empty if that is the project itself. Places on this machine are nobody
    /// else's business.
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
        let folder =
            git(project, &["rev-parse", "--show-prefix"])?.trim_end_matches('/').to_owned();
        let commit = git(project, &["rev-parse", "--verify", "--quiet", "HEAD^{commit}"])
            .map_err(|_| "the repository has no commit yet")?;
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

/// Runs git in `project`, with the settings of its environment, and returns its output.
///
/// # Errors
/// The first line of git's message.
fn git(project: &Path, args: &[&str]) -> Result<String, String> {
    let mut command = Command::new("git");
    // These options keep git from writing to the repository and from starting a service.
    command.args(["--no-optional-locks", "-c", "core.fsmonitor=false", "-C"]).arg(project);
    command.args(args).stdin(Stdio::null()).env("LC_ALL", "C");
    // For a hook or an alias, they name the repository that git is at work in, which may be another one.
    let named = std::env::vars_os().filter_map(|(name, _)| name.into_string().ok());
    let naming = named.filter(|name| name.starts_with("GIT_") && !name.starts_with("GIT_CONFIG"));
    naming.for_each(|name| _ = command.env_remove(name));
    let said = command.output().map_err(|e| format!("git cannot be started ({e})"))?;
    if said.status.success() {
        let text = String::from_utf8_lossy(&said.stdout);
        return Ok(text.trim_end_matches('\n').to_owned());
    }
    let text = String::from_utf8_lossy(&said.stderr);
    // Before it, there may be warnings, and what GIT_TRACE asks for.
    let fatal = text.lines().find_map(|line| line.strip_prefix("fatal: "));
    let why = fatal.or(text.lines().next()).unwrap_or_default();
    // Git also lists the folders in which it looked for a repository.
    let why = why.split(" (or any ").next().unwrap_or_default();
    Err(format!("git refuses: {why}"))
}

/// Returns a reason of git without the places on this machine that it names.
pub(super) fn without_places(why: &str) -> String {
    let place = Regex::new(r#"(^|[\s(:=])(?:'/[^']*'|"/[^"]*"|/\S*)"#).expect("a valid expression");
    place.replace_all(why, "${1}(a folder)").into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_on_this_machine_are_left_out() {
        for (why, said) in [
            (
                "dubious ownership in repository at '/home/a b/x'",
                "dubious ownership in repository at (a folder)",
            ),
            ("invalid gitfile format: /home/x/.git", "invalid gitfile format: (a folder)"),
            ("git cannot be started (os error 2/3)", "git cannot be started (os error 2/3)"),
        ] {
            assert_eq!(without_places(why), said);
        }
    }
}
