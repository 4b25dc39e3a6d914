//! Run times of the solvers, and the machine on which they were measured.

pub mod machine;
pub(crate) mod median;
pub mod recorded;

use std::sync::OnceLock;
use std::time::{Duration, Instant};

/// Returns the time since the first call.
pub fn clock() -> Duration {
    static START: OnceLock<Instant> = OnceLock::new();
    START.get_or_init(Instant::now).elapsed()
}
