//! Scenes: a statement with a title and wanted outputs, read from TOML.

use crate::figures::Print;
use crate::pipeline::InputFiles;
use crate::pipeline::error::{Error, Result, from_toml};
use crate::pipeline::names::refuse_forbidden;
use crate::replication::fields::Fields;
use crate::replication::fields::table::{Reading, Refused, Voice};
use crate::replication::mesh_files::{self, find_mesh};
pub use crate::replication::output::Output;
use crate::replication::study::{Member, Study};
use serde::{Deserialize, Serialize};
use signorini_mathematics::discrete::grid::Grid;
use signorini_mathematics::discrete::load::LoadRule;
use signorini_mathematics::experiments::problems::TableProblem;
use signorini_mathematics::identify::COARSEST;
use signorini_mathematics::problem::law::Law;
use signorini_mathematics::problem::source::Source;
use signorini_mathematics::saddle::StopRule;
use signorini_mathematics::solvers::{MOST_CELLS, SaddleSettings, Solver};
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
    /// Statement; of the runs of a saddle-point method, that of the one that is drawn, and of a study that of its first
    /// member.
    pub statement: Statement,
    /// Runs of a saddle-point method; none for other solvers.
    pub runs: Option<Runs>,
    /// Members, if the scene varies something.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) study: Option<Study>,
    /// Form of its own pictures in print.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) picture: Option<Print>,
    /// Wanted outputs, sorted.
    pub outputs: Vec<Output>,
    /// Files on which the problem depends, by path: the mesh, if there is one.
    #[serde(skip)]
    pub files: InputFiles,
}

/// Runs of a saddle-point method: one for each rule and r.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Runs {
    /// Duality parameters.
    pub r: Vec<f64>,
    /// Stopping rules; the first is the one compared with the paper.
    pub stop: Vec<StopRule>,
}

/// Stopping rule and r of one run of a saddle-point method.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct RuleAndR {
    pub rule: StopRule,
    pub r: f64,
}

/// Outputs of a scene on the square that other domains do not have, each with the reason.
const NOT_ON_DOMAINS: [(Output, &str); 2] = [
    (Output::History, "the method keeps no residuals on meshes"),
    (Output::Identify, "no table was published"),
];

/// Duality parameters of the published tables.
const PAPERS_R: [f64; 5] = [1e6, 10.0, 5.0, 1.0, 0.5];

impl Scene {
    /// Parses and validates the text of a scene file; `name` names the scene in messages.
    ///
    /// # Errors
    /// [`Error::Input`] with the line of the mistake. [`Scene::check`] tells whether there is a problem to be solved.
    pub fn parse(name: &str, text: &str) -> Result<Self> {
        let what = format!("scene `{name}`");
        let fields: Fields = from_toml(&what, text)?;
        let scene = match fields.vary {
            Some(_) => Self::of_study(name, &fields),
            None => Self::of(name, &fields),
        };
        let scene = scene.and_then(|scene| scene.check_outputs(&fields)?.complete());
        scene.map_err(|Refused { field, text: why }| {
            let line = line_of(field, text).map_or(String::new(), |line| format!("line {line}: "));
            Error::input(format!("{what}: {line}{why}"))
        })
    }

    /// The scene that these fields make, before it is checked as a whole.
    fn of(name: &str, fields: &Fields) -> Reading<Self> {
        let missing = |field| Refused::new(field, format!("missing field `{field}`; add it"));
        let title = fields.title.clone().ok_or_else(|| missing("title"))?;
        let outputs = fields.outputs.clone().ok_or_else(|| missing("outputs"))?;
        let usual = fields.usual(Voice::Keys)?;
        let is_papers = fields.paper_table.is_some();
        let papers = Solver::ArrowHurwicz;
        if let Some(solver) = fields.solver.filter(|&solver| is_papers && solver != papers) {
            let text = format!(
                "the published tables are those of {papers}; leave out solver = \"{solver}\", or `paper_table`"
            );
            return Err(Refused::new("solver", text));
        }
        let base = if is_papers { of_the_tables(usual) } else { usual };
        let usual = base.saddle.unwrap_or_default();
        let statement = fields.over(base, Voice::Keys)?;
        let runs = statement.saddle.map(|_| ()).map(|()| {
            let r = if is_papers { PAPERS_R.to_vec() } else { vec![usual.r] };
            Ok(Runs {
                r: fields.r.clone().unwrap_or(r),
                stop: fields.stop_rules(Voice::Keys)?.unwrap_or_else(|| vec![usual.stop]),
            })
        });
        Ok(Self {
            name: name.to_owned(),
            title,
            paper_table: fields.paper_table,
            statement,
            runs: runs.transpose()?,
            study: None,
            picture: fields.picture.clone(),
            outputs,
            files: InputFiles::new(),
        })
    }

