//! Manifests: what a task read and wrote, whole, so that a change can be explained and not only noticed.

use super::files::is_plain;
use super::{Hashes, Plan, Task, hash, stage};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

/// The record of one run of a task.
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
    /// The line to store: the seal, and what it seals.
    pub(super) fn to_line(&self) -> String {
        let json = self.to_json();
        format!("{} {json}\n", hash(json.as_bytes()))
    }

    /// The manifest in a stored line; `None` if it was truncated or edited, or names what lies outside
    /// the cache or an export's folder.
    pub(super) fn from_line(line: &[u8]) -> Option<Self> {
        let (seal, json) = line.strip_suffix(b"\n")?.split_at_checked(blake3::OUT_LEN * 2 + 1)?;
        if *seal != *format!("{} ", hash(json)).as_bytes() {
            return None;
        }
        let manifest: Self = serde_json::from_slice(json).ok()?;
        let safe = |(name, hash): (&String, &String)| is_plain(name) && is_hash(hash);
        manifest.outputs.iter().all(safe).then_some(manifest)
    }

    /// A hash of the whole record: an edited one is not believed, and it is the name of the run.
    pub(super) fn seal(&self) -> String {
        hash(self.to_json().as_bytes())
    }

    fn to_json(&self) -> String {
        serde_json::to_string(self).expect("a manifest is plain data")
    }

    /// Hash of all artifacts with their names.
    pub fn digest(&self) -> String {
        hash(&serde_json::to_vec(&self.outputs).expect("hashes are plain data"))
    }
}

impl Plan {
    /// A task's inputs today, given the outputs of every task that it needs.
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

    /// The inputs that no other task makes.
    fn own_inputs(&self, task: &Task) -> BTreeMap<String, String> {
        let mut inputs = BTreeMap::from([(PROGRAM.to_owned(), self.program.clone())]);
        inputs.extend(task.parameters.iter().map(|(k, v)| (format!("parameter {k}"), v.clone())));
        inputs.extend(task.files.iter().map(|(path, bytes)| (format!("file {path}"), hash(bytes))));
        inputs
    }

    /// A name for each task and all that it is made from: as long as nothing of that changes, the same.
    ///
    /// It is known before anything has run, and fit for a file or the target of a rule: the stage and
    /// sixteen hexadecimal digits.
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

    /// What has changed since this run among the task's inputs that no other task makes.
    pub fn own_changes(&self, task: &Task, since: &Manifest) -> Vec<Change> {
        let mut old = since.inputs.clone();
        old.retain(|input, _| !input.starts_with(ARTIFACT));
        changes(&old, &self.own_inputs(task))
    }
}

/// The input that stands for the code: what it is built from, with which compiler and options.
pub(super) const PROGRAM: &str = "program";

/// Digits of a key that tell stamps apart.
const STAMP_DIGITS: usize = 16;

/// Whether a file is called like a stamp.
pub(super) fn is_stamp(name: &str) -> bool {
    name.rsplit_once('-').is_some_and(|(_, key)| {
        key.len() == STAMP_DIGITS && key.bytes().all(|b| b.is_ascii_hexdigit())
    })
}

/// How the inputs begin that other tasks make.
const ARTIFACT: &str = "artifact ";

/// One input that is not what it was.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Change {
    /// Which input.
    pub input: String,
    /// Its value or hash when the task last ran; `None` if it was not an input then.
    pub old: Option<String>,
    /// Its value or hash today; `None` if it no longer is an input.
    pub new: Option<String>,
}

/// The inputs that differ between a stored manifest and today.
pub(super) fn changes(
    old: &BTreeMap<String, String>,
    new: &BTreeMap<String, String>,
) -> Vec<Change> {
    let keys: BTreeSet<_> = old.keys().chain(new.keys()).collect();
    keys.into_iter()
        .filter(|key| old.get(*key) != new.get(*key))
        .map(|key| Change {
            input: key.clone(),
            old: old.get(key).cloned(),
            new: new.get(key).cloned(),
        })
        .collect()
}

