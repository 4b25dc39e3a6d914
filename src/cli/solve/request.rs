//! Request of `solve`: the problem, the solver and its settings.

use super::SolveArgs;
use super::adapting::AdaptedMeshes;
use super::advice::{Remedy, Warning};
use super::clock::{Clock, Part};
use super::files::{Format, PictureKind, Solution};
use crate::cli::current_folder;
use crate::cli::output::{OutputFile, warn_of_outside};
use crate::cli::shown::signed;
use crate::pipeline::error::{Error, Result};
use crate::pipeline::names::found;
use crate::replication::accuracy::adapted;
use crate::replication::fields::Fields;
use crate::replication::fields::read::overridden;
use crate::replication::fields::table::Voice;
use crate::replication::mesh_files;
use crate::replication::project::Project;
use crate::replication::scene::Scene;
use crate::timing::machine;
use serde_json::Value;
use signorini_mathematics::bounds::{Accuracy, Bounds};
use signorini_mathematics::discrete::stop::Stop;
use signorini_mathematics::levels::{AdaptedMesh, Lattices, Levels, Problem, Watch};
use signorini_mathematics::mesh::AnyMesh;
use signorini_mathematics::multigrid::InputError;
use signorini_mathematics::problem::unsolvable::Unsolvable;
use signorini_mathematics::saddle::{Pair, StopRule};
use signorini_mathematics::solvers::{self, Refusal, Run, Solver};
use signorini_mathematics::statement::{
    Domain, Fineness, MOST_CELLS, SaddleSettings, Statement, StatementError, nodes_after,
};
use std::io::ErrorKind;
use std::ops::ControlFlow;
use std::path::Path;

/// Data that determine an answer.
pub(super) struct Request {
    /// Name of the scene, the file or the domain in messages and answers.
    pub name: String,
    /// Name of the scene, if f is that of a scene.
    pub scene: Option<String>,
    /// Title of a picture: that of the scene, the name of the mesh's file, or f.
    pub title: String,
    /// Kind of a picture.
    view: PictureKind,
    /// Remedies in the words of the options that the domain has.
    pub remedies: Remedies,
    /// What is asked.
    pub statement: Statement,
    /// Coarsest mesh; none on the square.
    coarsest: Option<AnyMesh>,
    /// Problem with its levels.
    pub problem: Problem,
    /// Way in which the accuracy is written.
    pub voice: Voice,
    /// End of adaptive refinement, where the mesh was refined so.
    pub adapted: Option<AdaptedMeshes>,
    /// True for a scene of a published table.
    is_papers: bool,
    /// Options that differ from the scene, in words.
    pub overridden: Vec<String>,
    /// Warnings of f that are printed already.
    pub warnings: Vec<String>,
    /// Memory per node for writing the solution, besides that of the solver.
    bytes_to_write: u64,
    /// Clock since the options are read.
    pub clock: Clock,
}

/// Remedy for a load vector that misses some of f at its jumps.
pub(super) const EXACT_LOAD: Remedy = Remedy::new("use --load exact", "--load exact");
/// Remedy for a load that moves jumps of f.
pub(super) const BILINEAR_LOAD: Remedy = Remedy::new("use --load bilinear", "--load bilinear");

