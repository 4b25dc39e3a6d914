#![doc = include_str!("../README.md")]

mod change;
mod engine;
pub mod error;
mod execute;
mod export;
pub mod files;
mod garbage;
mod graph;
mod input;
mod interrupt;
mod lock;
mod lockfile;
mod manifest;
pub mod names;
pub mod place;
mod progress;
mod run;
mod store;
mod summary;
mod worker;

pub use change::Change;
pub use engine::Engine;
pub use execute::execute;
pub use export::{Edited, Editor, Exports, Rights, WalkResults};
pub use garbage::Garbage;
pub use graph::mermaid;
pub use input::{InputFile, InputFiles};
pub use interrupt::{AtWork, Interrupt};
pub use lock::Lock;
pub use lockfile::LockFile;
pub use manifest::{Manifest, Reason, Verdict, why};
pub use progress::{Progress, bar, talk};
pub use store::{Hit, Store};
pub use summary::{Judged, Options, Ran, Summary};
pub use worker::work;

use error::{Error, Failure, Result};
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::sync::atomic::AtomicBool;

/// Named byte strings: what a task computes.
pub type Artifacts = BTreeMap<String, Vec<u8>>;

/// Hashes by name, as hexadecimal blake3.
pub type Hashes = BTreeMap<String, String>;

/// Name of the input for the program: a digest of its sources, the compiler and its options.
const PROGRAM: &str = "program";

/// Data that a task may read when it runs, and the folder to which it may write.
pub struct Inputs<'a> {
    /// Id of the task.
    pub task: &'a str,
    /// Files named by the task, by path.
    pub files: &'a InputFiles,
    /// Artifacts of the tasks it needs, by task id.
    pub artifacts: &'a BTreeMap<String, Artifacts>,
    /// Hash of all inputs of the task but the program, to be shown in its artifacts.
    pub digest: &'a str,
    /// Folder for temporary files, in no hash; after a run that was killed, the next run empties it.
    pub scratch: &'a Path,
    /// True once the run is to end; a task that takes long may end early, with [`Error::Interrupted`], and nothing else
    /// may depend on it.
    pub interrupted: &'a AtomicBool,
}

/// Artifacts of a task, or the reason for which there are none; a failure ends the task, but no other task.
pub type Made = std::result::Result<Artifacts, Failure>;

/// Node of the dependency graph.
pub struct Task {
    /// `stage/...`, unique, a relative path.
    pub id: String,
    /// Project files by path: the same bytes are hashed and used.
    pub files: InputFiles,
    /// Ids of the tasks whose artifacts the task reads.
    pub needs: Vec<String>,
    /// Project folder that gets a copy of every artifact.
    pub export: Option<&'static str>,
    /// Value that determines the work together with files and artifacts.
    value: Value,
    /// The value as it is hashed, by dotted keys.
    parameters: BTreeMap<String, String>,
    work: Work,
    group: Option<Group>,
}

/// Function that computes the artifacts of tasks, each from its value and inputs.
type Work = Box<dyn Fn(&[(&Value, &Inputs)]) -> Vec<Made> + Send + Sync>;

/// Tasks with one function that take less time side by side, and make the same bytes: those that are to be run of them
/// run in one thread.
#[derive(Clone, Debug, PartialEq)]
pub struct Group {
    /// Text that the tasks of the group have, and no others.
    pub key: String,
    /// Most that run side by side.
    pub most: usize,
}

impl Task {
    /// Returns a task that reads no files, and whose artifacts stay in the cache.
    ///
    /// `work` is a pointer, and gets the value as it is read back from what is hashed: it can reach nothing that is not
    /// hashed. Lists keep their order; objects have none.
    pub fn new<P: Serialize + DeserializeOwned + 'static>(
        id: impl Into<String>,
        value: &P,
        needs: Vec<String>,
        work: fn(&P, &Inputs) -> Made,
    ) -> Self {
        Self::of(id.into(), value, needs, move |all: &[(P, &Inputs)]| {
            all.iter().map(|(value, inputs)| work(value, inputs)).collect()
        })
    }

    /// As [`Task::new`], of a function for all tasks of a group; it gives to each what it gives to the task alone.
    pub fn in_group<P: Serialize + DeserializeOwned + 'static>(
        id: impl Into<String>,
        value: &P,
        group: Option<Group>,
        work: fn(&[(P, &Inputs)]) -> Vec<Made>,
    ) -> Self {
        Self { group, ..Self::of(id.into(), value, Vec::new(), work) }
    }

    fn of<P: Serialize + DeserializeOwned + 'static>(
        id: String,
        value: &P,
        needs: Vec<String>,
        work: impl Fn(&[(P, &Inputs)]) -> Vec<Made> + Send + Sync + 'static,
    ) -> Self {
        let value = serde_json::to_value(value).expect("the value of a task is plain data");
        let mut parameters = BTreeMap::new();
        flatten("", &value, &mut parameters);
        let work: Work = Box::new(move |all| {
            let all = all.iter().map(|&(value, inputs)| {
                (P::deserialize(value).expect("read as it is written"), inputs)
            });
            work(&all.collect::<Vec<_>>())
        });
        let (files, export, group) = (InputFiles::new(), None, None);
        Self { id, files, needs, export, value, parameters, work, group }
    }

    /// Returns the task with these files.
    pub fn with_files(self, files: InputFiles) -> Self {
        Self { files, ..self }
    }

    /// Returns the task with a copy of every artifact in this folder of the project.
    pub fn exported_to(self, folder: &'static str) -> Self {
        Self { export: Some(folder), ..self }
    }
}

