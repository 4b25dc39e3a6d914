//! Scenes: a problem with its grids, duality parameters, stopping rules and wanted outputs, read from TOML.

use crate::pipeline::InputFiles;
use crate::pipeline::error::{Error, Failure, Result, from_toml};
use crate::pipeline::names::refuse_forbidden;
use crate::replication::domain::{DomainSettings, name_or_table};
use crate::replication::stated::{CheckedMesh, OnSquare, StatedProblem};
use serde::{Deserialize, Deserializer, Serialize};
use signorini_mathematics::discrete::grid::{Grid, nested};
use signorini_mathematics::discrete::load::LoadRule;
use signorini_mathematics::discrete::transfer::Prolongation;
use signorini_mathematics::experiments::problems::TableProblem;
use signorini_mathematics::identify::COARSEST;
use signorini_mathematics::mesh::Touching;
use signorini_mathematics::problem::law::{Law, LawParameter};
use signorini_mathematics::problem::source::Source;
use signorini_mathematics::saddle::StopRule;
use std::fmt;
use std::path::Path;

/// Output for which a scene may ask; no other output is computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Output {
    /// Table of iteration counts and Delta a.
    Table,
    /// Map of f.
    Source,
    /// Surface of the solution on the finest grid.
    Surface,
    /// Map of the solution on the finest grid, with the boundary in contact.
    Map,
    /// Residuals against iterations.
    History,
    /// Trace and multiplier along the unrolled boundary.
    Contact,
    /// Values of f near the scene's with which the published counts still come out.
    Identify,
}

/// Writes the name used in scenes and file names.
impl fmt::Display for Output {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.serialize(out)
    }
}

/// A validated scene: a file of `pipeline/scenes/`, in which unknown keys are errors.
#[derive(Clone, Debug, Serialize)]
pub struct Scene {
    /// File name without its ending.
    pub name: String,
    /// Title in figures and pages, a single line.
    pub title: String,
    /// Number of the published table to compare with, if there is one.
    pub paper_table: Option<u8>,
    /// Problem as its file states it.
    #[serde(flatten)]
    pub problem: StatedProblem,
    /// Interpolation to the next grid of the square.
    pub prolongation: Prolongation,
    /// Duality parameters.
    pub r: Vec<f64>,
    /// Stopping rules; the first is the one compared with the paper.
    pub stop: Vec<StopRule>,
    /// Limit on iterations per level.
    pub max_iterations: usize,
    /// Wanted outputs, sorted.
    pub outputs: Vec<Output>,
    /// The r whose solution is drawn.
    draw_r: f64,
}

/// Keys of a file of a scene, with f as text or, on the square, read.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SceneFile<F> {
    title: String,
    paper_table: Option<u8>,
    #[serde(default, deserialize_with = "some_name_or_table")]
    domain: Option<DomainSettings>,
    f: F,
    law: Option<LawParameter>,
    load: Option<LoadRule>,
    prolongation: Option<Prolongation>,
    #[serde(default, deserialize_with = "some_grids")]
    grids: Option<Vec<Grid>>,
    #[serde(default = "paper_r")]
    r: Vec<f64>,
    #[serde(default = "paper_stop")]
    stop: Vec<StopRule>,
    #[serde(default = "default_limit")]
    max_iterations: usize,
    outputs: Vec<Output>,
    draw_r: Option<f64>,
}

/// Outputs of a scene on the square that other domains do not have, each with the reason.
const NOT_ON_DOMAINS: [(Output, &str); 2] = [
    (Output::History, "the method keeps no residuals on meshes"),
    (Output::Identify, "no table was published"),
];

impl<F> SceneFile<F> {
    /// Name of a key that means nothing but on the square, if there is one.
    fn key_of_the_square(&self) -> Option<&'static str> {
        let keys = [
            ("grids", self.grids.is_some()),
            ("load", self.load.is_some()),
            ("prolongation", self.prolongation.is_some()),
            ("paper_table", self.paper_table.is_some()),
        ];
        keys.into_iter().find(|(_, given)| *given).map(|(key, _)| key)
    }

    /// Returns the scene with this name and problem.
    fn scene(self, name: &str, problem: StatedProblem) -> Scene {
        let Self { title, paper_table, r, stop, max_iterations, outputs, .. } = self;
        let draw_r = self.draw_r.unwrap_or(r.get(r.len() / 2).copied().unwrap_or(f64::NAN));
        Scene {
            name: name.into(),
            title,
            paper_table,
            problem,
            prolongation: self.prolongation.unwrap_or_default(),
            r,
            stop,
            max_iterations,
            outputs,
            draw_r,
        }
    }
}