/// Remedies in the words of the options that a domain has.
pub(super) struct Remedies {
    /// For a load vector that no discrete solution balances, under the paper's law and under others.
    unbalanced: [&'static str; 2],
    /// For a multigrid that has reached its limit; none where a choice of solver is the remedy.
    limit: Option<Remedy>,
    /// For an energy beyond the bounds.
    pub load: Remedy,
    /// For a quadrature that misses some of f.
    pub quadrature: Remedy,
}

impl Remedies {
    const ON_THE_SQUARE: Self = Self {
        unbalanced: [
            "use --load exact, another --h, or a lower f",
            "use --load exact, another --h, or a wider law",
        ],
        limit: Some(Remedy::new("choose another --h", "")),
        load: EXACT_LOAD,
        quadrature: Remedy::new("choose a smaller --h", ""),
    };
    const ON_MESHES: Self = Self {
        unbalanced: ["lower f somewhere", "change f, or widen the law"],
        limit: Some(Remedy::new(
            "its cells are stretched too much; mesh with smaller aspects, or with fewer cells and --refine",
            "",
        )),
        load: Remedy::new("refine the grid", ""),
        quadrature: Remedy::new("write jumps of f as shapes, or refine the mesh", ""),
    };
}

impl Request {
    /// Reads and checks the arguments.
    pub(super) fn read(args: &SolveArgs) -> Result<Self> {
        let clock = Clock::start();
        let scene = args.scene.as_deref().map(scene).transpose()?;
        let scene = scene.as_ref();
        let (statement, overridden) = stated(&args.fields, scene)?;
        args.check_file_options(&statement)?;
        let voice = match scene {
            Some(_) if args.fields.accuracy().is_none() => Voice::Keys,
            _ => Voice::Options,
        };
        // Measured: a file's fields, and the recovered solution on four times as many nodes.
        let bytes_to_write = if args.recover { 176 } else { 24 * u64::from(args.out.is_some()) };
        let coarsest = coarsest(&statement, scene)?;
        let name = args.scene.as_deref().unwrap_or(&statement.domain.name);
        if let Some(mesh) = &coarsest {
            check_mesh(mesh, &statement, voice, args.out.is_some())?;
        } else {
            let memory = Memory { statement: &statement, bytes_to_write, voice };
            memory.check(
                statement
                    .grids()
                    .map_err(|e| of_options(&e))?
                    .last()
                    .map_or(0, |grid| grid.cells()),
            )?;
            clock.ended(Part::Setup);
        }
        let problem =
            of_options_on(&statement, coarsest.as_ref(), name, &|step| clock.ended_step(step))?;
        if coarsest.is_none() {
            clock.ended(Part::Load);
        }
        let file = file_name(&statement);
        let title = match (scene, file) {
            (Some(scene), _) => scene.title.clone(),
            (None, Some(file)) => file.to_owned(),
            (None, None) => problem.levels().f(),
        };
        let is_square = coarsest.is_none();
        let usual = if is_square { PictureKind::Surface } else { PictureKind::Map };
        let name = args.scene.as_deref().or(file).unwrap_or(&statement.domain.name).to_owned();
        let warnings = warn_of_outside(args.scene.as_deref(), &problem.levels().outside());
        Ok(Self {
            name,
            scene: args.scene.clone(),
            title,
            view: args.view().unwrap_or(usual),
            remedies: if is_square { Remedies::ON_THE_SQUARE } else { Remedies::ON_MESHES },
            statement,
            coarsest,
            problem,
            voice,
            adapted: None,
            is_papers: scene.is_some_and(|scene| scene.paper_table.is_some()),
            overridden,
            warnings,
            bytes_to_write,
            clock,
        })
    }

    /// Accuracy that is asked for.
    pub(super) fn accuracy(&self) -> Option<Accuracy> {
        self.statement.accuracy()
    }

    /// Solver.
    pub(super) fn solver(&self) -> Solver {
        self.statement.solver
    }

    /// Solves, without an answer in words.
    pub(super) fn run(&self) -> Result<Run> {
        let settings = self.statement.settings(&self.problem);
        let run = solvers::solve(&self.problem, &settings).map_err(|e| self.refused(&e))?;
        let last = run.last();
        if last.end.stop != Stop::Diverged {
            return Ok(run);
        }
        let (name, solver) = (&self.name, settings.solver);
        let grid = self.problem.levels().name(run.first_level + run.ends.len() - 1);
        Err(Error::Stage(vec![match solver.is_nested() {
            true => format!(
                "{name}: {solver} diverged on {grid} after {} iterations; choose a smaller r or scale f down",
                last.end.iterations
            ),
            false => format!("{name}: the solver diverged; scale f down"),
        }]))
    }

