//! Request of `solve`: the problem, the solver and its settings.

use super::SolveArgs;
use super::clock::{Clock, Part};
use super::files::{Format, PictureKind, Solution};
use crate::cli::output::OutputFile;
use crate::figures::Print;
use crate::pipeline::error::{Error, Result};
use crate::pipeline::names::found;
use crate::replication::fields::Fields;
use crate::replication::fields::read::{is_problem_of, overridden};
use crate::replication::fields::table::{Reading, Voice};
use crate::replication::mesh_files;
use crate::replication::scene::Scene;
use crate::timing::machine;
use signorini_mathematics::levels::Problem;
use signorini_mathematics::mesh::{AnyMesh, PointValue};
use signorini_mathematics::solvers::{Memory, Refusal, Solved, Watcher};
use signorini_mathematics::statement::{Domain, Fineness, Statement};
use std::io::ErrorKind;
use std::path::Path;

/// Data that determine an answer.
pub(super) struct Request {
    /// Name of the scene, the file or the domain in messages and answers.
    pub name: String,
    /// Name of the scene, if f is that of a scene.
    pub scene: Option<String>,
    /// Title of a picture: that of the scene, the name of the mesh's file, or f.
    pub title: String,
    /// Kind of a picture, and its form in print.
    view: PictureKind,
    print: Print,
    /// Statement of the options or of the scene.
    pub statement: Statement,
    /// Way in which the accuracy is written.
    pub voice: Voice,
    /// Options that differ from the scene, in words.
    pub overridden: Vec<String>,
    /// Points at which v is shown.
    pub points: Vec<Vec<f64>>,
    /// Memory that is left, and the files for which some of it is needed.
    memory: Memory,
    /// Clock since the options are read.
    pub clock: Clock,
}

impl Request {
    /// Reads and checks the arguments and the scene that they name; returns the problem as well, for an accuracy the
    /// one with which it begins.
    pub(super) fn read(args: &SolveArgs, scene: Option<&Scene>) -> Result<(Self, Problem)> {
        let clock = Clock::start();
        let statement = statement(&args.fields, scene)?;
        let overridden = scene.map(|scene| overridden(&scene.statement, &statement, &[]));
        let overridden = overridden.unwrap_or_default();
        let scene_of_problem = scene.filter(|scene| is_problem_of(&scene.statement, &statement));
        args.check_file_options(&statement)?;
        args.check_most_nodes(&statement)?;
        let voice = match scene {
            Some(_) => Voice::OverScene,
            None => Voice::Options,
        };
        let memory = Memory::new(machine::available_memory());
        let memory = if args.out.is_some() { memory.with_files() } else { memory };
        let memory = memory.with_most_nodes(args.most_nodes.unwrap_or(usize::MAX));
        let file = file_name(&statement);
        let name = args.scene.as_deref().unwrap_or_else(|| name_of_domain(&statement)).to_owned();
        let coarsest = coarsest(&statement, scene)?;
        check_fineness(coarsest.as_ref(), &statement, voice, memory)?;
        if coarsest.is_none() {
            clock.ended(Part::Setup);
        }
        let steps = |step| clock.ended_step(step);
        let problem = match args.out {
            None => statement.without_nodes(coarsest.as_ref()).problem(coarsest.as_ref(), &steps),
            Some(_) => statement.problem(coarsest.as_ref(), &steps),
        };
        let of_scene = scene.map(|scene| format!("scene `{}`", scene.name));
        let on = of_scene.or_else(|| coarsest.is_some().then(|| statement.domain.name.clone()));
        let problem = problem.map_err(|e| match (Voice::Options.stated(&e), on) {
            (Error::Input(text), Some(on)) => Error::input(format!("{on}: {text}")),
            (other, _) => other,
        })?;
        if coarsest.is_none() {
            clock.ended(Part::Load);
        }
        let title = match (scene_of_problem, file) {
            (Some(scene), _) => scene.title.clone(),
            (None, Some(file)) => file.to_owned(),
            (None, None) => problem.levels().facts().f.clone(),
        };
        let is_square = coarsest.is_none();
        let usual = if is_square { PictureKind::Surface } else { PictureKind::Map };
        let request = Self {
            name,
            scene: args.scene.clone(),
            title,
            view: args.view().unwrap_or(usual),
            print: Print { width: args.width.clone(), title: !args.no_title },
            statement,
            voice,
            overridden,
            points: args.points.points(&problem)?,
            memory,
            clock,
        };
        Ok((request, problem))
    }

    /// Solves, without an answer in words; for an accuracy the watcher is shown each grid or mesh.
    pub(super) fn solved(&self, problem: Problem, watcher: &mut dyn Watcher) -> Result<Solved> {
        let steps = |step| self.clock.ended_step(step);
        let solved = self.statement.solve(problem, self.memory, watcher, &steps);
        solved.map_err(|e| self.refused(&e))
    }

    /// Writes a file with a solution, or with its values at the points that are asked for.
    pub(super) fn write(
        &self,
        (file, format): &(OutputFile, Format),
        solved: &Solved,
        values: &[PointValue],
    ) -> Result<()> {
        let Self { name, title, view, print, .. } = self;
        let (problem, pair) = (&solved.problem, &solved.pair());
        let solution = Solution { problem, name, title, view: *view, print, pair, values };
        let written = solution.write(file, *format);
        self.clock.ended(Part::Files);
        written
    }