/// Returns the stage of a task: the part of its id before the first slash.
pub fn stage(id: &str) -> &str {
    id.split('/').next().unwrap_or(id)
}

/// Tasks, each after all that it needs, and the program that is to run them.
pub struct Plan {
    /// Digest of the program's sources, the compiler and its options.
    program: String,
    tasks: Vec<Task>,
    /// Position of each task.
    index: BTreeMap<String, usize>,
}

impl Plan {
    /// Returns the plan of these tasks, for the program with this digest.
    ///
    /// # Errors
    /// [`Error::Input`] if two tasks have the same id, an id is no relative path, or a task needs one that does not
    /// come before it.
    pub fn new(program: impl Into<String>, tasks: Vec<Task>) -> Result<Self> {
        let mut index = BTreeMap::new();
        for (k, task) in tasks.iter().enumerate() {
            if !files::is_plain(&task.id) {
                return Err(Error::input(format!(
                    "`{}` cannot name a task; rename the scene",
                    task.id.escape_debug()
                )));
            }
            if let Some(need) = task.needs.iter().find(|need| !index.contains_key(*need)) {
                let id = &task.id;
                return Err(Error::input(format!(
                    "{id} needs {need}, which does not come before it"
                )));
            }
            if index.insert(task.id.clone(), k).is_some() {
                return Err(Error::input(format!(
                    "two tasks are called {}; rename a scene",
                    task.id
                )));
            }
        }
        Ok(Self { program: program.into(), tasks, index })
    }

    /// Keeps the tasks with a wanted id, and all that they need.
    pub fn only(mut self, wanted: impl Fn(&str) -> bool) -> Self {
        let mut kept = BTreeSet::new();
        for task in self.tasks.iter().rev() {
            if wanted(&task.id) || kept.contains(&task.id) {
                kept.insert(task.id.clone());
                kept.extend(task.needs.iter().cloned());
            }
        }
        self.tasks.retain(|task| kept.contains(&task.id));
        self.index = self.tasks.iter().enumerate().map(|(k, task)| (task.id.clone(), k)).collect();
        self
    }

    /// Makes each task for which there is a reason fail with it.
    pub fn refuse(&mut self, reason: impl Fn(&str) -> Option<String>) {
        for task in &mut self.tasks {
            if let Some(reason) = reason(&task.id) {
                task.work =
                    Box::new(move |all| all.iter().map(|_| Err(reason.clone().into())).collect());
                task.group = None;
            }
        }
    }

    /// Returns the tasks, each after all that it needs.
    pub fn tasks(&self) -> &[Task] {
        &self.tasks
    }

    /// Returns the task with this id.
    pub fn task(&self, id: &str) -> Option<&Task> {
        self.index(id).map(|k| &self.tasks[k])
    }

    fn index(&self, id: &str) -> Option<usize> {
        self.index.get(id).copied()
    }
}

/// Length from which on the text of a parameter is entered by its hash: manifests are read in every run, and `explain`
/// prints parameters.
const LONG: usize = 2000;

/// Enters a value by dotted keys and JSON texts, so that different values have different entries. Strings are entered
/// as they are, unless they could be mistaken for another value.
fn flatten(key: &str, value: &Value, out: &mut BTreeMap<String, String>) {
    let text = match value {
        Value::Object(map) if !map.is_empty() => {
            for (name, value) in map {
                let is_plain = !name.is_empty() && !name.contains(['.', '"']);
                let name = if is_plain { name.clone() } else { format!("{name:?}") };
                let key = if key.is_empty() { name } else { format!("{key}.{name}") };
                flatten(&key, value, out);
            }
            return;
        }
        Value::String(text) if serde_json::from_str::<Value>(text).is_err() => text.clone(),
        other => other.to_string(),
    };
    let text = if text.len() < LONG { text } else { hash(text.as_bytes()) };
    out.insert(key.into(), text);
}

