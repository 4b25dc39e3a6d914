//! `solve`: one problem, once, without scene files, cache or book.

use super::{current_folder, say, say_json};
use crate::error::{Error, IoContext, Result};
use crate::fast::active_set::{ActiveSetParams, active_set};
use crate::fast::multigrid::{MultigridParams, multigrid};
use crate::fast::{self, InputError};
use crate::fields;
use crate::grid::{Grid, nested};
use crate::kkt::{Kkt, kkt};
use crate::load::{LoadRule, load};
use crate::norms::{Errors, errors};
use crate::project::Project;
use crate::saddle::{
    self, Outcome, Pair, Params, ProximalParams, StopRule, UzawaOutcome, UzawaParams, on_nested,
    solve_nested, tolerance, uzawa, uzawa_proximal,
};
use crate::scene::{MAX_CELLS, Scene, positive_r, solvable};
use crate::source::Source;
use crate::stiffness::{energy, residual};
use crate::transfer::Prolongation;
use clap::{Args, ValueEnum};
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Arguments of `solve`.
#[derive(Args)]
pub(super) struct SolveArgs {
    /// A scene of the project, whose f, load rule and grids are taken
    #[arg(required_unless_present = "f")]
    scene: Option<String>,
    /// The right-hand side, e.g. 'rect(-0.25,0.25,-0.25,0.25)=1.5; else=-1'
    #[arg(long, conflicts_with = "scene")]
    f: Option<String>,
    /// Width of the finest grid, e.g. 1/256 [default: the scene's finest, or 1/64]
    #[arg(long, value_name = "1/N")]
    h: Option<String>,
    /// Solver
    #[arg(long, value_enum, default_value_t = Solver::ArrowHurwicz)]
    solver: Solver,
    /// Quadrature of the load vector [default: the scene's, or nodal]
    #[arg(long, value_enum)]
    load: Option<LoadName>,
    /// Duality parameter
    #[arg(long, default_value_t = 10.0)]
    r: f64,
    /// Stopping rule: signed (as in the tables), printed (as in (13)), signed-dual, printed-dual
    #[arg(long, default_value = "printed")]
    stop: String,
    /// Cap on iterations per grid; for the Uzawa solvers, on sweeps
    #[arg(long, value_name = "N", default_value_t = Params::default().max_iterations)]
    max_iterations: usize,
    /// Print JSON
    #[arg(long)]
    json: bool,
    /// Write the solution: .vti for ParaView, .npy for NumPy, .svg for a picture
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Solver {
    /// The paper's method on nested grids
    ArrowHurwicz,
    /// A full minimisation before each step of the multiplier, on nested grids
    Uzawa,
    /// The same with iterative proximal regularisation
    UzawaProximal,
    /// Full multigrid to the rounding floor: the fastest by far
    Multigrid,
    /// Primal-dual active set with sparse Cholesky factors: slow, independent, exact
    ActiveSet,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum LoadName {
    /// f at the nodes; on a jump from the left and below
    Nodal,
    /// Integrals of f times the hat functions
    Exact,
    /// Mean of f around each node
    LumpedAverage,
}

impl From<LoadName> for LoadRule {
    fn from(name: LoadName) -> Self {
        match name {
            LoadName::Nodal => Self::default(),
            LoadName::Exact => Self::Exact { diagonal: crate::load::Diagonal::Rising },
            LoadName::LumpedAverage => Self::LumpedAverage,
        }
    }
}

pub(super) fn solve(args: &SolveArgs) -> Result<u8> {
    let scene = match &args.scene {
        Some(name) => Some(scene(name)?),
        None => None,
    };
    let f: Source = match (&scene, &args.f) {
        (Some(scene), _) => scene.f.clone(),
        (None, Some(text)) => text.parse().map_err(|e| Error::input(format!("--f: {e}")))?,
        (None, None) => return Err(Error::input("give a scene or --f")),
    };
    let integral = solvable(&f)?;
    let finest = match (&args.h, &scene) {
        (Some(h), _) => cells(h)?,
        (None, Some(scene)) => scene.finest().cells(),
        (None, None) => 64,
    };
    let rule = args.load.map(LoadRule::from).or(scene.as_ref().map(|s| s.load)).unwrap_or_default();
    let stop =
        StopRule::ALL.into_iter().find(|rule| rule.name() == args.stop).ok_or_else(|| {
            let names = StopRule::ALL.map(StopRule::name).join(", ");
            Error::input(format!("--stop: no rule `{}`; choose one of {names}", args.stop))
        })?;
    if let Some(out) = &args.out {
        fields::check_ending(out)?;
    }

    let name = scene.as_ref().map_or("custom", |scene| &scene.name);
    let problem = Problem { name, f: &f, rule, finest };
    let solved = match args.solver {
        Solver::ArrowHurwicz | Solver::Uzawa | Solver::UzawaProximal => {
            let params = Params {
                r: positive_r(args.r)?,
                rule: stop,
                max_iterations: args.max_iterations,
                ..Params::default()
            };
            problem.saddle(args.solver, &params)?
        }
        Solver::Multigrid => problem.multigrid()?,
        Solver::ActiveSet => problem.active_set()?,
    };
    let grid = solved.grid;
    if let Some(out) = &args.out {
        let bytes = fields::write(out, grid, &solved.pair, name)?;
        std::fs::write(out, bytes).context("write", out)?;
    }
    let last = solved.levels.last().expect("at least one grid");
    let solver = args.solver.to_possible_value().expect("no solver is hidden");
    if args.json {
        let mut json = serde_json::json!({
            "schema": 1,
            "scene": name,
            "f": f.to_string(),
            "solver": solver.get_name(),
            "h": grid.h(),
            "unknowns": grid.nodes(),
            "iterations": last.iterations,
            "iterations_per_grid": solved.levels.iter().map(|o| o.iterations).collect::<Vec<_>>(),
            "stop": last.stop,
            "energy": last.energy,
            "integral_f": integral,
            "sum_load": last.sum_load,
            "kkt": last.kkt,
            "seconds": { "setup": solved.setup, "solve": solved.seconds },
        });
        let sweeps: Vec<_> = solved.levels.iter().filter_map(|o| o.sweeps).collect();
        if let Some(last) = sweeps.last() {
            json["sweeps"] = (*last).into();
            json["sweeps_per_grid"] = sweeps.into();
        }
        if let Some(work_units) = solved.work_units {
            json["work_units"] = work_units.into();
        }
        if let Some(errors) = solved.errors {
            json["errors"] = serde_json::json!({
                "l2": errors.l2, "h1": errors.h1, "max": errors.max, "multiplier_l2": errors.multiplier_l2,
            });
        }
        return say_json(&json);
    }
    say(&text(&problem, integral, &solved, args.out.as_deref()))
}

/// What is to be solved.
struct Problem<'a> {
    name: &'a str,
    f: &'a Source,
    rule: LoadRule,
    /// Cells per side.
    finest: usize,
}

/// What came out.
struct Solved {
    /// The finest grid.
    grid: Grid,
    pair: Pair,
    /// One entry per grid on which the solver stopped, coarsest first.
    levels: Vec<Level>,
    /// Cost in sweeps of the finest grid, if the solver counts it.
    work_units: Option<f64>,
    /// Errors, if the solution is known.
    errors: Option<Errors>,
    /// Seconds for grids and load vectors.
    setup: f64,
    /// Seconds for the solver.
    seconds: f64,
}

/// How a solver stopped on one grid.
struct Level {
    cells: usize,
    iterations: usize,
    /// Gauss-Seidel sweeps, if they are what the solver does.
    sweeps: Option<usize>,
    stop: String,
    energy: f64,
    sum_load: f64,
    kkt: Kkt,
}

impl Problem<'_> {
    fn load(&self, grid: Grid) -> Vec<f64> {
        load(grid, self.f, self.rule)
    }

