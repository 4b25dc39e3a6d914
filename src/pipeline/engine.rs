//! The tasks as a workflow of another program, which runs each by a process of its own.
//!
//! The target of a rule is a stamp in the cache, which `run --task` writes. The name of a stamp stands for all
//! that the task is made from: a stamp that exists is up to date, whatever its time and the clocks of several
//! machines say, and a rule of an older project names other stamps.

use super::{Plan, Store, stage};
use crate::pipeline::error::{Error, Result};
use serde_json::json;
use std::collections::BTreeMap;
use std::path::Path;

/// A plan for another program's engine, to be run in the folder of the project.
pub struct Engine<'a> {
    plan: &'a Plan,
    /// Names of the stamps, in the order of the tasks.
    stamps: Vec<String>,
    /// Folder of the stamps, as a path from the folder of the project.
    folder: String,
    program: &'a str,
    cache: &'a str,
}

/// A task as an engine sees it.
struct Rule<'a> {
    id: &'a str,
    needs: &'a [String],
    stamp: &'a str,
}

impl<'a> Engine<'a> {
    /// This plan, to be run by the program at this path on the cache at that one.
    ///
    /// # Errors
    /// [`Error::Input`] if a path is not UTF-8, or the id of a task has more than one line.
    pub fn new(plan: &'a Plan, program: &'a Path, cache: &'a Path) -> Result<Self> {
        let [program, cache] = [utf8(program, "program")?, utf8(cache, "cache")?];
        for task in plan.tasks() {
            refuse(&task.id, "a task", char::is_control, "rename the scene")?;
        }
        let folder = Store::new(Path::new(cache))?.stamp_folder().to_string_lossy().into_owned();
        let folder = if cfg!(windows) { folder.replace('\\', "/") } else { folder };
        Ok(Self { plan, stamps: plan.stamps(), folder, program, cache })
    }

    /// The tasks, what each needs, and the stamp that exists once it is done.
    pub fn json(&self) -> String {
        let task = |rule: Rule| {
            let stamp = format!("{}/{}", self.folder, rule.stamp);
            json!({ "id": rule.id, "needs": rule.needs, "stamp": stamp })
        };
        let tasks: Vec<_> = self.rules().map(task).collect();
        let text = serde_json::to_string_pretty(&json!({ "schema": 1, "tasks": tasks }));
        text.expect("names are plain data") + "\n"
    }

    /// A makefile for GNU make: a rule for each task, and one that keeps the file up to date.
    ///
    /// # Errors
    /// [`Error::Input`] if make cannot name one of the paths.
    pub fn make(&self) -> Result<String> {
        refuse(self.program, "the program", char::is_control, "move it")?;
        // In names of targets make takes these for its own, escaped or not.
        let is_special = |c: char| c.is_control() || "*?[;|\\".contains(c);
        refuse(self.cache, "the cache", is_special, "give another with --cache-dir")?;
        let stamp_of: BTreeMap<&str, &str> =
            self.rules().map(|rule| (rule.id, rule.stamp)).collect();
        let mut text = format!(
            "{MAKE_TITLE}SIGNORINI := {}\nCACHE := {}\nSTAMPS := {}\n{MAKE}",
            in_make(&in_shell(self.program)),
            in_make(&in_shell(self.cache)),
            in_make(&self.folder).replace(' ', "\\ ").replace(':', "\\:"),
        );
        text += "\nall:";
        self.stamps.iter().for_each(|stamp| text += &format!(" \\\n  $(STAMPS)/{stamp}"));
        text += "\n";
        for Rule { id, needs, stamp } in self.rules() {
            text += &format!("\n$(MADE)/{stamp}:");
            if !needs.is_empty() {
                // Order only: times of stamps mean nothing.
                text += " |";
            }
            needs
                .iter()
                .for_each(|need| text += &format!(" $(STAMPS)/{}", stamp_of[need.as_str()]));
            text += &format!("\n\t@$(TASK) {}\n", in_shell(id).replace('$', "$$"));
        }
        Ok(text)
    }

    /// A Snakefile: a rule for each stage, whose jobs run one task each.
    ///
    /// # Errors
    /// [`Error::Input`] if Snakemake cannot name the cache.
    pub fn snakemake(&self) -> Result<String> {
        // In names of files they hold a wildcard.
        let is_brace = |c: char| "{}".contains(c);
        refuse(self.cache, "the cache", is_brace, "give another with --cache-dir")?;
        // A string of JSON is one of Python.
        let [program, cache] = [self.program, self.cache].map(|path| json!(path).to_string());
        let mut text = format!(
            "{SNAKEMAKE_TITLE}SIGNORINI = config.get(\"signorini\", {program})\n\
            CACHE = config.get(\"cache\", {cache})\n{SNAKEMAKE}"
        );
        let mut stages: Vec<&str> = self.rules().map(|rule| stage(rule.id)).collect();
        stages.dedup();
        stages.iter().for_each(|stage| text += &RULE.replace("STAGE", stage));
        Ok(text)
    }

    fn rules(&self) -> impl Iterator<Item = Rule<'_>> {
        let tasks = self.plan.tasks().iter().zip(&self.stamps);
        tasks.map(|(task, stamp)| Rule { id: &task.id, needs: &task.needs, stamp })
    }
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

/// A word of a shell's command.
fn in_shell(word: &str) -> String {
    format!("'{}'", word.replace('\'', r"'\''"))
}

/// The value of a variable of a makefile.
fn in_make(value: &str) -> String {
    let mut text = String::new();
    for c in value.chars() {
        if c == '#' {
            // Backslashes before it count twice.
            let backslashes = text.chars().rev().take_while(|&c| c == '\\').count();
            text += &"\\".repeat(backslashes + 1);
        }
        text += if c == '$' { "$" } else { "" };
        text.push(c);
    }
    text
}

/// The first lines of the makefile.
const MAKE_TITLE: &str = include_str!("engine/title.mk");

/// The makefile between the paths and the rules of the tasks.
const MAKE: &str = include_str!("engine/head.mk");

/// The first lines of the Snakefile.
const SNAKEMAKE_TITLE: &str = include_str!("engine/title.smk");

/// The Snakefile between the paths and the rules of the stages.
const SNAKEMAKE: &str = include_str!("engine/head.smk");

/// The rule of the Snakefile for the stage called STAGE.
const RULE: &str = include_str!("engine/rule.smk");