    /// Returns, on a mesh, how fine it is after so many refinements.
    pub(super) fn refined(&self, times: usize) -> Option<String> {
        let Statement { domain, fineness, .. } = &self.statement;
        (!self.statement.has_grids()).then(|| match (fineness, times) {
            (Fineness::Width(cells), _) if domain.is_cube() => format!("h 1/{cells}"),
            // The same option has meant grids.
            _ if domain.is_square() => {
                format!("mesh of width 1/{}", fineness.cells().last().copied().unwrap_or_default())
            }
            (_, 0) => "not refined".into(),
            (_, 1) => "refined once".into(),
            (_, times) => format!("refined {times} times"),
        })
    }

    /// Refusal of the solver, behind the name of what it refuses.
    fn refused(&self, refusal: &Refusal) -> Error {
        let error = self.voice.refused(&self.statement, refusal);
        match (error, refusal) {
            (Error::Stage(texts), _) => {
                Error::Stage(texts.iter().map(|text| format!("{}: {text}", self.name)).collect())
            }
            (
                Error::Input(text),
                Refusal::Spectral(_) | Refusal::Input(_) | Refusal::Problem(_),
            ) if !text.starts_with("--") => Error::input(format!("{}: {text}", self.name)),
            (other, _) => other,
        }
    }
}

/// Returns what the options ask, over a scene if one is named.
pub(super) fn statement(fields: &Fields, scene: Option<&Scene>) -> Reading<Statement> {
    match scene {
        Some(scene) => fields.over(scene.statement.clone(), Voice::OverScene),
        None => fields.stated(Voice::Options),
    }
}

/// Returns the coarsest mesh, read from its file if it is not built in: that of the scene, or the one that the options
/// name; none on the square.
pub(super) fn coarsest(statement: &Statement, scene: Option<&Scene>) -> Result<Option<AnyMesh>> {
    if let Some(scene) = scene {
        return mesh_files::mesh(statement, &scene.files);
    }
    let path = &statement.domain.name;
    let file = statement.domain.is_file().then(|| std::fs::read(found(Path::new(path))));
    let file = file.transpose().map_err(|e| match e.kind() {
        ErrorKind::NotFound => Voice::Options.stated(&statement.domain.unknown()),
        ErrorKind::IsADirectory => {
            Error::input(format!("--domain {path}: it is a folder; name a file of a mesh in it"))
        }
        _ => Error::input(format!("{path}: {e}")),
    })?;
    statement.mesh(file.as_deref()).map_err(|e| Voice::Options.stated(&e))
}

/// Name of the domain in messages and answers: that of the file with the mesh, if there is one.
pub(super) fn name_of_domain(statement: &Statement) -> &str {
    file_name(statement).unwrap_or(&statement.domain.name)
}

/// Returns the name of the file with the mesh, without folders, if there is one.
fn file_name(statement: &Statement) -> Option<&str> {
    let Domain { name, .. } = &statement.domain;
    statement.domain.is_file().then(|| Path::new(name).file_name()?.to_str()).flatten()
}

/// Refuses grids and meshes that take too much memory, or are too fine for the solver or the domain.
pub(super) fn check_fineness(
    mesh: Option<&AnyMesh>,
    statement: &Statement,
    voice: Voice,
    memory: Memory,
) -> Result<()> {
    match mesh {
        Some(mesh) => check_mesh(mesh, statement, voice, memory),
        None => check_grid(statement, voice, memory),
    }
}

/// Refuses a grid of the square that takes too much memory, or is too fine for the solver.
fn check_grid(statement: &Statement, voice: Voice, memory: Memory) -> Result<()> {
    let grids = statement.grids().map_err(|e| Voice::Options.stated(&e))?;
    let cells = grids.last().map_or(0, |grid| grid.cells());
    let asked = match statement.accuracy() {
        Some(accuracy) => format!("{}: grid 1/{cells}", voice.accuracy(accuracy)),
        None => format!("--h 1/{cells}"),
    };
    let checked = memory.check_grid(statement.solver, cells);
    checked.map_err(|e| Error::input(e.on_grid(&asked)))
}

/// Refuses an accuracy in space, and meshes that take too much memory or are too large for the solver.
fn check_mesh(mesh: &AnyMesh, statement: &Statement, voice: Voice, memory: Memory) -> Result<()> {
    match statement.accuracy() {
        None => check_size(mesh, statement, memory),
        Some(accuracy) if mesh.dimension() == 3 => Err(Error::input(format!(
            "{} is for domains in the plane; in space, --refine says how fine, and the answer how close",
            voice.accuracy(accuracy)
        ))),
        Some(_) => Ok(()),
    }
}

/// Refuses refinements that take more memory than there is, or more nodes than the solver can do with.
fn check_size(mesh: &AnyMesh, statement: &Statement, memory: Memory) -> Result<()> {
    let solver = statement.solver;
    let times = statement.refinements(mesh).map_err(|e| Voice::Options.stated(&e))?;
    let Err(too_large) = memory.check_mesh(solver, mesh, times) else { return Ok(()) };
    // The option by which the levels of the domain are chosen.
    let option = |fewer: usize| match statement.fineness {
        Fineness::Width(cells) => format!("--h 1/{}", cells >> (times - fewer)),
        _ => format!("--refine {fewer}"),
    };
    let remedy = match too_large.fits {
        Some(times) => format!("{} would fit", option(times)),
        None if too_large.is_of_memory() => "begin with a coarser mesh and --refine".into(),
        None => "choose another solver, or begin with a coarser mesh".into(),
    };
    // A mesh that is not refined is the file's own.
    let asked = if times == 0 { statement.domain.name.clone() } else { option(times) };
    Err(Error::input(format!("{asked} {too_large}; {remedy}")))
}