fn paper_grids() -> Vec<Grid> {
    nested(&[4, 8, 16, 32, 64]).expect("each halves the one before")
}

fn some_grids<'de, D: Deserializer<'de>>(
    deserializer: D,
) -> std::result::Result<Option<Vec<Grid>>, D::Error> {
    nested(&Vec::<usize>::deserialize(deserializer)?).map(Some).map_err(serde::de::Error::custom)
}

fn some_name_or_table<'de, D: Deserializer<'de>>(
    deserializer: D,
) -> std::result::Result<Option<DomainSettings>, D::Error> {
    name_or_table(deserializer).map(Some)
}

fn paper_r() -> Vec<f64> {
    vec![1e6, 10.0, 5.0, 1.0, 0.5]
}

fn paper_stop() -> Vec<StopRule> {
    vec![StopRule::Signed]
}

fn default_limit() -> usize {
    signorini_mathematics::saddle::Params::default().max_iterations
}

impl Scene {
    /// Parses and validates the text of a scene file; `name` names the scene in messages.
    ///
    /// # Errors
    /// [`Error::Input`] with the line of the mistake, or what makes the scene unsolvable.
    pub fn parse(name: &str, text: &str) -> Result<Self> {
        let what = format!("scene `{name}`");
        let in_scene = |e: Error| Error::input(format!("{what}: {e}"));
        let keys: toml::Table = toml::from_str(text).unwrap_or_default();
        let mut scene = match domain_of(&keys).is_none_or(|domain| domain == SQUARE) {
            true => Self::on_square(name, from_toml(&what, text)?),
            false => Self::on_mesh(name, from_toml(&what, text)?),
        }
        .map_err(in_scene)?;
        scene.complete().map_err(|e| Error::input(format!("{what}: {e}")))?;
        Ok(scene)
    }

    fn on_square(name: &str, file: SceneFile<Source>) -> Result<Self> {
        if let Some(key) = file.domain.as_ref().and_then(DomainSettings::about_mesh) {
            return Err(Error::input(format!(
                "`{key}` is for meshes; the square has `grids`, and is in contact everywhere"
            )));
        }
        let square = OnSquare {
            f: file.f.clone(),
            load: file.load.unwrap_or_default(),
            grids: file.grids.clone().unwrap_or_else(paper_grids),
        };
        let problem = StatedProblem::on_square(square, file.law);
        Ok(file.scene(name, problem))
    }

    fn on_mesh(name: &str, mut file: SceneFile<String>) -> Result<Self> {
        if let Some(key) = file.key_of_the_square() {
            return Err(Error::input(format!(
                "`{key}` is for the square; leave it out beside `domain`, whose meshes are its refinements"
            )));
        }
        let domain = file.domain.take().expect("a scene on a mesh names its domain");
        let f = file.f.split_whitespace().collect::<Vec<_>>().join(" ");
        let problem = StatedProblem::on_mesh(domain, f, file.law);
        Ok(file.scene(name, problem))
    }

    /// Finds the mesh of the domain, if the scene has one, in the project in `root`, among the `known` files or else on
    /// the disk. Checks a domain without a mesh; [`Scene::check_mesh`] checks one with a mesh, which takes time.
    ///
    /// # Errors
    /// [`Error::Input`] and [`Error::Io`]: no mesh, or a domain that does not fit the scene.
    pub(crate) fn find_mesh(&mut self, root: &Path, known: &mut InputFiles) -> Result<()> {
        let found = self.problem.find_mesh(root, known);
        if found.map_err(|e| in_scene(&self.name, e))? {
            self.check_mesh()?;
        }
        Ok(())
    }

    /// Reads the mesh of the domain, if the scene has one, and checks that it fits the scene. Returns the place where
    /// the domain touches itself, if there is one.
    ///
    /// # Errors
    /// [`Error::Input`] if it does not; [`Error::Io`].
    pub(crate) fn check_mesh(&self) -> Result<Option<Touching>> {
        let checked = self.problem.check_mesh().map_err(|e| in_scene(&self.name, e))?;
        let Some(CheckedMesh { dimension, touching }) = checked else { return Ok(None) };
        let mut pictures = [Output::Source, Output::Surface, Output::Map, Output::Contact].iter();
        match pictures.find(|output| dimension == 3 && self.outputs.contains(output)) {
            None => Ok(touching),
            Some(output) => Err(Error::input(format!(
                "scene `{name}`: `{output}` is a picture of a domain in the plane; drop it from `outputs`, and look \
                 at the solution with `signorini solve {name} --out {name}.vtu`",
                name = self.name
            ))),
        }
    }

