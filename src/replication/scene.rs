//! Scenes: a problem with its grids, solver and wanted outputs, read from TOML.

use crate::pipeline::InputFiles;
use crate::pipeline::error::{Error, Failure, Result, from_toml};
use crate::pipeline::names::refuse_forbidden;
use crate::replication::domain::{DomainSettings, first_given, name_or_table};
use crate::replication::saddle::{RuleAndR, SaddleKeys, SaddleSettings, repeated};
use crate::replication::stated::{CheckedMesh, OnSquare, StatedProblem, grids};
use crate::replication::written::Written;
use serde::{Deserialize, Deserializer, Serialize};
use signorini_mathematics::bounds::Accuracy;
use signorini_mathematics::discrete::grid::{Grid, nested};
use signorini_mathematics::discrete::load::LoadRule;
use signorini_mathematics::discrete::transfer::Prolongation;
use signorini_mathematics::experiments::problems::TableProblem;
use signorini_mathematics::identify::COARSEST;
use signorini_mathematics::problem::law::{Law, LawParameter};
use signorini_mathematics::problem::source::Source;
use signorini_mathematics::saddle::StopRule;
use signorini_mathematics::solvers::{MOST_CELLS, Solver};
use signorini_mathematics::statement::Fineness;
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
    /// Problem as its file states it.
    #[serde(flatten)]
    pub problem: StatedProblem,
    /// Solver.
    pub solver: Solver,
    /// Accuracy by which the grid of the square is chosen, beginning with that of the problem; none if the scene has
    /// its grids.
    #[serde(flatten)]
    pub accuracy: Option<Accuracy>,
    /// Settings of a saddle-point method; none for other solvers.
    #[serde(flatten)]
    pub settings: Option<SaddleSettings>,
    /// Wanted outputs, sorted.
    pub outputs: Vec<Output>,
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
    solver: Option<Solver>,
    #[serde(default, deserialize_with = "some_grids")]
    grids: Option<Vec<Grid>>,
    accuracy: Option<f64>,
    accuracy_energy: Option<f64>,
    prolongation: Option<Prolongation>,
    r: Option<Vec<f64>>,
    stop: Option<Vec<StopRule>>,
    max_iterations: Option<usize>,
    draw_r: Option<f64>,
    outputs: Vec<Output>,
}

/// Outputs of a scene on the square that other domains do not have, each with the reason.
const NOT_ON_DOMAINS: [(Output, &str); 2] = [
    (Output::History, "the method keeps no residuals on meshes"),
    (Output::Identify, "no table was published"),
];

