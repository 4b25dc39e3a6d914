//! A make for pure functions: tasks turn hashed bytes into hashed bytes, and what is up to date never runs.
//!
//! A [`Task`] names its inputs (parameters, files, artifacts of other tasks) and computes its
//! artifacts from them alone. The [`Store`] keeps artifacts by content and, per task, a [`Manifest`]
//! of every run: inputs and outputs by hash. A task is up to date if some manifest has today's inputs
//! and its artifacts are intact; since artifacts are inputs by content, a task that reproduces them
//! bit for bit does not disturb those that depend on it.

pub mod error;
mod execute;
mod export;
pub(crate) mod files;
mod graph;
mod lock;
mod lockfile;
mod manifest;
mod progress;
mod store;
mod times;
mod trace;

pub use execute::{Judged, Options, Ran, Summary, execute};
pub use graph::{Graph, Node};
pub use lock::CacheLock;
pub use lockfile::LockFile;
pub use manifest::{Change, Manifest, Reason, Verdict, why};
pub use progress::Progress;
pub(crate) use store::write_atomically;
pub use store::{Garbage, Hit, Store};
pub use times::{Times, brief};
pub use trace::Trace;

use serde::Serialize;
use std::collections::BTreeMap;

/// Named byte strings: what a task computes.
pub type Artifacts = BTreeMap<String, Vec<u8>>;

/// Hashes by name, as hexadecimal blake3.
pub type Hashes = BTreeMap<String, String>;

/// The kinds of task, in the order in which they run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Stage {
    /// One (problem, stopping rule, r) column over all grids.
    Solve,
    /// One table per scene and stopping rule.
    Tabulate,
    /// Tables against the published ones.
    Diff,
    /// How sharply a published table fixes f, and a search for it.
    Identify,
    /// Numerical experiments past the paper: accuracy, claims, stability.
    Bench,
    /// SVG pictures.
    Figures,
    /// Markdown pages and the book.
    Report,
}

impl Stage {
    /// All stages, in order.
    pub const ALL: [Self; 7] = [
        Self::Solve,
        Self::Tabulate,
        Self::Diff,
        Self::Identify,
        Self::Bench,
        Self::Figures,
        Self::Report,
    ];

    /// The name on the command line and in task ids.
    pub fn name(self) -> &'static str {
        match self {
            Self::Solve => "solve",
            Self::Tabulate => "tabulate",
            Self::Diff => "diff",
            Self::Identify => "identify",
            Self::Bench => "bench",
            Self::Figures => "figures",
            Self::Report => "report",
        }
    }

    /// Raise when a change of code changes what a stage writes for the same inputs.
    ///
    /// The committed lock file fails a `--locked` run when this was forgotten.
    pub fn version(self) -> u32 {
        match self {
            // 2: the torsion function is summed in another way.
            Self::Solve => 2,
            // 2: multigrid with enlarged corrections, and exact springs beside a corner.
            Self::Bench => 2,
            Self::Tabulate | Self::Diff | Self::Identify | Self::Figures | Self::Report => 1,
        }
    }
}

/// What a task may read when it runs.
pub struct Inputs<'a> {
    /// Contents of the files named by the task.
    pub files: &'a Artifacts,
    /// Artifacts of the tasks it needs, by task id.
    pub artifacts: &'a BTreeMap<String, Artifacts>,
    /// Hash of everything the task depends on, to be shown in what it makes.
    pub digest: &'a str,
}

/// Computes a task's artifacts from its inputs; an error text ends the task, not the run's siblings.
pub type Work = Box<dyn Fn(&Inputs) -> Result<Artifacts, String> + Send + Sync>;

/// One node of the dependency graph.
pub struct Task {
    /// `stage/...`, unique.
    pub id: String,
    /// Its stage.
    pub stage: Stage,
    /// Everything that determines the work besides files and artifacts; see [`parameters`].
    pub parameters: BTreeMap<String, String>,
    /// Project files by path, read when the plan was made: what is hashed is what is used.
    pub files: Artifacts,
    /// Ids of the tasks whose artifacts it reads, of earlier stages.
    pub needs: Vec<String>,
    /// Project folder that gets a copy of every artifact.
    pub export: Option<&'static str>,
    /// The work.
    pub work: Work,
}

/// Flattens a serialisable value to dotted keys and JSON values: the hashed parameters of a task.
///
/// A task that computes from the same value cannot depend on anything that is not hashed.
pub fn parameters(value: &impl Serialize) -> BTreeMap<String, String> {
    fn flatten(prefix: &str, value: serde_json::Value, out: &mut BTreeMap<String, String>) {
        match value {
            serde_json::Value::Object(map) => {
                for (key, value) in map {
                    let key = if prefix.is_empty() { key } else { format!("{prefix}.{key}") };
                    flatten(&key, value, out);
                }
            }
            serde_json::Value::String(text) => {
                out.insert(prefix.into(), text);
            }
            other => {
                out.insert(prefix.into(), other.to_string());
            }
        }
    }
    let mut out = BTreeMap::new();
    let value = serde_json::to_value(value).expect("parameters are plain data");
    flatten("", value, &mut out);
    out
}

/// Hexadecimal blake3 of some bytes.
pub fn hash(bytes: &[u8]) -> String {
    blake3::hash(bytes).to_hex().to_string()
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
}