    /// The study that these fields make: of each member the statement, all else of the first.
    fn of_study(name: &str, fields: &Fields) -> Reading<Self> {
        let Some(vary) = &fields.vary else { return Self::of(name, fields) };
        if fields.paper_table.is_some() {
            let text =
                "the published tables are of one problem each; leave out `vary`, or `paper_table`";
            return Err(Refused::new("vary", text));
        }
        let (mut study, mut first) = (Study::of(&vary.names), None);
        for (values, fields) in vary.members.iter().zip(vary.fields(fields, Voice::Keys)?) {
            let member = Self::of(name, &fields).and_then(Self::of_one_run);
            let member = member.map_err(|refused| study.refused(values, refused))?;
            study
                .members
                .push(Member { values: values.clone(), statement: member.statement.clone() });
            first.get_or_insert(member);
        }
        let first =
            first.ok_or_else(|| Refused::new("vary", "`vary` has no members; add values"))?;
        let is_drawn = first.wants(Output::Chart);
        study.chart = is_drawn.then(|| study.axes(fields.chart.as_ref())).transpose()?;
        study.columns = study.columns(fields.columns.as_deref())?;
        Ok(Self { study: Some(study), ..first })
    }

    /// A member of a study, checked on its domain; it has one rule and one r.
    fn of_one_run(self) -> Reading<Self> {
        let several = self.runs.as_ref().and_then(|runs| {
            let counts = [("r", runs.r.len()), ("stop", runs.stop.len())];
            counts.into_iter().find(|(_, count)| *count > 1).map(|(field, _)| field)
        });
        if let Some(field) = several {
            let text = format!(
                "`{field}` has several values; in a study give one, or name them in `vary`"
            );
            return Err(Refused::new(field, text));
        }
        self.check_on_domain()?;
        Ok(Self { runs: None, ..self })
    }

    /// Finds the mesh of the domain, if the scene has one, in the project in `root`, among the `known` files or else on
    /// the disk.
    ///
    /// # Errors
    /// [`Error::Input`] and [`Error::Io`] if there is no such mesh.
    pub(crate) fn find_mesh(&mut self, root: &Path, known: &mut InputFiles) -> Result<()> {
        let mut files = InputFiles::new();
        for statement in self.statements() {
            let found = find_mesh(&statement.domain, root, known);
            files.extend(found.map_err(|e| in_scene(&self.name, e))?);
        }
        self.files = files;
        Ok(())
    }

    /// Checks that there is a problem to be solved, and reads the mesh of the domain, if the scene has one, and checks
    /// that it fits the scene. Takes time in the size of the problem: only a run of the scene asks for it. Returns what
    /// a user has to know, in a line each. A study has rows in place of such errors.
    ///
    /// # Errors
    /// [`Error::Input`] if there is none, or the mesh does not fit; [`Error::Io`].
    pub fn check(&self) -> Result<Vec<String>> {
        if self.study.is_some() {
            return Ok(Vec::new());
        }
        self.checked().map_err(|e| in_scene(&self.name, e))
    }

