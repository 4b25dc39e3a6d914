//! Where and when a check was made: processor, system, compiler, commit, and the date.

use crate::pipeline::error::{Error, Result};
use crate::timing::machine;
use chrono::DateTime;
use std::path::Path;
use std::process::Command;
use std::time::{SystemTime, UNIX_EPOCH};

/// The machine in pairs of name and value, in the order in which to show them.
pub(super) fn description() -> Vec<(&'static str, String)> {
    let system = machine::field("/etc/os-release", "PRETTY_NAME=")
        .unwrap_or_else(|| std::env::consts::OS.to_owned());
    let memory = machine::field("/proc/meminfo", "MemTotal").unwrap_or_else(machine::unknown);
    vec![
        ("processor", machine::processor()),
        ("cores", machine::cores().to_string()),
        ("memory", memory),
        ("system", format!("{system} {}", machine::kernel()).trim().to_owned()),
        ("architecture", std::env::consts::ARCH.to_owned()),
    ]
}

/// The commit that is checked out in `project`, and whether files differ from it; `None` without git.
pub(super) fn commit(project: &Path) -> Option<String> {
    let commit = git(project, &["rev-parse", "HEAD"])?;
    let edited = git(project, &["status", "--porcelain", "--untracked-files=no"])?;
    Some(if edited.is_empty() { commit } else { format!("{commit}, with local changes") })
}

/// Whether the lock file is the committed one; `None` without git.
pub(super) fn lock_is_committed(project: &Path) -> Option<bool> {
    // A file that git does not know differs from no commit, yet has a status.
    Some(git(project, &["status", "--porcelain", "--", "pipeline/lock.toml"])?.is_empty())
}

/// What git says of `project`; `None` if it fails or is not there.
fn git(project: &Path, args: &[&str]) -> Option<String> {
    let said = Command::new("git").arg("-C").arg(project).args(args).output().ok()?;
    said.status.success().then(|| String::from_utf8_lossy(&said.stdout).trim().to_owned())
}

/// Now in UTC, or the moment in `SOURCE_DATE_EPOCH`, as `2026-11-21 07:20:05`.
pub(super) fn check_time() -> Result<String> {
    let seconds = match std::env::var("SOURCE_DATE_EPOCH") {
        Ok(text) => {
            text.parse().ok().filter(|seconds| (0..=LAST).contains(seconds)).ok_or_else(|| {
                Error::input(format!(
                    "SOURCE_DATE_EPOCH={text}: give seconds since 1970, or unset it"
                ))
            })?
        }
        // A clock before 1970 is wrong by so much that the date says it.
        Err(_) => {
            SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |now| now.as_secs() as i64)
        }
    };
    let moment = DateTime::from_timestamp(seconds, 0);
    Ok(moment.expect("within four digits of year").format("%Y-%m-%d %H:%M:%S").to_string())
}

/// The last second of the year 9999, after which dates have five digits.
const LAST: i64 = 253_402_300_799;
