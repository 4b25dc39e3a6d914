//! What a person sees while tasks run: a bar on a terminal, plain lines elsewhere, on standard error.

use super::times::{Ahead, brief};
use super::{Ran, Stage, Trace};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};
use serde_json::Value;
use std::fmt;
use std::io::{IsTerminal, Write};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

/// Reports the walk of the plan.
pub struct Progress {
    bar: Option<ProgressBar>,
    ahead: Arc<Mutex<Ahead>>,
    trace: Option<Trace>,
    verbose: bool,
    quiet: bool,
}

impl Progress {
    /// A bar if standard error is a terminal. `verbose` adds a line per task; `quiet` silences all.
    pub fn new(verbose: bool, quiet: bool) -> Self {
        let ahead = Arc::<Mutex<Ahead>>::default();
        let bar = (moves() && !quiet).then(|| {
            let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr());
            let ahead = Arc::clone(&ahead);
            let left = move |_: &ProgressState, out: &mut dyn fmt::Write| {
                let left = ahead.lock().expect("no panic while it is held").left();
                // A bar that cannot be drawn is not worth an error.
                let _ = left.map_or(Ok(()), |left| write!(out, "about {} left", brief(left)));
            };
            let style = ProgressStyle::with_template(
                "{prefix:>9} [{bar:30}] {pos}/{len}  {left}  {wide_msg}",
            );
            let style = style.expect("a valid template").with_key("left", left);
            bar.set_style(style.progress_chars("=> "));
            bar
        });
        Self { bar, ahead, trace: None, verbose: verbose && !quiet, quiet }
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

    /// A stage starts with this many tasks to run, for this reason.
    pub(super) fn begin(&self, stage: Stage, tasks: usize, why: &str, ahead: Ahead) {
        let left = ahead.left();
        *self.ahead.lock().expect("no panic while it is held") = ahead;
        match &self.bar {
            Some(bar) => {
                bar.reset();
                bar.set_length(tasks as u64);
                bar.set_prefix(stage.name());
                bar.set_message(why.to_owned());
                // The time left goes down while nothing else happens.
                bar.enable_steady_tick(Duration::from_millis(250));
            }
            None if !self.quiet => {
                let left = left.map(|left| format!(", about {} left", brief(left)));
                let left = left.unwrap_or_default();
                say(&format!("{}: {tasks} to run{left} ({why})", stage.name()));
            }
            None => {}
        }
    }

    /// A task starts.
    pub(super) fn start(&self, task: &str) {
        self.ahead.lock().expect("no panic while it is held").started(task);
    }

    /// A task ended.
    pub(super) fn done(&self, ran: &Ran, succeeded: bool) {
        self.ahead.lock().expect("no panic while it is held").ended(&ran.task);
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

/// Whether standard error is a terminal on which a line can be drawn over, with a person before it.
fn moves() -> bool {
    let dumb = std::env::var_os("TERM").is_some_and(|term| term == "dumb");
    let logged = std::env::var_os("CI").is_some_and(|ci| !ci.is_empty() && ci != "false");
    std::io::stderr().is_terminal() && !dumb && !logged
}

/// A plain line; a reader that has gone away is no reason to stop.
fn say(line: &str) {
    let _ = writeln!(std::io::stderr(), "{line}");
}
