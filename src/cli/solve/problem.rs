//! Problem of `solve`: f and its domain, the grids, the solver and its settings.

use super::accuracy::Accuracy;
use super::domain::Domain;
use super::format::{Format, ReportedAs};
use super::mesh::MeshDomain;
use super::{SolveArgs, Solver, cells, rule_name};
use crate::cli::current_folder;
use crate::cli::output::{check_options, warn_of_outside};
use crate::pipeline::error::{Error, Result};
use crate::replication::project::Project;
use crate::replication::scene::{Scene, positive_r};
use crate::timing::machine;
use serde_json::{Value, json};
use signorini_mathematics::discrete::grid::nested;
use signorini_mathematics::discrete::load::{LoadRule, integrals};
use signorini_mathematics::discrete::transfer::Prolongation;
use signorini_mathematics::problem::law::Law;
use signorini_mathematics::problem::source::Source;
use signorini_mathematics::saddle::{Pair, Params, StopRule};

/// Cells per side of the finest grid, if neither the user nor a scene gives a number.
const DEFAULT_CELLS: usize = 64;

/// Data that determine an answer.
pub(super) struct Problem {
    /// Name of the scene, if f is that of a scene.
    pub scene: Option<String>,
    pub domain: Domain,
    /// Law on the boundary.
    pub law: Law,
    /// Integral of f.
    pub integral: f64,
    pub solver: Solver,
    /// Cells per side, or refinements, of the nested grids, coarsest first; only the saddle-point methods use more than the last.
    pub grids: Vec<usize>,
    /// Parameters of the saddle-point methods, but the tolerance, which depends on the grid.
    pub params: Params,
    pub prolongation: Prolongation,
    /// Tolerance of multigrid, relative to the load; `None` for the rounding floor.
    pub tolerance: Option<f64>,
    /// Guaranteed bound of the error, by which the grids are chosen.
    pub accuracy: Option<Accuracy>,
    /// Options that differ from the scene, in words.
    pub overridden: Vec<String>,
    /// Warnings of f that are printed already.
    pub warnings: Vec<String>,
    /// Memory per node for writing the solution, besides that of the solver.
    bytes_to_write: u64,
}

impl Problem {
    /// Reads and checks the arguments.
    pub(super) fn read(args: &SolveArgs) -> Result<Self> {
        let scene = args.scene.as_deref().map(scene).transpose()?;
        let scene = scene.as_ref();
        let mut overridden = Vec::new();
        let law = law(args, scene)?;
        let domain = domain(args, scene, law, &mut overridden)?;
        let warnings = warn_of_outside(args.scene.as_deref(), &domain.outside());
        let integral = domain.solvable(law)?;
        let solver = args.solver.unwrap_or(default_solver(args));
        check_solver_options(args, solver)?;
        check_mesh_options(args, &domain)?;
        let given = args.h.as_deref().map(cells).transpose()?;
        let of_scene = scene.filter(|s| s.domain.is_none()).map(|s| s.finest().cells());
        let finest = choose("finest grid", given, of_scene, |n| format!("1/{n}"), &mut overridden)
            .unwrap_or(DEFAULT_CELLS);
        let grids = match &domain {
            Domain::Mesh(mesh) => (0..mesh.problem.levels.len()).collect(),
            Domain::Square { .. } => hierarchy(finest, scene)?,
        };
        let params = params(args, scene, &mut overridden)?;
        let problem = Self {
            scene: scene.map(|scene| scene.name.clone()),
            solver,
            grids,
            params,
            prolongation: scene.map(|scene| scene.prolongation).unwrap_or_default(),
            tolerance: args.tolerance()?,
            accuracy: args.accuracy(),
            overridden,
            warnings,
            // Measured: a file's fields, and the recovered solution on four times as many nodes.
            bytes_to_write: if args.recover { 176 } else { 24 * u64::from(args.out.is_some()) },
            integral,
            law,
            domain,
        };
        problem.check_memory()?;
        Ok(problem)
    }

