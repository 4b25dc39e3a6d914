//! What a person sees while tasks run: a bar on a terminal, plain lines elsewhere, on standard error.

use super::{Ran, Stage};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::{IsTerminal, Write};

/// Reports the walk of the plan.
pub struct Progress {
    bar: Option<ProgressBar>,
    verbose: bool,
    quiet: bool,
}

impl Progress {
    /// A bar if standard error is a terminal. `verbose` adds a line per task; `quiet` silences all.
    pub fn new(verbose: bool, quiet: bool) -> Self {
        let bar = (std::io::stderr().is_terminal() && !quiet).then(|| {
            let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr());
            let style =
                ProgressStyle::with_template("{prefix:>9} [{bar:30}] {pos}/{len} {wide_msg}");
            bar.set_style(style.expect("a valid template").progress_chars("=> "));
            bar
        });
        Self { bar, verbose: verbose && !quiet, quiet }
    }

    /// A stage starts with this many tasks to run.
    pub(super) fn begin(&self, stage: Stage, tasks: usize) {
        match &self.bar {
            Some(bar) => {
                bar.reset();
                bar.set_length(tasks as u64);
                bar.set_prefix(stage.name());
            }
            None if !self.quiet => say(&format!("{}: {tasks} to run", stage.name())),
            None => {}
        }
    }

    /// A task ended.
    pub(super) fn done(&self, ran: &Ran, succeeded: bool) {
        if self.verbose {
            let verdict = if succeeded { "ran" } else { "FAILED" };
            let line = format!(
                "{verdict} {} ({:.1} ms): {}",
                ran.task,
                ran.time.as_secs_f64() * 1e3,
                ran.reason
            );
            match &self.bar {
                Some(bar) => bar.println(line),
                None => say(&line),
            }
        }
        if let Some(bar) = &self.bar {
            bar.set_message(ran.task.clone());
            bar.inc(1);
        }
    }

    /// The stage that began last has ended.
    pub(super) fn end(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

/// A plain line; a reader that has gone away is no reason to stop.
fn say(line: &str) {
    let _ = writeln!(std::io::stderr(), "{line}");
}
