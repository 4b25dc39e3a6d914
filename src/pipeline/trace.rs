//! A record of what each worker did when, to be looked at in chrome://tracing or Perfetto; in no hash.

use serde_json::{Value, json};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Mutex;
use std::time::{Duration, Instant};

/// Collects spans from all threads.
#[derive(Debug)]
pub struct Trace {
    start: Instant,
    spans: Mutex<Vec<Span>>,
}

#[derive(Debug)]
struct Span {
    name: String,
    category: &'static str,
    start: Duration,
    length: Duration,
    /// Name of the thread.
    thread: String,
    args: Value,
}

impl Default for Trace {
    /// A trace that begins now.
    fn default() -> Self {
        Self { start: Instant::now(), spans: Mutex::default() }
    }
}

impl Trace {
    /// Something that began at `start` on this thread and ends now.
    pub(super) fn span(&self, category: &'static str, name: &str, start: Instant, args: Value) {
        let span = Span {
            name: name.into(),
            category,
            start: start.duration_since(self.start),
            length: start.elapsed(),
            thread: std::thread::current().name().unwrap_or_default().to_owned(),
            args,
        };
        self.spans.lock().expect("no panic while it is held").push(span);
    }

    /// The trace in the JSON array format of Chrome: complete events, in microseconds.
    pub fn to_json(&self) -> String {
        let spans = self.spans.lock().expect("no panic while it is held");
        let process = std::process::id();
        let names: BTreeSet<&str> = spans.iter().map(|span| span.thread.as_str()).collect();
        let threads: BTreeMap<&str, usize> = names.into_iter().zip(0..).collect();
        let mut events: Vec<Value> = threads
            .iter()
            .map(|(name, thread)| {
                json!({
                    "name": "thread_name", "ph": "M", "pid": process, "tid": thread,
                    "args": { "name": name },
                })
            })
            .collect();
        let mut sorted: Vec<&Span> = spans.iter().collect();
        // What contains comes before what it contains.
        sorted.sort_by_key(|span| (span.start, std::cmp::Reverse(span.length)));
        events.extend(sorted.into_iter().map(|span| {
            json!({
                "name": span.name, "cat": span.category, "ph": "X", "pid": process,
                "tid": threads[span.thread.as_str()], "ts": microseconds(span.start),
                "dur": microseconds(span.length), "args": span.args,
            })
        }));
        let lines: Vec<String> = events.iter().map(Value::to_string).collect();
        format!("[\n{}\n]\n", lines.join(",\n"))
    }
}

fn microseconds(time: Duration) -> f64 {
    time.as_nanos() as f64 / 1e3
}