    /// Refuses a solver that the domain does not have, or that would take too much memory on the finest grid.
    pub(super) fn check_memory(&self) -> Result<()> {
        let (solver, finest) = (self.solver, self.finest());
        let most = self.domain.most_cells(solver)?;
        let asked = match self.accuracy {
            Some(accuracy) => format!("{accuracy}: grid 1/{finest}"),
            None if matches!(self.domain, Domain::Mesh(_)) => return Ok(()),
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
        let dimension = self.domain.dimension();
        let per_node = (self.solver.entry().bytes_per_node)(n as u64) + self.bytes_to_write;
        (n as u64 + 1).pow(dimension.into()) * per_node
    }

    /// Returns the bytes of a file with a solution on a grid.
    pub(super) fn file(&self, kind: Format, n: usize, pair: &Pair) -> Result<Vec<u8>> {
        let reported = ReportedAs { name: self.name(), law: self.law };
        self.domain.file(kind, n, pair, reported)
    }

    /// Number of the finest grid: cells per side, or refinements.
    pub(super) fn finest(&self) -> usize {
        self.grids[self.grids.len() - 1]
    }

    pub(super) fn name(&self) -> &str {
        match &self.domain {
            Domain::Mesh(mesh) => &mesh.name,
            Domain::Square { .. } => self.scene.as_deref().unwrap_or("custom"),
        }
    }

    /// Returns advice for a smaller residual; each option in it goes with those that are given.
    pub(super) fn closer(&self) -> &'static str {
        match (self.solver, self.params.rule) {
            (Solver::Multigrid, _) if self.accuracy.is_some() => "ask for a smaller accuracy",
            (Solver::Multigrid, _) if self.tolerance.is_some() => "ask for a smaller --tolerance",
            (Solver::Multigrid, _) => "use --solver active-set",
            (solver, StopRule::PrintedDual) if solver.is_nested() => "use --solver multigrid",
            (solver, _) if solver.is_nested() => "use --stop printed-dual, or --solver multigrid",
            _ => "use --solver multigrid",
        }
    }

    /// Returns the settings, by name, on which the answer depends besides f, the solver and the grids.
    pub(super) fn settings(&self) -> Vec<(&'static str, Value)> {
        let mut settings = Vec::new();
        if !self.law.is_signorini() {
            settings.push(("law", self.law.to_string().into()));
        }
        if let Domain::Square { rule, .. } = &self.domain {
            settings.push(("load", rule_name(rule).into()));
        }
        if self.solver.is_nested() {
            let Params { r, rule, max_iterations, .. } = self.params;
            settings.push(("r", r.into()));
            settings.push(("stop", rule.name().into()));
            settings.push(("max_iterations", max_iterations.into()));
            if !matches!(self.domain, Domain::Mesh(_)) {
                settings.push(("prolongation", json!(self.prolongation)));
            }
        }
        settings.extend(self.tolerance.map(|tolerance| ("tolerance", tolerance.into())));
        settings.extend(self.accuracy.map(|of| (of.option(), of.wanted().into())));
        settings
    }
}

