//! `solve --solver spectral`: the true solution, without a grid.

use super::SolveArgs;
use super::bound::contact;
use super::domain::Domain;
use super::problem::Problem;
use crate::cli::output::{say, say_json};
use crate::discrete::grid::Grid;
use crate::pipeline::bar;
use crate::pipeline::error::{Error, Result};
use crate::replication::scene::shown_integral;
use crate::saddle::Pair;
use crate::spectral::{Params, Solution, SpectralError, spectral};
use indicatif::ProgressBar;
use std::time::{Duration, Instant};

/// Says what the solution is, and returns it.
pub(super) fn solve(args: &SolveArgs, problem: &Problem) -> Result<Solution> {
    let Domain::Square { f, .. } = &problem.domain else {
        unreachable!("the cube has no such solver")
    };
    let start = Instant::now();
    let solution = spectral(f, Params::default()).map_err(|e| failed(problem.name(), &e))?;
    let finer = solution.at_resolution(Params::FINER).map_err(|e| failed(problem.name(), &e))?;
    let seconds = start.elapsed().as_secs_f64();
    if args.json {
        let [lower_right, upper_right, upper_left, lower_left] = finer.corners();
        say_json(&serde_json::json!({
            "schema": 1,
            "scene": problem.name(),
            "f": f.to_string(),
            "dimension": 2,
            "solver": "spectral",
            "iterations": solution.steps,
            "stop": "converged",
            "energy": finer.energy,
            "integral_f": problem.integral,
            "contact": finer.contact,
            "value": {
                "centre": finer.value(0.0, 0.0),
                "lower_left": lower_left,
                "lower_right": lower_right,
                "upper_right": upper_right,
                "upper_left": upper_left,
            },
            "checks": finer.checks,
            "warnings": problem.warnings,
            "seconds": { "solve": seconds },
        }))?;
        return Ok(finer);
    }
    let integral = shown_integral(problem.integral);
    let mut text = format!("{}: f = {f}, integral {integral}\n", problem.name());
    text += &table(&finer);
    text += &format!(
        "checks: {}\nsolved in {seconds:.4} s, {} Newton steps\n",
        finer.checks, solution.steps
    );
    say(&text)?;
    Ok(finer)
}

/// v at the nodes of a grid, and the multiplier at those of its boundary.
pub(super) fn on_grid(solution: &Solution, grid: Grid) -> Pair {
    let multiplier = |b: usize| {
        let (i, j) = grid.boundary_node(b);
        let [_, multiplier] = solution.on_border([grid.coordinate(i), grid.coordinate(j)]);
        // Rounding errors are not to look like a pull.
        multiplier.max(0.0)
    };
    let a = (0..grid.boundary_nodes()).map(multiplier).collect();
    let bar = bar("{spinner} v at {msg} nodes, {elapsed}");
    if let Some(bar) = &bar {
        bar.set_message(grid.nodes().to_string());
        bar.enable_steady_tick(Duration::from_millis(200));
    }
    let y = solution.at_nodes(grid.cells());
    bar.inspect(ProgressBar::finish_and_clear);
    Pair { y, a }
}

fn table(solution: &Solution) -> String {
    let mut text = format!("energy {:.15e}\n", solution.energy);
    solution.contact.iter().for_each(|arc| text += &contact(arc, 16));
    text + &format!("v(0,0) {:.15e}\n", solution.value(0.0, 0.0))
}

/// What cannot be solved is the user's to change; a solution that is not found is a failure.
fn failed(name: &str, error: &SpectralError) -> Error {
    match error {
        SpectralError::NotPieces | SpectralError::NotCoercive(_) => {
            Error::input(format!("{name}: {error}; use --solver multigrid, or change f"))
        }
        SpectralError::Unchecked { near: Some(_), .. } | SpectralError::NoContactSet(Some(_)) => {
            Error::Stage(vec![format!(
                "{name}: {error}; use --solver multigrid --accuracy-energy 1e-6"
            )])
        }
        _ => Error::Stage(vec![format!("{name}: {error}; use --solver multigrid")]),
    }
}
