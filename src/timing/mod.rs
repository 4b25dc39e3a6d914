//! Run times of the solvers, and the machine they were measured on.

mod bandwidth;
pub mod machine;
pub mod measure;
pub mod recorded;
pub mod solver;

use std::sync::OnceLock;
use std::time::{Duration, Instant};

/// The time since this was first asked for.
pub fn clock() -> Duration {
    static START: OnceLock<Instant> = OnceLock::new();
    START.get_or_init(Instant::now).elapsed()
}