/// Refuses an option that has no use with the solver.
fn check_solver_options(args: &SolveArgs, solver: Solver) -> Result<()> {
    const MULTIGRID: &[Solver] = &[Solver::Multigrid];
    let options: [(_, _, &[Solver]); 8] = [
        ("--r", args.r.is_some(), Solver::NESTED),
        ("--stop", args.stop.is_some(), Solver::NESTED),
        ("--max-iterations", args.max_iterations.is_some(), Solver::NESTED),
        ("--tolerance", args.tolerance.is_some(), MULTIGRID),
        ("--accuracy", args.accuracy.is_some(), MULTIGRID),
        ("--accuracy-energy", args.accuracy_energy.is_some(), MULTIGRID),
        ("--load", args.load.is_some(), &Solver::ON_GRIDS),
        ("--recover", args.recover, &Solver::ON_GRIDS),
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

/// Refuses an option about a mesh where there is none, or one about the square on the domain of a scene.
fn check_mesh_options(args: &SolveArgs, domain: &Domain) -> Result<()> {
    let parts = [
        ("--free", !args.free.is_empty()),
        ("--fixed", !args.fixed.is_empty()),
        ("--curve", !args.curve.is_empty()),
    ];
    let refine = ("--refine", args.refine.is_some());
    let of_the_square = [
        ("--h", args.h.is_some()),
        ("--load", args.load.is_some()),
        ("--accuracy", args.accuracy.is_some()),
        ("--accuracy-energy", args.accuracy_energy.is_some()),
        ("--recover", args.recover),
    ];
    let on_mesh = matches!(domain, Domain::Mesh(_));
    let (refused, remedy) = match (on_mesh, args.scene.is_some()) {
        // The width of the cube is judged where its mesh is made.
        (true, false) => {
            (of_the_square[1..].to_vec(), "is for the square; leave it out, or leave out --domain")
        }
        (true, true) => (
            [&parts[..], &of_the_square].concat(),
            "does not go with the domain of a scene; leave it out, or change the scene",
        ),
        (false, _) => (
            [&parts[..], &[refine]].concat(),
            "is about a mesh; add --domain NAME or --domain FILE, or leave it out",
        ),
    };
    match refused.iter().find(|(_, given)| *given) {
        None => Ok(()),
        Some((option, _)) => Err(Error::input(format!("{option} {remedy}"))),
    }
}

fn domain(
    args: &SolveArgs,
    scene: Option<&Scene>,
    law: Law,
    overridden: &mut Vec<String>,
) -> Result<Domain> {
    if let Some(mesh) = MeshDomain::read(args, scene, law, overridden)? {
        return Ok(Domain::Mesh(Box::new(mesh)));
    }
    let f: Source = match (&args.f, scene) {
        (Some(text), _) => text.parse().map_err(|e| Error::input(format!("--f: {e}")))?,
        (None, Some(scene)) => scene.f.clone(),
        (None, None) => return Err(Error::input("give a scene or --f")),
    };
    // An accuracy concerns the solution for f, whatever load vector a scene takes; with the bilinear rule the bounds are
    // closest, and the grids that they need coarsest.
    let given = args.load.map(|rule| rule.0).or(args.accuracy().map(|_| LoadRule::Bilinear {}));
    let rule = choose("load", given, scene.map(|s| s.load), rule_name, overridden);
    let (rule, integrals) = (rule.unwrap_or(LoadRule::Bilinear {}), integrals(&f));
    Ok(Domain::Square { f, rule, integrals })
}

/// Returns the default solver: the paper's method for a scene or with an option that only this method takes, else
/// multigrid.
fn default_solver(args: &SolveArgs) -> Solver {
    let of_the_paper = args.r.is_some() || args.stop.is_some() || args.max_iterations.is_some();
    if args.accuracy().is_none() && (args.scene.is_some() || of_the_paper) {
        Solver::ArrowHurwicz
    } else {
        Solver::Multigrid
    }
}

/// Returns the law of the scene, or else that of the options.
fn law(args: &SolveArgs, scene: Option<&Scene>) -> Result<Law> {
    scene.map_or_else(|| args.law(), |scene| Ok(scene.law()))
}

fn params(args: &SolveArgs, scene: Option<&Scene>, overridden: &mut Vec<String>) -> Result<Params> {
    let r = choose("r", args.r, scene.map(Scene::drawn_r), f64::to_string, overridden);
    let stop = args.stop.as_deref().map(stop_rule).transpose()?;
    let rule = choose("stop", stop, scene.map(|s| s.stop[0]), StopRule::to_string, overridden);
    let given = args.max_iterations.map(|n| n as usize);
    let of_scene = scene.map(|s| s.max_iterations);
    let limit = choose("max-iterations", given, of_scene, usize::to_string, overridden);
    let defaults = Params::default();
    Ok(Params {
        r: positive_r(r.unwrap_or(10.0))?,
        rule: rule.unwrap_or(StopRule::Printed),
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
    scene.check_domain()?;
    Ok(scene)
}

/// Returns the cells per side of nested grids, each half as wide as the one before, down to the finest: from the
/// coarsest grid of the scene on if that is possible, else from the coarsest with at least four cells, or from the finest
/// alone.
fn hierarchy(finest: usize, scene: Option<&Scene>) -> Result<Vec<usize>> {
    let mut sizes = vec![finest];
    let coarsest = scene.map(|scene| scene.grids[0].cells());
    let stop_at = coarsest
        .filter(|&n| finest.is_multiple_of(n) && (finest / n).is_power_of_two())
        .unwrap_or(4);
    while sizes[0].is_multiple_of(2) && sizes[0] / 2 >= stop_at {
        sizes.insert(0, sizes[0] / 2);
    }
    nested(&sizes).map_err(|e| Error::input(e.to_string()))?;
    Ok(sizes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hierarchies_halve_down_to_an_odd_or_small_grid_or_to_the_scenes() {
        assert_eq!(hierarchy(64, None).unwrap(), [4, 8, 16, 32, 64]);
        assert_eq!(hierarchy(12, None).unwrap(), [6, 12]);
        assert_eq!(hierarchy(7, None).unwrap(), [7]);
        assert!(hierarchy(1, None).is_err());
        let text = "title = \"t\"\nf = \"else=-1\"\ngrids = [16, 32]\noutputs = []\n";
        let scene = Scene::parse("s", text).unwrap();
        assert_eq!(hierarchy(32, Some(&scene)).unwrap(), [16, 32]);
        assert_eq!(hierarchy(128, Some(&scene)).unwrap(), [16, 32, 64, 128]);
        assert_eq!(hierarchy(24, Some(&scene)).unwrap(), [6, 12, 24]);
    }
}
