//! `list`: the scenes of the project, the solvers, the domains, and the problems with known solutions.

use super::name_parser;
use super::output::{say, say_json, talk, tell};
use super::{project_root, scene};
use crate::pipeline::error::{Error, Result};
use crate::replication::fields::write::command;
use crate::replication::project::Project;
use crate::replication::scene::Scene;
use crate::replication::scenes::SceneFolder;
use crate::table::Table;
use clap::Args;
use serde::Serialize;
use signorini_mathematics::mesh::BUILT_IN;
use signorini_mathematics::problem::exact::Known;
use signorini_mathematics::solvers::SOLVERS;

#[derive(Args)]
pub(super) struct ListArgs {
    /// A scene, whose command of `solve` is shown
    #[arg(value_parser = name_parser)]
    scene: Option<String>,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

/// Names that commands take.
#[derive(Serialize)]
struct Listed {
    schema: u8,
    scenes: Vec<Named>,
    /// Scenes that cannot be read, each with the error.
    broken: Vec<Named>,
    solvers: Vec<Named>,
    domains: Vec<Named>,
    /// Problems with known solutions on the square and on the cube, as in `exact(NAME)`.
    square: Vec<&'static str>,
    cube: Vec<&'static str>,
}

/// Name, and the thing that bears it in words.
#[derive(Serialize)]
struct Named {
    name: String,
    description: String,
}

/// Scene with the command that solves it.
#[derive(Serialize)]
struct SceneCommand {
    schema: u8,
    name: String,
    title: String,
    /// Command in the folder of the project; of a saddle-point method for the r that is drawn.
    command: String,
}

pub(super) fn list(args: &ListArgs) -> Result<u8> {
    if let Some(name) = &args.scene {
        return list_scene(name, args.json);
    }
    let SceneFolder { scenes, broken, .. } = scenes()?;
    let listed = Listed {
        schema: 1,
        scenes: scenes.into_iter().map(|scene| Named::new(scene.name, scene.title)).collect(),
        broken: broken.into_iter().map(|(name, why)| Named::new(name, why)).collect(),
        solvers: solvers(),
        domains: domains(),
        square: known(2),
        cube: known(3),
    };
    if args.json { say_json(&listed) } else { tell(&listed.text()) }?;
    for Named { description, .. } in &listed.broken {
        talk(&format!("error: {description}"));
    }
    Ok(if listed.broken.is_empty() { 0 } else { BROKEN })
}

fn list_scene(name: &str, json: bool) -> Result<u8> {
    let Scene { name, title, statement, study, .. } = scene(name)?;
    // The members of a study are those of its file.
    let of_study = study.map(|_| format!("signorini solve {name}"));
    let command = of_study.unwrap_or_else(|| command(&statement).join(" "));
    let shown = SceneCommand { schema: 1, name, title, command };
    match json {
        true => say_json(&shown)?,
        // To be copied: not broken between words.
        false => say(&format!("{}: {}\n{}\n", shown.name, shown.title, shown.command))?,
    };
    Ok(0)
}

/// Exit code if a scene cannot be read, as for all wrong input.
const BROKEN: u8 = 2;

/// Returns the scenes of the project; none, with a note, outside a project and in one without scenes.
fn scenes() -> Result<SceneFolder> {
    let root = project_root();
    match root.and_then(|root| Project::read_scenes(&root)) {
        Ok(folder) => {
            folder.ignored.iter().for_each(|file| talk(&format!("note: {file}")));
            Ok(folder)
        }
        Err(Error::Input(why)) => {
            talk(&format!("note: no scenes are listed: {why}"));
            Ok(SceneFolder::default())
        }
        Err(other) => Err(other),
    }
}

/// Returns the names of the problems with known solutions on the square or, in three dimensions, on the cube.
fn known(dimension: usize) -> Vec<&'static str> {
    Known::all(dimension).iter().map(|known| known.name()).collect()
}

fn solvers() -> Vec<Named> {
    SOLVERS.iter().map(|entry| Named::new(entry.name, entry.description)).collect()
}

fn domains() -> Vec<Named> {
    BUILT_IN.iter().map(|(name, domain)| Named::new(*name, domain.description())).collect()
}

impl Named {
    fn new(name: impl Into<String>, description: impl Into<String>) -> Self {
        Self { name: name.into(), description: description.into() }
    }
}

impl Listed {
    fn text(&self) -> String {
        let mut text = String::new();
        if !self.scenes.is_empty() {
            text += &format!("Scenes, for `run` and `solve`:\n{}\n", table(&self.scenes));
        }
        text += &format!("Solvers, for `solve --solver`:\n{}\n", table(&self.solvers));
        text += &format!("Domains, for `solve --domain`:\n{}\n", table(&self.domains));
        text += "Problems with known solutions, for `solve --f 'exact(NAME)'`:\n";
        text +=
            &format!("  square: {}\n  cube:   {}\n", self.square.join(", "), self.cube.join(", "));
        text
    }
}

/// Returns a line per name, with the part of its description before the first colon or semicolon.
fn table(named: &[Named]) -> String {
    let mut rows = Vec::new();
    for Named { name, description } in named {
        let short = description.split([':', ';']).next().unwrap_or_default();
        rows.push(vec![format!("  {name}"), short.to_owned()]);
    }
    Table::without_head(rows, &[0, 1]).text()
}
