//! Studies of `solve`: `--vary`, and scenes that vary something.
//!
//! Central is [`solve`]: the statements of all members, each checked and solved beside others, and their table.

use super::SolveArgs;
use super::request::{check_fineness, coarsest, name_of_domain, statement};
use super::save::{self, NewScene};
use crate::cli::interrupt::{at_work, interrupted};
use crate::cli::output::{OutputFile, in_columns, paragraph, say, tell};
use crate::pipeline::error::{Error, Result};
use crate::pipeline::names::found;
use crate::pipeline::{InputFile, InputFiles, bar};
use crate::replication::fields::member::Member;
use crate::replication::fields::read::overridden;
use crate::replication::fields::table::Voice;
use crate::replication::fields::vary::{VARY, Vary};
use crate::replication::mesh_files::path_of;
use crate::replication::numbers::Numbers;
use crate::replication::scene::Scene;
use crate::replication::stages::solve::numbers;
use crate::replication::study::{Study, WARNINGS, count_of};
use crate::table::Table;
use crate::timing::machine;
use indicatif::ProgressBar;
use rayon::prelude::*;
use serde_json::{Map, Value, json};
use signorini_mathematics::problem::text::{percent, plain};
use signorini_mathematics::solvers::Memory;
use signorini_mathematics::statement::Statement;
use std::collections::BTreeSet;
use std::ffi::OsStr;
use std::path::Path;

/// Most reasons, and most warnings, that are printed.
const MOST_REMARKS: usize = 5;

/// Members to be solved.
pub(super) struct Asked<'a> {
    /// Name of the scene or the domain, and f, in the first line of the answer.
    title: String,
    /// Name of the scene, if one is named.
    scene_name: Option<String>,
    study: Study,
    /// Files of the meshes.
    files: InputFiles,
    /// Way in which reasons and remedies name fields.
    voice: Voice,
    /// Scene to be written if some member has a solution.
    saved: Option<NewScene<'a>>,
}

impl<'a> Asked<'a> {
    /// Returns the study for which the arguments and the scene that they name ask, checked but for whether its members
    /// have solutions; none if they ask for one solution.
    pub(super) fn read(args: &'a SolveArgs, scene: Option<&Scene>) -> Result<Option<Self>> {
        let of_scene = scene.filter(|scene| scene.is_study).map(|scene| &scene.study);
        let study = match (of_scene, args.vary.is_empty()) {
            (None, true) if args.csv.is_some() => {
                return Err(Error::input(
                    "--csv is the table of a study; add --vary NAME=VALUE,VALUE, or leave it out",
                ));
            }
            (None, true) => return Ok(None),
            (Some(_), false) => {
                return Err(Error::input(
                    "--vary does not go with a scene that varies something; change the scene, or leave it out",
                ));
            }
            (Some(study), true) => over(study, args)?,
            (None, false) => varied(args, scene)?,
        };
        args.refuse_files_of_one()?;
        let voice = if scene.is_some() { Voice::OverScene } else { Voice::Options };
        let files = InputFiles::new();
        let scene_name = args.scene.clone();
        let mut asked = Self { title: String::new(), scene_name, study, files, voice, saved: None };
        asked.check(args, scene)?;
        asked.title = match scene {
            Some(scene) => asked.over_scene(scene, args.fields.text("f")),
            None => asked.in_common(args.fields.text("f")),
        };
        if let Some(name) = &args.save {
            asked.saved = Some(save::study(name, args, &asked.study)?);
        }
        Ok(Some(asked))
    }

    /// Scene, and what all members have in place of its own: f, as it is given, and other fields.
    fn over_scene(&self, scene: &Scene, f: Option<&str>) -> String {
        let Study { names, members, .. } = &self.study;
        let but_f = [&names[..], &["f".to_owned()]].concat();
        let other = overridden(&scene.statement, &members[0].statement, &but_f);
        let parts = f.map(|f| format!("f = {f}")).into_iter().chain(other);
        let title = format!("{}: {}", scene.name, scene.title);
        [title].into_iter().chain(parts).collect::<Vec<_>>().join("; ")
    }