    fn saddle(&self, solver: Solver, params: &Params) -> Result<Solved> {
        let start = Instant::now();
        let grids = hierarchy(self.finest)?;
        let loads: Vec<_> = grids.iter().map(|&grid| self.load(grid)).collect();
        let setup = start.elapsed().as_secs_f64();
        let start = Instant::now();
        let (outcomes, pair) = on_saddle(solver, &grids, &loads, params);
        let seconds = start.elapsed().as_secs_f64();
        if let Some(o) =
            outcomes.last().map(|o| o.end).filter(|o| o.stop == saddle::StopReason::Diverged)
        {
            return Err(Error::Stage(vec![format!(
                "{} diverged on grid 1/{} after {} iterations; choose a smaller r or scale f down",
                self.name, o.cells, o.iterations
            )]));
        }
        let levels = outcomes
            .iter()
            .map(|&UzawaOutcome { end: o, sweeps }| Level {
                cells: o.cells,
                iterations: o.iterations,
                sweeps: Some(sweeps),
                stop: o.stop.to_string(),
                energy: o.energy,
                sum_load: o.sum_load,
                kkt: o.kkt,
            })
            .collect();
        let (grid, load) = (grids[grids.len() - 1], &loads[loads.len() - 1]);
        let errors = self.errors(grid, &pair.y, load);
        Ok(Solved { grid, pair, levels, work_units: None, errors, setup, seconds })
    }

