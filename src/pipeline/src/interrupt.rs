//! Order to end, which a signal gives while something is at work that is worth finishing.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// Order to end, and the number of tasks at work.
#[derive(Debug, Default)]
pub struct Interrupt {
    asked: AtomicBool,
    at_work: AtomicUsize,
}

impl Interrupt {
    /// Returns an order that nobody has given.
    pub const fn new() -> Self {
        Self { asked: AtomicBool::new(false), at_work: AtomicUsize::new(0) }
    }

    /// Flag that is set once the order is given.
    pub fn flag(&self) -> &AtomicBool {
        &self.asked
    }

    /// True if the order was given.
    pub fn is_asked(&self) -> bool {
        self.asked.load(Ordering::Relaxed)
    }

    /// Gives the order, after which what is at work is finished.
    pub fn ask(&self) {
        self.asked.store(true, Ordering::Relaxed);
    }

    /// Counts a task as at work until the value is dropped.
    pub fn begin(&self) -> AtWork<'_> {
        self.at_work.fetch_add(1, Ordering::SeqCst);
        AtWork(self)
    }

    /// True if something is at work. If not, the process may end at once: files are written whole or not at all.
    pub fn is_at_work(&self) -> bool {
        self.at_work.load(Ordering::SeqCst) > 0
    }
}

/// Task that counts as at work.
#[derive(Debug)]
pub struct AtWork<'a>(&'a Interrupt);

impl Drop for AtWork<'_> {
    fn drop(&mut self) {
        self.0.at_work.fetch_sub(1, Ordering::SeqCst);
    }
}
