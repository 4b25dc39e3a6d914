//! A record of what each worker did when, to be looked at in chrome://tracing or Perfetto; in no hash.

use serde_json::{Value, json};
use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Mutex;
use std::time::{Duration, Instant};

/// Collects spans from all threads.
#[derive(Debug)]
pub struct Trace {
    start: Instant,
    spans: Mutex<Vec<Span>>,
}

/// When it began, how long it took, the name of its thread, and the event without that.
type Span = (Duration, Reverse<Duration>, String, Value);

impl Default for Trace {
    /// A trace that begins now.
    fn default() -> Self {
        Self { start: Instant::now(), spans: Mutex::default() }
    }
}

impl Trace {
    /// Something that began at `start` on this thread and ends now.
    pub(super) fn span(&self, category: &'static str, name: &str, start: Instant, args: Value) {
        let (start, length) = (start.duration_since(self.start), start.elapsed());
        let event = json!({
            "name": name, "cat": category, "ph": "X", "pid": std::process::id(),
            "ts": microseconds(start), "dur": microseconds(length), "args": args,
        });
        let thread = std::thread::current().name().unwrap_or_default().to_owned();
        let mut spans = self.spans.lock().expect("no panic while it is held");
        spans.push((start, Reverse(length), thread, event));
    }

    /// The trace in the JSON array format of Chrome: complete events, in microseconds.
    pub fn to_json(&self) -> String {
        let mut spans = self.spans.lock().expect("no panic while it is held").clone();
        // What contains comes before what it contains.
        spans.sort_by_key(|(start, length, ..)| (*start, *length));
        let names: BTreeSet<String> = spans.iter().map(|(.., name, _)| name.clone()).collect();
        let threads: BTreeMap<String, usize> = names.into_iter().zip(0..).collect();
        let named = threads.iter().map(|(name, thread)| {
            json!({
                "name": "thread_name", "ph": "M", "pid": std::process::id(), "tid": thread,
                "args": { "name": name },
            })
        });
        let events = spans.into_iter().map(|(.., thread, mut event)| {
            event["tid"] = threads[&thread].into();
            event
        });
        let lines: Vec<String> = named.chain(events).map(|event| event.to_string()).collect();
        format!("[\n{}\n]\n", lines.join(",\n"))
    }
}

fn microseconds(time: Duration) -> f64 {
    time.as_nanos() as f64 / 1e3
}
