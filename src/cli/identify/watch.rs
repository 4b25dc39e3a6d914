//! Progress of a search for a person: a bar on a terminal, plain lines elsewhere.

use crate::cli::output::talk;
use crate::pipeline::bar;
use indicatif::ProgressBar;
use signorini_mathematics::identify::SearchProgress;
use std::time::{Duration, Instant};

/// Time between two plain lines.
const LINE: Duration = Duration::from_secs(10);

/// Reports a search on standard error.
pub(super) struct Watch {
    name: String,
    bar: Option<ProgressBar>,
    began: Instant,
    spoke: Instant,
    last: Option<SearchProgress>,
}

impl Watch {
    pub(super) fn new(name: &str) -> Self {
        let bar = bar("{prefix} [{bar:24}] {percent:>3} %  {eta:>4}  {wide_msg}");
        bar.iter().for_each(|bar| bar.set_prefix(name.to_owned()));
        let now = Instant::now();
        Self { name: name.into(), bar, began: now, spoke: now, last: None }
    }

    pub(super) fn show(&mut self, progress: &SearchProgress) {
        self.last = Some(progress.clone());
        match &self.bar {
            Some(bar) => {
                bar.set_length(progress.all);
                bar.set_position(progress.done);
                bar.set_message(in_words(progress, self.began.elapsed()));
            }
            None if self.spoke.elapsed() >= LINE => {
                let percent = 100 * progress.done / progress.all.max(1);
                let words = in_words(progress, self.began.elapsed());
                talk(&format!("{}: {percent} %, {words}", self.name));
                self.spoke = Instant::now();
            }
            None => {}
        }
    }

    /// Seconds so far, and runs per second that entered each grid.
    pub(super) fn rates(&self) -> (f64, Vec<f64>) {
        let Some(last) = &self.last else { return (0.0, Vec::new()) };
        let seconds = self.began.elapsed().as_secs_f64();
        (seconds, last.entered.iter().map(|&n| n as f64 / seconds).collect())
    }

    pub(super) fn line(&mut self, text: &str) {
        match &self.bar {
            Some(bar) => bar.println(text),
            None => talk(text),
        }
    }

    pub(super) fn end(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
        if let Some(last) = &self.last {
            let time = self.began.elapsed();
            let words = in_words(last, time);
            talk(&format!("{}: {:.1} s, {words}", self.name, time.as_secs_f64()));
        }
    }
}

/// Candidates, the rate at which each grid is entered, and the best so far.
fn in_words(progress: &SearchProgress, time: Duration) -> String {
    let seconds = time.as_secs_f64().max(1e-3);
    let tried = progress.tried as f64;
    let mut text = format!("{} candidates, {}/s", short(tried), short(tried / seconds));
    for (level, &n) in progress.entered.iter().enumerate().skip(1) {
        text += &format!("; grid {}: {}/s", level + 1, short(n as f64 / seconds));
    }
    match progress.best {
        Some(best) => text + &format!("; best {best:.3}"),
        None => text + "; none yet",
    }
}

/// Three digits and a letter.
fn short(x: f64) -> String {
    match x {
        x if x >= 1e6 => format!("{:.2} M", x / 1e6),
        x if x >= 1e4 => format!("{:.0} k", x / 1e3),
        x if x >= 1e3 => format!("{:.1} k", x / 1e3),
        x if x >= 10.0 || x == 0.0 => format!("{x:.0}"),
        x => format!("{x:.1}"),
    }
}