    fn checked(&self) -> Result<Vec<String>> {
        let mesh = mesh_files::mesh(&self.statement, &self.files)?;
        let notes = mesh_files::check(&self.statement, mesh.as_ref())?;
        let Some(mesh) = mesh else {
            // The load of a published table is the paper's.
            let own = notes.into_iter().filter(|_| self.paper_table.is_none());
            return Ok(own
                .map(|note| note + "; load = { rule = \"bilinear\" } does not")
                .collect());
        };
        let (dimension, (_, nodes)) = (mesh.dimension(), mesh_files::size(&self.statement, &mesh)?);
        if let Some(accuracy) = self.statement.accuracy().filter(|_| dimension == 3) {
            let asked = Voice::Keys.accuracy(accuracy);
            let text =
                format!("{asked} is for domains in the plane; in space, `refine` says how fine");
            return Err(Error::input(text));
        }
        self.statement.solver.check_nodes(dimension, nodes).map_err(|e| {
            let remedy = "choose another `solver`, or fewer refinements";
            Error::input(format!("{e}; {remedy}"))
        })?;
        let mut pictures = [Output::Source, Output::Surface, Output::Map, Output::Contact].iter();
        match pictures.find(|output| dimension == 3 && self.outputs.contains(output)) {
            None => Ok(notes),
            Some(output) => Err(Error::input(format!(
                "`{output}` is a picture of a domain in the plane; drop it from `outputs`, and look \
                 at the solution with `signorini solve {name} --out {name}.vtu`",
                name = self.name
            ))),
        }
    }

    /// Statements: of a study those of its members, else the one.
    pub(crate) fn statements(&self) -> impl Iterator<Item = &Statement> {
        let members = self.study.iter().flat_map(|study| &study.members);
        let one = Some(&self.statement).filter(|_| self.study.is_none());
        one.into_iter().chain(members.map(|member| &member.statement))
    }

    /// Output that a study does not have, if there is one.
    fn other_than_of_studies(&self) -> Option<&Output> {
        self.outputs.iter().find(|output| ![Output::Table, Output::Chart].contains(*output))
    }

    /// Refuses outputs and keys that only a study has, or that a study does not have.
    fn check_outputs(self, fields: &Fields) -> Reading<Self> {
        let has_axes = fields.chart.is_some();
        if self.study.is_none() && fields.columns.is_some() {
            let text = "`columns` are of a study; add `vary`, or leave them out";
            return Err(Refused::new("columns", text));
        }
        let text = match (&self.study, self.wants(Output::Chart)) {
            (None, true) => "`chart` shows a study; add `vary`, or drop it from `outputs`".into(),
            (None, false) if has_axes => {
                "`chart` is of a study; add `vary`, or leave it out".into()
            }
            (Some(_), false) if has_axes => {
                "`chart` has axes; add \"chart\" to `outputs`, or leave it out".into()
            }
            (Some(_), _) => match self.other_than_of_studies() {
                None => return Ok(self),
                Some(output) => format!(
                    "`{output}` shows one solution; a study has \"table\" and \"chart\": drop it from `outputs`"
                ),
            },
            (None, false) => return Ok(self),
        };
        Err(Refused::new("outputs", text))
    }

    /// Makes the checks that concern the scene as a whole.
    fn complete(mut self) -> Reading<Self> {
        if self.statement.law.is_some() && self.paper_table.is_some() {
            let text =
                "the published tables are for the paper's law; leave out `law`, or `paper_table`";
            return Err(Refused::new("law", text));
        }
        self.check_on_domain()?;
        match &self.runs {
            Some(runs) => runs.check(self.saddle().r)?,
            None if self.wants(Output::History) => {
                return Err(Refused::new(
                    "outputs",
                    format!(
                        "`history` is of the saddle-point methods, not of {}; add solver = \"{}\", or drop it from \
                     `outputs`",
                        self.statement.solver,
                        Solver::ArrowHurwicz
                    ),
                ));
            }
            None => (),
        }
        if let Some(output) = repeated(&self.outputs) {
            let text = format!("`outputs` lists {output} twice; remove one");
            return Err(Refused::new("outputs", text));
        }
        self.outputs.sort();
        if self.wants(Output::Identify) && self.paper_table.is_none() {
            let text = "`identify` explains a published table; add `paper_table`, or drop it from `outputs`";
            return Err(Refused::new("outputs", text));
        }
        if self.title.contains(['\n', '\r']) {
            return Err(Refused::new("title", "`title` must be a single line"));
        }
        refuse_forbidden("`title`", &self.title)
            .map_err(|e| Refused::new("title", e.to_string()))?;
        Ok(self)
    }

