//! A make for pure functions: tasks turn hashed bytes into hashed bytes, and a task that is up to date does not run.
//!
//! A [`Task`] names its inputs (parameters, files, artifacts of other tasks) and computes its
//! artifacts from them alone. The [`Store`] keeps artifacts by content and, per task, a [`Manifest`]
//! of every run: inputs and outputs by hash. The program itself is an input of every task. A task is
//! up to date if some manifest has today's inputs and its artifacts are intact; since artifacts are
//! inputs by content, tasks stay up to date if those that they need reproduce their artifacts bit for bit.
//!
//! Central is [`execute`], which walks a [`Plan`].

mod change;
mod engine;
pub mod error;
mod execute;
mod export;
pub(crate) mod files;
mod garbage;
mod graph;
mod input;
mod interrupt;
mod lock;
mod lockfile;
mod manifest;
pub(crate) mod names;
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
pub use graph::{Graph, GraphNode};
pub use input::{InputFile, InputFiles};
pub use interrupt::{AtWork, Interrupt};
pub use lock::Lock;
pub use lockfile::LockFile;
pub use manifest::{Manifest, Reason, Verdict, why};
pub use progress::Progress;
pub(crate) use progress::{bar, talk};
pub use store::{Hit, Store};
pub use summary::{Judged, Options, Ran, Summary};
pub use worker::work;

use error::{Error, Failure, Result};
use serde::Serialize;
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

/// Function that computes a task's artifacts from its inputs; an error ends the task, but no other task.
pub type Work = Box<dyn Fn(&Inputs) -> std::result::Result<Artifacts, Failure> + Send + Sync>;

/// Node of the dependency graph.
pub struct Task {
    /// `stage/...`, unique, a relative path.
    pub id: String,
    /// Values that determine the work together with files and artifacts; see [`parameters`].
    pub parameters: BTreeMap<String, String>,
    /// Project files by path: the same bytes are hashed and used.
    pub files: InputFiles,
    /// Ids of the tasks whose artifacts the task reads.
    pub needs: Vec<String>,
    /// Project folder that gets a copy of every artifact.
    pub export: Option<&'static str>,
    /// Function that computes the artifacts.
    pub work: Work,
}

impl Task {
    /// Returns a task that reads no files, and whose artifacts stay in the cache.
    pub fn new(
        id: impl Into<String>,
        parameters: BTreeMap<String, String>,
        needs: Vec<String>,
        work: impl Fn(&Inputs) -> std::result::Result<Artifacts, Failure> + Send + Sync + 'static,
    ) -> Self {
        let (id, files) = (id.into(), InputFiles::new());
        Self { id, parameters, files, needs, export: None, work: Box::new(work) }
    }
}

/// Returns the stage of a task: the part of its id before the first slash.
pub fn stage(id: &str) -> &str {
    id.split('/').next().unwrap_or(id)
}

/// Tasks, each after all that it needs, and the program that is to run them.
pub struct Plan {
    program: String,
    tasks: Vec<Task>,
    /// Position of each task.
    index: BTreeMap<String, usize>,
}

impl Plan {
    /// Returns the plan of these tasks, for the program with this digest of its code.
    ///
    /// # Errors
    /// [`Error::Input`] if two tasks have the same id, an id is no relative path, or a task needs one that does not
    /// come before it.
    pub fn new(program: &str, tasks: Vec<Task>) -> Result<Self> {
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
                task.work = Box::new(move |_| Err(reason.clone().into()));
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

/// Flattens a serialisable value to dotted keys and JSON values: the hashed parameters of a task.
///
/// A task whose work reads only this value, files and artifacts depends on nothing that is not hashed.
pub fn parameters(value: &impl Serialize) -> BTreeMap<String, String> {
    let mut out = BTreeMap::new();
    let value = serde_json::to_value(value).expect("parameters are plain data");
    flatten("", value, &mut out);
    out
}

fn flatten(prefix: &str, value: serde_json::Value, out: &mut BTreeMap<String, String>) {
    let text = match value {
        serde_json::Value::Object(map) => {
            for (key, value) in map {
                let key = if prefix.is_empty() { key } else { format!("{prefix}.{key}") };
                flatten(&key, value, out);
            }
            return;
        }
        serde_json::Value::String(text) => text,
        other => other.to_string(),
    };
    out.insert(prefix.into(), text);
}

/// Returns the hexadecimal blake3 of some bytes.
pub fn hash(bytes: &[u8]) -> String {
    blake3::hash(bytes).to_hex().to_string()
}

/// True if the text has the form of a hash that this program writes.
fn is_hash(text: &str) -> bool {
    text.len() == 64 && text.bytes().all(|b| b.is_ascii_digit() || (b'a'..=b'f').contains(&b))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parameters_are_flat_and_exact() {
        #[derive(Serialize)]
        struct Inner {
            r: f64,
        }
        #[derive(Serialize)]
        struct Outer {
            f: &'static str,
            grids: [usize; 2],
            inner: Inner,
        }
        let flat = parameters(&Outer { f: "else=-1", grids: [4, 8], inner: Inner { r: 0.1 } });
        let want = [("f", "else=-1"), ("grids", "[4,8]"), ("inner.r", "0.1")];
        assert!(flat.iter().map(|(k, v)| (k.as_str(), v.as_str())).eq(want));
    }

    fn task(id: &str, needs: &[&str]) -> Task {
        let needs = needs.iter().map(|need| (*need).to_owned()).collect();
        Task::new(id, BTreeMap::new(), needs, |_| Ok(Artifacts::new()))
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
