//! Manifests: all inputs and outputs of a run of a task, so that a change can be explained and not only noticed.

use super::files::is_plain;
use super::{Hashes, Plan, Task, hash, stage};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

/// Record of one run of a task.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Manifest {
    /// Task id.
    pub task: String,
    /// `program`, `parameter ...`, `file ...`, `artifact ...` -> value or hash.
    pub inputs: BTreeMap<String, String>,
    /// Artifact name -> hash.
    pub outputs: Hashes,
}

impl Manifest {
    /// Returns the line to store: the seal and the record.
    pub(super) fn to_line(&self) -> String {
        let json = self.to_json();
        format!("{} {json}\n", hash(json.as_bytes()))
    }

    /// Returns the manifest in a stored line; `None` if the line was truncated or edited, or names a path outside the
    /// cache or an export's folder.
    pub(super) fn from_line(line: &[u8]) -> Option<Self> {
        let (seal, json) = line.strip_suffix(b"\n")?.split_at_checked(blake3::OUT_LEN * 2 + 1)?;
        if *seal != *format!("{} ", hash(json)).as_bytes() {
            return None;
        }
        let manifest: Self = serde_json::from_slice(json).ok()?;
        let safe = manifest.outputs.iter().all(|(name, hash)| is_plain(name) && is_hash(hash));
        safe.then_some(manifest)
    }

    /// Returns a hash of the whole record, with which an edited record is recognised; it is also the name of the run.
    pub(super) fn seal(&self) -> String {
        hash(self.to_json().as_bytes())
    }

    fn to_json(&self) -> String {
        serde_json::to_string(self).expect("a manifest is plain data")
    }

    /// Returns the hash of all artifacts with their names.
    pub fn digest(&self) -> String {
        hash(&serde_json::to_vec(&self.outputs).expect("hashes are plain data"))
    }
}

impl Plan {
    /// Returns a task's inputs today, given the outputs of every task that it needs.
    pub(super) fn inputs<'a>(
        &self,
        task: &Task,
        outputs: impl Fn(&str) -> &'a Hashes,
    ) -> BTreeMap<String, String> {
        let mut inputs = self.own_inputs(task);
        for need in &task.needs {
            for (name, hash) in outputs(need) {
                inputs.insert(format!("{ARTIFACT}{need}/{name}"), hash.clone());
            }
        }
        inputs
    }

    /// Returns the inputs that no other task makes.
    fn own_inputs(&self, task: &Task) -> BTreeMap<String, String> {
        let mut inputs = BTreeMap::from([(PROGRAM.to_owned(), self.program.clone())]);
        for (key, value) in &task.parameters {
            inputs.insert(format!("parameter {key}"), value.clone());
        }
        for (path, bytes) in &task.files {
            inputs.insert(format!("file {path}"), hash(bytes));
        }
        inputs
    }

    /// Returns a stamp for each task: a name that changes exactly if an input of the task or of a task that it needs
    /// changes.
    ///
    /// Stamps are known before anything has run. They can name files and targets of rules: the stage and sixteen
    /// hexadecimal digits.
    pub fn stamps(&self) -> Vec<String> {
        let mut keys = BTreeMap::<&str, String>::new();
        let mut stamps = Vec::with_capacity(self.tasks().len());
        for task in self.tasks() {
            let needs: BTreeMap<&str, &String> =
                task.needs.iter().map(|need| (need.as_str(), &keys[need.as_str()])).collect();
            let recipe = (&task.id, self.own_inputs(task), needs);
            let key = hash(&serde_json::to_vec(&recipe).expect("inputs are plain data"));
            stamps.push(format!("{}-{}", stage(&task.id), &key[..STAMP_DIGITS]));
            keys.insert(&task.id, key);
        }
        stamps
    }

    /// Returns the changes since this run of the task's inputs that no other task makes.
    pub fn own_changes(&self, task: &Task, since: &Manifest) -> Vec<Change> {
        let mut old = since.inputs.clone();
        old.retain(|input, _| !input.starts_with(ARTIFACT));
        changes(&old, &self.own_inputs(task))
    }
}

