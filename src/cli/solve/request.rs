//! Request of `solve`: the problem, the solver and its settings.

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
use crate::replication::domain::DomainSettings;
use crate::replication::project::Project;
use crate::replication::saddle::{self, positive_r};
use crate::replication::scene::Scene;
use crate::replication::stated::{OnMesh, OnSquare, Place, StatedProblem};
use crate::replication::written::{Written, option};
use crate::timing::machine;
use serde_json::{Value, json};
use signorini_mathematics::bounds::Accuracy;
use signorini_mathematics::discrete::grid::{Grid, nested};
use signorini_mathematics::discrete::load::LoadRule;
use signorini_mathematics::levels::{Levels, Problem, Watch};
use signorini_mathematics::mesh::AnyMesh;
use signorini_mathematics::problem::law::Law;
use signorini_mathematics::saddle::{Pair, Params, StopRule};
use signorini_mathematics::solvers::{Memory, Refusal, Solved, Solver, Watcher};
use signorini_mathematics::statement::{Fineness, SaddleSettings, Statement};
use std::io::ErrorKind;
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
    /// Remedies in the words of the options that the domain has.
    pub remedies: Remedies,
    /// Statement of the options or of the scene.
    pub statement: Statement,
    /// Way in which the accuracy is written.
    pub written: Written,
    /// True for a scene of a published table.
    is_papers: bool,
    /// Options that differ from the scene, in words.
    pub overridden: Vec<String>,
    /// Warnings of f that are printed already.
    pub warnings: Vec<String>,
    /// Memory that is left, and the files for which some of it is needed.
    memory: Memory,
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
    /// Reads and checks the arguments; returns the problem as well, for an accuracy the one with which it begins.
    pub(super) fn read(args: &SolveArgs) -> Result<(Self, Problem)> {
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
        let memory = Memory::new(machine::available_memory());
        let memory = if args.out.is_some() { memory.with_files(args.recover) } else { memory };
        let (domain, problem, remedies) = match &stated.place {
            Place::Square(square) => {
                check_domain_options(args, None)?;
                let cells = square.finest().cells();
                let asked = match accuracy {
                    Some(accuracy) => format!("{}: grid 1/{cells}", written(args).text(accuracy)),
                    None => format!("--h 1/{cells}"),
                };
                let fits = memory.check_grid(solver, cells);
                fits.map_err(|e| Error::input(e.on_grid(&asked)))?;
                clock.ended(Part::Setup);
                let problem = stated.problem(&InputFiles::new())?;
                clock.ended(Part::Load);
                ("square", problem, Remedies::ON_THE_SQUARE)
            }
            Place::Mesh(place) => {
                check_domain_options(args, Some(place))?;
                let name = args.scene.as_deref().unwrap_or(&place.domain.name);
                let asked = accuracy.map(|accuracy| written(args).text(accuracy));
                if let Some(asked) = &asked {
                    place.domain.check_adapted(asked, "--")?;
                }
                let wanted = Wanted { solver, asked, memory };
                let problem =
                    on_mesh(name, (&stated, place), &wanted, &|step| clock.ended_step(step))?;
                let domain = stated.file_name().unwrap_or(&place.domain.name);
                (domain, problem, Remedies::ON_MESHES)
            }
        };
        let name = args.scene.as_deref().unwrap_or(domain).to_owned();
        let title = match (scene, stated.file_name()) {
            (Some(scene), _) => scene.title.clone(),
            (None, Some(file)) => file.to_owned(),
            (None, None) => problem.levels().f(),
        };
        let usual = if stated.square().is_some() { PictureKind::Surface } else { PictureKind::Map };
        let warnings = warn_of_outside(args.scene.as_deref(), &problem.levels().outside());
        let settings = scene.and_then(|scene| scene.settings.as_ref());
        let Params { r, rule: stop, max_iterations, .. } = params(args, settings, &mut overridden)?;
        let prolongation = settings.map(|settings| settings.prolongation).unwrap_or_default();
        let saddle = SaddleSettings { prolongation, r, stop, max_iterations };
        let statement = Statement {
            tolerance: args.tolerance()?,
            ..stated.statement(solver, accuracy, solver.is_nested().then_some(saddle))
        };
        let request = Self {
            name,
            scene: args.scene.clone(),
            title,
            view: args.view().unwrap_or(usual),
            remedies,
            statement,
            written: written(args),
            is_papers: scene.is_some_and(|scene| scene.paper_table.is_some()),
            overridden,
            warnings,
            memory,
            clock,
        };
        Ok((request, problem))
    }

    /// Solves, without an answer in words; for an accuracy the watcher is shown each grid or mesh.
    pub(super) fn solved(&self, problem: Problem, watcher: &mut dyn Watcher) -> Result<Solved> {
        let Self { statement, written, .. } = self;
        if let Some(accuracy) = statement.accuracy() {
            written.check(accuracy)?;
        }
        let steps = |step| self.clock.ended_step(step);
        let solved = statement.solve(problem, self.memory, watcher, &steps);
        let solved = solved.map_err(|e| self.refused(&e))?;
        self.check_diverged(&solved)?;
        if let (Some(accuracy), Some(reached), true) =
            (statement.accuracy(), &solved.reached, statement.domain.is_square())
        {
            written.check_end(accuracy, reached.end)?;
        }
        Ok(solved)
    }

    /// Refuses values that are not finite.
    fn check_diverged(&self, solved: &Solved) -> Result<()> {
        let (name, solver) = (&self.name, self.statement.solver);
        let Some(last) = solved.ends().last().filter(|last| last.end.has_diverged()) else {
            return Ok(());
        };
        let first = solved.run().map_or(0, |run| run.first_level);
        let grid = solved.problem.levels().name(first + solved.ends().len() - 1);
        Err(Error::Stage(vec![match solver.is_nested() {
            true => format!(
                "{name}: {solver} diverged on {grid} after {} iterations; choose a smaller r or scale f down",
                last.end.iterations
            ),
            false => format!("{name}: the solver diverged; scale f down"),
        }]))
    }

    /// Writes a file with a solution on the finest of these levels.
    pub(super) fn write(
        &self,
        (file, format): &(OutputFile, Format),
        (levels, law): (&dyn Levels, Law),
        pair: &Pair,
    ) -> Result<()> {
        let Self { name, title, view, .. } = self;
        let solution = Solution { levels, name, title, view: *view, law, pair };
        let written = solution.file(*format).and_then(|bytes| file.write(&bytes));
        self.clock.ended(Part::Files);
        written
    }

    /// Part of the integral of |f| by which the load of a problem moves jumps of f; none for a published table, whose
    /// load is the paper's.
    pub(super) fn moved_jumps(&self, problem: &Problem) -> Option<f64> {
        if self.is_papers { None } else { problem.moved_jumps() }
    }

    /// Width of the finest level: of the square and the cube that of their cells, on other meshes the longest edge.
    pub(super) fn width(&self, problem: &Problem) -> f64 {
        match self.statement.fineness {
            Fineness::Width(cells) => 1.0 / cells as f64,
            _ => problem.levels().width(),
        }
    }

    /// Returns, on a mesh, how fine it is after so many refinements.
    pub(super) fn refined(&self, times: usize) -> Option<String> {
        if let Fineness::Width(cells) = self.statement.fineness {
            return Some(format!("h 1/{cells}"));
        }
        (!self.statement.domain.is_square()).then(|| match times {
            0 => "not refined".into(),
            1 => "refined once".into(),
            _ => format!("refined {times} times"),
        })
    }

    /// Returns advice for a smaller residual; each option in it goes with those that are given.
    pub(super) fn closer(&self) -> Remedy {
        const MULTIGRID: &str = "--solver multigrid";
        let Statement { solver, saddle, tolerance, .. } = self.statement;
        match (solver, saddle.map(|settings| settings.stop)) {
            (Solver::Multigrid, _) if self.statement.accuracy().is_some() => {
                Remedy::new("ask for a smaller accuracy", "")
            }
            (Solver::Multigrid, _) if tolerance.is_some() => {
                Remedy::new("ask for a smaller --tolerance", "")
            }
            (Solver::Multigrid, _) => Remedy::new("use --solver active-set", "--solver active-set"),
            (_, Some(StopRule::PrintedDual)) => Remedy::new("use --solver multigrid", MULTIGRID),
            (_, Some(_)) => {
                Remedy::new("use --stop printed-dual, or --solver multigrid", MULTIGRID)
            }
            _ => Remedy::new("use --solver multigrid", MULTIGRID),
        }
    }

    /// Returns advice after a limit on iterations.
    pub(super) fn after_limit(&self) -> Remedy {
        if self.statement.solver.is_nested() {
            let words = "raise --max-iterations, or use --solver multigrid";
            return Remedy::new(words, "--solver multigrid");
        }
        self.remedies.limit.unwrap_or_else(|| self.closer())
    }

    /// Returns the settings, by name, on which the answer depends besides f, the solver and the levels.
    pub(super) fn settings(&self, law: Law) -> Vec<(&'static str, Value)> {
        let Statement { load, saddle, tolerance, .. } = self.statement;
        let mut settings = Vec::new();
        if !law.is_signorini() {
            settings.push(("law", law.to_string().into()));
        }
        settings.extend(load.map(|rule| ("load", rule_name(&rule).into())));
        if let Some(SaddleSettings { prolongation, r, stop, max_iterations }) = saddle {
            settings.push(("r", r.into()));
            settings.push(("stop", stop.name().into()));
            settings.push(("max_iterations", max_iterations.into()));
            settings.extend(load.map(|_| ("prolongation", json!(prolongation))));
        }
        settings.extend(tolerance.map(|tolerance| ("tolerance", tolerance.into())));
        let accuracy = self.statement.accuracy();
        settings.extend(accuracy.map(|of| (option(of), of.wanted().into())));
        settings
    }

    /// Returns the message that no nodal vector solves the discrete problem on the level with this name, for a load
    /// vector with this sum.
    pub(super) fn without_solution(&self, level: &str, sum_load: f64) -> Warning {
        let [papers, others] = self.remedies.unbalanced;
        let remedy = if self.statement.law.is_none() { papers } else { others };
        let (name, sum_load) = (&self.name, signed(sum_load, 4));
        let fact = format!(
            "{name}: the load vector sums to {sum_load} on {level}, where the discrete problem has no solution"
        );
        Warning::new(fact, Remedy::new(remedy, ""))
    }

    fn refused(&self, refusal: &Refusal) -> Error {
        if let Some(error) = self.written.refused(&self.statement, refusal) {
            return error;
        }
        let place = self.scene.as_deref().unwrap_or("--f");
        match refusal {
            // The integral of f has been judged before.
            Refusal::Unbalanced { level, sum_load, .. } => {
                Error::Stage(vec![self.without_solution(level, *sum_load).sentence()])
            }
            Refusal::GridSize(e) => Error::input(format!("--h: {e}")),
            Refusal::NotOnMeshes(solver) => {
                Error::input(format!("--solver {solver} is for the square; choose another solver"))
            }
            Refusal::Spectral(e) if e.is_of_input() => {
                Error::input(format!("{}: {e}; use --solver multigrid, or change f", self.name))
            }
            Refusal::Spectral(e) => {
                let more = if e.is_of_touch() { " --accuracy-energy 1e-6" } else { "" };
                Error::Stage(vec![format!("{}: {e}; use --solver multigrid{more}", self.name)])
            }
            _ => Error::input(format!("{place}: {refusal}; check f")),
        }
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
    memory: Memory,
}

