//! Ctrl-C, and the other signals that ask a process to end: at once, unless something is at work.

use super::fail;
use super::output::talk;
use crate::pipeline::error::Error;
use crate::pipeline::{AtWork, Interrupt};
use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM, SIGXFSZ};
use signal_hook::iterator::Signals;
use std::sync::{Arc, Once};

/// Order of this process to end.
static INTERRUPT: Interrupt = Interrupt::new();

/// Order that the first signal gives while something is at work; a second signal, or one while nothing is at work, ends
/// the process at once. Commands that write nothing need no handler, and do not call this, but for
/// `solve` to an accuracy on meshes, which ends with its best answer.
pub(super) fn interrupted() -> &'static Interrupt {
    static HANDLER: Once = Once::new();
    HANDLER.call_once(|| {
        let asked = [SIGINT, SIGTERM, SIGHUP].into_iter().filter(|&signal| !is_ignored(signal));
        // Without a handler a signal ends the process at once, which does not damage the cache.
        let Ok(mut signals) = Signals::new(asked) else { return };
        let _ = std::thread::Builder::new().name("signals".into()).spawn(move || {
            for _ in signals.forever() {
                if INTERRUPT.is_asked() || !INTERRUPT.is_at_work() {
                    if !INTERRUPT.is_asked() {
                        fail(&Error::Interrupted.to_string());
                    }
                    std::process::exit(i32::from(Error::Interrupted.exit_code()));
                }
                // The flag comes after: the error that ends the work is the last line.
                talk("finishing what has begun; Ctrl-C again to stop at once");
                INTERRUPT.ask();
            }
        });
    });
    &INTERRUPT
}

/// Counts the whole process as at work until the value is dropped: a signal ends it with what it has found.
pub(super) fn at_work() -> AtWork<'static> {
    // First, so that no signal finds the handler without work.
    let at_work = INTERRUPT.begin();
    interrupted();
    at_work
}

/// Lets a write beyond the limit on the size of files fail, with a message of this program, in place of a signal that
/// ends it without a word. Programs that are started get the signal as usual.
pub(super) fn survive_file_limit() {
    // Without it the limit holds as well.
    let _ = signal_hook::flag::register(SIGXFSZ, Arc::default());
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