/// Name of the input for the program: a digest of its sources, the compiler and its options.
pub(super) const PROGRAM: &str = "program";

/// Number of digits of a key in a stamp.
const STAMP_DIGITS: usize = 16;

/// True if the name has the form of a stamp.
pub(super) fn is_stamp(name: &str) -> bool {
    name.rsplit_once('-').is_some_and(|(_, key)| {
        key.len() == STAMP_DIGITS && key.bytes().all(|b| b.is_ascii_hexdigit())
    })
}

/// Beginning of the names of inputs that other tasks make.
const ARTIFACT: &str = "artifact ";

/// Change of one input.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Change {
    /// Name of the input.
    pub input: String,
    /// Value or hash when the task last ran; `None` if it was not an input then.
    pub old: Option<String>,
    /// Value or hash today; `None` if it no longer is an input.
    pub new: Option<String>,
}

/// Returns the inputs that differ between a stored manifest and today.
pub(super) fn changes(
    old: &BTreeMap<String, String>,
    new: &BTreeMap<String, String>,
) -> Vec<Change> {
    let keys: BTreeSet<_> = old.keys().chain(new.keys()).collect();
    let mut changes = Vec::new();
    for key in keys {
        let (old, new) = (old.get(key).cloned(), new.get(key).cloned());
        if old != new {
            changes.push(Change { input: key.clone(), old, new });
        }
    }
    changes
}

impl fmt::Display for Change {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let subject = match self.input.as_str() {
            PROGRAM => "the program changed",
            input => input,
        };
        let parts = [&self.old, &self.new].map(|value| serde_json::from_str(value.as_ref()?).ok());
        let mut differences = Vec::new();
        if let [Some(old), Some(new)] = &parts {
            compare(subject, old, new, &mut differences);
        }
        match &differences[..] {
            [Difference { place, old, new }, rest @ ..] if place != subject => {
                write!(out, "{place}: {old} -> {new}")?;
                out.write_str(if rest.is_empty() { "" } else { ", and elsewhere" })
            }
            // A value without parts, as it was written.
            _ => write!(out, "{subject}: {} -> {}", brief(&self.old), brief(&self.new)),
        }
    }
}

/// Returns a value, or the first twelve digits of a hash, which identify it.
fn brief(value: &Option<String>) -> &str {
    match value {
        None => "absent",
        Some(hash) if is_hash(hash) => &hash[..12],
        Some(value) => value,
    }
}

/// Difference of two JSON values in one place.
struct Difference<'a> {
    place: String,
    old: &'a Value,
    new: &'a Value,
}

/// Finds the differences of two values: of objects with the same keys and arrays of the same length part by part, but
/// not of lists of plain values.
fn compare<'a>(place: &str, old: &'a Value, new: &'a Value, found: &mut Vec<Difference<'a>>) {
    match (old, new) {
        _ if old == new => {}
        (Value::Object(old), Value::Object(new)) if old.keys().eq(new.keys()) => {
            for (key, value) in old {
                compare(&format!("{place}.{key}"), value, &new[key], found);
            }
        }
        (Value::Array(old), Value::Array(new))
            if old.len() == new.len() && old.iter().any(|v| v.is_object() || v.is_array()) =>
        {
            for (k, (old, new)) in old.iter().zip(new).enumerate() {
                compare(&format!("{place}[{k}]"), old, new, found);
            }
        }
        _ => found.push(Difference { place: place.into(), old, new }),
    }
}

/// True if the text has the form of a hash that this program writes.
pub(super) fn is_hash(text: &str) -> bool {
    text.len() == 64 && text.bytes().all(|b| b.is_ascii_digit() || (b'a'..=b'f').contains(&b))
}

