//! `solve`: one problem, once, without scene files, cache or book.

mod cube;
mod problem;
mod spectral;

use super::{current_folder, say, say_json};
use crate::cli::formats;
use crate::discrete::load::{Diagonal, LoadRule};
use crate::multigrid::Goal;
use crate::pipeline::error::{Error, IoContext, Result};
use crate::problem::source::Source;
use crate::replication::project::Project;
use crate::replication::scene::{MAX_CELLS, Scene, positive_r, solvable};
use crate::saddle::{Params, StopRule};
use clap::{Args, ValueEnum};
use problem::{Level, Problem, Solved};
use std::path::{Path, PathBuf};

/// Arguments of `solve`.
#[derive(Args)]
pub(super) struct SolveArgs {
    /// A scene of the project, whose f, load rule and grids are taken
    #[arg(required_unless_present_any = ["f", "cube"])]
    scene: Option<String>,
    /// The right-hand side, e.g. 'rect(-0.25,0.25,-0.25,0.25)=1.5; else=-1'
    #[arg(long, conflicts_with = "scene")]
    f: Option<String>,
    /// A right-hand side on the unit cube, e.g. 'ball(0,0,0,0.25)=2; else=-1'
    #[arg(long, value_name = "F",
        conflicts_with_all = ["scene", "f", "load", "r", "stop", "max_iterations"])]
    cube: Option<String>,
    /// Width of the finest grid, e.g. 1/256 [default: the scene's finest, or 1/64]
    #[arg(long, value_name = "1/N")]
    h: Option<String>,
    /// Solver [default: arrow-hurwicz; on the cube, which has multigrid and active-set, multigrid]
    #[arg(long, value_enum)]
    solver: Option<Solver>,
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
    /// KKT residual over the largest load at which multigrid stops [default: the rounding floor]
    #[arg(long, value_name = "RESIDUAL")]
    tolerance: Option<f64>,
    /// Print JSON
    #[arg(long)]
    json: bool,
    /// Write the solution: .vti for ParaView, .npy for NumPy, .svg for a picture; or vtk, npy, svg alone
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

impl SolveArgs {
    /// The file to write: where only a format was named, one called `name` in this folder.
    fn out(&self, name: &str) -> Option<PathBuf> {
        self.out.as_deref().map(|out| match out.to_str() {
            Some("vtk") => PathBuf::from(format!("{name}.vti")),
            Some(format) if formats::ENDINGS.contains(&format) => {
                PathBuf::from(format!("{name}.{format}"))
            }
            _ => out.to_path_buf(),
        })
    }

    /// The tolerance of multigrid, if it is asked for.
    fn tolerance(&self, solver: Solver) -> Result<Option<f64>> {
        match self.tolerance {
            Some(_) if solver != Solver::Multigrid => Err(Error::input(
                "--tolerance is for --solver multigrid; the paper's method stops on its N-th grid at 10^-N",
            )),
            Some(tolerance) if !(tolerance > 0.0 && tolerance.is_finite()) => Err(Error::input(
                format!("--tolerance {tolerance}: must be a positive number, e.g. 1e-8"),
            )),
            tolerance => Ok(tolerance),
        }
    }
}

/// What multigrid is to reach for a tolerance relative to the load vector.
fn goal(tolerance: Option<f64>, load: &[f64]) -> Goal {
    let largest = || load.iter().fold(0.0_f64, |largest, f| largest.max(f.abs()));
    tolerance.map_or(Goal::RoundingFloor, |tolerance| Goal::Kkt(tolerance * largest()))
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum Solver {
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
    /// The true solution to rounding, for piecewise constant f
    Spectral,
}

impl Solver {
    fn name(self) -> String {
        self.to_possible_value().expect("no solver is hidden").get_name().into()
    }
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
            LoadName::Exact => Self::Exact { diagonal: Diagonal::Rising },
            LoadName::LumpedAverage => Self::LumpedAverage,
        }
    }
}

pub(super) fn solve(args: &SolveArgs) -> Result<u8> {
    if let Some(f) = &args.cube {
        return cube::solve(args, f);
    }
    let solver = args.solver.unwrap_or(Solver::ArrowHurwicz);
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
    let name = scene.as_ref().map_or("custom", |scene| &scene.name);
    let out = args.out(scene.as_ref().map_or("solution", |scene| &scene.name));
    if let Some(out) = &out {
        formats::check_ending(out)?;
    }
    let tolerance = args.tolerance(solver)?;
    let problem = Problem { name, f: &f, rule, finest };
    let solved = match solver {
        Solver::Spectral => return spectral::solve(args, &problem, integral),
        Solver::ArrowHurwicz | Solver::Uzawa | Solver::UzawaProximal => {
            let params = Params {
                r: positive_r(args.r)?,
                rule: stop,
                max_iterations: args.max_iterations,
                ..Params::default()
            };
            problem.saddle(solver, &params)?
        }
        Solver::Multigrid => problem.multigrid(tolerance)?,
        Solver::ActiveSet => problem.active_set()?,
    };
    let grid = solved.grid;
    if let Some(out) = &out {
        let bytes = formats::write(out, grid, &solved.pair, name)?;
        std::fs::write(out, bytes).context("write", out)?;
    }
    let last = solved.levels.last().expect("at least one grid");
    if args.json {
        let mut json = serde_json::json!({
            "schema": 1,
            "scene": name,
            "f": f.to_string(),
            "dimension": 2,
            "solver": solver.name(),
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
    say(&text(&problem, integral, &solved, out.as_deref()))
}

fn text(problem: &Problem, integral: f64, solved: &Solved, out: Option<&Path>) -> String {
    let mut text = format!("{}: f = {}, integral {integral:.4}\n", problem.name, problem.f);
    text += &table(&solved.levels);
    text += &cost(solved.seconds, solved.work_units);
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

/// One line per grid.
fn table(levels: &[Level]) -> String {
    // One sweep to an iteration is what Arrow-Hurwicz means; a column would only repeat it.
    let nested = levels.iter().any(|o| o.sweeps.is_some_and(|sweeps| sweeps > o.iterations));
    let column = |what: &dyn std::fmt::Display| match nested {
        true => format!(" {what:>9}"),
        false => String::new(),
    };
    let mut text = format!(
        "{:>8} {:>11}{} {:>16} {:>14} {:>13} {:>10}\n",
        "grid",
        "iterations",
        column(&"sweeps"),
        "stop",
        "energy",
        "KKT residual",
        "relative"
    );
    for level in levels {
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
    text
}

fn cost(seconds: f64, work_units: Option<f64>) -> String {
    let mut text = format!("solved in {seconds:.3} s");
    if let Some(work_units) = work_units {
        text += &format!(", the cost of {work_units:.1} sweeps");
    }
    text + "\n"
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
}
