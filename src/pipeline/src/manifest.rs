//! Manifests: all inputs and outputs of a run of a task, so that a change can be explained and not only noticed.

use super::change::{Change, changes};
use super::files::is_plain;
use super::{Hashes, PROGRAM, Plan, Task, hash, is_hash, stage};
use crate::error::Result;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
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
    /// Hash of all artifacts with their names, as the record has them.
    #[serde(skip)]
    pub digest: String,
}

impl Manifest {
    /// Returns the record of a run.
    pub(super) fn new(task: String, inputs: BTreeMap<String, String>, outputs: Hashes) -> Self {
        let digest = hash(&serde_json::to_vec(&outputs).expect("hashes are plain data"));
        Self { task, inputs, outputs, digest }
    }

    /// Returns the line to store: the seal and the record.
    pub(super) fn to_line(&self) -> String {
        let json = self.to_json();
        format!("{} {json}\n", hash(json.as_bytes()))
    }

    /// Returns the manifest in a stored line; `None` if the line was truncated or edited, or names a path outside the
    /// cache or an export's folder.
    pub(super) fn from_line(line: &[u8]) -> Option<Self> {
        let Self { task, inputs, outputs, .. } = serde_json::from_slice(sealed(line)?).ok()?;
        are_safe(&outputs).then(|| Self::new(task, inputs, outputs))
    }

    /// Returns a hash of the whole record, with which an edited record is recognised; it is also the name of the run.
    pub(super) fn seal(&self) -> String {
        hash(self.to_json().as_bytes())
    }

    fn to_json(&self) -> String {
        serde_json::to_string(self).expect("a manifest is plain data")
    }
}

/// Returns the record in a stored line, if the line was neither truncated nor edited.
fn sealed(line: &[u8]) -> Option<&[u8]> {
    let (seal, json) = line.strip_suffix(b"\n")?.split_at_checked(blake3::OUT_LEN * 2 + 1)?;
    (*seal == *format!("{} ", hash(json)).as_bytes()).then_some(json)
}

/// True if the artifacts have places inside of the cache and of an export's folder.
fn are_safe(outputs: &Hashes) -> bool {
    outputs.iter().all(|(name, hash)| is_plain(name) && is_hash(hash))
}

impl Plan {
    /// Returns a task's inputs today, given the outputs of every task that it needs.
    pub(super) fn inputs<'a>(
        &self,
        task: &Task,
        outputs: impl Fn(&str) -> &'a Hashes,
    ) -> Result<BTreeMap<String, String>> {
        let mut inputs = self.own_inputs(task)?;
        for need in &task.needs {
            for (name, hash) in outputs(need) {
                inputs.insert(format!("{ARTIFACT}{need}/{name}"), hash.clone());
            }
        }
        Ok(inputs)
    }

    /// True if a run of a task has the inputs of today, as far as they are known: `outputs` has those of some tasks.
    ///
    /// # Errors
    /// [`Error::Io`](crate::error::Error::Io) if a file of the task cannot be read.
    pub(super) fn has_inputs_of_today<'a>(
        &self,
        task: &Task,
        run: &Manifest,
        outputs: impl Fn(&str) -> Option<&'a Hashes>,
    ) -> Result<bool> {
        static UNKNOWN: Hashes = Hashes::new();
        let mut unknown = task.needs.clone();
        unknown.retain(|need| outputs(need).is_none());
        let unknown: Vec<_> = unknown.iter().map(|need| format!("{ARTIFACT}{need}/")).collect();
        let today = self.inputs(task, |need| outputs(need).unwrap_or(&UNKNOWN))?;
        let then = run.inputs.iter();
        Ok(then.filter(|(input, _)| !unknown.iter().any(|need| input.starts_with(need))).eq(&today))
    }

    /// Returns the inputs that no other task makes.
    fn own_inputs(&self, task: &Task) -> Result<BTreeMap<String, String>> {
        let mut inputs = BTreeMap::from([(PROGRAM.to_owned(), self.program.clone())]);
        for (key, value) in &task.parameters {
            inputs.insert(format!("parameter {key}"), value.clone());
        }
        for (path, file) in &task.files {
            inputs.insert(format!("file {path}"), file.hash()?.to_owned());
        }
        Ok(inputs)
    }

    /// Returns a stamp for each task: a name that changes exactly if an input of the task or of a task that it needs
    /// changes.
    ///
    /// Stamps are known before anything has run. They can name files and targets of rules: the stage and sixteen
    /// hexadecimal digits.
    ///
    /// # Errors
    /// [`Error::Io`](crate::error::Error::Io) if a file of a task cannot be read.
    pub fn stamps(&self) -> Result<Vec<String>> {
        let mut keys = BTreeMap::<&str, String>::new();
        let mut stamps = Vec::with_capacity(self.tasks().len());
        for task in self.tasks() {
            let needs: BTreeMap<&str, &String> =
                task.needs.iter().map(|need| (need.as_str(), &keys[need.as_str()])).collect();
            let recipe = (&task.id, self.own_inputs(task)?, needs);
            let key = hash(&serde_json::to_vec(&recipe).expect("inputs are plain data"));
            stamps.push(format!("{}-{}", stage(&task.id), &key[..STAMP_DIGITS]));
            keys.insert(&task.id, key);
        }
        Ok(stamps)
    }

    /// Returns the changes since this run of the task's inputs that no other task makes.
    ///
    /// # Errors
    /// [`Error::Io`](crate::error::Error::Io) if a file of the task cannot be read.
    pub fn own_changes(&self, task: &Task, since: &Manifest) -> Result<Vec<Change>> {
        let mut old = since.inputs.clone();
        old.retain(|input, _| !input.starts_with(ARTIFACT));
        Ok(changes(&old, &self.own_inputs(task)?))
    }
}

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
            Self::NeverRan => out.write_str("first run"),
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
        Manifest::new(
            "solve/a".into(),
            BTreeMap::from([("parameter r".into(), "10".into())]),
            BTreeMap::from([("cell.json".into(), hash(b"x"))]),
        )
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