    /// Domain and f, as it is given, of all members; without what varies.
    fn in_common(&self, f: Option<&str>) -> String {
        let domain = &self.study.members[0].statement.domain.name;
        let varies = self.study.names.iter().any(|name| name == "domain");
        let parts = [(!varies).then(|| domain.clone()), f.map(|f| format!("f = {f}"))];
        let parts: Vec<String> = parts.into_iter().flatten().collect();
        if parts.is_empty() { "study".into() } else { parts.join(": ") }
    }

    /// Refuses members that take too much memory, each kind of grid or mesh once, and finds their meshes.
    fn check(&mut self, args: &SolveArgs, scene: Option<&Scene>) -> Result<()> {
        let memory = Memory::new(machine::available_memory());
        let mut checked = BTreeSet::new();
        for Member { statement, .. } in &self.study.members {
            let Statement { domain, boundary, fineness, solver, f, k, reaction, .. } = statement;
            let kind =
                format!("{domain:?} {boundary:?} {fineness:?} {solver} {f} {k:?} {reaction:?}");
            if !checked.insert(kind) {
                continue;
            }
            let mesh = coarsest(statement, scene)?;
            check_fineness(mesh.as_ref(), statement, self.voice, memory)?;
            if let Some(mesh) = &mesh {
                statement.check_f(mesh).map_err(|e| self.voice.stated(&e))?;
            }
            let Some(path) = path_of(&statement.domain).filter(|_| args.scene.is_none()) else {
                continue;
            };
            let file = InputFile::new(found(Path::new(&statement.domain.name)));
            self.files.insert(path, file);
        }
        self.files.extend(scene.into_iter().flat_map(|scene| scene.files.clone()));
        Ok(())
    }

    /// Solves the members, beside each other; returns their numbers in their order. After a first signal none is begun,
    /// and those that have none say so.
    fn solve(&self) -> Result<Vec<Numbers>> {
        let bar = bar("[{bar:30}] {pos} of {len}  {elapsed}");
        if let Some(bar) = &bar {
            bar.set_length(self.study.members.len() as u64);
        }
        let (_at_work, interrupt) = (at_work(), interrupted());
        let solved = self.study.members.par_iter().map(|Member { statement, .. }| {
            let numbers = match interrupt.is_asked() {
                true => Err(Error::Interrupted),
                false => numbers((statement, self.voice), &self.files, interrupt.flag()),
            };
            bar.iter().for_each(|bar| bar.inc(1));
            match numbers {
                Err(Error::Interrupted) => {
                    Ok(Numbers::without(statement, "interrupted; solve it again".into()))
                }
                numbers => numbers,
            }
        });
        let solved = solved.collect();
        bar.iter().for_each(ProgressBar::finish_and_clear);
        solved
    }
}

/// Returns the study of a scene with all columns, and with what the options have in place of what does not vary.
fn over(study: &Study, args: &SolveArgs) -> Result<Study> {
    let mut study = Study { columns: Vec::new(), ..study.clone() };
    for member in &mut study.members {
        *member = member.over(&study.names, &args.fields)?;
    }
    let stated: BTreeSet<_> =
        study.members.iter().map(|of| format!("{:?}", of.statement)).collect();
    if stated.len() < study.members.len() {
        return Err(Error::input(
            "the options take the place of what the scene varies; leave some out, or change the scene",
        ));
    }
    Ok(study)
}

/// Returns the study of what `--vary` names.
fn varied(args: &SolveArgs, scene: Option<&Scene>) -> Result<Study> {
    let voice = if scene.is_some() { Voice::OverScene } else { Voice::Options };
    let vary = Vary::of(std::slice::from_ref(&args.vary), VARY).map_err(Error::input)?;
    let members = vary.members(&args.fields, voice, |fields| statement(fields, scene))?;
    Ok(Study::of(&vary.names, members))
}