    /// Refines the mesh where the error is large until it is as small as asked; returns the run with its bounds.
    /// `watch` is shown each mesh.
    pub(super) fn adapt(
        &mut self,
        accuracy: Accuracy,
        watch: &mut dyn FnMut(&AdaptedMesh),
    ) -> Result<(Run, Bounds)> {
        let Some(coarsest) = &self.coarsest else {
            return Err(Error::input("the square has grids in place of meshes"));
        };
        let clock = &self.clock;
        let ended = |step| clock.ended_step(step);
        let mut watch = |mesh: &AdaptedMesh| {
            watch(mesh);
            ControlFlow::Continue(())
        };
        let adapted =
            adapted(&self.statement, coarsest, (accuracy, self.voice), &mut watch, &ended)?;
        let ends = adapted.outcomes().to_vec();
        let (y, judgement) = (adapted.y, adapted.judgement);
        let meshes = AdaptedMeshes { count: adapted.meshes, nodes: y.len(), end: adapted.end };
        (self.problem, self.adapted) = (adapted.problem, Some(meshes));
        let first_level = meshes.count - ends.len();
        Ok((Run { y, ends, first_level, judgement }, adapted.bounds))
    }

    /// Puts the problem on the square on one grid with as many cells per side.
    pub(super) fn set_grid(&mut self, cells: usize) -> Result<()> {
        let (bytes_to_write, voice) = (self.bytes_to_write, self.voice);
        Memory { statement: &self.statement, bytes_to_write, voice }.check(cells)?;
        let on_grid =
            Statement { fineness: Fineness::Grids(vec![cells]), ..self.statement.clone() };
        self.problem = on_grid.problem(None, &|_| ()).map_err(|e| of_options(&e))?;
        Ok(())
    }

    /// Writes a file with a solution on the finest of these levels.
    pub(super) fn write(
        &self,
        (file, format): &(OutputFile, Format),
        levels: &dyn Levels,
        pair: &Pair,
    ) -> Result<()> {
        let Self { name, title, view, .. } = self;
        let law = self.problem.law();
        let solution = Solution { levels, name, title, view: *view, law, pair };
        let written = solution.file(*format).and_then(|bytes| file.write(&bytes));
        self.clock.ended(Part::Files);
        written
    }

    /// Grids and f on the square; refuses meshes, for an option that only the square has.
    pub(super) fn lattices(&self, option: &str) -> Result<&Lattices> {
        let on_mesh = || Error::input(format!("{option} is for the square; leave it out"));
        self.problem.lattices().ok_or_else(on_mesh)
    }

    /// Part of the integral of |f| by which the load moves jumps of f; none for a published table, whose load is the
    /// paper's.
    pub(super) fn moved_jumps(&self) -> Option<f64> {
        if self.is_papers { None } else { self.statement.moved_jumps() }
    }

    /// Width of the finest level: of the square and the cube that of their cells, on other meshes the longest edge.
    pub(super) fn width(&self) -> f64 {
        match self.statement.fineness {
            Fineness::Width(cells) if self.statement.domain.is_cube() => 1.0 / cells as f64,
            _ => self.problem.levels().width(),
        }
    }

    /// Returns, on a mesh, how fine it is.
    pub(super) fn refined(&self) -> Option<String> {
        if let Some(meshes) = self.adapted {
            return Some(format!("{} adapted meshes", meshes.count));
        }
        self.coarsest.as_ref()?;
        Some(match (&self.statement.fineness, self.problem.finest()) {
            (Fineness::Width(cells), _) => format!("h 1/{cells}"),
            (_, 0) => "not refined".into(),
            (_, 1) => "refined once".into(),
            (_, times) => format!("refined {times} times"),
        })
    }