impl fmt::Display for Change {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        // Hashes are for machines; twelve digits tell two of them apart.
        let brief = |value: &Option<String>| match value {
            None => "absent".to_owned(),
            Some(v) if is_hash(v) => v[..12].into(),
            Some(v) => v.clone(),
        };
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
            [(place, old, new), rest @ ..] if place != subject => {
                write!(out, "{place}: {old} -> {new}")?;
                out.write_str(if rest.is_empty() { "" } else { ", and elsewhere" })
            }
            // Of one part, and as it was written.
            _ => write!(out, "{subject}: {} -> {}", brief(&self.old), brief(&self.new)),
        }
    }
}

/// Finds the parts in which two values differ: objects with the same keys and arrays of the same length are taken
/// apart, lists of plain values are not.
fn compare<'a>(
    place: &str,
    old: &'a Value,
    new: &'a Value,
    found: &mut Vec<(String, &'a Value, &'a Value)>,
) {
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
        _ => found.push((place.into(), old, new)),
    }
}

/// Whether a text is a hash as this program writes them.
pub(super) fn is_hash(text: &str) -> bool {
    text.len() == 64 && text.bytes().all(|b| b.is_ascii_digit() || (b'a'..=b'f').contains(&b))
}

/// Why a task has to run.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case", tag = "why", content = "what")]
pub enum Reason {
    /// No record of an earlier run.
    NeverRan,
    /// Inputs changed since the last run.
    Changed(Vec<Change>),
    /// This artifact is missing, truncated or edited.
    Damaged(String),
    /// The cache cannot be read, for this reason: nothing is known of earlier runs.
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

/// Why several tasks have to run, in a few words: the first reason, and how many have others.
pub fn why(reasons: &[&Reason]) -> String {
    let Some(first) = reasons.first() else { return String::new() };
    match reasons.iter().filter(|reason| *reason != first).count() {
        0 => first.to_string(),
        1 => format!("{first}; one task for another reason"),
        n => format!("{first}; {n} tasks for other reasons"),
    }
}

/// What becomes of a task.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case", tag = "state", content = "reason")]
pub enum Verdict {
    /// Up to date.
    Fresh,
    /// To be run.
    Stale(Reason),
    /// Cannot be told before this task, which is stale, has run.
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

    #[test]
    fn of_a_value_with_parts_only_the_changed_ones_are_told() {
        let told = |old: &str, new: &str| {
            let [old, new] = [old, new].map(|value| Some(value.to_owned()));
            Change { input: "parameter p".into(), old, new }.to_string()
        };
        assert_eq!(told("1e6", "10"), "parameter p: 1e6 -> 10");
        assert_eq!(told("[4, 8]", "[3, 8]"), "parameter p: [4, 8] -> [3, 8]");
        let plan =
            |r: f64, cap: usize| format!(r#"[{{"r":[{r:?},1.0],"cap":5}},{{"r":[],"cap":{cap}}}]"#);
        assert_eq!(
            told(&plan(1e6, 7), &plan(0.5, 7)),
            "parameter p[0].r: [1000000.0,1.0] -> [0.5,1.0]"
        );
        assert_eq!(
            told(&plan(1e6, 7), &plan(0.5, 8)),
            "parameter p[0].r: [1000000.0,1.0] -> [0.5,1.0], and elsewhere"
        );
        assert_eq!(told(&plan(1.0, 7), "[]"), format!("parameter p: {} -> []", plan(1.0, 7)));
    }

    #[test]
    fn a_stored_manifest_is_believed_only_unedited() {
        let line = sample().to_line();
        let read = |line: &str| Manifest::from_line(line.as_bytes());
        assert_eq!(read(&line), Some(sample()));
        assert_eq!(read(&line.replace("\"10\"", "\"11\"")), None);
        assert!((0..line.len()).all(|end| read(&line[..end]).is_none()));
        // Sealed again, but its artifact would be written outside the project.
        for name in ["../../thesis.txt", "/tmp/thesis.txt"] {
            let mut forged = sample();
            forged.outputs.insert(name.into(), hash(b"x"));
            assert_eq!(read(&forged.to_line()), None);
        }
    }
}