/// Solves a study, prints its table, and writes the file that is asked for.
///
/// # Errors
/// [`Error::Stage`] if no member has a solution, [`Error::Interrupted`] if some were not solved.
pub(super) fn solve(args: &SolveArgs, asked: &Asked) -> Result<u8> {
    let file = args.csv.as_deref().map(checked_csv).transpose()?;
    let (study, solved) = (&asked.study, asked.solve()?);
    let csv = file.as_ref().map(|file| file.write(study.table(&solved).csv().as_bytes()));
    // The answer is not lost with the file.
    if args.json {
        say(&lines(asked, &solved))
    } else {
        let head = paragraph(&format!("{}\n", asked.title));
        say(&(head + &in_columns(&for_people(study, &solved))))?;
        let remarks = study.remarks(study.members.iter().zip(&solved), MOST_REMARKS);
        let remarks: String = remarks.into_iter().flat_map(|line| [line, "\n".into()]).collect();
        tell(&paragraph(&remarks))
    }?;
    csv.transpose()?;
    if let Some(file) = file.filter(|_| !args.json) {
        tell(&format!("wrote {}\n", file.path().display()))?;
    }
    if interrupted().is_asked() {
        return Err(Error::Interrupted);
    }
    match solved.iter().map(|of| of.reason.as_ref()).collect::<Option<Vec<_>>>() {
        Some(reasons) => {
            let not_saved = if asked.saved.is_some() { "; no scene is written" } else { "" };
            let reason = format!("no member has a solution{not_saved}: {}", reasons[0]);
            Err(Error::Stage(vec![reason]))
        }
        None => asked.saved.as_ref().map_or(Ok(()), NewScene::write).map(|()| 0),
    }
}

/// Returns the file of a table in CSV.
pub(in crate::cli) fn checked_csv(path: &Path) -> Result<OutputFile> {
    let ending = path.extension().and_then(OsStr::to_str).map(str::to_lowercase);
    let remedy = match ending.as_deref() {
        Some("csv") => return OutputFile::check(path),
        Some("tex" | "md") => {
            "add --save NAME for a scene, of which `run NAME` writes the table in LaTeX and Markdown"
        }
        // A device, such as the standard output.
        None if path.exists() && !path.is_file() => return OutputFile::check(path),
        _ => "let the name end with .csv, or print the rows by --json",
    };
    Err(Error::input(format!("--csv {}: the table is in CSV; {remedy}", path.display())))
}

/// Returns a line of JSON for each member: what `solve --json` prints of its solution, with what `varied`, whose values
/// are also beside the rest.
fn lines(Asked { study, scene_name, .. }: &Asked, solved: &[Numbers]) -> String {
    let mut text = String::new();
    for ((member, numbers), row) in study.members.iter().zip(solved).zip(study.rows(solved)) {
        let mut line = numbers.answer(&member.statement);
        line.extend(row);
        let values = study.values(member).map(|value| value.json());
        let varied: Map<String, Value> = study.names.iter().cloned().zip(values).collect();
        line.insert("varied".into(), varied.into());
        let name = scene_name.as_deref().unwrap_or_else(|| name_of_domain(&member.statement));
        line.insert("scene".into(), name.into());
        line.insert("schema".into(), 1.into());
        text += &(json!(line).to_string() + "\n");
    }
    text
}

/// Returns the table with the digits that are read, and what is asked for first on the left.
fn for_people(study: &Study, solved: &[Numbers]) -> Table {
    let columns = ["energy", "error", "true error", "contact", "force", "v from", "to", "nodes"];
    let marks = study.marks(solved);
    let head = study.names.iter().map(String::as_str).chain(columns).chain(marks.iter().copied());
    let mut table = Table::new(head, &[]);
    for (member, of) in study.members.iter().zip(solved) {
        let mut row: Vec<String> = study.values(member).map(|value| value.to_string()).collect();
        let digits = [("contact_length", 4), ("force", 4), ("v_least", 4), ("v_greatest", 4)];
        row.push(of.shown_energy(7));
        row.push(of.last.error_relative.map_or(String::new(), |error| percent(error, 3)));
        row.push(of.error_true.map_or(String::new(), |error| plain(error, 3)));
        row.extend(of.shown(digits));
        row.push(of.last.nodes.map_or(String::new(), |nodes| nodes.to_string()));
        for &mark in &marks {
            row.push(match mark {
                WARNINGS => count_of(of),
                mark => of.cells(&[mark]).concat(),
            });
        }
        table.rows.push(row);
    }
    table.with_columns(|_| true)
}
