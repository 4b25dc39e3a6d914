//! How long each task took when it last ran, and what that makes a run last: for people, in no hash.

use super::files::read;
use super::{Ran, stage};
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Name of the file in the cache folder.
const FILE: &str = "times.json";

/// Seconds by task id. A file that is missing or damaged is as good as empty.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Times {
    #[serde(skip)]
    path: PathBuf,
    schema: u8,
    seconds: BTreeMap<String, f64>,
}

const SCHEMA: u8 = 1;

impl Times {
    /// What is on record in this cache folder.
    pub fn read(cache: &Path) -> Self {
        let path = cache.join(FILE);
        let stored = read(&path).ok().and_then(|text| serde_json::from_slice(&text).ok());
        let Self { mut seconds, .. } =
            stored.filter(|stored: &Self| stored.schema == SCHEMA).unwrap_or_default();
        seconds.retain(|_, time| (0.0..LONGEST).contains(time));
        Self { path, schema: SCHEMA, seconds }
    }

    pub(super) fn learn(&mut self, ran: &Ran) {
        self.seconds.insert(ran.task.clone(), ran.time.as_secs_f64());
    }

    /// Forgets all tasks but these.
    pub fn keep(&mut self, tasks: &BTreeSet<String>) {
        self.seconds.retain(|task, _| tasks.contains(task));
    }

    /// Writes the record, if it can be written: no run should fail for the sake of an estimate.
    pub fn save(&self) {
        let text = serde_json::to_vec_pretty(self).expect("times are plain data");
        // A pipe would wait for its reader.
        if fs::metadata(&self.path).is_ok_and(|there| !there.is_file()) {
            return;
        }
        // In place: half of it is as good as none.
        let _ = fs::write(&self.path, &text);
    }

    /// What a task is expected to take: its last time, else the mean of its stage.
    fn of(&self, task: &str) -> Option<f64> {
        self.seconds.get(task).copied().or_else(|| {
            let siblings = || self.seconds.iter().filter(|(id, _)| stage(id) == stage(task));
            let mean = siblings().map(|(_, time)| time).sum::<f64>() / siblings().count() as f64;
            mean.is_finite().then_some(mean)
        })
    }

    /// What is ahead when these tasks are to run.
    pub fn ahead<'a>(&self, tasks: impl Iterator<Item = &'a str>, threads: usize) -> Ahead {
        let tasks = tasks.map(|id| (id.to_owned(), self.of(id))).collect();
        Ahead { tasks, threads: threads.max(1) }
    }
}

/// A year; what claims more is no time that was measured.
const LONGEST: f64 = 365.0 * 86_400.0;

/// Tasks that have not ended, with the seconds each is expected to take.
#[derive(Debug, Default)]
pub struct Ahead {
    tasks: BTreeMap<String, Option<f64>>,
    threads: usize,
}

impl Ahead {
    pub(super) fn ended(&mut self, task: &str) {
        self.tasks.remove(task);
    }

    pub(super) fn len(&self) -> usize {
        self.tasks.len()
    }

    /// Time left, if it is known and worth telling: no less than the longest task takes, nor than the
    /// threads need for all of them.
    pub fn left(&self) -> Option<Duration> {
        let times = self.tasks.values().copied().collect::<Option<Vec<f64>>>()?;
        let longest = times.iter().copied().fold(0.0, f64::max);
        let left = longest.max(times.iter().sum::<f64>() / self.threads as f64);
        (left >= SHORT).then(|| Duration::from_secs_f64(left))
    }
}

/// A duration with two digits and a unit, for people.
pub fn brief(time: Duration) -> String {
    match time.as_secs_f64() {
        s if s < SHORT => format!("<{SHORT} s"),
        s if s < 9.95 => format!("{s:.1} s"),
        s if s < 99.5 => format!("{s:.0} s"),
        s if s < 5970.0 => format!("{:.0} min", s / 60.0),
        s => format!("{:.0} h", s / 3600.0),
    }
}

/// Seconds below which nobody waits.
const SHORT: f64 = 0.1;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tasks_share_the_threads_and_what_has_ended_is_no_longer_ahead() {
        let seconds = [("solve/a", 100.0), ("solve/b", 300.0), ("diff/a", 50.0)];
        let seconds = seconds.iter().map(|(id, time)| ((*id).to_owned(), *time)).collect();
        let times = Times { seconds, ..Times::default() };
        let left = |tasks: &[&str], threads| {
            times.ahead(tasks.iter().copied(), threads).left().map(|left| left.as_secs())
        };
        assert_eq!(left(&["solve/a", "solve/b", "diff/a"], 1), Some(450));
        assert_eq!(left(&["solve/a", "solve/b", "diff/a"], 2), Some(300), "no less than solve/b");
        assert_eq!(left(&["solve/new"], 4), Some(200), "the mean of its siblings");
        assert_eq!(left(&["figures/a"], 4), None);
        let mut ahead = times.ahead(["solve/a", "solve/b"].into_iter(), 1);
        ahead.ended("solve/b");
        assert_eq!(ahead.left(), Some(Duration::from_secs(100)));
    }

    #[test]
    fn a_damaged_record_is_an_empty_one() {
        let folder = tempfile::tempdir().unwrap();
        assert!(Times::read(folder.path()).seconds.is_empty());
        let mut written = Times::read(folder.path());
        written.seconds.insert("solve/a".into(), 2.0);
        written.save();
        assert_eq!(Times::read(folder.path()).seconds, written.seconds);
        for garbage in [
            &b"{"[..],
            b"\xff",
            br#"{"schema":2,"seconds":{"solve/a":1}}"#,
            br#"{"schema":1,"seconds":{"solve/a":-1,"solve/b":1e300}}"#,
        ] {
            fs::write(folder.path().join(FILE), garbage).unwrap();
            assert!(Times::read(folder.path()).seconds.is_empty());
        }
    }

    #[test]
    fn durations_are_told_with_their_unit() {
        let texts = [0.04, 9.94, 9.96, 99.0, 100.0, 5940.0, 7200.0]
            .map(|s| brief(Duration::from_secs_f64(s)));
        assert_eq!(texts, ["<0.1 s", "9.9 s", "10 s", "99 s", "2 min", "99 min", "2 h"]);
    }
}
