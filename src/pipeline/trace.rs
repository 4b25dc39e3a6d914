//! A record of what each worker did when, to be looked at in chrome://tracing or Perfetto; in no hash.

use serde_json::{Value, json};
use std::collections::BTreeSet;
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
    /// 0 for the main thread, then the workers.
    thread: usize,
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
            thread: rayon::current_thread_index().map_or(0, |worker| worker + 1),
            args,
        };
        self.spans.lock().expect("no panic while it is held").push(span);
    }

    /// The trace in the JSON array format of Chrome: complete events, in microseconds.
    pub fn to_json(&self) -> String {
        let spans = self.spans.lock().expect("no panic while it is held");
        let process = std::process::id();
        let threads: BTreeSet<usize> = spans.iter().map(|span| span.thread).collect();
        let mut events: Vec<Value> = threads
            .into_iter()
            .map(|thread| {
                let name = match thread {
                    0 => "plan".to_owned(),
                    worker => format!("worker {worker}"),
                };
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
                "tid": span.thread, "ts": microseconds(span.start),
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
