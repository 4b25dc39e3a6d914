//! Scenes: a statement with a title and wanted outputs.

mod check;
mod keys;
mod read;

use crate::figures::Print;
use crate::pipeline::InputFiles;
use crate::pipeline::error::{Error, Result};
use crate::replication::fields::member::Member;
use crate::replication::mesh_files::find_mesh;
pub use crate::replication::output::Output;
use crate::replication::study::Study;
use serde::{Deserialize, Serialize};
use signorini_mathematics::discrete::grid::Grid;
use signorini_mathematics::discrete::load::LoadRule;
use signorini_mathematics::problem::law::Law;
use signorini_mathematics::problem::source::Source;
use signorini_mathematics::saddle::StopRule;
use signorini_mathematics::solvers::SaddleSettings;
use signorini_mathematics::statement::Statement;
use std::path::Path;

/// A validated scene: a file of `pipeline/scenes/`, in which unknown keys are errors. Tasks read back what was written
/// of it; files are read by [`Scene::parse`].
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Scene {
    /// File name without its ending.
    pub name: String,
    /// Title in figures and pages, a single line.
    pub title: String,
    /// Number of the published table to compare with, if there is one.
    pub paper_table: Option<u8>,
    /// Statement; of several members that of the one that is drawn, and of a study that of the first.
    pub statement: Statement,
    /// Members: of a study all; of a saddle-point method one for each stopping rule and r, the first rule being the one
    /// compared with the paper; else one alone.
    pub(crate) study: Study,
    /// True for a scene with the key `vary`, whose table has a row for each member, and which draws none.
    pub(crate) is_study: bool,
    /// Form of its own pictures in print.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) picture: Option<Print>,
    /// Wanted outputs, sorted.
    pub outputs: Vec<Output>,
    /// Files on which the problem depends, by path: the mesh, if there is one.
    #[serde(skip)]
    pub files: InputFiles,
}

impl Scene {
    /// Finds the mesh of the domain, if the scene has one, in the project in `root`, among the `known` files or else on
    /// the disk.
    ///
    /// # Errors
    /// [`Error::Input`] and [`Error::Io`] if there is no such mesh.
    pub(crate) fn find_mesh(&mut self, root: &Path, known: &mut InputFiles) -> Result<()> {
        let mut files = InputFiles::new();
        for member in &self.study.members {
            let found = find_mesh(&member.statement.domain, root, known);
            files.extend(found.map_err(|e| in_scene(&self.name, e))?);
        }
        self.files = files;
        Ok(())
    }

    /// Returns the law on the boundary.
    pub(crate) fn law(&self) -> Law {
        self.statement.law().expect("validated: a law with this parameter")
    }

    /// Returns the settings of the run of a saddle-point method that is drawn; usual ones for another solver.
    pub fn saddle(&self) -> SaddleSettings {
        self.statement.saddle.unwrap_or_default()
    }

    /// Returns the duality parameters under the first rule.
    pub fn r(&self) -> Vec<f64> {
        self.under(self.first_rule()).filter_map(Member::r).collect()
    }

    /// Returns the stopping rules of the members, each of which has a table of its own; none for a solver without.
    pub(crate) fn rules(&self) -> Vec<Option<StopRule>> {
        let mut rules: Vec<_> = self.study.members.iter().map(Member::rule).collect();
        rules.dedup();
        rules
    }

    /// Returns the first rule of the scene, that of its pictures.
    pub(crate) fn first_rule(&self) -> Option<StopRule> {
        self.study.members[0].rule()
    }

    /// Returns the members under a rule.
    pub(crate) fn under(&self, rule: Option<StopRule>) -> impl Iterator<Item = &Member> {
        self.study.members.iter().filter(move |member| member.rule() == rule)
    }

    /// Returns the member under a rule that is drawn.
    ///
    /// # Panics
    /// If the scene has no such rule.
    pub(crate) fn drawn(&self, rule: Option<StopRule>) -> &Member {
        let r = self.statement.saddle.map(|saddle| saddle.r);
        let drawn = self.under(rule).find(|member| member.r() == r);
        drawn.expect("validated: the r that is drawn is among those of each rule")
    }

    /// True if the scene asks for this output.
    pub(crate) fn wants(&self, output: Output) -> bool {
        self.outputs.contains(&output)
    }

    /// True if the scene is one of the paper's two problems; no two scenes of a project are the same problem.
    pub(crate) fn is_problem(&self) -> bool {
        matches!(self.paper_table, Some(1 | 2))
    }

    /// Returns f of a scene on the square, as those of published tables are.
    ///
    /// # Panics
    /// If the scene is on a mesh.
    pub fn source(&self) -> Source {
        self.statement.source().expect("validated: f on the square")
    }

    /// Returns the quadrature of the load vector of a scene on the square.
    pub fn load(&self) -> LoadRule {
        self.statement.load.unwrap_or(Statement::LOAD)
    }

    /// Returns the grids of a scene on the square, coarsest first.
    ///
    /// # Panics
    /// If they do not nest, which [`Scene::parse`] refuses.
    pub fn grids(&self) -> Vec<Grid> {
        self.statement.grids().expect("validated: nested grids")
    }

    /// Returns the finest grid of a scene on the square.
    ///
    /// # Panics
    /// As [`Scene::grids`].
    pub fn finest(&self) -> Grid {
        *self.grids().last().expect("at least one grid")
    }
}

/// Returns the error with the name of the scene before it, unless it is of the system, and names a path.
fn in_scene(name: &str, error: Error) -> Error {
    match error {
        Error::Input(text) => Error::input(format!("scene `{name}`: {text}")),
        other => other,
    }
}

#[cfg(test)]
mod tests;
