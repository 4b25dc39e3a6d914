//! Progress while tasks run: a bar on a terminal, plain lines elsewhere, on standard error.

use super::Ran;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::collections::BTreeSet;
use std::io::{IsTerminal, Write};
use std::sync::Mutex;
use std::time::Duration;

/// Report on the walk of the plan.
pub struct Progress {
    bar: Option<ProgressBar>,
    /// Tasks that run now.
    running: Mutex<BTreeSet<String>>,
    verbose: bool,
    quiet: bool,
}

/// Time between two drawings of the elapsed time.
const TICK: Duration = Duration::from_millis(200);

impl Progress {
    /// Returns a report with a bar if standard error is a terminal. `verbose` adds a line per task; `quiet` silences
    /// all.
    pub fn new(verbose: bool, quiet: bool) -> Self {
        let bar = if quiet { None } else { bar("[{bar:30}] {pos}/{len}  {elapsed}  {wide_msg}") };
        Self { bar, running: Mutex::default(), verbose: verbose && !quiet, quiet }
    }

    /// Announces the number of tasks to run, and why the first of them run.
    pub(super) fn begin(&self, tasks: usize, why: &str) {
        match &self.bar {
            Some(bar) => {
                bar.set_length(tasks as u64);
                bar.set_message(why.to_owned());
                bar.enable_steady_tick(TICK);
            }
            None if !self.quiet => {
                let plural = if tasks == 1 { "" } else { "s" };
                talk(&format!("{tasks} task{plural} to run ({why})"));
            }
            None => {}
        }
    }

    /// Shows a task among those that run now.
    pub(super) fn start(&self, task: &str) {
        self.change(|running| running.insert(task.to_owned()));
    }

    /// Counts a task that waited and need not run.
    pub(super) fn skip(&self) {
        if let Some(bar) = &self.bar {
            bar.inc(1);
        }
    }

    pub(super) fn done(&self, ran: &Ran, verdict: &str) {
        if self.verbose {
            let time = ran.time.as_secs_f64() * 1e3;
            let line = format!("{verdict} {} ({time:.1} ms): {}", ran.task, ran.reason);
            match &self.bar {
                Some(bar) => bar.println(line),
                None => talk(&line),
            }
        }
        self.change(|running| running.remove(&ran.task));
        self.skip();
    }

    /// Changes the set of running tasks, and shows it.
    fn change(&self, change: impl FnOnce(&mut BTreeSet<String>) -> bool) {
        let Some(bar) = &self.bar else { return };
        let mut running = self.running.lock().expect("no panic while it is held");
        change(&mut running);
        bar.set_message(running.iter().map(String::as_str).collect::<Vec<_>>().join(", "));
    }

    /// Writes the reason for a delay.
    pub fn note(&self, line: &str) {
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

/// Returns a bar of this style if standard error is a terminal that can overwrite a line, outside continuous
/// integration.
pub fn bar(template: &str) -> Option<ProgressBar> {
    let dumb = std::env::var_os("TERM").is_some_and(|term| term == "dumb");
    let logged = std::env::var_os("CI").is_some_and(|ci| !ci.is_empty() && ci != "false");
    (std::io::stderr().is_terminal() && !dumb && !logged).then(|| {
        let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr());
        let style = ProgressStyle::with_template(template).expect("a valid template");
        bar.set_style(style.progress_chars("=> "));
        bar
    })
}

/// Writes a line on standard error; if that is closed, the line is lost, and the program goes on.
pub fn talk(line: &str) {
    let _ = writeln!(anstream::stderr(), "{line}");
}
