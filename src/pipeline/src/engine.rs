//! Workflows for other programs (engines), which run each task by a process of its own.
//!
//! The target of a rule is a stamp in the cache, which `run --task` writes. The name of a stamp is a hash of all inputs
//! of its task: a stamp that exists is up to date, whatever its time and the clocks of several machines say, and a rule
//! of an older project names other stamps.

use super::{Plan, Store, stage};
use crate::error::{Error, Result};
use serde_json::json;
use std::path::Path;

/// Plan in the form of a workflow, to be run in the folder of the project.
pub struct Engine<'a> {
    plan: &'a Plan,
    /// Names of the stamps, in the order of the tasks.
    stamps: Vec<String>,
    /// Folder of the stamps, as a path from the folder of the project.
    folder: String,
    program: &'a str,
    cache: &'a str,
}

/// Task with its stamp.
struct StampedTask<'a> {
    id: &'a str,
    needs: &'a [String],
    stamp: &'a str,
}

impl<'a> Engine<'a> {
    /// Returns the workflow of this plan, for the program and the cache with these paths.
    ///
    /// # Errors
    /// [`Error::Input`] if a path is not UTF-8, or the id of a task has more than one line; [`Error::Io`] if a file of
    /// a task cannot be read.
    pub fn new(plan: &'a Plan, program: &'a Path, cache: &'a Path) -> Result<Self> {
        let [program, cache] = [utf8(program, "program")?, utf8(cache, "cache")?];
        for task in plan.tasks() {
            refuse(&task.id, "a task", char::is_control, "rename the scene")?;
        }
        let folder = Store::new(Path::new(cache))?.stamp_folder().to_string_lossy().into_owned();
        let folder = if cfg!(windows) { folder.replace('\\', "/") } else { folder };
        Ok(Self { plan, stamps: plan.stamps()?, folder, program, cache })
    }

    /// Returns, as JSON, the tasks, the tasks that each needs, and the stamp that exists after it has run.
    pub fn json(&self) -> String {
        let mut tasks = Vec::new();
        for StampedTask { id, needs, stamp } in self.tasks() {
            let stamp = format!("{}/{stamp}", self.folder);
            tasks.push(json!({ "id": id, "needs": needs, "stamp": stamp }));
        }
        let text = serde_json::to_string_pretty(&json!({ "schema": 1, "tasks": tasks }));
        text.expect("names are plain data") + "\n"
    }

    /// Returns a Snakefile: a rule for each stage, whose jobs run one task each.
    ///
    /// # Errors
    /// [`Error::Input`] if Snakemake cannot name the cache.
    pub fn snakemake(&self) -> Result<String> {
        refuse(self.cache, "the cache", is_brace, "give another with --cache-dir")?;
        // A string of JSON is also a string of Python.
        let [program, cache] = [self.program, self.cache].map(|path| json!(path).to_string());
        let mut text = format!(
            "{SNAKEMAKE_TITLE}SIGNORINI = config.get(\"signorini\", {program})\n\
            CACHE = config.get(\"cache\", {cache})\n{SNAKEMAKE}"
        );
        let mut stages: Vec<&str> = self.tasks().map(|task| stage(task.id)).collect();
        stages.dedup();
        for stage in stages {
            text += &RULE.replace("STAGE", stage);
        }
        Ok(text)
    }

    fn tasks(&self) -> impl Iterator<Item = StampedTask<'_>> {
        let tasks = self.plan.tasks().iter().zip(&self.stamps);
        tasks.map(|(task, stamp)| StampedTask { id: &task.id, needs: &task.needs, stamp })
    }
}

/// True if the character encloses a wildcard in names of files of Snakemake.
fn is_brace(c: char) -> bool {
    "{}".contains(c)
}

fn utf8<'a>(path: &'a Path, what: &str) -> Result<&'a str> {
    path.to_str().ok_or_else(|| {
        let path = path.display();
        Error::input(format!("the path of the {what} {path} is not UTF-8; move it to one that is"))
    })
}

/// Refuses a name with a character that an engine cannot take.
fn refuse(name: &str, what: &str, is_special: impl Fn(char) -> bool, remedy: &str) -> Result<()> {
    match name.chars().find(|&c| is_special(c)) {
        Some(c) => Err(Error::input(format!(
            "engines cannot name {what} {name:?}, which has a {c:?}; {remedy}"
        ))),
        None => Ok(()),
    }
}

/// First lines of the Snakefile.
const SNAKEMAKE_TITLE: &str = include_str!("engine/title.smk");

/// Part of the Snakefile between the paths and the rules of the stages.
const SNAKEMAKE: &str = include_str!("engine/head.smk");

/// Rule of the Snakefile for the stage called STAGE.
const RULE: &str = include_str!("engine/rule.smk");