    /// Makes the checks that concern the square or, on another domain, do not need the mesh.
    fn check_on_domain(&self) -> Reading<()> {
        let statement = &self.statement;
        if !statement.domain.is_square() {
            if self.paper_table.is_some() {
                let text = "`paper_table` is for the square; leave it out beside `domain`";
                return Err(Refused::new("paper_table", text));
            }
            let mut refused = NOT_ON_DOMAINS.iter();
            return match refused.find(|(output, _)| self.outputs.contains(output)) {
                None => Ok(()),
                Some((output, reason)) => Err(Refused::new(
                    "outputs",
                    format!("`{output}` is for the square: {reason}; drop it from `outputs`"),
                )),
            };
        }
        let field = statement.fineness.field();
        let grids = statement.grids().map_err(|e| Refused::new(field, e.to_string()))?;
        // As many counts on other grids would be compared without an error.
        if self.paper_table.is_some() && grids[0].cells() != COARSEST {
            return Err(Refused::new(
                "grids",
                format!(
                    "the published tables begin with the grid 1/{COARSEST}; let `grids` begin with {COARSEST}, or \
                 leave out `paper_table`"
                ),
            ));
        }
        let finest = self.finest().cells();
        if let Err(e) = statement.solver.check_cells(finest) {
            return Err(Refused::new(field, format!("`{field}`: {e}")));
        }
        if finest > MOST_CELLS {
            return Err(Refused::new(
                field,
                format!(
                    "grid 1/{finest} needs more memory than is sensible; 1/{MOST_CELLS} is the finest"
                ),
            ));
        }
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

    /// Returns the duality parameters of the runs.
    pub fn r(&self) -> &[f64] {
        self.runs.as_ref().map_or(&[], |runs| &runs.r)
    }

    /// Returns the stopping rules of the runs.
    pub(crate) fn stop(&self) -> &[StopRule] {
        self.runs.as_ref().map_or(&[], |runs| &runs.stop)
    }

    /// Returns the stopping rules of the scene, each of which has a table of its own; none for a solver without.
    pub(crate) fn rules(&self) -> Vec<Option<StopRule>> {
        match &self.runs {
            Some(runs) => runs.stop.iter().copied().map(Some).collect(),
            None => vec![None],
        }
    }

    /// Returns the first rule of the scene, that of its pictures.
    pub(crate) fn first_rule(&self) -> Option<StopRule> {
        self.stop().first().copied()
    }

    /// Returns the runs of the solver under a rule: of a saddle-point method one for each r.
    pub(crate) fn runs(&self, rule: Option<StopRule>) -> Vec<Option<RuleAndR>> {
        match (&self.runs, rule) {
            (Some(runs), Some(rule)) => {
                runs.r.iter().map(|&r| Some(RuleAndR { rule, r })).collect()
            }
            _ => vec![None],
        }
    }

    /// Returns the run of the solver under a rule that is drawn.
    pub(crate) fn drawn(&self, rule: Option<StopRule>) -> Option<RuleAndR> {
        Some(RuleAndR { rule: rule?, r: self.statement.saddle?.r })
    }

    /// Returns what a run asks.
    pub(crate) fn of_run(&self, run: Option<RuleAndR>) -> Statement {
        let saddle = self.statement.saddle;
        let saddle = run.map_or(saddle, |RuleAndR { rule: stop, r }| {
            saddle.map(|saddle| SaddleSettings { stop, r, ..saddle })
        });
        Statement { saddle, ..self.statement.clone() }
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
        let (number, r) = (self.paper_table?, self.r().to_vec());
        Some(TableProblem { number, r, statement: self.statement.clone() })
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

impl Runs {
    /// Makes the checks that a parser cannot; `drawn` is the r that is drawn.
    fn check(&self, drawn: f64) -> Reading<()> {
        let empty = [("r", self.r.is_empty()), ("stop", self.stop.is_empty())];
        if let Some((field, _)) = empty.into_iter().find(|(_, is_empty)| *is_empty) {
            let example = "r = [10], stop = [\"signed\"]";
            let text = format!("`r` and `stop` must not be empty; e.g. {example}");
            return Err(Refused::new(field, text));
        }
        if let Some(r) = repeated(&self.r) {
            return Err(Refused::new("r", format!("`r` lists {r} twice; remove one")));
        }
        if let Some(rule) = repeated(&self.stop) {
            return Err(Refused::new("stop", format!("`stop` lists {rule} twice; remove one")));
        }
        if !self.r.contains(&drawn) {
            let text = format!("`draw_r` = {drawn} is not among `r`; add it there");
            return Err(Refused::new("draw_r", text));
        }
        Ok(())
    }
}

/// The statement with what a published table has in place of the usual.
fn of_the_tables(usual: Statement) -> Statement {
    let r = PAPERS_R[PAPERS_R.len() / 2];
    let saddle = SaddleSettings { r, stop: StopRule::Signed, ..SaddleSettings::default() };
    let solver = Solver::ArrowHurwicz;
    Statement { solver, load: Some(LoadRule::default()), saddle: Some(saddle), ..usual }
}

/// Returns the first item that equals an earlier one.
pub(super) fn repeated<T: PartialEq>(items: &[T]) -> Option<&T> {
    items.iter().enumerate().find(|(k, item)| items[..*k].contains(item)).map(|(_, item)| item)
}

/// Returns the number of the line of a text in TOML on which a key stands, if it is written plainly.
fn line_of(key: &str, text: &str) -> Option<usize> {
    let is_there = |line: &str| {
        let mut words = line.split(|c: char| !(c.is_alphanumeric() || c == '_'));
        line.contains('=') && words.any(|word| word == key)
    };
    let begins = |line: &str| {
        line.trim_start().strip_prefix(key).is_some_and(|rest| rest.trim_start().starts_with('='))
    };
    let mut lines = text.lines();
    let place = lines.position(begins).or_else(|| text.lines().position(is_there));
    place.map(|line| line + 1)
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
        assert_eq!(papers.statement.solver, Solver::ArrowHurwicz);
        assert_eq!(papers.load(), LoadRule::default());
        assert_eq!(papers.r(), [1e6, 10.0, 5.0, 1.0, 0.5]);
        assert_eq!(papers.stop(), [StopRule::Signed]);
        assert!(papers.wants(Output::Table) && !papers.wants(Output::Surface));
        let own = Scene::parse("s", GOOD).unwrap();
        assert_eq!((own.finest().cells(), own.statement.solver), (64, Solver::Multigrid));
        assert_eq!(own.load(), LoadRule::Bilinear {});
        assert!(own.runs.is_none());
        let method = Scene::parse("s", &format!("{GOOD}solver = \"uzawa\"\n")).unwrap();
        assert_eq!(method.load(), own.load());
        assert_eq!((method.r(), method.stop()), (&[10.0][..], &[StopRule::Printed][..]));
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
            ("accuracy = 0.01\ngrids = [4]", "both say how fine"),
            ("accuracy = 0.01\nsolver = \"uzawa\"", "`accuracy` is for multigrid, not for uzawa"),
            (
                "accuracy = 0.01\npaper_table = 1",
                "`accuracy` is for multigrid, not for arrow-hurwicz",
            ),
            ("accuracy = 2", "accuracy = 2.0: must be between 0 and 1"),
            ("accuracy_energy = 0", "accuracy_energy = 0.0: must be between 0 and 1"),
            (
                "solver = \"spectral\"\ndomain = \"ball\"",
                "is for domains in the plane; choose another",
            ),
            ("solver = \"active-set\"\ngrids = [512]", "1/256 is the finest"),
            ("grids = [11, 22, 44]", "the nearest: 40 and 48"),
            ("solver = \"jacobi\"", "unknown variant `jacobi`"),
        ] {
            let text = error(&format!("{GOOD}{keys}\n"));
            assert!(text.contains(words), "{words}: {text}");
        }
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
        assert!(
            error(&format!("{method}stop = [\"never\"]\n"))
                .contains("no rule `never`; choose one of signed")
        );
    }
}
