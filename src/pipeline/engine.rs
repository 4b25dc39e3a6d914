//! The tasks as a workflow of another program, which runs each by a process of its own.
//!
//! The target of a rule is a stamp in the cache, which `run --task` writes. Its name stands for all
//! that the task is made from: a stamp that is there is up to date, whatever the clocks of several
//! machines say, and whoever asks for one of an older project misses it.

use super::{Plan, Store, stage};
use crate::pipeline::error::{Error, Result};
use serde_json::json;
use std::collections::BTreeMap;
use std::path::Path;

/// A plan for another program's engine, to be run in the folder of the project.
pub struct Engine<'a> {
    plan: &'a Plan,
    /// The stamps of the tasks in the plan's order, as paths from there.
    stamps: Vec<String>,
    program: &'a str,
    cache: &'a str,
}

impl<'a> Engine<'a> {
    /// This plan, to be run by the program at this path on the cache at that one.
    ///
    /// # Errors
    /// [`Error::Input`] if engines cannot name one of the paths, or the shell a task.
    pub fn new(plan: &'a Plan, program: &'a Path, cache: &'a Path) -> Result<Self> {
        let [program, cache] = [plain(program, "program")?, plain(cache, "cache")?];
        let odd = |id: &&str| id.contains(char::is_control);
        if let Some(id) = plan.tasks().iter().map(|task| task.id.as_str()).find(odd) {
            return Err(Error::input(format!("no line can name {id:?}; rename the scene")));
        }
        let store = Store::new(Path::new(cache))?;
        let path = |stamp: &String| store.stamp_file(stamp).to_string_lossy().replace('\\', "/");
        Ok(Self { plan, stamps: plan.stamps().iter().map(path).collect(), program, cache })
    }

    /// The tasks, what each needs, and the stamp that is there once it is done.
    pub fn json(&self) -> String {
        let task = |(id, needs, stamp): (&str, &[String], &str)| json!({ "id": id, "needs": needs, "stamp": stamp });
        let tasks: Vec<_> = self.rules().map(task).collect();
        let text = serde_json::to_string_pretty(&json!({ "schema": 1, "tasks": tasks }));
        text.expect("names are plain data") + "\n"
    }

    /// A makefile for GNU make: a rule for each task, and one that keeps the file up to date.
    pub fn make(&self) -> String {
        let of: BTreeMap<&str, &str> = self.rules().map(|(id, _, stamp)| (id, stamp)).collect();
        let Self { program, cache, .. } = self;
        let mut text = MAKE.replace("PROGRAM", program).replace("CACHE", cache);
        text += "\nall:";
        self.stamps.iter().for_each(|stamp| text += &format!(" \\\n  {stamp}"));
        text += "\n";
        for (id, needs, stamp) in self.rules() {
            let needs: String =
                needs.iter().map(|need| format!(" {}", of[need.as_str()])).collect();
            let id = id.replace('\'', r"'\''").replace('$', "$$");
            text += &format!("\n{stamp}:{needs}\n\t@$(TASK) '{id}'\n");
        }
        text
    }

    /// A Snakefile: a rule for each stage, whose jobs run one task each.
    pub fn snakemake(&self) -> String {
        let mut text = SNAKEMAKE.replace("PATH", self.program).replace("FOLDER", self.cache);
        let mut stages: Vec<&str> = self.rules().map(|(id, ..)| stage(id)).collect();
        stages.dedup();
        stages.iter().for_each(|stage| text += &RULE.replace("STAGE", stage));
        text
    }

    /// Id, needs and stamp of each task.
    fn rules(&self) -> impl Iterator<Item = (&str, &[String], &str)> {
        let tasks = self.plan.tasks().iter().zip(&self.stamps);
        tasks.map(|(task, stamp)| (task.id.as_str(), task.needs.as_slice(), stamp.as_str()))
    }
}

/// A path that make, Snakemake and the shell take as it stands.
fn plain<'a>(path: &'a Path, what: &str) -> Result<&'a str> {
    let fits = |c: char| c.is_ascii_alphanumeric() || "/._+-".contains(c);
    path.to_str().filter(|text| text.chars().all(fits)).ok_or_else(|| {
        Error::input(format!(
            "engines cannot name the {what} {}: move it to a path of letters, digits and / . _ + -",
            path.display()
        ))
    })
}

/// The head of the makefile; PROGRAM and CACHE stand for paths.
const MAKE: &str = include_str!("engine/head.mk");

/// The head of the Snakefile; PATH and FOLDER stand for paths.
const SNAKEMAKE: &str = include_str!("engine/head.smk");

/// Its rule for the stage called STAGE.
const RULE: &str = include_str!("engine/rule.smk");