    fn multigrid(&self) -> Result<Solved> {
        self.fast(|grid, load| {
            let params = MultigridParams::default();
            let (y, outcome) = multigrid(grid.cells(), load, None, &params, |_| ())?;
            Ok((y, outcome.cycles, outcome.stop, Some(outcome.work_units)))
        })
    }

    fn active_set(&self) -> Result<Solved> {
        if self.finest > MAX_DIRECT {
            return Err(Error::input(format!(
                "active-set factorises a matrix, which at h = 1/{} takes too much memory; use --solver multigrid, or h = 1/{MAX_DIRECT}",
                self.finest
            )));
        }
        self.fast(|grid, load| {
            let params = ActiveSetParams::default();
            let (y, outcome) = active_set(grid.cells(), load, None, &params, |_| ())?;
            Ok((y, outcome.steps, outcome.stop, None))
        })
    }

    /// Runs a solver that works on the finest grid alone; it returns y, steps, why it stopped, and work units.
    fn fast(&self, solver: impl Fn(Grid, &[f64]) -> FastResult) -> Result<Solved> {
        let start = Instant::now();
        let grid = Grid::new(self.finest).map_err(|e| Error::input(e.to_string()))?;
        let load = self.load(grid);
        let setup = start.elapsed().as_secs_f64();
        let start = Instant::now();
        let (y, iterations, stop, work_units) = solver(grid, &load).map_err(|e| {
            let remedy = match e {
                InputError::NotCoercive(_) => {
                    "average f on its jumps with --load lumped-average, or lower it"
                }
                InputError::GridSize(..) => "choose another --h",
                _ => "check f",
            };
            Error::input(format!("{}: {e}; {remedy}", self.name))
        })?;
        let seconds = start.elapsed().as_secs_f64();
        if stop == fast::StopReason::Diverged {
            return Err(Error::Stage(vec![format!("{} diverged; scale f down", self.name)]));
        }
        let mut flux = vec![0.0; grid.nodes()];
        residual(grid, &y, &load, &mut flux);
        // In contact y is exactly zero; elsewhere the flux is rounding error.
        let multiplier =
            |node: usize| if y[node] > 0.0 { 0.0 } else { flux[node].max(0.0) / grid.h() };
        let a = grid.boundary().map(multiplier).collect();
        let level = Level {
            cells: grid.cells(),
            iterations,
            sweeps: None,
            stop: stop.name().into(),
            energy: energy(grid, &y, &load),
            sum_load: load.iter().sum(),
            kkt: kkt(grid, &y, &load),
        };
        let errors = self.errors(grid, &y, &load);
        let pair = Pair { y, a };
        Ok(Solved { grid, pair, levels: vec![level], work_units, errors, setup, seconds })
    }

    fn errors(&self, grid: Grid, y: &[f64], load: &[f64]) -> Option<Errors> {
        self.f.exact().map(|exact| errors(grid, exact, y, load))
    }
}

/// Runs a saddle-point method over the nested grids: the end and the sweeps on each, and the last pair.
fn on_saddle(
    solver: Solver,
    grids: &[Grid],
    loads: &[Vec<f64>],
    params: &Params,
) -> (Vec<UzawaOutcome>, Pair) {
    let prolongation = Prolongation::default();
    if solver == Solver::ArrowHurwicz {
        let (ends, pair) = solve_nested(grids, loads, params, prolongation, &mut ());
        let sweeps = |end: Outcome| UzawaOutcome { end, sweeps: end.iterations };
        return (ends.into_iter().map(sweeps).collect(), pair);
    }
    let Params { r, rule, max_iterations, .. } = *params;
    on_nested(grids, loads, prolongation, |level, grid, load, pair| {
        let params = UzawaParams {
            r,
            rule,
            tolerance: tolerance(level),
            max_sweeps: max_iterations,
            ..UzawaParams::default()
        };
        let outcome = if solver == Solver::Uzawa {
            uzawa(grid, load, &params, pair, None)
        } else {
            let params = ProximalParams { uzawa: params, ..ProximalParams::default() };
            uzawa_proximal(grid, load, &params, pair, None)
        };
        (outcome, outcome.end.stop)
    })
}

