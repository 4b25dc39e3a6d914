//! `list`: the scenes of the project, the solvers, the domains, and the problems with known solutions.

use super::name_parser;
use super::output::{say, say_json, talk, tell};
use super::{project_root, scene};
use crate::pipeline::error::{Error, Result};
use crate::pipeline::names::in_shell;
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
    /// A scene, whose command of `solve` is shown, or one of: scenes, solvers, domains, known
    #[arg(value_parser = name_parser)]
    name: Option<String>,
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

/// Parts of the list, in their order.
pub(super) const PARTS: [&str; 4] = ["scenes", "solvers", "domains", "known"];

/// Name, and the thing that bears it in words.
#[derive(Serialize)]
struct Named {
    name: String,
    description: String,
}

pub(super) fn list(args: &ListArgs) -> Result<u8> {
    let part = args.name.as_deref().filter(|name| PARTS.contains(name));
    if let (Some(name), None) = (&args.name, part) {
        return list_scene(name, args.json);
    }
    let SceneFolder { scenes, broken, .. } = scenes()?;
    let listed = Listed {
        schema: 1,
        scenes: scenes.into_iter().map(|scene| Named::new(scene.name, scene.title)).collect(),
        broken: broken.into_iter().map(|(name, why)| Named::new(name, why)).collect(),
        solvers: SOLVERS.iter().map(|entry| Named::new(entry.name, entry.description)).collect(),
        domains: BUILT_IN.iter().map(|(name, of)| Named::new(*name, of.description())).collect(),
        square: Known::all(2).iter().map(|known| known.name()).collect(),
        cube: Known::all(3).iter().map(|known| known.name()).collect(),
    };
    if args.json { say_json(&listed) } else { tell(&listed.text(part)) }?;
    for Named { description, .. } in &listed.broken {
        talk(&format!("error: {description}"));
    }
    Ok(if listed.broken.is_empty() { 0 } else { BROKEN })
}

fn list_scene(name: &str, json: bool) -> Result<u8> {
    let found = scene(name).map_err(|error| match error {
        Error::Unknown(text) => Error::Unknown(format!("{text}; or list {}", PARTS.join(", "))),
        other => other,
    });
    let Scene { name, title, statement, is_study, .. } = found?;
    let command = match is_study {
        // The members of a study are those of its file.
        true => format!("signorini solve {}", in_shell(&name)),
        false => command(&statement).join(" "),
    };
    match json {
        true => say_json(&serde_json::json!({
            "schema": 1, "name": name, "title": title, "command": command,
        })),
        // To be copied: not broken between words.
        false => say(&format!("{name}: {title}\n{command}\n")),
    }
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

impl Named {
    fn new(name: impl Into<String>, description: impl Into<String>) -> Self {
        Self { name: name.into(), description: description.into() }
    }
}

impl Listed {
    /// Text of one part, or of all, with an empty line between them.
    fn text(&self, part: Option<&str>) -> String {
        let (square, cube) = (self.square.join(", "), self.cube.join(", "));
        let texts = [
            format!("Scenes, for `run` and `solve`:\n{}", table(&self.scenes, str::trim)),
            format!("Solvers, for `solve --solver`:\n{}", table(&self.solvers, short)),
            format!("Domains, for `solve --domain`:\n{}", table(&self.domains, short)),
            format!(
                "Problems with known solutions, for `solve --f 'exact(NAME)'`:\n  square: {square}\n  cube:   {cube}\n"
            ),
        ];
        let mut shown = Vec::new();
        for (name, text) in PARTS.into_iter().zip(texts) {
            let is_empty = name == "scenes" && self.scenes.is_empty();
            if part.map_or(!is_empty, |part| part == name) {
                shown.push(text);
            }
        }
        shown.join("\n")
    }
}

/// Returns a line per name, with its description as `shown`.
fn table(named: &[Named], shown: fn(&str) -> &str) -> String {
    let mut rows = Vec::new();
    for Named { name, description } in named {
        rows.push(vec![format!("  {name}"), shown(description).to_owned()]);
    }
    Table::without_head(rows, &[0, 1]).text()
}

/// Returns the part of a description before the first colon or semicolon.
fn short(description: &str) -> &str {
    description.split([':', ';']).next().unwrap_or_default()
}
