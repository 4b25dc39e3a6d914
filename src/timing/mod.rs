//! Run times of the solvers, and the machine on which they were measured.

mod bandwidth;
pub mod machine;
pub mod measure;
pub mod recorded;

use std::sync::OnceLock;
use std::time::{Duration, Instant};

/// Returns the time since the first call.
pub fn clock() -> Duration {
    static START: OnceLock<Instant> = OnceLock::new();
    START.get_or_init(Instant::now).elapsed()
}