impl<F> SceneFile<F> {
    /// Name of a key that means nothing but on the square, if there is one.
    fn key_of_the_square(&self) -> Option<&'static str> {
        first_given([
            ("grids", self.grids.is_some()),
            ("load", self.load.is_some()),
            ("prolongation", self.prolongation.is_some()),
            ("paper_table", self.paper_table.is_some()),
        ])
    }

    /// Name of a key that means nothing but for a saddle-point method, if there is one.
    fn key_of_saddle_points(&self) -> Option<&'static str> {
        first_given([
            ("r", self.r.is_some()),
            ("stop", self.stop.is_some()),
            ("max_iterations", self.max_iterations.is_some()),
            ("draw_r", self.draw_r.is_some()),
            ("prolongation", self.prolongation.is_some()),
        ])
    }

    /// Returns the solver: the one that the scene names, or else the paper's for a published table and that of `solve`
    /// for any other problem.
    fn solver(&self) -> Result<Solver> {
        let papers = Solver::ArrowHurwicz;
        if let Some(solver) = self.solver.filter(|&solver| solver != papers)
            && self.paper_table.is_some()
        {
            return Err(Error::input(format!(
                "the published tables are those of {papers}; leave out solver = \"{solver}\", or `paper_table`"
            )));
        }
        let usual = if self.paper_table.is_some() { papers } else { StatedProblem::SOLVER };
        let solver = self.solver.unwrap_or(usual);
        let Some(key) = self.key_of_saddle_points().filter(|_| !solver.is_nested()) else {
            return Ok(solver);
        };
        let load = match self.solver.is_none() && self.domain.is_none() && self.load.is_none() {
            true => {
                "; a scene that names no `load` has the bilinear one, where earlier versions took \
                 { rule = \"nodal\", diagonal = \"rising\" }"
            }
            false => "",
        };
        Err(Error::input(format!(
            "`{key}` is for the saddle-point methods, not for {solver}; add solver = \"{papers}\", or leave `{key}` \
             out{load}"
        )))
    }

    /// Returns the accuracy that the scene asks for in place of grids.
    fn accuracy(&self, solver: Solver) -> Result<Option<Accuracy>> {
        let asked = match (self.accuracy, self.accuracy_energy) {
            (Some(_), Some(_)) => {
                return Err(Error::input(
                    "`accuracy` and `accuracy_energy` both choose the grid; leave one of them out",
                ));
            }
            (Some(wanted), None) => Accuracy::Error(wanted),
            (None, Some(wanted)) => Accuracy::Energy(wanted),
            (None, None) => return Ok(None),
        };
        let written = Written::Key.text(asked);
        if self.grids.is_some() {
            return Err(Error::input(format!(
                "{written} chooses the grid; leave out `grids`, or the accuracy"
            )));
        }
        if solver != Solver::Multigrid {
            return Err(Error::input(format!(
                "{written} is reached by {}, not by {solver}; change `solver`, or leave the accuracy out",
                Solver::Multigrid
            )));
        }
        Written::Key.check(asked)?;
        Ok(Some(asked))
    }

    /// Returns the scene with this name, problem and solver.
    fn scene(self, name: &str, problem: StatedProblem, solver: Solver) -> Result<Scene> {
        let accuracy = self.accuracy(solver)?;
        let Self { title, paper_table, outputs, .. } = self;
        let Self { prolongation, r, stop, max_iterations, draw_r, .. } = self;
        let keys = SaddleKeys { prolongation, r, stop, max_iterations, draw_r };
        let settings = solver.is_nested().then(|| keys.settings(paper_table.is_some()));
        let name = name.to_owned();
        Ok(Scene { name, title, paper_table, problem, solver, accuracy, settings, outputs })
    }
}

fn some_grids<'de, D: Deserializer<'de>>(
    deserializer: D,
) -> std::result::Result<Option<Vec<Grid>>, D::Error> {
    grids(deserializer).map(Some)
}

fn some_name_or_table<'de, D: Deserializer<'de>>(
    deserializer: D,
) -> std::result::Result<Option<DomainSettings>, D::Error> {
    name_or_table(deserializer).map(Some)
}