    /// Returns advice for a smaller residual; each option in it goes with those that are given.
    pub(super) fn closer(&self) -> Remedy {
        const MULTIGRID: &str = "--solver multigrid";
        match (self.solver(), self.statement.saddle.unwrap_or_default().stop) {
            (Solver::Multigrid, _) if self.accuracy().is_some() => {
                Remedy::new("ask for a smaller accuracy", "")
            }
            (Solver::Multigrid, _) if self.statement.tolerance.is_some() => {
                Remedy::new("ask for a smaller --tolerance", "")
            }
            (Solver::Multigrid, _) => Remedy::new("use --solver active-set", "--solver active-set"),
            (solver, StopRule::PrintedDual) if solver.is_nested() => {
                Remedy::new("use --solver multigrid", MULTIGRID)
            }
            (solver, _) if solver.is_nested() => {
                Remedy::new("use --stop printed-dual, or --solver multigrid", MULTIGRID)
            }
            _ => Remedy::new("use --solver multigrid", MULTIGRID),
        }
    }

    /// Returns advice after a limit on iterations.
    pub(super) fn after_limit(&self) -> Remedy {
        if self.solver().is_nested() {
            let words = "raise --max-iterations, or use --solver multigrid";
            return Remedy::new(words, "--solver multigrid");
        }
        self.remedies.limit.unwrap_or_else(|| self.closer())
    }

    /// Returns the settings, by name, on which the answer depends besides f, the solver and the levels.
    pub(super) fn settings(&self) -> Vec<(&'static str, Value)> {
        let mut settings = Vec::new();
        let law = self.problem.law();
        if !law.is_signorini() {
            settings.push(("law", law.to_string().into()));
        }
        let Statement { load, saddle, tolerance, .. } = &self.statement;
        settings.extend(load.map(|rule| ("load", rule.name().into())));
        if let Some(SaddleSettings { prolongation, r, stop, max_iterations }) = *saddle {
            settings.push(("r", r.into()));
            settings.push(("stop", stop.name().into()));
            settings.push(("max_iterations", max_iterations.into()));
            settings.extend(load.map(|_| ("prolongation", prolongation.name().into())));
        }
        settings.extend(tolerance.map(|tolerance| ("tolerance", tolerance.into())));
        settings.extend(self.accuracy().map(|of| match of {
            Accuracy::Error(wanted) => ("accuracy", wanted.into()),
            Accuracy::Energy(wanted) => ("accuracy-energy", wanted.into()),
        }));
        settings
    }

    /// Returns the message that no nodal vector solves the discrete problem for a load vector with this sum.
    pub(super) fn without_solution(&self, sum_load: f64) -> Warning {
        let [papers, others] = self.remedies.unbalanced;
        let remedy = if self.problem.law().is_signorini() { papers } else { others };
        let (name, grid) = (&self.name, self.problem.levels().name(self.problem.finest()));
        let sum_load = signed(sum_load, 4);
        let fact = format!(
            "{name}: the load vector sums to {sum_load} on {grid}, where the discrete problem has no solution"
        );
        Warning::new(fact, Remedy::new(remedy, ""))
    }

    fn refused(&self, refusal: &Refusal) -> Error {
        let place = self.scene.as_deref().unwrap_or("--f");
        match refusal {
            // The integral of f has been judged before.
            Refusal::Input(InputError::Unsolvable(
                Unsolvable::NotCoercive { integral: sum, .. }
                | Unsolvable::Unbalanced { integral: sum, .. },
            )) => Error::Stage(vec![self.without_solution(*sum).sentence()]),
            Refusal::Input(e @ InputError::GridSize { .. }) => Error::input(format!("--h: {e}")),
            Refusal::NotOnMeshes(solver) => {
                Error::input(format!("--solver {solver} is for the square; choose another solver"))
            }
            Refusal::Input(_) | Refusal::Problem(_) | Refusal::Spectral(_) => {
                Error::input(format!("{place}: {refusal}; check f"))
            }
        }
    }
}

/// Memory that a solver takes on the square.
struct Memory<'a> {
    statement: &'a Statement,
    /// Memory per node for writing the solution, besides that of the solver.
    bytes_to_write: u64,
    voice: Voice,
}

