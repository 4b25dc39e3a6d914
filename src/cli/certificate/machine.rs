//! Where and when a check was made: processor, system, compiler, commit, and the date.

use crate::pipeline::error::{Error, Result};
use crate::timing::machine;
use std::path::Path;
use std::process::Command;
use std::time::{SystemTime, UNIX_EPOCH};

/// The machine in pairs of name and value, in the order in which to show them.
pub(super) fn description() -> Vec<(&'static str, String)> {
    let system = machine::field("/etc/os-release", "PRETTY_NAME=")
        .unwrap_or_else(|| std::env::consts::OS.to_owned());
    let memory = machine::field("/proc/meminfo", "MemTotal").unwrap_or_else(|| "unknown".into());
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
    let git = |args: &[&str]| {
        let said = Command::new("git").arg("-C").arg(project).args(args).output().ok()?;
        said.status.success().then(|| String::from_utf8_lossy(&said.stdout).trim().to_owned())
    };
    let commit = git(&["rev-parse", "HEAD"])?;
    let edited = git(&["status", "--porcelain", "--untracked-files=no"])?;
    Some(if edited.is_empty() { commit } else { format!("{commit}, with local changes") })
}

/// Whether the lock file is the committed one; `None` without git.
pub(super) fn lock_is_committed(project: &Path) -> Option<bool> {
    commit(project)?;
    let mut git = Command::new("git");
    git.arg("-C").arg(project).args(["diff", "--quiet", "HEAD", "--", "pipeline/lock.toml"]);
    Some(git.status().ok()?.success())
}

/// Now in UTC, or the moment in `SOURCE_DATE_EPOCH`, as `2026-11-21 07:20:05`.
///
/// # Errors
/// [`Error::Input`] if `SOURCE_DATE_EPOCH` is no number of seconds.
pub(super) fn check_time() -> Result<String> {
    let seconds = match std::env::var("SOURCE_DATE_EPOCH") {
        Ok(text) => text.parse().ok().filter(|seconds| *seconds < LAST).ok_or_else(|| {
            Error::input(format!("SOURCE_DATE_EPOCH={text}: give seconds since 1970, or unset it"))
        })?,
        // A clock before 1970 is wrong by so much that the date says it.
        Err(_) => SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |now| now.as_secs()),
    };
    Ok(date(seconds))
}

/// The last second of the year 9999, after which dates have five digits.
const LAST: u64 = 253_402_300_800;

/// Date and time in UTC of a moment in seconds since 1970.
fn date(seconds: u64) -> String {
    let (mut day, second) = (seconds / 86_400, seconds % 86_400);
    let leap = |year: u64| {
        year.is_multiple_of(4) && (!year.is_multiple_of(100) || year.is_multiple_of(400))
    };
    let mut year = 1970;
    while day >= 365 + u64::from(leap(year)) {
        day -= 365 + u64::from(leap(year));
        year += 1;
    }
    let february = 28 + u64::from(leap(year));
    let mut month = 1;
    for length in [31, february, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31] {
        if day < length {
            break;
        }
        day -= length;
        month += 1;
    }
    let (hour, minute, second) = (second / 3600, second / 60 % 60, second % 60);
    format!("{year:04}-{month:02}-{:02} {hour:02}:{minute:02}:{second:02}", day + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dates_are_those_of_the_calendar() {
        assert_eq!(date(0), "1970-01-01 00:00:00");
        assert_eq!(date(951_782_399), "2000-02-28 23:59:59");
        assert_eq!(date(951_782_400), "2000-02-29 00:00:00");
        assert_eq!(date(1_709_251_199), "2024-02-29 23:59:59");
        assert_eq!(date(1_795_245_605), "2026-11-21 07:20:05");
        assert_eq!(date(4_107_542_400), "2100-03-01 00:00:00");
        assert_eq!(date(LAST - 1), "9999-12-31 23:59:59");
    }
}
