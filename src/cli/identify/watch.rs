//! Progress of a search for a person: a bar on a terminal, plain lines elsewhere.

use crate::cli::output::talk;
use crate::pipeline::bar;
use indicatif::ProgressBar;
use signorini_mathematics::identify::SearchReport;
use std::time::{Duration, Instant};

/// Time between two plain lines.
const LINE: Duration = Duration::from_secs(10);
/// Steps of the bar.
const STEPS: u64 = 1000;

/// Reports a search on standard error.
pub(super) struct Watch {
    name: String,
    bar: Option<ProgressBar>,
    began: Instant,
    spoke: Instant,
    /// Last report.
    words: Option<String>,
}

impl Watch {
    pub(super) fn new(name: &str) -> Self {
        let bar = bar("{prefix} [{bar:24}] {percent:>3} %  {eta:>4}  {wide_msg}");
        if let Some(bar) = &bar {
            bar.set_prefix(name.to_owned());
            bar.set_length(STEPS);
        }
        let now = Instant::now();
        Self { name: name.into(), bar, began: now, spoke: now, words: None }
    }

    /// Shows the share that is done, and the report so far.
    pub(super) fn show(&mut self, share: f64, report: &SearchReport) {
        let words = in_words(report, self.began.elapsed());
        match &self.bar {
            Some(bar) => {
                bar.set_position((share * STEPS as f64) as u64);
                bar.set_message(words.clone());
            }
            None if self.spoke.elapsed() >= LINE => {
                talk(&format!("{}: {:.0} %, {words}", self.name, 100.0 * share));
                self.spoke = Instant::now();
            }
            None => {}
        }
        self.words = Some(words);
    }

    pub(super) fn end(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
        if let Some(words) = &self.words {
            talk(&format!("{}: {:.1} s, {words}", self.name, self.began.elapsed().as_secs_f64()));
        }
    }
}

/// Candidates, the rate at which they are tried, and how many give all counts.
fn in_words(report: &SearchReport, time: Duration) -> String {
    let tried = report.tried as f64;
    let rate = tried / time.as_secs_f64().max(1e-3);
    format!("{} candidates, {}/s; {} with all counts", short(tried), short(rate), report.exact)
}

/// Three digits and a letter.
fn short(x: f64) -> String {
    match x {
        x if x >= 1e6 => format!("{:.2} M", x / 1e6),
        x if x >= 1e4 => format!("{:.0} k", x / 1e3),
        x if x >= 1e3 => format!("{:.1} k", x / 1e3),
        x => format!("{x:.0}"),
    }
}