impl Memory<'_> {
    /// Refuses a grid on which the solver would take too much memory.
    fn check(&self, finest: usize) -> Result<()> {
        let solver = self.statement.solver;
        let most = solver.entry().most_on_square.unwrap_or(MOST_CELLS);
        let asked = match self.statement.accuracy() {
            Some(accuracy) => format!("{}: grid 1/{finest}", self.voice.accuracy(accuracy)),
            None => format!("--h 1/{finest}"),
        };
        if finest > most {
            return Err(Error::input(format!(
                "{asked} needs too much memory; 1/{most} is the finest for {solver}"
            )));
        }
        let left = machine::available_memory().unwrap_or(u64::MAX);
        if self.bytes(finest) <= left {
            return Ok(());
        }
        let mut fits = finest / 2;
        while fits >= 4 && self.bytes(fits) > left {
            fits /= 2;
        }
        Err(Error::input(format!(
            "{asked} takes about {} MB of memory, where {} MB are left; 1/{fits} would fit",
            self.bytes(finest) / 1_000_000,
            left / 1_000_000,
        )))
    }

    /// Memory for solving on a grid and writing the solution.
    fn bytes(&self, n: usize) -> u64 {
        let n = n as u64;
        let per_node = (self.statement.solver.entry().bytes_per_node)(n) + self.bytes_to_write;
        (n + 1).pow(2) * per_node
    }
}

/// Returns what the options ask, over a scene if one is named, and what they have in place of the scene's, in words.
fn stated(fields: &Fields, scene: Option<&Scene>) -> Result<(Statement, Vec<String>)> {
    let Some(scene) = scene else {
        let usual = fields.usual(Voice::Options)?;
        return Ok((fields.over(usual, Voice::Options)?, Vec::new()));
    };
    let statement = fields.over(scene.statement.clone(), Voice::OverScene)?;
    let overridden = overridden(&scene.statement, &statement);
    Ok((statement, overridden))
}

/// Returns the coarsest mesh, read from its file if it is not built in: that of the scene, or the one that the options
/// name; none on the square.
fn coarsest(statement: &Statement, scene: Option<&Scene>) -> Result<Option<AnyMesh>> {
    if let Some(scene) = scene {
        return mesh_files::mesh(statement, &scene.files);
    }
    let path = &statement.domain.name;
    let file = statement.domain.is_file().then(|| std::fs::read(found(Path::new(path))));
    let file = file.transpose().map_err(|e| match e.kind() {
        ErrorKind::NotFound => of_options(&statement.domain.unknown()),
        _ => Error::input(format!("{path}: {e}")),
    })?;
    statement.mesh(file.as_deref()).map_err(|e| of_options(&e))
}

/// Returns the name of the file with the mesh, without folders, if there is one.
fn file_name(statement: &Statement) -> Option<&str> {
    let Domain { name, .. } = &statement.domain;
    statement.domain.is_file().then(|| Path::new(name).file_name()?.to_str()).flatten()
}

/// Returns the error of a statement in the words of options.
fn of_options(error: &StatementError) -> Error {
    Error::input(match error {
        StatementError::Field { field, value, reason } => {
            let given = Voice::Options.with_value(field, value);
            format!("{}: {reason}", given.trim_end())
        }
        StatementError::Problem(_) => error.to_string(),
    })
}

/// Returns the problem of a statement, on a mesh under its name in messages. Where the domain is curved, whether there
/// is a solution is asked of the usual refinement, as for scenes.
fn of_options_on(
    statement: &Statement,
    coarsest: Option<&AnyMesh>,
    name: &str,
    watch: Watch<'_>,
) -> Result<Problem> {
    let usual = statement.on_usual_meshes();
    let asked = if coarsest.is_some_and(AnyMesh::is_curved) { &usual } else { statement };
    asked.problem(coarsest, watch).map_err(|e| match (of_options(&e), coarsest) {
        (Error::Input(text), Some(_)) => Error::input(format!("{name}: {text}")),
        (other, _) => other,
    })
}

