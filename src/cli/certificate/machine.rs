//! Place and time of a check: processor, system, and the date.

use crate::pipeline::error::{Error, Result};
use crate::timing::machine;
use chrono::DateTime;
use std::time::{SystemTime, UNIX_EPOCH};

/// Returns the facts on the machine as pairs of name and value, in the order in which they are shown.
pub(super) fn description() -> Vec<(&'static str, String)> {
    let system = machine::field("/etc/os-release", "PRETTY_NAME=")
        .unwrap_or_else(|| std::env::consts::OS.to_owned());
    vec![
        ("processor", machine::processor()),
        ("system", format!("{system} {}", machine::kernel()).trim().to_owned()),
    ]
}

/// Returns the time in UTC, or that in `SOURCE_DATE_EPOCH`, in the form `2026-11-21 07:20:05`.
pub(super) fn check_time() -> Result<String> {
    let seconds = match std::env::var("SOURCE_DATE_EPOCH") {
        Ok(text) => {
            text.parse().ok().filter(|seconds| (0..=LAST).contains(seconds)).ok_or_else(|| {
                Error::input(format!(
                    "SOURCE_DATE_EPOCH={text}: give seconds since 1970, or unset it"
                ))
            })?
        }
        // A clock before 1970 is shown as 1970, which is visibly wrong.
        Err(_) => {
            SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |now| now.as_secs() as i64)
        }
    };
    let moment = DateTime::from_timestamp(seconds, 0);
    Ok(moment.expect("within four digits of year").format("%Y-%m-%d %H:%M:%S").to_string())
}

/// Last second of the year 9999, after which years have five digits.
const LAST: i64 = 253_402_300_799;