/// Returns the hexadecimal blake3 of some bytes.
pub fn hash(bytes: &[u8]) -> String {
    blake3::hash(bytes).to_hex().to_string()
}

/// True if the text has the form of a hash that this program writes.
fn is_hash(text: &str) -> bool {
    text.len() == 2 * blake3::OUT_LEN
        && text.bytes().all(|b| matches!(b, b'0'..=b'9' | b'a'..=b'f'))
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde::Deserialize;
    use serde_json::json;

    #[test]
    fn parameters_are_flat_and_differ_if_the_values_do() {
        let flat = |value: Value| {
            Task::new("a/1", &value, Vec::new(), |_, _| Ok(Artifacts::new())).parameters
        };
        let said = flat(json!({ "f": "else=-1", "grids": [4, 8], "inner": { "r": 0.1 } }));
        let want = [("f", "else=-1"), ("grids", "[4,8]"), ("inner.r", "0.1")];
        assert!(said.iter().map(|(k, v)| (k.as_str(), v.as_str())).eq(want));
        let long = "x".repeat(LONG);
        let mut all = BTreeMap::new();
        for value in [
            json!({ "a": { "b": 1 } }),
            json!({ "a.b": 1 }),
            json!({ "\"a.b\"": 1 }),
            json!({ "a": { "b": "1" } }),
            json!({ "a": { "b": "\"1\"" } }),
            json!({ "a": { "b": null } }),
            json!({ "a": { "b": "null" } }),
            json!({ "a": { "b": {} } }),
            json!({ "a": {} }),
            json!({ "a": [1, 2] }),
            json!({ "a": [2, 1] }),
            json!({ "a": "[1,2]" }),
            json!({ "a": long }),
            json!({ "a": [long] }),
            json!({ "": 1 }),
            json!(1),
            json!(null),
            json!({}),
        ] {
            if let Some(same) = all.insert(flat(value.clone()), value.clone()) {
                panic!("{value} is entered like {same}");
            }
        }
    }

    #[test]
    fn a_function_gets_what_is_hashed_and_no_more() {
        #[derive(Serialize, Deserialize)]
        struct Parts {
            r: Vec<f64>,
            #[serde(skip)]
            hidden: u8,
        }
        let parts = Parts { r: vec![0.1, 1e300, -0.0], hidden: 7 };
        let task = Task::new("a/1", &parts, Vec::new(), |parts: &Parts, _| {
            let bytes = parts.r.iter().flat_map(|r| r.to_le_bytes()).chain([parts.hidden]);
            Ok(Artifacts::from([("out".into(), bytes.collect())]))
        });
        let inputs = Inputs {
            task: "a/1",
            files: &InputFiles::new(),
            artifacts: &BTreeMap::new(),
            digest: "",
            scratch: Path::new(""),
            interrupted: &AtomicBool::new(false),
        };
        let want: Vec<u8> = parts.r.iter().flat_map(|r| r.to_le_bytes()).chain([0]).collect();
        let made = (task.work)(&[(&task.value, &inputs)]);
        assert_eq!(made[0].as_ref().unwrap()["out"], want);
    }

    fn task(id: &str, needs: &[&str]) -> Task {
        let needs = needs.iter().map(|need| (*need).to_owned()).collect();
        Task::new(id, &(), needs, |(), _| Ok(Artifacts::new()))
    }

    #[test]
    fn a_plan_without_order_is_refused() {
        assert!(Plan::new("program", vec![task("a/1", &[]), task("b/1", &["a/1"])]).is_ok());
        let cases = [
            (vec![task("b/1", &["a/1"]), task("a/1", &[])], "does not come before"),
            (vec![task("a/1", &["a/1"])], "does not come before"),
            (vec![task("a/1", &[]), task("a/1", &[])], "two tasks"),
            (vec![task("a/../../b", &[])], "cannot name"),
            (vec![task("/a", &[])], "cannot name"),
        ];
        for (tasks, why) in cases {
            let refusal = Plan::new("program", tasks).err().unwrap().to_string();
            assert!(refusal.contains(why), "{refusal}");
        }
    }
}
