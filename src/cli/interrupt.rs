//! Ctrl-C, and the other signals that ask a process to end, as a flag that long work reads.

use super::output::talk;
use crate::pipeline::error::Error;
use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
use signal_hook::iterator::Signals;
use std::sync::Once;
use std::sync::atomic::{AtomicBool, Ordering};

/// Flag that the first signal sets; the second signal ends the process at once.
pub(super) fn interrupted() -> &'static AtomicBool {
    static FLAG: AtomicBool = AtomicBool::new(false);
    static HANDLER: Once = Once::new();
    HANDLER.call_once(|| {
        let asked = [SIGINT, SIGTERM, SIGHUP].into_iter().filter(|&signal| !is_ignored(signal));
        // Without a handler a signal ends the process at once, which does not damage the cache.
        let Ok(mut signals) = Signals::new(asked) else { return };
        let _ = std::thread::Builder::new().name("signals".into()).spawn(move || {
            for _ in signals.forever() {
                if FLAG.load(Ordering::Relaxed) {
                    std::process::exit(i32::from(Error::Interrupted.exit_code()));
                }
                // The flag comes after: the error that ends the work is the last line.
                talk("finishing what has begun; Ctrl-C again to stop at once");
                FLAG.store(true, Ordering::Relaxed);
            }
        });
    });
    &FLAG
}

/// True if the process was started with the order to ignore the end of its terminal, as by `nohup`.
///
/// Only Linux tells this; on other systems no handler is set for that signal.
fn is_ignored(signal: i32) -> bool {
    if signal != SIGHUP {
        return false;
    }
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let mask = mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
    mask.is_none_or(|mask| mask & (1 << (signal - 1)) != 0)
}
