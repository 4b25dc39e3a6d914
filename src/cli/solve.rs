//! `solve`: one problem, once, without scene files, cache or book.

use super::{current_folder, say, say_json};
use crate::error::{Error, IoContext, Result};
use crate::fields;
use crate::grid::{Grid, nested};
use crate::load::{LoadRule, load};
use crate::project::Project;
use crate::saddle::{
    Outcome, Pair, Params, ProximalParams, StopReason, StopRule, UzawaOutcome, UzawaParams,
    on_nested, solve_nested, tolerance, uzawa, uzawa_proximal,
};
use crate::scene::{MAX_CELLS, Scene, positive_r, solvable};
use crate::source::Source;
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

#[derive(Clone, Copy, Debug, PartialEq, ValueEnum)]
enum Solver {
    /// The paper's method on nested grids
    ArrowHurwicz,
    /// A full minimisation before each step of the multiplier
    Uzawa,
    /// The same with iterative proximal regularisation
    UzawaProximal,
}

impl Solver {
    fn name(self) -> &'static str {
        match self {
            Self::ArrowHurwicz => "arrow-hurwicz",
            Self::Uzawa => "uzawa",
            Self::UzawaProximal => "uzawa-proximal",
        }
    }

    /// The end and the sweeps on each grid, and the last pair.
    fn run(self, grids: &[Grid], loads: &[Vec<f64>], params: &Params) -> (Vec<UzawaOutcome>, Pair) {
        let prolongation = Prolongation::default();
        if self == Self::ArrowHurwicz {
            let (ends, pair) = solve_nested(grids, loads, params, prolongation, &mut ());
            let sweeps = |end: Outcome| UzawaOutcome { end, sweeps: end.iterations };
            return (ends.into_iter().map(sweeps).collect(), pair);
        }
        let Params { r, rule, max_iterations, .. } = *params;
        on_nested(grids, loads, prolongation, |level, grid, load, pair| {
            let uzawa_params = UzawaParams {
                r,
                rule,
                tolerance: tolerance(level),
                max_sweeps: max_iterations,
                ..UzawaParams::default()
            };
            let outcome = if self == Self::Uzawa {
                uzawa(grid, load, &uzawa_params, pair, None)
            } else {
                let params = ProximalParams { uzawa: uzawa_params, ..ProximalParams::default() };
                uzawa_proximal(grid, load, &params, pair, None)
            };
            (outcome, outcome.end.stop)
        })
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

    let start = Instant::now();
    let grids = hierarchy(finest)?;
    let loads: Vec<_> = grids.iter().map(|&grid| load(grid, &f, rule)).collect();
    let setup = start.elapsed().as_secs_f64();
    let params = Params {
        r: positive_r(args.r)?,
        rule: stop,
        max_iterations: args.max_iterations,
        ..Params::default()
    };
    let start = Instant::now();
    let (outcomes, pair) = args.solver.run(&grids, &loads, &params);
    let seconds = start.elapsed().as_secs_f64();
    let UzawaOutcome { end: last, sweeps } = *outcomes.last().expect("at least one grid");
    let name = scene.as_ref().map_or("custom", |scene| &scene.name);
    if last.stop == StopReason::Diverged {
        return Err(Error::Stage(vec![format!(
            "{name} diverged on grid 1/{} after {} iterations; choose a smaller r or scale f down",
            last.cells, last.iterations
        )]));
    }
    if let Some(out) = &args.out {
        let grid = *grids.last().expect("at least one grid");
        let bytes = fields::write(out, grid, &pair, name)?;
        std::fs::write(out, bytes).context("write", out)?;
    }
    let grid = Grid::new(last.cells).expect("solved on it");
    if args.json {
        return say_json(&serde_json::json!({
            "schema": 1,
            "scene": name,
            "f": f.to_string(),
            "solver": args.solver.name(),
            "h": grid.h(),
            "unknowns": grid.nodes(),
            "iterations": last.iterations,
            "iterations_per_grid": outcomes.iter().map(|o| o.end.iterations).collect::<Vec<_>>(),
            "sweeps": sweeps,
            "sweeps_per_grid": outcomes.iter().map(|o| o.sweeps).collect::<Vec<_>>(),
            "stop": last.stop,
            "energy": last.energy,
            "integral_f": integral,
            "sum_load": last.sum_load,
            "delta_a": last.delta_a,
            "kkt": last.kkt,
            "seconds": { "setup": setup, "solve": seconds },
        }));
    }
    let title = format!("{name}: f = {f}, integral {integral:.4}\n");
    say(&text(title, args.solver, &outcomes, seconds, args.out.as_deref()))
}

fn text(
    title: String,
    solver: Solver,
    outcomes: &[UzawaOutcome],
    seconds: f64,
    out: Option<&Path>,
) -> String {
    let mut text = title;
    // One sweep to an iteration is what Arrow-Hurwicz means; a column would only repeat it.
    let sweeps = |number: &dyn std::fmt::Display| match solver {
        Solver::ArrowHurwicz => String::new(),
        Solver::Uzawa | Solver::UzawaProximal => format!(" {number:>9}"),
    };
    text += &format!(
        "{:>8} {:>11}{} {:>16} {:>14} {:>12} {:>10}\n",
        "grid",
        "iterations",
        sweeps(&"sweeps"),
        "stop",
        "energy",
        "KKT residual",
        "Delta a"
    );
    for o in outcomes {
        text += &format!(
            "{:>8} {:>11}{} {:>16} {:>14.6e} {:>12.2e} {:>10.2e}\n",
            format!("1/{}", o.end.cells),
            o.end.iterations,
            sweeps(&o.sweeps),
            o.end.stop.to_string(),
            o.end.energy,
            o.end.kkt.natural,
            o.end.delta_a
        );
    }
    text += &format!("solved in {seconds:.3} s\n");
    if outcomes.iter().any(|o| o.end.sum_load >= 0.0) {
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
