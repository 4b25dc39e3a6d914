//! How long each task took when it last ran, and what that makes a run last: for people, in no hash.

use super::store::write_atomically;
use super::{Ran, Stage};
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Name of the file in the cache folder.
const FILE: &str = "times.json";

/// Seconds by task id. A file that is missing or damaged is as good as empty.
#[derive(Clone, Debug, Default)]
pub struct Times {
    path: PathBuf,
    seconds: BTreeMap<String, f64>,
}

#[derive(Serialize, Deserialize)]
struct Stored {
    schema: u8,
    seconds: BTreeMap<String, f64>,
}

const SCHEMA: u8 = 1;

impl Times {
    /// What is on record in this cache folder.
    pub fn read(cache: &Path) -> Self {
        let path = cache.join(FILE);
        let stored = fs::read(&path).ok().and_then(|text| serde_json::from_slice(&text).ok());
        let mut seconds = match stored {
            Some(Stored { schema: SCHEMA, seconds }) => seconds,
            _ => BTreeMap::new(),
        };
        seconds.retain(|_, time| (0.0..LONGEST).contains(time));
        Self { path, seconds }
    }

    /// Remembers a task that ran.
    pub(super) fn learn(&mut self, ran: &Ran) {
        self.seconds.insert(ran.task.clone(), ran.time.as_secs_f64());
    }

    /// Forgets all tasks but these.
    pub fn keep(&mut self, tasks: &BTreeSet<String>) {
        self.seconds.retain(|task, _| tasks.contains(task));
    }

    /// Writes the record, if it can be written: no run should fail for the sake of an estimate.
    pub fn save(&self) {
        let stored = Stored { schema: SCHEMA, seconds: self.seconds.clone() };
        let text = serde_json::to_vec_pretty(&stored).expect("times are plain data");
        let _ = write_atomically(&self.path, &text);
    }

    /// What a task is expected to take: its last time, else the mean of its stage.
    fn of(&self, stage: Stage, task: &str) -> Option<f64> {
        self.seconds.get(task).copied().or_else(|| {
            let prefix = format!("{}/", stage.name());
            let siblings = || self.seconds.iter().filter(|(id, _)| id.starts_with(&prefix));
            let mean = siblings().map(|(_, time)| time).sum::<f64>() / siblings().count() as f64;
            mean.is_finite().then_some(mean)
        })
    }

    /// What tasks are expected to take, stage after stage, on so many threads.
    ///
    /// `None` if nothing is known about one of them.
    pub fn expect<'a>(
        &self,
        tasks: impl IntoIterator<Item = (Stage, &'a str)>,
        threads: usize,
    ) -> Option<Duration> {
        let mut stages = BTreeMap::<Stage, Vec<f64>>::new();
        for (stage, task) in tasks {
            stages.entry(stage).or_default().push(self.of(stage, task)?);
        }
        let seconds = stages.values().map(|times| wall(times.iter().copied(), threads)).sum();
        Some(Duration::from_secs_f64(seconds))
    }

    /// What is ahead when the tasks `now` of a stage start, with the tasks `later` to follow.
    pub(super) fn ahead<'a>(
        &self,
        stage: Stage,
        now: impl Iterator<Item = &'a str>,
        later: impl Iterator<Item = (Stage, &'a str)>,
        threads: usize,
    ) -> Ahead {
        let later = self.expect(later, threads);
        let tasks =
            now.map(|id| Some((id.to_owned(), Doing { time: self.of(stage, id)?, start: None })));
        let tasks = tasks.collect::<Option<BTreeMap<_, _>>>();
        Ahead { known: later.zip(tasks), threads }
    }
}

/// A year; what claims more is no time that was measured.
const LONGEST: f64 = 365.0 * 86_400.0;

/// Seconds for independent tasks on so many threads: no less than the longest, nor than a fair share.
fn wall(times: impl Iterator<Item = f64> + Clone, threads: usize) -> f64 {
    let longest = times.clone().fold(0.0, f64::max);
    longest.max(times.sum::<f64>() / threads.max(1) as f64)
}

/// What is left of a run, as far as times are known.
#[derive(Debug, Default)]
pub(super) struct Ahead {
    /// The stages that follow, and the tasks of this one that have not ended.
    known: Option<(Duration, BTreeMap<String, Doing>)>,
    threads: usize,
}

#[derive(Debug)]
struct Doing {
    time: f64,
    start: Option<Instant>,
}

impl Ahead {
    pub(super) fn started(&mut self, task: &str) {
        let doing = self.known.as_mut().and_then(|(_, tasks)| tasks.get_mut(task));
        doing.into_iter().for_each(|doing| doing.start = Some(Instant::now()));
    }

    pub(super) fn ended(&mut self, task: &str) {
        self.known.as_mut().and_then(|(_, tasks)| tasks.remove(task));
    }

    /// Time left, if it is known and worth telling.
    pub(super) fn left(&self) -> Option<Duration> {
        let (later, tasks) = self.known.as_ref()?;
        let left = tasks.values().map(|doing| {
            let spent = doing.start.map_or(0.0, |start| start.elapsed().as_secs_f64());
            (doing.time - spent).max(0.0)
        });
        let left = *later + Duration::from_secs_f64(wall(left, self.threads));
        (left.as_secs_f64() >= SHORT).then_some(left)
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

    fn times(seconds: &[(&str, f64)]) -> Times {
        let seconds = seconds.iter().map(|(id, time)| ((*id).to_owned(), *time)).collect();
        Times { path: PathBuf::new(), seconds }
    }

    #[test]
    fn stages_follow_each_other_and_tasks_share_the_threads() {
        let times = times(&[("solve/a", 1.0), ("solve/b", 1.0), ("solve/c", 4.0), ("diff/a", 0.5)]);
        let all = [(Stage::Solve, "solve/a"), (Stage::Solve, "solve/c"), (Stage::Diff, "diff/a")];
        assert_eq!(times.expect(all, 1), Some(Duration::from_millis(5500)));
        assert_eq!(times.expect(all, 2), Some(Duration::from_millis(4500)), "no less than solve/c");
        // The mean of its siblings.
        assert_eq!(times.expect([(Stage::Solve, "solve/new")], 4), Some(Duration::from_secs(2)));
        assert_eq!(times.expect([(Stage::Figures, "figures/a")], 4), None);
    }

    #[test]
    fn what_has_ended_is_no_longer_ahead() {
        let times = times(&[("solve/a", 100.0), ("solve/b", 300.0), ("diff/a", 50.0)]);
        let later = || [(Stage::Diff, "diff/a")].into_iter();
        let mut ahead = times.ahead(Stage::Solve, ["solve/a", "solve/b"].into_iter(), later(), 2);
        assert_eq!(ahead.left(), Some(Duration::from_secs(350)));
        ahead.started("solve/b");
        assert!(ahead.left().is_some_and(|left| left < Duration::from_secs(350)));
        ahead.ended("solve/b");
        assert_eq!(ahead.left(), Some(Duration::from_secs(150)));
        let unknown = times.ahead(Stage::Figures, ["figures/a"].into_iter(), later(), 2);
        assert_eq!(unknown.left(), None);
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
        let told = [0.04, 9.94, 9.96, 99.0, 100.0, 5940.0, 7200.0]
            .map(|s| brief(Duration::from_secs_f64(s)));
        assert_eq!(told, ["<0.1 s", "9.9 s", "10 s", "99 s", "2 min", "99 min", "2 h"]);
    }
}
