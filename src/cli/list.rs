//! `list`: the scenes of the project, the solvers, the domains, and the problems with known solutions.

use super::current_folder;
use super::output::{columns, say, say_json, talk};
use crate::pipeline::error::Result;
use crate::replication::project::Project;
use clap::Args;
use serde::Serialize;
use signorini_mathematics::mesh::BUILT_IN;
use signorini_mathematics::problem::{cube, exact};
use signorini_mathematics::solvers::SOLVERS;

#[derive(Args)]
pub(super) struct ListArgs {
    /// Print JSON
    #[arg(long)]
    json: bool,
}

/// Names that commands take.
#[derive(Serialize)]
struct Listed {
    scenes: Vec<Named>,
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

pub(super) fn list(args: &ListArgs) -> Result<u8> {
    let listed = Listed {
        scenes: scenes(),
        solvers: solvers(),
        domains: domains(),
        square: exact::Exact::ALL.map(exact::Exact::name).into(),
        cube: cube::Exact::ALL.map(cube::Exact::name).into(),
    };
    if args.json {
        return say_json(&listed);
    }
    say(&listed.text())
}

/// Returns the scenes of the project; none outside a project.
fn scenes() -> Vec<Named> {
    let project = current_folder().and_then(|folder| Project::read(Project::find(&folder)?));
    match project {
        Ok(project) => project
            .scenes
            .iter()
            .map(|scene| Named { name: scene.name.clone(), description: scene.title.clone() })
            .collect(),
        Err(why) => {
            talk(&format!("note: no scenes are listed: {why}"));
            Vec::new()
        }
    }
}

fn solvers() -> Vec<Named> {
    let mut named = Vec::new();
    for entry in &SOLVERS {
        named.push(Named { name: entry.name.into(), description: entry.description.into() });
    }
    named
}

fn domains() -> Vec<Named> {
    let mut named = Vec::new();
    for (name, domain) in BUILT_IN {
        named.push(Named { name: name.into(), description: domain.description().into() });
    }
    named
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
    columns(&[], &[0, 1], rows)
}