type FastResult = std::result::Result<(Vec<f64>, usize, fast::StopReason, Option<f64>), InputError>;

fn text(problem: &Problem, integral: f64, solved: &Solved, out: Option<&Path>) -> String {
    let mut text = format!("{}: f = {}, integral {integral:.4}\n", problem.name, problem.f);
    // One sweep to an iteration is what Arrow-Hurwicz means; a column would only repeat it.
    let nested = solved.levels.iter().any(|o| o.sweeps.is_some_and(|sweeps| sweeps > o.iterations));
    let column = |what: &dyn std::fmt::Display| match nested {
        true => format!(" {what:>9}"),
        false => String::new(),
    };
    text += &format!(
        "{:>8} {:>11}{} {:>16} {:>14} {:>13} {:>10}\n",
        "grid",
        "iterations",
        column(&"sweeps"),
        "stop",
        "energy",
        "KKT residual",
        "relative"
    );
    for level in &solved.levels {
        text += &format!(
            "{:>8} {:>11}{} {:>16} {:>14.6e} {:>13.2e} {:>10.2e}\n",
            format!("1/{}", level.cells),
            level.iterations,
            column(&level.sweeps.unwrap_or(level.iterations)),
            level.stop,
            level.energy,
            level.kkt.natural,
            level.kkt.relative
        );
    }
    text += &format!("solved in {:.3} s", solved.seconds);
    if let Some(work_units) = solved.work_units {
        text += &format!(", the cost of {work_units:.1} sweeps");
    }
    text.push('\n');
    if let Some(e) = &solved.errors {
        text += &format!(
            "errors: L2 {:.2e}, H1 {:.2e}, nodes {:.2e}; multiplier L2 {:.2e}\n",
            e.l2, e.h1, e.max, e.multiplier_l2
        );
    }
    if solved.levels.iter().any(|level| level.sum_load >= 0.0) {
        text += "note: the load vector sums to a non-negative number on some grid, where the discrete problem has no solution\n";
    }
    if let Some(out) = out {
        text += &format!("wrote {}\n", out.display());
    }
    text
}

fn scene(name: &str) -> Result<Scene> {
    let project = Project::read(Project::find(&current_folder()?)?)?;
    project.scene(name).cloned()
}

/// Cells per side in `1/N`, `N`, or a decimal that is one over an integer.
fn cells(h: &str) -> Result<usize> {
    let wrong = || Error::input(format!("--h {h}: write the width as 1/N, e.g. 1/256"));
    let n = match h.split_once('/') {
        Some(("1", n)) => n.parse::<usize>().map_err(|_| wrong())?,
        Some(_) => return Err(wrong()),
        None => {
            let width: f64 = h.parse().map_err(|_| wrong())?;
            let n = (1.0 / width).round();
            if !(width > 0.0 && n * width == 1.0) {
                return Err(wrong());
            }
            n as usize
        }
    };
    if n > MAX_CELLS {
        return Err(Error::input(format!(
            "--h 1/{n} needs more memory than is sensible; 1/{MAX_CELLS} is the finest"
        )));
    }
    Ok(n)
}

/// Finest grid whose Cholesky factor fits comfortably in memory.
const MAX_DIRECT: usize = 1024;

/// Grids from the coarsest that halves down to `finest`, with at least four cells if possible.
fn hierarchy(finest: usize) -> Result<Vec<Grid>> {
    let mut sizes = vec![finest];
    while sizes[0].is_multiple_of(2) && sizes[0] >= 8 {
        sizes.insert(0, sizes[0] / 2);
    }
    nested(&sizes).map_err(|e| Error::input(e.to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn widths_are_read_and_refused() {
        assert_eq!(cells("1/256").unwrap(), 256);
        assert_eq!(cells("0.25").unwrap(), 4);
        for wrong in ["2/3", "0.3", "-0.25", "nan", "1/x", "x", "0"] {
            assert!(cells(wrong).is_err(), "{wrong}");
        }
        assert!(cells("1/100000").unwrap_err().to_string().contains("memory"));
    }

    #[test]
    fn hierarchies_halve_down_to_an_odd_or_small_grid() {
        let sizes = |n| -> Vec<_> { hierarchy(n).unwrap().iter().map(|g| g.cells()).collect() };
        assert_eq!(sizes(64), [4, 8, 16, 32, 64]);
        assert_eq!(sizes(12), [6, 12]);
        assert_eq!(sizes(7), [7]);
        assert!(hierarchy(1).is_err());
    }
}