/// Refuses an accuracy in space, and meshes that take too much memory or are too large for the solver.
fn check_mesh(mesh: &AnyMesh, statement: &Statement, voice: Voice, is_written: bool) -> Result<()> {
    match statement.accuracy() {
        None => check_size(mesh, statement, is_written),
        Some(accuracy) if mesh.dimension() == 3 => Err(Error::input(format!(
            "{} is for domains in the plane; in space, --refine says how fine, and the answer how close",
            voice.accuracy(accuracy)
        ))),
        Some(_) => Ok(()),
    }
}

/// Memory on meshes in bytes per node, of file, mesh, network, solver and bounds: measured, rounded up.
struct MeshMemory {
    /// For each node of the finest mesh.
    finest: f64,
    /// For each node of the coarsest mesh besides, below which there are levels of aggregates.
    coarsest: f64,
    /// For each node of the finest mesh besides, if the solution is written.
    written: f64,
}

impl MeshMemory {
    const IN_PLANE: Self = Self { finest: 480.0, coarsest: 320.0, written: 240.0 };
    const IN_SPACE: Self = Self { finest: 950.0, coarsest: 1000.0, written: 520.0 };

    /// Bytes for a mesh that is refined so often.
    fn bytes(&self, mesh: &AnyMesh, times: usize, is_written: bool) -> f64 {
        let written = if is_written { self.written } else { 0.0 };
        (self.finest + written) * nodes_after(mesh, times) + self.coarsest * mesh.nodes() as f64
    }
}

/// Refuses refinements that take more memory than there is, or more nodes than the solver can do with.
fn check_size(mesh: &AnyMesh, statement: &Statement, is_written: bool) -> Result<()> {
    let solver = statement.solver;
    let is_plane = mesh.dimension() == 2;
    let memory = if is_plane { MeshMemory::IN_PLANE } else { MeshMemory::IN_SPACE };
    let bytes = |times| memory.bytes(mesh, times, is_written);
    let left = machine::available_memory().unwrap_or(u64::MAX) as f64;
    let most = solver.entry().most_nodes[usize::from(mesh.dimension() - 2)];
    let most = most.map_or(f64::INFINITY, |most| most as f64);
    let fits = |times: &usize| {
        let nodes = nodes_after(mesh, *times);
        nodes <= most && bytes(*times) <= left
    };
    let times = statement.refinements(mesh).map_err(|e| of_options(&e))?;
    if fits(&times) {
        return Ok(());
    }
    // The option by which the levels of the domain are chosen.
    let option = |fewer: usize| match statement.fineness {
        Fineness::Width(cells) => format!("--h 1/{}", cells >> (times - fewer)),
        _ => format!("--refine {fewer}"),
    };
    let nodes = nodes_after(mesh, times);
    let reason = match nodes > most {
        true => format!("makes about {nodes:.0} nodes, where {solver} can do with {most}"),
        false => format!(
            "takes about {:.0} MB of memory, where {:.0} MB are left",
            bytes(times) / 1e6,
            left / 1e6
        ),
    };
    let remedy = match (0..times).rev().find(fits) {
        Some(times) => format!("{} would fit", option(times)),
        None if nodes <= most => "begin with a coarser mesh and --refine".into(),
        None => "choose another solver, or begin with a coarser mesh".into(),
    };
    // A mesh that is not refined is the file's own.
    let asked = if times == 0 { statement.domain.name.clone() } else { option(times) };
    Err(Error::input(format!("{asked} {reason}; {remedy}")))
}

fn scene(name: &str) -> Result<Scene> {
    let folder = Project::read_scenes(&Project::find(&current_folder()?)?)?;
    let scene = folder.named(name)?.clone();
    scene.check()?;
    Ok(scene)
}
