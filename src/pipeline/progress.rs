//! What a person sees while tasks run: a bar on a terminal, plain lines elsewhere, on standard error.

use super::times::Ahead;
use super::{Ran, Trace, brief};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde_json::Value;
use std::io::{IsTerminal, Write};
use std::sync::{Mutex, MutexGuard};
use std::time::Instant;

/// Reports the walk of the plan.
pub struct Progress {
    bar: Option<ProgressBar>,
    ahead: Mutex<Ahead>,
    trace: Option<Trace>,
    verbose: bool,
    quiet: bool,
}

impl Progress {
    /// A bar if standard error is a terminal. `verbose` adds a line per task; `quiet` silences all.
    pub fn new(verbose: bool, quiet: bool) -> Self {
        let bar = if quiet { None } else { bar("[{bar:30}] {pos}/{len}  {prefix}  {wide_msg}") };
        Self { bar, ahead: Mutex::default(), trace: None, verbose: verbose && !quiet, quiet }
    }

    /// The same, recording what happens when.
    pub fn traced(self) -> Self {
        Self { trace: Some(Trace::default()), ..self }
    }

    /// What was recorded.
    pub fn trace(&self) -> Option<&Trace> {
        self.trace.as_ref()
    }

    /// Something that began at `start` on this thread has ended.
    pub(super) fn span(
        &self,
        category: &'static str,
        name: &str,
        start: Instant,
        args: impl FnOnce() -> Value,
    ) {
        if let Some(trace) = &self.trace {
            trace.span(category, name, start, args());
        }
    }

    fn ahead(&self) -> MutexGuard<'_, Ahead> {
        self.ahead.lock().expect("no panic while it is held")
    }

    /// These tasks are to run, the first of them for this reason.
    pub(super) fn begin(&self, ahead: Ahead, why: &str) {
        let (tasks, left) = (ahead.len(), left(&ahead));
        *self.ahead() = ahead;
        match &self.bar {
            Some(bar) => {
                bar.set_length(tasks as u64);
                bar.set_prefix(left);
                bar.set_message(why.to_owned());
            }
            None if !self.quiet => {
                let left = if left.is_empty() { left } else { format!(", {left}") };
                let plural = if tasks == 1 { "" } else { "s" };
                talk(&format!("{tasks} task{plural} to run{left} ({why})"));
            }
            None => {}
        }
    }

    /// A task that waited need not run.
    pub(super) fn skip(&self, task: &str) {
        self.ahead().ended(task);
        if let Some(bar) = &self.bar {
            bar.set_prefix(left(&self.ahead()));
            bar.inc(1);
        }
    }

    pub(super) fn done(&self, ran: &Ran, succeeded: bool) {
        if self.verbose {
            let verdict = if succeeded { "ran" } else { "FAILED" };
            let time = ran.time.as_secs_f64() * 1e3;
            let line = format!("{verdict} {} ({time:.1} ms): {}", ran.task, ran.reason);
            match &self.bar {
                Some(bar) => bar.println(line),
                None => talk(&line),
            }
        }
        if let Some(bar) = &self.bar {
            bar.set_message(ran.task.clone());
        }
        self.skip(&ran.task);
    }

    /// A line for whoever wonders why nothing happens.
    pub(super) fn note(&self, line: &str) {
        if !self.quiet {
            talk(line);
        }
    }

    pub(super) fn end(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

fn left(ahead: &Ahead) -> String {
    ahead.left().map_or(String::new(), |left| format!("about {} left", brief(left)))
}

/// A bar of this style, if standard error is a terminal on which a line can be drawn over, with a
/// person before it.
pub(crate) fn bar(template: &str) -> Option<ProgressBar> {
    let dumb = std::env::var_os("TERM").is_some_and(|term| term == "dumb");
    let logged = std::env::var_os("CI").is_some_and(|ci| !ci.is_empty() && ci != "false");
    (std::io::stderr().is_terminal() && !dumb && !logged).then(|| {
        let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr());
        let style = ProgressStyle::with_template(template).expect("a valid template");
        bar.set_style(style.progress_chars("=> "));
        bar
    })
}

/// A line of talk on standard error; a reader that has gone away is no reason to stop.
pub(crate) fn talk(line: &str) {
    let _ = writeln!(anstream::stderr(), "{line}");
}
