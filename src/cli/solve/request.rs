//! Request of `solve`: the problem, the solver and its settings.

use super::adapting::AdaptedMeshes;
use super::advice::{Remedy, Warning};
use super::clock::{Clock, Part};
use super::files::{Format, PictureKind, Solution};
use super::{SolveArgs, cells, rule_name};
use crate::cli::current_folder;
use crate::cli::output::{OutputFile, check_options, warn_of_outside};
use crate::cli::shown::signed;
use crate::pipeline::InputFiles;
use crate::pipeline::error::{Error, Result};
use crate::pipeline::names::found;
use crate::replication::accuracy::{Accuracy, MAX_CELLS, Written};
use crate::replication::domain::{DomainSettings, nodes_after};
use crate::replication::project::Project;
use crate::replication::saddle::{SaddleSettings, positive_r};
use crate::replication::scene::Scene;
use crate::replication::stated::{OnMesh, OnSquare, Place, StatedProblem};
use crate::timing::machine;
use serde_json::{Value, json};
use signorini_mathematics::bounds::Bounds;
use signorini_mathematics::discrete::grid::{Grid, nested};
use signorini_mathematics::discrete::load::LoadRule;
use signorini_mathematics::discrete::norms::largest;
use signorini_mathematics::discrete::stop::Stop;
use signorini_mathematics::levels::{AdaptedMesh, Lattices, Levels, Problem, Watch};
use signorini_mathematics::mesh::AnyMesh;
use signorini_mathematics::multigrid::{Goal, InputError};
use signorini_mathematics::problem::unsolvable::Unsolvable;
use signorini_mathematics::saddle::{Pair, Params, StopRule};
use signorini_mathematics::solvers::{self, Refusal, Run, Settings, Solver};
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
    title: String,
    /// Kind of a picture.
    view: PictureKind,
    /// Quadrature of the load vector; none on meshes, which have one alone.
    load: Option<LoadRule>,
    /// Remedies in the words of the options that the domain has.
    pub remedies: Remedies,
    /// Problem as it was stated.
    stated: StatedProblem,
    /// Coarsest mesh; none on the square.
    coarsest: Option<AnyMesh>,
    /// Problem with its levels.
    pub problem: Problem,
    pub settings: Settings,
    /// Tolerance of multigrid, relative to the load; `None` for the rounding floor.
    pub tolerance: Option<f64>,
    /// Guaranteed bound of the error, by which the grids are chosen.
    pub accuracy: Option<Accuracy>,
    /// Way in which the accuracy is written.
    pub written: Written,
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
        let mut overridden = Vec::new();
        let usual = default_solver(args, scene);
        let solver = args.solver.unwrap_or(usual);
        let solver_of_scene = scene.map(|scene| scene.solver);
        choose("solver", Some(solver), solver_of_scene, Solver::to_string, &mut overridden);
        let accuracy = accuracy(args, scene, solver, &mut overridden);
        let stated = match scene {
            Some(scene) => of_scene(args, scene, &mut overridden)?,
            None => of_options(args)?,
        };
        check_solver_options(args, solver)?;
        // Measured: a file's fields, and the recovered solution on four times as many nodes.
        let bytes_to_write = if args.recover { 176 } else { 24 * u64::from(args.out.is_some()) };
        let memory = Memory { solver, bytes_to_write, accuracy, written: written(args) };
        let (domain, load, (problem, coarsest), remedies) = match &stated.place {
            Place::Square(square) => {
                check_domain_options(args, None)?;
                memory.check(square.finest().cells())?;
                clock.ended(Part::Setup);
                let problem = stated.problem(&InputFiles::new())?;
                clock.ended(Part::Load);
                ("square", Some(square.load), (problem, None), Remedies::ON_THE_SQUARE)
            }
            Place::Mesh(place) => {
                check_domain_options(args, Some(place))?;
                let name = args.scene.as_deref().unwrap_or(&place.domain.name);
                let asked = accuracy.map(|accuracy| written(args).text(accuracy));
                if let Some(asked) = &asked {
                    place.domain.check_adapted(asked, "--")?;
                }
                let wanted = Wanted { solver, asked, is_written: args.out.is_some() };
                let (problem, coarsest) =
                    on_mesh(name, (&stated, place), &wanted, &|step| clock.ended_step(step))?;
                let domain = stated.file_name().unwrap_or(&place.domain.name);
                (domain, None, (problem, Some(coarsest)), Remedies::ON_MESHES)
            }
        };
        let name = args.scene.as_deref().unwrap_or(domain).to_owned();
        let title = match (scene, stated.file_name()) {
            (Some(scene), _) => scene.title.clone(),
            (None, Some(file)) => file.to_owned(),
            (None, None) => problem.levels().f(),
        };
        // Meshes have no choice of load vectors.
        let usual = if load.is_some() { PictureKind::Surface } else { PictureKind::Map };
        let warnings = warn_of_outside(args.scene.as_deref(), &problem.levels().outside());
        let settings = scene.and_then(|scene| scene.settings.as_ref());
        let settings = Settings {
            params: params(args, settings, &mut overridden)?,
            prolongation: settings.map(|settings| settings.prolongation).unwrap_or_default(),
            ..Settings::of(solver)
        };
        Ok(Self {
            name,
            scene: args.scene.clone(),
            title,
            view: args.view().unwrap_or(usual),
            load,
            remedies,
            stated,
            coarsest,
            problem,
            settings,
            tolerance: args.tolerance()?,
            accuracy,
            written: written(args),
            adapted: None,
            is_papers: scene.is_some_and(|scene| scene.paper_table.is_some()),
            overridden,
            warnings,
            bytes_to_write,
            clock,
        })
    }

    /// Solves, without an answer in words.
    pub(super) fn run(&self) -> Result<Run> {
        let goal = match (self.accuracy, self.tolerance) {
            (Some(accuracy), _) => accuracy.goal(),
            (None, Some(tolerance)) => Goal::Kkt(tolerance * largest(self.problem.load())),
            (None, None) => Goal::RoundingFloor,
        };
        let settings = Settings { goal, ..self.settings };
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
        let asked = (accuracy, self.written);
        let Some(coarsest) = &self.coarsest else {
            return Err(Error::input("the square has grids in place of meshes"));
        };
        let clock = &self.clock;
        let ended = |step| clock.ended_step(step);
        let mut watch = |mesh: &AdaptedMesh| {
            watch(mesh);
            ControlFlow::Continue(())
        };
        let adapted = self.stated.adapted(coarsest, asked, &mut watch, &ended)?;
        let ends = adapted.outcomes().to_vec();
        let (y, judgement) = (adapted.y, adapted.judgement);
        let meshes = AdaptedMeshes { count: adapted.meshes, nodes: y.len(), end: adapted.end };
        (self.problem, self.adapted) = (adapted.problem, Some(meshes));
        let first_level = meshes.count - ends.len();
        Ok((Run { y, ends, first_level, judgement }, adapted.bounds))
    }

    /// Puts the problem on the square on one grid with as many cells per side.
    pub(super) fn set_grid(&mut self, cells: usize) -> Result<()> {
        let (solver, accuracy, written) = (self.settings.solver, self.accuracy, self.written);
        Memory { solver, bytes_to_write: self.bytes_to_write, accuracy, written }.check(cells)?;
        self.stated.set_grid(grid(cells)?);
        self.problem = self.stated.problem(&InputFiles::new())?;
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
        if self.is_papers { None } else { self.stated.moved_jumps() }
    }

    /// Width of the finest level: of the square and the cube that of their cells, on other meshes the longest edge.
    pub(super) fn width(&self) -> f64 {
        let coarsest = self.stated.cells_of_coarsest_cube();
        let width = |cells: usize| 1.0 / (cells << self.problem.finest()) as f64;
        coarsest.map_or(self.problem.levels().width(), width)
    }

    /// Returns, on a mesh, how fine it is.
    pub(super) fn refined(&self) -> Option<String> {
        if let Some(meshes) = self.adapted {
            return Some(format!("{} adapted meshes", meshes.count));
        }
        self.stated.refined(self.problem.finest())
    }

    /// Returns advice for a smaller residual; each option in it goes with those that are given.
    pub(super) fn closer(&self) -> Remedy {
        const MULTIGRID: &str = "--solver multigrid";
        match (self.settings.solver, self.settings.params.rule) {
            (Solver::Multigrid, _) if self.accuracy.is_some() => {
                Remedy::new("ask for a smaller accuracy", "")
            }
            (Solver::Multigrid, _) if self.tolerance.is_some() => {
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
        if self.settings.solver.is_nested() {
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
        settings.extend(self.load.map(|rule| ("load", rule_name(&rule).into())));
        if self.settings.solver.is_nested() {
            let Params { r, rule, max_iterations, .. } = self.settings.params;
            settings.push(("r", r.into()));
            settings.push(("stop", rule.name().into()));
            settings.push(("max_iterations", max_iterations.into()));
            let prolongation = json!(self.settings.prolongation);
            settings.extend(self.load.map(|_| ("prolongation", prolongation)));
        }
        settings.extend(self.tolerance.map(|tolerance| ("tolerance", tolerance.into())));
        settings.extend(self.accuracy.map(|of| (of.option(), of.wanted().into())));
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
struct Memory {
    solver: Solver,
    /// Memory per node for writing the solution, besides that of the solver.
    bytes_to_write: u64,
    accuracy: Option<Accuracy>,
    written: Written,
}

impl Memory {
    /// Refuses a grid on which the solver would take too much memory.
    fn check(&self, finest: usize) -> Result<()> {
        let solver = self.solver;
        let most = solver.entry().most_on_square.unwrap_or(MAX_CELLS);
        let asked = match self.accuracy {
            Some(accuracy) => format!("{}: grid 1/{finest}", self.written.text(accuracy)),
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
        let per_node = (self.solver.entry().bytes_per_node)(n) + self.bytes_to_write;
        (n + 1).pow(2) * per_node
    }
}

/// Returns the problem of a scene, with the options that change its levels.
fn of_scene(
    args: &SolveArgs,
    scene: &Scene,
    overridden: &mut Vec<String>,
) -> Result<StatedProblem> {
    let mut stated = scene.problem.clone();
    match &mut stated.place {
        Place::Square(square) => {
            let given = args.h.as_deref().map(cells).transpose()?;
            // An accuracy begins with a grid of its own, and gives way to options that name a grid or a solver.
            if scene.accuracy.is_some() {
                square.grids = OnSquare::usual_grids();
            }
            let of_scene = Some(square.finest().cells()).filter(|_| scene.accuracy.is_none());
            let finest = choose("finest grid", given, of_scene, |n| format!("1/{n}"), overridden);
            let finest = finest.unwrap_or(square.finest().cells());
            square.grids = hierarchy(finest, Some(square.grids[0].cells()))?;
            let rule = choose("load", load_rule(args), Some(square.load), rule_name, overridden);
            square.load = rule.unwrap_or(square.load);
        }
        Place::Mesh(place) => {
            if args.accuracy().is_some()
                && let Some(refine) = place.domain.refine.take()
            {
                overridden.push(format!("without refine = {refine}"));
            }
            let of_scene = place.domain.refinements(&place.coarsest(&place.files)?);
            if let Some(refine) = args.refine.filter(|&refine| usize::from(refine) != of_scene) {
                overridden.push(format!("refine {refine} instead of {of_scene}"));
                place.domain.refine = Some(refine);
            }
        }
    }
    Ok(stated)
}

/// Returns the problem that the options state.
fn of_options(args: &SolveArgs) -> Result<StatedProblem> {
    let f = args.f.as_deref().ok_or_else(|| Error::input("give a scene or --f"))?;
    let domain = args.domain.as_deref().map(DomainSettings::named);
    let law = args.law()?;
    if let Some(domain) = domain.filter(|domain| !domain.is_square()) {
        return Ok(StatedProblem::on_mesh(with_options(domain, args)?, f.into(), law));
    }
    let finest = args.h.as_deref().map(cells).transpose()?;
    let square = OnSquare {
        f: f.parse().map_err(|e| Error::input(format!("--f: {e}")))?,
        load: load_rule(args).unwrap_or(OnSquare::LOAD),
        grids: finest.map_or_else(|| Ok(OnSquare::usual_grids()), |n| hierarchy(n, None))?,
    };
    Ok(StatedProblem::on_square(square, law))
}

/// Returns a domain with the options about its mesh.
fn with_options(mut domain: DomainSettings, args: &SolveArgs) -> Result<DomainSettings> {
    domain.refine = args.refine;
    domain.free.clone_from(&args.free);
    domain.fixed.clone_from(&args.fixed);
    for text in &args.curve {
        let (part, numbers) = curve(text)?;
        if domain.curve.insert(part, numbers).is_some() {
            return Err(Error::input(format!(
                "--curve {text}: the part has one already; name it once"
            )));
        }
    }
    if let Some(h) = &args.h {
        if !domain.is_cube() {
            return Err(Error::input(format!(
                "--h is for the square and the cube; refine {} with --refine K",
                domain.name
            )));
        }
        let [coarsest, times] = cube(cells(h)?)?;
        (domain.cells, domain.refine) = (Some(coarsest), Some(times as u8));
    }
    Ok(domain)
}

/// Solver, accuracy and file that are wanted on a mesh.
struct Wanted {
    solver: Solver,
    /// Accuracy, as the user wrote it.
    asked: Option<String>,
    /// True if the solution is written to a file.
    is_written: bool,
}

/// Returns the problem on a mesh that is read from its file, if it is not built in, and that mesh.
/// An accuracy begins with that mesh. `watch` is told when the mesh is made, and when f is integrated on it.
fn on_mesh(
    name: &str,
    (stated, place): (&StatedProblem, &OnMesh),
    Wanted { solver, asked, is_written }: &Wanted,
    watch: Watch<'_>,
) -> Result<(Problem, AnyMesh)> {
    if !solver.entry().on_meshes {
        return Err(Error::input(format!(
            "--solver {solver}: {name} has every solver but this one"
        )));
    }
    let in_domain = |e: Error| match e {
        Error::Input(text) => Error::input(format!("{name}: {text}")),
        other => other,
    };
    let coarsest = match place.files.is_empty() {
        false => place.coarsest(&place.files)?,
        true => {
            let path = &place.domain.name;
            let there = found(Path::new(path));
            let file = place.domain.is_file().then(|| std::fs::read(there)).transpose();
            let file = file.map_err(|e| match e.kind() {
                ErrorKind::NotFound => place.domain.unknown("--"),
                _ => Error::input(format!("{path}: {e}")),
            })?;
            place.domain.coarsest(file.as_deref(), "--")?
        }
    };
    if let Some(asked) = asked {
        if coarsest.dimension() == 3 {
            return Err(Error::input(format!(
                "{asked} is for domains in the plane; in space, --refine says how fine, and the answer how close"
            )));
        }
        // Where the domain is curved, whether there is a solution is asked of the usual refinement, as for scenes.
        let refine = if coarsest.is_curved() { place.domain.refine } else { Some(0) };
        let domain = DomainSettings { refine, ..place.domain.clone() };
        let problem = stated.on_coarsest(&OnMesh { domain, ..place.clone() }, &coarsest, watch);
        return Ok((problem.map_err(in_domain)?, coarsest));
    }
    check_size(&coarsest, place, *solver, *is_written)?;
    let problem = stated.on_coarsest(place, &coarsest, watch).map_err(in_domain)?;
    Ok((problem, coarsest))
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
fn check_size(mesh: &AnyMesh, place: &OnMesh, solver: Solver, is_written: bool) -> Result<()> {
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
    let times = place.domain.refinements(mesh);
    if fits(&times) {
        return Ok(());
    }
    // The option by which the levels of the domain are chosen.
    let option = |times: usize| match place.domain.cells {
        Some(cells) => format!("--h 1/{}", cells << times),
        None => format!("--refine {times}"),
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
    let asked = if times == 0 { place.domain.name.clone() } else { option(times) };
    Err(Error::input(format!("{asked} {reason}; {remedy}")))
}

/// Returns the cells per side of the coarsest mesh of the cube, and the number of refinements to as many as are asked
/// for.
fn cube(cells: usize) -> Result<[usize; 2]> {
    /// Largest number of cells per side, a power of two aside, of a coarsest mesh that is solved directly.
    const MOST_ODD: usize = 7;
    let odd = |cells: usize| cells >> cells.trailing_zeros();
    if odd(cells) <= MOST_ODD {
        return Ok([odd(cells), cells.trailing_zeros() as usize]);
    }
    let can = |n: &usize| odd(*n) <= MOST_ODD;
    let below = (1..cells).rev().find(can).expect("one cell per side");
    let above = (cells..=2 * cells).find(can).expect("the next power of two");
    Err(Error::input(format!(
        "--h 1/{cells}: on the cube N is a power of two times 1, 3, 5 or 7; the nearest: 1/{below} and 1/{above}"
    )))
}

/// Reads `PART=NUMBERS`: a part of the boundary, and the numbers of the curve on which it lies.
fn curve(text: &str) -> Result<(String, Vec<f64>)> {
    let read = || {
        // A name may have the sign.
        let (part, numbers) = text.rsplit_once('=')?;
        let numbers = numbers.split(',').map(|number| number.trim().parse().ok());
        Some((part.trim().to_owned(), numbers.collect::<Option<_>>()?))
    };
    read().ok_or_else(|| {
        Error::input(format!(
            "--curve {text}: write PART=NUMBERS, e.g. hole=0,0,0.3 for a circle of radius 0.3 around (0, 0)"
        ))
    })
}

/// Returns the quadrature of the load vector that the options ask for: an accuracy concerns the solution for f,
/// whatever load vector a scene takes; with the bilinear rule the bounds are closest, and the grids that they need
/// coarsest.
fn load_rule(args: &SolveArgs) -> Option<LoadRule> {
    args.load.map(|rule| rule.0).or(args.accuracy().map(|_| LoadRule::Bilinear {}))
}

/// Refuses an option that has no use with the solver.
fn check_solver_options(args: &SolveArgs, solver: Solver) -> Result<()> {
    const MULTIGRID: &[Solver] = &[Solver::Multigrid];
    let (nested, on_grids) = (Solver::nested(), Solver::on_grids());
    let options: [(_, _, &[Solver]); 8] = [
        ("--r", args.r.is_some(), &nested),
        ("--stop", args.stop.is_some(), &nested),
        ("--max-iterations", args.max_iterations.is_some(), &nested),
        ("--tolerance", args.tolerance.is_some(), MULTIGRID),
        ("--accuracy", args.accuracy.is_some(), MULTIGRID),
        ("--accuracy-energy", args.accuracy_energy.is_some(), MULTIGRID),
        ("--load", args.load.is_some(), &on_grids),
        ("--recover", args.recover, &on_grids),
    ];
    check_options("--solver", solver, &options)?;
    let of_the_file =
        [("--recover", args.recover), ("--h", args.h.is_some() && solver == Solver::Spectral)];
    match of_the_file.iter().find(|(_, given)| *given && args.out.is_none()) {
        None => Ok(()),
        Some((option, _)) => Err(Error::input(format!(
            "{option} is about the file that --out names; add --out FILE"
        ))),
    }
}

/// Refuses an option about a mesh where there is none, or one about the square on another domain.
fn check_domain_options(args: &SolveArgs, on_mesh: Option<&OnMesh>) -> Result<()> {
    let parts = [
        ("--free", !args.free.is_empty()),
        ("--fixed", !args.fixed.is_empty()),
        ("--curve", !args.curve.is_empty()),
    ];
    let refine = ("--refine", args.refine.is_some());
    let width = ("--h", args.h.is_some());
    let of_the_square = [("--load", args.load.is_some()), ("--recover", args.recover)];
    let (refused, remedy) = match (on_mesh, args.scene.is_some()) {
        // Where the mesh is made, the width has been refused for all domains but the cube.
        (Some(_), false) => {
            (of_the_square.to_vec(), "is for the square; leave it out, or leave out --domain")
        }
        (Some(_), true) => (
            [&parts[..], &[width], &of_the_square].concat(),
            "does not go with the domain of a scene; leave it out, or change the scene",
        ),
        (None, _) => (
            [&parts[..], &[refine]].concat(),
            "is about a mesh; add --domain NAME or --domain FILE, or leave it out",
        ),
    };
    if width.1 && refine.1 {
        return Err(Error::input("--h and --refine both say how fine; leave one of them out"));
    }
    match refused.iter().find(|(_, given)| *given) {
        None => Ok(()),
        Some((option, _)) => Err(Error::input(format!("{option} {remedy}"))),
    }
}

/// Returns the solver if no option names one: that for an accuracy, the paper's for an option that only saddle-point
/// methods take, else that of the scene or the usual one.
fn default_solver(args: &SolveArgs, scene: Option<&Scene>) -> Solver {
    let of_the_paper = args.r.is_some() || args.stop.is_some() || args.max_iterations.is_some();
    match scene.map(|scene| scene.solver) {
        _ if args.accuracy().is_some() => Solver::Multigrid,
        Some(solver) if solver.is_nested() || !of_the_paper => solver,
        None if !of_the_paper => StatedProblem::SOLVER,
        _ => Solver::ArrowHurwicz,
    }
}

/// Returns the accuracy by which the grids are chosen: that of the options or else of the scene, unless an option names
/// a grid, a number of refinements, a tolerance or another solver.
fn accuracy(
    args: &SolveArgs,
    scene: Option<&Scene>,
    solver: Solver,
    overridden: &mut Vec<String>,
) -> Option<Accuracy> {
    let of_scene = scene.and_then(|scene| scene.accuracy);
    if let Some(accuracy) = args.accuracy() {
        return choose(
            "accuracy",
            Some(accuracy),
            of_scene,
            |of| Written::Key.text(*of),
            overridden,
        );
    }
    let is_fine = args.h.is_some() || args.refine.is_some() || args.tolerance.is_some();
    let is_free = !is_fine && solver == Solver::Multigrid;
    if let Some(accuracy) = of_scene.filter(|_| !is_free) {
        overridden.push(format!("without {}", Written::Key.text(accuracy)));
    }
    of_scene.filter(|_| is_free)
}

/// Returns the way in which the accuracy is written: as an option, unless the scene asks for it.
fn written(args: &SolveArgs) -> Written {
    if args.scene.is_some() && args.accuracy().is_none() { Written::Key } else { Written::Option }
}

fn params(
    args: &SolveArgs,
    scene: Option<&SaddleSettings>,
    overridden: &mut Vec<String>,
) -> Result<Params> {
    let r = choose("r", args.r, scene.map(|s| s.draw_r), f64::to_string, overridden);
    let stop = args.stop.as_deref().map(stop_rule).transpose()?;
    let rule = choose("stop", stop, scene.map(|s| s.stop[0]), StopRule::to_string, overridden);
    let given = args.max_iterations.map(|n| n as usize);
    let of_scene = scene.map(|s| s.max_iterations);
    let limit = choose("max-iterations", given, of_scene, usize::to_string, overridden);
    let defaults = Params::default();
    Ok(Params {
        r: positive_r(r.unwrap_or(SaddleSettings::R))?,
        rule: rule.unwrap_or(SaddleSettings::RULE),
        max_iterations: limit.unwrap_or(defaults.max_iterations),
        ..defaults
    })
}

/// Returns the option's value, or else the scene's; adds a difference between the two to `overridden`.
fn choose<T: PartialEq>(
    name: &str,
    option: Option<T>,
    scene: Option<T>,
    show: impl Fn(&T) -> String,
    overridden: &mut Vec<String>,
) -> Option<T> {
    if let (Some(option), Some(scene)) = (&option, &scene)
        && option != scene
    {
        overridden.push(format!("{name} {} instead of {}", show(option), show(scene)));
    }
    option.or(scene)
}

fn stop_rule(name: &str) -> Result<StopRule> {
    StopRule::ALL.into_iter().find(|rule| rule.name() == name).ok_or_else(|| {
        let names = StopRule::ALL.map(StopRule::name).join(", ");
        Error::input(format!("--stop: no rule `{name}`; choose one of {names}"))
    })
}

fn scene(name: &str) -> Result<Scene> {
    let folder = Project::read_scenes(&Project::find(&current_folder()?)?)?;
    let scene = folder.named(name)?.clone();
    scene.check()?;
    Ok(scene)
}

/// Returns nested grids, each half as wide as the one before, down to the finest with as many cells per side: from the
/// `coarsest` grid of the scene on if that is possible, else from the coarsest with at least four cells, or from the
/// finest alone.
fn hierarchy(finest: usize, coarsest: Option<usize>) -> Result<Vec<Grid>> {
    let mut sizes = vec![finest];
    let stop_at = coarsest
        .filter(|&n| finest.is_multiple_of(n) && (finest / n).is_power_of_two())
        .unwrap_or(4);
    while sizes[0].is_multiple_of(2) && sizes[0] / 2 >= stop_at {
        sizes.insert(0, sizes[0] / 2);
    }
    nested(&sizes).map_err(|e| Error::input(e.to_string()))
}

/// Returns the grid with as many cells per side.
fn grid(cells: usize) -> Result<Grid> {
    Grid::new(cells).map_err(|e| Error::input(e.to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sizes(finest: usize, coarsest: Option<usize>) -> Vec<usize> {
        hierarchy(finest, coarsest).unwrap().iter().map(|grid| grid.cells()).collect()
    }

    #[test]
    fn hierarchies_halve_down_to_an_odd_or_small_grid_or_to_the_scenes() {
        assert_eq!(sizes(64, None), [4, 8, 16, 32, 64]);
        assert_eq!(sizes(12, None), [6, 12]);
        assert_eq!(sizes(7, None), [7]);
        assert!(hierarchy(1, None).is_err());
        assert_eq!(sizes(32, Some(16)), [16, 32]);
        assert_eq!(sizes(128, Some(16)), [16, 32, 64, 128]);
        assert_eq!(sizes(24, Some(16)), [6, 12, 24]);
    }
}
