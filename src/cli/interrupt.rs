//! Ctrl-C as a flag that long work looks at.

use super::output::talk;
use crate::pipeline::error::Error;
use std::sync::Once;
use std::sync::atomic::{AtomicBool, Ordering};

/// Set by the first Ctrl-C; the second ends the process at once.
pub(super) fn interrupted() -> &'static AtomicBool {
    static FLAG: AtomicBool = AtomicBool::new(false);
    static HANDLER: Once = Once::new();
    HANDLER.call_once(|| {
        // Without a handler Ctrl-C still ends the process, and the cache survives that.
        let _ = ctrlc::set_handler(|| {
            if FLAG.swap(true, Ordering::Relaxed) {
                std::process::exit(i32::from(Error::Interrupted.exit_code()));
            }
            talk("finishing what has begun; Ctrl-C again to stop at once");
        });
    });
    &FLAG
}
