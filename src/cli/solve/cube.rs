//! `solve --cube`: the same problem in three dimensions.

use super::problem::Level;
use super::{SolveArgs, Solver, cells, cost, goal, table};
use crate::cli::formats;
use crate::cli::{say, say_json};
use crate::discrete::cube::{Grid, energy, errors, exact_load, kkt};
use crate::multigrid::MultigridParams;
use crate::multigrid::active_set::ActiveSetParams;
use crate::multigrid::cube::{active_set, multigrid};
use crate::multigrid::{InputError, StopReason};
use crate::pipeline::error::{Error, IoContext, Result};
use crate::problem::cube::Source;
use crate::replication::scene::solvable_on_cube;
use std::time::Instant;

/// Finest grid: it has 135 million nodes, for which multigrid takes three gigabytes.
const MAX_CELLS: usize = 512;
/// Finest grid whose Cholesky factor fits comfortably in memory.
const MAX_DIRECT: usize = 32;
const DEFAULT_CELLS: usize = 64;

pub(super) fn solve(args: &SolveArgs, f: &str) -> Result<u8> {
    let f: Source = f.parse().map_err(|e| Error::input(format!("--cube: {e}")))?;
    let integral = solvable_on_cube(&f)?;
    let solver = args.solver.unwrap_or(Solver::Multigrid);
    let n = args.h.as_deref().map_or(Ok(DEFAULT_CELLS), cells)?;
    let finest = match solver {
        Solver::Multigrid => MAX_CELLS,
        Solver::ActiveSet => MAX_DIRECT,
        _ => {
            let name = solver.name();
            let text = format!("--solver {name}: the cube has only multigrid and active-set");
            return Err(Error::input(text));
        }
    };
    if n > finest {
        return Err(Error::input(format!(
            "--h 1/{n} takes too much memory on the cube; 1/{finest} is the finest for {}",
            solver.name()
        )));
    }
    let grid = Grid::new(n).map_err(|e| Error::input(e.to_string()))?;
    let out = args.out("cube");
    if let Some(out) = &out {
        formats::check_cube_ending(out)?;
    }
    let tolerance = args.tolerance(solver)?;

    let start = Instant::now();
    let load = exact_load(grid, &f);
    let setup = start.elapsed().as_secs_f64();
    let start = Instant::now();
    let solved = if solver == Solver::Multigrid {
        let params = MultigridParams { goal: goal(tolerance, &load), ..Default::default() };
        multigrid(n, &load, None, &params, |_| ())
            .map(|(y, o)| (y, o.cycles, o.stop, Some(o.work_units)))
    } else {
        active_set(n, &load, None, &ActiveSetParams::default(), |_| ())
            .map(|(y, o)| (y, o.steps, o.stop, None))
    };
    let (y, iterations, stop, work_units) = solved.map_err(|e| {
        let remedy = match e {
            InputError::NotCoercive(_) => "lower f somewhere",
            InputError::GridSize(..) => "choose another --h",
            _ => "check f",
        };
        Error::input(format!("--cube: {e}; {remedy}"))
    })?;
    let seconds = start.elapsed().as_secs_f64();
    if stop == StopReason::Diverged {
        return Err(Error::Stage(vec!["--cube: the solver diverged; scale f down".into()]));
    }
    let level = Level {
        cells: n,
        iterations,
        sweeps: None,
        stop: stop.name().into(),
        energy: energy(grid, &y, &load),
        sum_load: load.iter().sum(),
        kkt: kkt(grid, &y, &load),
    };
    let errors = f.exact().map(|exact| errors(grid, exact, &y));
    if let Some(out) = &out {
        let bytes = formats::write_cube(out, grid, &y, "cube")?;
        std::fs::write(out, bytes).context("write", out)?;
    }
    if args.json {
        let mut json = serde_json::json!({
            "schema": 1,
            "scene": "custom",
            "f": f.to_string(),
            "dimension": 3,
            "solver": solver.name(),
            "h": grid.h(),
            "unknowns": grid.nodes(),
            "iterations": iterations,
            "iterations_per_grid": [iterations],
            "stop": level.stop,
            "energy": level.energy,
            "integral_f": integral,
            "sum_load": level.sum_load,
            "kkt": level.kkt,
            "seconds": { "setup": setup, "solve": seconds },
        });
        if let Some(work_units) = work_units {
            json["work_units"] = work_units.into();
        }
        if let Some(e) = errors {
            json["errors"] = serde_json::json!({ "l2": e.l2, "h1": e.h1, "max": e.max });
        }
        return say_json(&json);
    }
    let mut text = format!("cube: f = {f}, integral {integral:.4}\n");
    text += &table(&[level]);
    text += &cost(seconds, work_units);
    if let Some(e) = errors {
        text += &format!("errors: L2 {:.2e}, H1 {:.2e}, nodes {:.2e}\n", e.l2, e.h1, e.max);
    }
    if let Some(out) = &out {
        text += &format!("wrote {}\n", out.display());
    }
    say(&text)
}