    /// Fills in the values that follow from others, and makes the checks that a parser cannot.
    fn complete(&mut self) -> std::result::Result<(), Failure> {
        self.problem.law()?;
        if self.problem.law.is_some() && self.paper_table.is_some() {
            return Err(
                "the published tables are for the paper's law; leave out `law`, or `paper_table`"
                    .into(),
            );
        }
        self.check_on_domain()?;
        if self.r.is_empty() || self.stop.is_empty() {
            let example = "r = [10], stop = [\"signed\"]";
            return Err(format!("`r` and `stop` must not be empty; e.g. {example}").into());
        }
        for &r in &self.r {
            positive_r(r)?;
        }
        if let Some(r) = repeated(&self.r) {
            return Err(format!("`r` lists {r} twice; remove one").into());
        }
        if let Some(rule) = repeated(&self.stop) {
            return Err(format!("`stop` lists {rule} twice; remove one").into());
        }
        if self.max_iterations == 0 {
            return Err("`max_iterations` must be at least 1".into());
        }
        let drawn = self.draw_r;
        if !self.r.contains(&drawn) {
            return Err(format!("`draw_r` = {drawn} is not among `r`; add it there").into());
        }
        if let Some(output) = repeated(&self.outputs) {
            return Err(format!("`outputs` lists {output} twice; remove one").into());
        }
        self.outputs.sort();
        if self.wants(Output::Identify) && self.paper_table.is_none() {
            return Err("`identify` explains a published table; add `paper_table`, or drop it from `outputs`".into());
        }
        if self.title.contains(['\n', '\r']) {
            return Err("`title` must be a single line".into());
        }
        refuse_forbidden("`title`", &self.title)?;
        Ok(())
    }

    /// Makes the checks that concern the square or, on another domain, do not need the mesh.
    fn check_on_domain(&self) -> std::result::Result<(), Failure> {
        let Some(square) = self.problem.square() else {
            let mut refused = NOT_ON_DOMAINS.iter();
            return match refused.find(|(output, _)| self.outputs.contains(output)) {
                None => Ok(()),
                Some((output, reason)) => {
                    Err(format!("`{output}` is for the square: {reason}; drop it from `outputs`")
                        .into())
                }
            };
        };
        // A known solution is proof enough, and its integral takes milliseconds on every command.
        if square.f.exact().is_none() || self.problem.law.is_some() {
            self.problem.problem(&InputFiles::new())?;
        }
        // As many counts on other grids would be compared without an error.
        if self.paper_table.is_some() && square.grids[0].cells() != COARSEST {
            return Err(format!(
                "the published tables begin with the grid 1/{COARSEST}; let `grids` begin with {COARSEST}, or leave \
                 out `paper_table`"
            )
            .into());
        }
        let finest = square.finest().cells();
        if finest > MAX_CELLS {
            return Err(format!(
                "grid 1/{finest} needs more memory than is sensible; 1/{MAX_CELLS} is the finest"
            )
            .into());
        }
        Ok(())
    }

    /// Returns the law on the boundary.
    pub(crate) fn law(&self) -> Law {
        self.problem.law().expect("validated: a law with this parameter")
    }

    /// Returns the r whose solution is drawn: the middle one, unless the scene names another.
    pub(crate) fn drawn_r(&self) -> f64 {
        self.draw_r
    }

    /// True if the scene asks for this output.
    pub(crate) fn wants(&self, output: Output) -> bool {
        self.outputs.contains(&output)
    }

    /// True if the scene is one of the paper's two problems; no two scenes of a project are the same problem.
    pub(crate) fn is_problem(&self) -> bool {
        matches!(self.paper_table, Some(1 | 2))
    }

    /// Returns the problem in the form that experiments take, if it belongs to a published table.
    pub fn table_problem(&self) -> Option<TableProblem> {
        let (number, square) = (self.paper_table?, self.on_grids());
        Some(TableProblem {
            number,
            f: square.f.to_string(),
            law: self.problem.law,
            load: square.load,
            prolongation: self.prolongation,
            grids: square.grids.iter().map(|grid| grid.cells()).collect(),
            r: self.r.clone(),
            max_iterations: self.max_iterations,
        })
    }