impl Scene {
    /// Parses and validates the text of a scene file; `name` names the scene in messages.
    ///
    /// # Errors
    /// [`Error::Input`] with the line of the mistake. [`Scene::check`] tells whether there is a problem to be solved.
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
        let solver = file.solver()?;
        let square = OnSquare {
            f: file.f.clone(),
            load: file.load.unwrap_or(match file.paper_table {
                Some(_) => LoadRule::default(),
                None => OnSquare::LOAD,
            }),
            grids: match file.accuracy(solver)? {
                Some(accuracy) => nested(&Fineness::Within(accuracy).cells()).expect("one grid"),
                None => file.grids.clone().unwrap_or_else(OnSquare::usual_grids),
            },
        };
        let problem = StatedProblem::on_square(square, file.law);
        file.scene(name, problem, solver)
    }

    fn on_mesh(name: &str, mut file: SceneFile<String>) -> Result<Self> {
        if let Some(key) = file.key_of_the_square() {
            return Err(Error::input(format!(
                "`{key}` is for the square; leave it out beside `domain`, whose meshes are its refinements"
            )));
        }
        let solver = file.solver()?;
        if !solver.entry().on_meshes {
            return Err(Error::input(format!(
                "solver = \"{solver}\" is for the square; choose another, or leave it out"
            )));
        }
        let domain = file.domain.take().expect("a scene on a mesh names its domain");
        if let Some(accuracy) = file.accuracy(solver)? {
            domain.check_adapted(&Written::Key.text(accuracy), "")?;
        }
        let f = file.f.split_whitespace().collect::<Vec<_>>().join(" ");
        let problem = StatedProblem::on_mesh(domain, f, file.law);
        file.scene(name, problem, solver)
    }

    /// Finds the mesh of the domain, if the scene has one, in the project in `root`, among the `known` files or else on
    /// the disk.
    ///
    /// # Errors
    /// [`Error::Input`] and [`Error::Io`] if there is no such mesh.
    pub(crate) fn find_mesh(&mut self, root: &Path, known: &mut InputFiles) -> Result<()> {
        self.problem.find_mesh(root, known).map_err(|e| in_scene(&self.name, e))
    }

    /// Checks that there is a problem to be solved, and reads the mesh of the domain, if the scene has one, and checks
    /// that it fits the scene. Takes time in the size of the problem: only a run of the scene asks for it. Returns what
    /// a user has to know of the mesh, in a line each.
    ///
    /// # Errors
    /// [`Error::Input`] if there is none, or the mesh does not fit; [`Error::Io`].
    pub fn check(&self) -> Result<Vec<String>> {
        let checked = self.problem.check().map_err(|e| in_scene(&self.name, e))?;
        let Some(CheckedMesh { dimension, nodes, notes }) = checked else { return Ok(Vec::new()) };
        if let Some(accuracy) = self.accuracy.filter(|_| dimension == 3) {
            let asked = Written::Key.text(accuracy);
            let text =
                format!("{asked} is for domains in the plane; in space, `refine` says how fine");
            return Err(in_scene(&self.name, Error::input(text)));
        }
        self.solver.check_nodes(dimension, nodes).map_err(|e| {
            let remedy = "choose another `solver`, or fewer refinements";
            Error::input(format!("scene `{}`: {e}; {remedy}", self.name))
        })?;
        let mut pictures = [Output::Source, Output::Surface, Output::Map, Output::Contact].iter();
        match pictures.find(|output| dimension == 3 && self.outputs.contains(output)) {
            None => Ok(notes),
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
        if let Some(settings) = &self.settings {
            settings.check()?;
        } else if self.wants(Output::History) {
            return Err(format!(
                "`history` is of the saddle-point methods, not of {}; add solver = \"{}\", or drop it from `outputs`",
                self.solver,
                Solver::ArrowHurwicz
            )
            .into());
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
        // As many counts on other grids would be compared without an error.
        if self.paper_table.is_some() && square.grids[0].cells() != COARSEST {
            return Err(format!(
                "the published tables begin with the grid 1/{COARSEST}; let `grids` begin with {COARSEST}, or leave \
                 out `paper_table`"
            )
            .into());
        }
        if self.solver == Solver::Spectral && square.f.is_smooth() {
            return Err(
                "solver = \"spectral\" takes an f of constant pieces; choose another `solver`"
                    .into(),
            );
        }
        let finest = square.finest().cells();
        if let Err(e) = self.solver.check_cells(finest) {
            return Err(format!("`grids`: {e}").into());
        }
        if finest > MOST_CELLS {
            return Err(format!(
                "grid 1/{finest} needs more memory than is sensible; 1/{MOST_CELLS} is the finest"
            )
            .into());
        }
        Ok(())
    }

    /// Returns the law on the boundary.
    pub(crate) fn law(&self) -> Law {
        self.problem.law().expect("validated: a law with this parameter")
    }

    /// Returns the settings of the saddle-point method of a scene, as those of published tables have one.
    ///
    /// # Panics
    /// If the scene has another solver.
    pub fn saddle(&self) -> &SaddleSettings {
        self.settings.as_ref().expect("a scene with a saddle-point method")
    }

    /// Returns the stopping rules of the scene, each of which has a table of its own; none for a solver without.
    pub(crate) fn rules(&self) -> Vec<Option<StopRule>> {
        match &self.settings {
            Some(settings) => settings.stop.iter().copied().map(Some).collect(),
            None => vec![None],
        }
    }

    /// Returns the first rule of the scene, that of its pictures.
    pub(crate) fn first_rule(&self) -> Option<StopRule> {
        self.settings.as_ref().map(|settings| settings.stop[0])
    }

    /// Returns the runs of the solver under a rule: of a saddle-point method one for each r.
    pub(crate) fn runs(&self, rule: Option<StopRule>) -> Vec<Option<RuleAndR>> {
        match (&self.settings, rule) {
            (Some(settings), Some(rule)) => {
                settings.r.iter().map(|&r| Some(RuleAndR { rule, r })).collect()
            }
            _ => vec![None],
        }
    }

    /// Returns the run of the solver under a rule that is drawn.
    pub(crate) fn drawn(&self, rule: Option<StopRule>) -> Option<RuleAndR> {
        Some(RuleAndR { rule: rule?, r: self.settings.as_ref()?.draw_r })
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
            prolongation: self.saddle().prolongation,
            grids: square.grids.iter().map(|grid| grid.cells()).collect(),
            r: self.saddle().r.clone(),
            max_iterations: self.saddle().max_iterations,
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

#[cfg(test)]
mod tests {
    use super::*;
    use signorini_mathematics::discrete::load::integrals;

    const GOOD: &str = "title = \"t\"\nf = \"else=-1\"\noutputs = [\"table\"]\n";

    fn error(text: &str) -> String {
        Scene::parse("s", text).unwrap_err().to_string()
    }

    #[test]
    fn defaults_are_the_papers_for_its_tables_and_else_those_of_solve() {
        let papers = Scene::parse("s", &format!("{GOOD}paper_table = 1\n")).unwrap();
        assert_eq!(papers.finest().cells(), 64);
        assert_eq!(papers.solver, Solver::ArrowHurwicz);
        assert_eq!(papers.on_grids().load, LoadRule::default());
        assert_eq!(papers.saddle().r, [1e6, 10.0, 5.0, 1.0, 0.5]);
        assert_eq!(papers.saddle().stop, [StopRule::Signed]);
        assert!(papers.wants(Output::Table) && !papers.wants(Output::Surface));
        let own = Scene::parse("s", GOOD).unwrap();
        assert_eq!((own.finest().cells(), own.solver), (64, Solver::Multigrid));
        assert_eq!(own.on_grids().load, LoadRule::Bilinear {});
        assert!(own.settings.is_none());
        let method = Scene::parse("s", &format!("{GOOD}solver = \"uzawa\"\n")).unwrap();
        assert_eq!(method.on_grids().load, own.on_grids().load);
        assert_eq!(
            (&*method.saddle().r, &*method.saddle().stop),
            (&[10.0][..], &[StopRule::Printed][..])
        );
    }

    #[test]
    fn tasks_read_back_the_scene_that_was_hashed() {
        let method = "solver = \"uzawa\"\nr = [1, 0.1, 1e12]\ndraw_r = 0.1\nstop = [\"printed\", \"signed\"]\n\
            max_iterations = 7\nprolongation = \"rising-diagonal\"\nlaw = { friction = 0.3 }\n\
            load = { rule = \"nodal\", tie = \"upper-left\", diagonal = \"falling\" }\n";
        let on_mesh = "domain = { name = \"annulus\", refine = 2, free = [\"outer\", \"inner\"], fixed = [\"a.b\"], \
            curve = { outer = [0.0, 0.1, 0.5], \"a.b\" = [0, 0, 1] } }\n";
        let mut scenes = Vec::new();
        for f in [
            "else=-1",
            "else=-0.1",
            "halfplane(0.1,0.7,-0.3)=2; rect(-0.1,0.3,-0.2,0.1)=1e-3; disc(0,0,0.1)=-7; else=-1.998",
            "halfplane(5e-324,5e-324,0)=1; halfplane(1.7e308,1.7e308,1.7e308)=-3; else=-1",
            "formula( x*y  - 1.1 )",
            "exact(full-contact)",
        ] {
            scenes.push(GOOD.replace("else=-1", f));
            scenes.push(GOOD.replace("else=-1", f) + "paper_table = 2\n");
        }
        for more in
            [method, on_mesh, "accuracy = 0.1\n", "accuracy_energy = 0.1\nlaw = { limit = 3 }\n"]
        {
            scenes.push(GOOD.to_owned() + more);
        }
        for text in scenes {
            let scene = Scene::parse("s", &text).unwrap();
            let written = serde_json::to_value(&scene).unwrap();
            let back: Scene = serde_json::from_value(written.clone()).unwrap();
            assert_eq!(format!("{scene:?}"), format!("{back:?}"), "{text}");
            assert_eq!(serde_json::to_value(&back).unwrap(), written, "{text}");
        }
    }

    #[test]
    fn each_solver_has_its_own_keys() {
        for key in [
            "r = [10]",
            "stop = [\"signed\"]",
            "draw_r = 1",
            "max_iterations = 9",
            "prolongation = \"bilinear\"",
        ] {
            for solver in [
                "",
                "solver = \"multigrid\"\n",
                "solver = \"active-set\"\n",
                "solver = \"spectral\"\n",
            ] {
                let text = error(&format!("{GOOD}{solver}{key}\n"));
                assert!(text.contains("add solver = \"arrow-hurwicz\", or leave `"), "{text}");
                // Without a solver the text may be one for an earlier version, which had another load.
                assert_eq!(text.contains("earlier versions"), solver.is_empty(), "{text}");
            }
        }
        let history = error(&GOOD.replace("\"table\"", "\"history\""));
        assert!(history.contains("add solver = \"arrow-hurwicz\", or drop it"), "{history}");
        for (keys, words) in [
            (
                "solver = \"multigrid\"\npaper_table = 1",
                "the published tables are those of arrow-hurwicz",
            ),
            ("accuracy = 0.01\naccuracy_energy = 0.01", "leave one of them out"),
            ("accuracy = 0.01\ngrids = [4]", "leave out `grids`"),
            ("accuracy = 0.01\nsolver = \"uzawa\"", "reached by multigrid, not by uzawa"),
            ("accuracy = 0.01\npaper_table = 1", "reached by multigrid, not by arrow-hurwicz"),
            ("accuracy = 2", "accuracy = 2.0: must be between 0 and 1"),
            ("accuracy_energy = 0", "accuracy_energy = 0.0: must be between 0 and 1"),
            ("solver = \"spectral\"\ndomain = \"disc\"", "is for the square; choose another"),
            ("solver = \"active-set\"\ngrids = [512]", "1/256 is the finest"),
            ("grids = [11, 22, 44]", "the nearest: 40 and 48"),
            ("solver = \"jacobi\"", "unknown variant `jacobi`"),
        ] {
            let text = error(&format!("{GOOD}{keys}\n"));
            assert!(text.contains(words), "{words}: {text}");
        }
        let smooth = GOOD.replace("else=-1", "formula(x - 1)") + "solver = \"spectral\"\n";
        assert!(error(&smooth).contains("takes an f of constant pieces"));
    }

    #[test]
    fn problems_with_known_solutions_are_solvable() {
        for exact in signorini_mathematics::problem::exact::Exact::ALL {
            assert!(integrals(&Source::from(exact))[0] < -0.5, "{exact:?}");
        }
    }

    #[test]
    fn mistakes_have_their_own_messages() {
        let method = format!("{GOOD}solver = \"arrow-hurwicz\"\n");
        assert!(error(&format!("{method}stop = [\"signed\", \"signed\"]\n")).contains("twice"));
        assert!(error(&GOOD.replace("[\"table\"]", "[\"table\", \"table\"]")).contains("twice"));
        let no_table = error(&format!("{GOOD}load = \"exact\"\n"));
        assert!(no_table.contains("a table such as { rule = \"exact\" }"), "{no_table}");
        for rule in ["bilinear", "lumped-average"] {
            let load = format!("load = {{ rule = \"{rule}\", diagonal = \"rising\" }}\n");
            assert!(error(&format!("{GOOD}{load}")).contains("diagonal"));
        }
        assert!(error(&format!("{GOOD}grids = [1]\n")).contains("at least 2 cells"));
        assert!(error(&format!("{method}draw_r = 3\n")).contains("not among `r`"));
        assert!(error(&format!("{method}draw_r = nan\n")).contains("not among `r`"));
        assert!(error(&format!("{method}max_iterations = 0\n")).contains("at least 1"));
        assert!(error(&GOOD.replace("table", "identify")).contains("add `paper_table`"));
        let other_grids = format!("{GOOD}paper_table = 1\ngrids = [3, 6, 12, 24, 48]\n");
        assert!(error(&other_grids).contains("let `grids` begin with 4"));
        assert!(error(&GOOD.replace("\"t\"", "\"t\\nu\"")).contains("a single line"));
        assert!(error(&GOOD.replace("\"t\"", "\"t\\uFFFE\"")).contains("U+FFFE"));
        assert!(error(&format!("{GOOD}stop = [\"never\"]\n")).contains("unknown variant `never`"));
    }
}