/// Returns the problem on a mesh that is read from its file, if it is not built in.
/// An accuracy begins with that mesh. `watch` is told when the mesh is made, and when f is integrated on it.
fn on_mesh(
    name: &str,
    (stated, place): (&StatedProblem, &OnMesh),
    Wanted { solver, asked, memory }: &Wanted,
    watch: Watch<'_>,
) -> Result<Problem> {
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
        return problem.map_err(in_domain);
    }
    check_size(&coarsest, place, *solver, *memory)?;
    stated.on_coarsest(place, &coarsest, watch).map_err(in_domain)
}

/// Refuses refinements that take more memory than there is, or more nodes than the solver can do with.
fn check_size(mesh: &AnyMesh, place: &OnMesh, solver: Solver, memory: Memory) -> Result<()> {
    let times = place.domain.refinements(mesh);
    let Err(too_large) = memory.check_mesh(solver, mesh, times) else { return Ok(()) };
    // The option by which the levels of the domain are chosen.
    let option = |times: usize| match place.domain.cells {
        Some(cells) => format!("--h 1/{}", cells << times),
        None => format!("--refine {times}"),
    };
    let remedy = match too_large.fits {
        Some(times) => format!("{} would fit", option(times)),
        None if too_large.is_of_memory() => "begin with a coarser mesh and --refine".into(),
        None => "choose another solver, or begin with a coarser mesh".into(),
    };
    // A mesh that is not refined is the file's own.
    let asked = if times == 0 { place.domain.name.clone() } else { option(times) };
    Err(Error::input(format!("{asked} {too_large}; {remedy}")))
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
    scene: Option<&saddle::SaddleSettings>,
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
        r: positive_r(r.unwrap_or(saddle::SaddleSettings::R))?,
        rule: rule.unwrap_or(saddle::SaddleSettings::RULE),
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