/// Reason for which a task has to run.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case", tag = "why", content = "what")]
pub enum Reason {
    /// No record of an earlier run.
    NeverRan,
    /// Inputs changed since the last run.
    Changed(Vec<Change>),
    /// This artifact is missing, truncated or edited.
    Damaged(String),
    /// The cache cannot be read, for this reason, so that nothing is known of earlier runs.
    Unreadable(String),
    /// `--force`.
    Forced,
}

impl fmt::Display for Reason {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NeverRan => out.write_str("never ran"),
            Self::Changed(changes) => match &changes[..] {
                [one] => write!(out, "{one}"),
                [first, rest @ ..] => write!(out, "{first} (and {} more)", rest.len()),
                [] => out.write_str("inputs changed"),
            },
            Self::Damaged(name) => write!(out, "artifact {name} is missing, truncated or edited"),
            Self::Unreadable(why) => out.write_str(why),
            Self::Forced => out.write_str("forced"),
        }
    }
}

/// Returns in a few words why several tasks have to run: the first reason, and how many tasks have other reasons.
pub fn why(reasons: &[&Reason]) -> String {
    let Some(first) = reasons.first() else { return String::new() };
    match reasons.iter().filter(|reason| *reason != first).count() {
        0 => first.to_string(),
        1 => format!("{first}; one task for another reason"),
        n => format!("{first}; {n} tasks for other reasons"),
    }
}

/// Verdict on a task.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case", tag = "state", content = "reason")]
pub enum Verdict {
    /// Up to date.
    Fresh,
    /// To be run.
    Stale(Reason),
    /// Unknown before this task, which is stale, has run.
    Waits(String),
}

impl fmt::Display for Verdict {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Fresh => out.write_str("up to date"),
            Self::Stale(reason) => write!(out, "stale: {reason}"),
            Self::Waits(on) => write!(out, "waits for {on}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample() -> Manifest {
        Manifest {
            task: "solve/a".into(),
            inputs: BTreeMap::from([("parameter r".into(), "10".into())]),
            outputs: BTreeMap::from([("cell.json".into(), hash(b"x"))]),
        }
    }

    /// Words for the change of a parameter.
    fn told(old: &str, new: &str) -> String {
        let [old, new] = [old, new].map(|value| Some(value.to_owned()));
        Change { input: "parameter p".into(), old, new }.to_string()
    }

    #[test]
    fn of_a_value_with_parts_only_the_changed_ones_are_told() {
        assert_eq!(told("1e6", "10"), "parameter p: 1e6 -> 10");
        assert_eq!(told("[4, 8]", "[3, 8]"), "parameter p: [4, 8] -> [3, 8]");
        let old = r#"[{"r":[1000000.0,1.0],"limit":5},{"r":[],"limit":7}]"#;
        let other_r = r#"[{"r":[0.5,1.0],"limit":5},{"r":[],"limit":7}]"#;
        let other_limit = r#"[{"r":[0.5,1.0],"limit":5},{"r":[],"limit":8}]"#;
        assert_eq!(told(old, other_r), "parameter p[0].r: [1000000.0,1.0] -> [0.5,1.0]");
        assert_eq!(
            told(old, other_limit),
            "parameter p[0].r: [1000000.0,1.0] -> [0.5,1.0], and elsewhere"
        );
        assert_eq!(told(old, "[]"), format!("parameter p: {old} -> []"));
    }

    #[test]
    fn a_stored_manifest_is_believed_only_unedited() {
        let line = sample().to_line();
        assert_eq!(Manifest::from_line(line.as_bytes()), Some(sample()));
        let edited = line.replace("\"10\"", "\"11\"");
        assert_eq!(Manifest::from_line(edited.as_bytes()), None);
        for end in 0..line.len() {
            assert_eq!(Manifest::from_line(&line.as_bytes()[..end]), None);
        }
        // With a valid seal, but with an artifact that would be written outside the project.
        for name in ["../../thesis.txt", "/tmp/thesis.txt"] {
            let mut forged = sample();
            forged.outputs.insert(name.into(), hash(b"x"));
            assert_eq!(Manifest::from_line(forged.to_line().as_bytes()), None);
        }
    }
}