    /// Returns f and the grids of a scene on the square, as those of published tables are.
    ///
    /// # Panics
    /// If the scene is on a mesh.
    pub fn on_grids(&self) -> &OnSquare {
        self.problem.square().expect("a scene on the square")
    }

    /// Returns the finest grid of a scene on the square.
    ///
    /// # Panics
    /// If the scene is on a mesh.
    pub fn finest(&self) -> Grid {
        self.on_grids().finest()
    }
}

/// Name of the domain that has grids.
const SQUARE: &str = "square";

/// Returns the name of the domain that the keys of a scene name.
fn domain_of(keys: &toml::Table) -> Option<&str> {
    let domain = keys.get("domain")?;
    let name = domain.as_table().and_then(|table| table.get("name"));
    Some(name.unwrap_or(domain).as_str().unwrap_or_default())
}

/// Returns the error with the name of the scene before it, unless it is of the system, and names a path.
fn in_scene(name: &str, error: Error) -> Error {
    match error {
        Error::Input(text) => Error::input(format!("scene `{name}`: {text}")),
        other => other,
    }
}

/// Largest number of cells per side; two nodal vectors of that grid take about 1 GB.
pub const MAX_CELLS: usize = 8192;

/// Returns the first item that equals an earlier one.
pub(super) fn repeated<T: PartialEq>(items: &[T]) -> Option<&T> {
    items.iter().enumerate().find(|(k, item)| items[..*k].contains(item)).map(|(_, item)| item)
}

/// Checks that r is a positive number that the name of a task can show without an exponent.
pub(crate) fn positive_r(r: f64) -> Result<f64> {
    if (1e-12..=1e12).contains(&r) {
        return Ok(r);
    }
    Err(Error::input(format!(
        "r = {r:?} must be a positive number from 1e-12 to 1e12; the paper takes 0.5 to 1e6"
    )))
}

#[cfg(test)]
mod tests {
    use super::*;
    use signorini_mathematics::discrete::load::integrals;

    const GOOD: &str = "title = \"t\"\nf = \"else=-1\"\noutputs = [\"table\"]\n";

    fn error(text: &str) -> String {
        Scene::parse("s", text).unwrap_err().to_string()
    }

    #[test]
    fn defaults_are_the_papers() {
        let scene = Scene::parse("s", GOOD).unwrap();
        assert_eq!(scene.finest().cells(), 64);
        assert_eq!(scene.r, [1e6, 10.0, 5.0, 1.0, 0.5]);
        assert_eq!(scene.stop, [StopRule::Signed]);
        assert!(scene.wants(Output::Table) && !scene.wants(Output::Surface));
    }

    #[test]
    fn problems_with_known_solutions_are_solvable() {
        for exact in signorini_mathematics::problem::exact::Exact::ALL {
            assert!(integrals(&Source::from(exact))[0] < -0.5, "{exact:?}");
        }
    }

    #[test]
    fn mistakes_have_their_own_messages() {
        assert!(error(&format!("{GOOD}stop = [\"signed\", \"signed\"]\n")).contains("twice"));
        assert!(error(&GOOD.replace("[\"table\"]", "[\"table\", \"table\"]")).contains("twice"));
        let no_table = error(&format!("{GOOD}load = \"exact\"\n"));
        assert!(no_table.contains("a table such as { rule = \"exact\" }"), "{no_table}");
        for rule in ["bilinear", "lumped-average"] {
            let load = format!("load = {{ rule = \"{rule}\", diagonal = \"rising\" }}\n");
            assert!(error(&format!("{GOOD}{load}")).contains("diagonal"));
        }
        assert!(error(&format!("{GOOD}grids = [1]\n")).contains("at least 2 cells"));
        assert!(error(&format!("{GOOD}draw_r = 3\n")).contains("not among `r`"));
        assert!(error(&format!("{GOOD}draw_r = nan\n")).contains("not among `r`"));
        assert!(error(&format!("{GOOD}max_iterations = 0\n")).contains("at least 1"));
        assert!(error(&GOOD.replace("table", "identify")).contains("add `paper_table`"));
        let other_grids = format!("{GOOD}paper_table = 1\ngrids = [3, 6, 12, 24, 48]\n");
        assert!(error(&other_grids).contains("let `grids` begin with 4"));
        assert!(error(&GOOD.replace("\"t\"", "\"t\\nu\"")).contains("a single line"));
        assert!(error(&GOOD.replace("\"t\"", "\"t\\uFFFE\"")).contains("U+FFFE"));
        assert!(error(&format!("{GOOD}stop = [\"never\"]\n")).contains("unknown variant `never`"));
    }
}
