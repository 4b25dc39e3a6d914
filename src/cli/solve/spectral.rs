//! `solve --solver spectral`: the true solution, without a grid.

use super::SolveArgs;
use super::answer::law_json;
use super::bound::BoundaryWords;
use super::request::Request;
use crate::cli::output::{say_json, tell};
use crate::cli::shown::brief;
use crate::pipeline::bar;
use crate::pipeline::error::{Error, Result};
use indicatif::ProgressBar;
use signorini_mathematics::discrete::grid::Grid;
use signorini_mathematics::levels::{Integrals, Lattices, Levels};
use signorini_mathematics::problem::law::Law;
use signorini_mathematics::problem::text::plain;
use signorini_mathematics::saddle::Pair;
use signorini_mathematics::spectral::{
    Checks, Solution, SpectralError, TrueSolution, true_solution,
};
use std::time::{Duration, Instant};

/// Solves, prints the answer, and returns the solution.
pub(super) fn solve(args: &SolveArgs, request: &Request, lattices: &Lattices) -> Result<Solution> {
    let (name, f, law) = (&request.name, lattices.source(), request.problem.law());
    let integral = lattices.integrals().of_f;
    let start = Instant::now();
    let TrueSolution { solution: finer, steps } =
        true_solution(law, f).map_err(|e| failed(name, &e))?;
    let time = start.elapsed();
    if args.json {
        let [lower_right, upper_right, upper_left, lower_left] = finer.corners();
        let mut json = serde_json::json!({
            "schema": 1,
            "scene": name,
            "f": f.to_string(),
            "dimension": 2,
            "solver": "spectral",
            "iterations": steps,
            "stop": "converged",
            "energy": finer.energy,
            "integral_f": integral,
            "contact": finer.contact,
            "force": force(&finer, law),
            "grids": null,
            "grids_reason": "the spectral solver uses no grid",
            "bound": null,
            "bound_reason": "the spectral solver checks its digits, see `checks`; --accuracy-energy gives guaranteed \
                bounds",
            "value": {
                "centre": finer.value(0.0, 0.0),
                "lower_left": lower_left,
                "lower_right": lower_right,
                "upper_right": upper_right,
                "upper_left": upper_left,
            },
            "checks": finer.checks,
            "warnings": request.warnings,
            "seconds": { "solve": time.as_secs_f64() },
        });
        if !law.is_signorini() {
            json["law"] = law_json(law);
        }
        say_json(&json)?;
        return Ok(finer);
    }
    let mut text = format!("{name}: f = {f}, integral {}\n", plain(integral, 4));
    let words = BoundaryWords::of(law);
    if !law.is_signorini() {
        text += &format!("law {law}\n");
    }
    text += &table(&finer, &words, lattices.integrals());
    text += &words.force([force(&finer, law), 0.0 - integral], lattices.integrals(), 16);
    text += &checks(&finer.checks);
    text += &format!("solved in {}, {steps} Newton steps\n", brief(time));
    tell(&text)?;
    Ok(finer)
}

/// Returns v at the nodes of a grid, and the multiplier at its boundary nodes.
pub(super) fn on_grid(solution: &Solution, grid: Grid) -> Pair {
    let bar = bar("{spinner} v at {msg} nodes, {elapsed}");
    if let Some(bar) = &bar {
        bar.set_message(grid.nodes().to_string());
        bar.enable_steady_tick(Duration::from_millis(200));
    }
    let pair = solution.on_grid(grid);
    bar.inspect(ProgressBar::finish_and_clear);
    pair
}

/// Returns the total contact force; under another law than the paper's the flux through all of the boundary.
fn force(solution: &Solution, law: Law) -> f64 {
    if law.is_signorini() {
        return solution.contact.iter().map(|arc| arc.force).sum();
    }
    solution.boundary_points().map(|point| point.weight * point.multiplier).sum()
}

fn table(solution: &Solution, words: &BoundaryWords, integrals: &Integrals) -> String {
    let mut text = format!("energy {}\n", plain(solution.energy, 16));
    for arc in &solution.contact {
        text += &words.arc(arc, integrals, 16);
    }
    text + &format!("v(0,0) {}\n", plain(solution.value(0.0, 0.0), 16))
}

/// Returns the checks in two lines: the signs that hold, and the numbers that vanish.
fn checks(checks: &Checks) -> String {
    let &Checks { least_multiplier, least_value, green, rellich, moments, resolution } = checks;
    let [least_multiplier, least_value] =
        [least_multiplier, least_value].map(|least| plain(least, 2));
    let mut text = format!(
        "checks: least multiplier {least_multiplier}, least value {least_value}\n  \
        zero up to rounding: Green {green:.1e}, Rellich {rellich:.1e}, moments {moments:.1e}"
    );
    if let Some(resolution) = resolution {
        text += &format!(",\n  two resolutions {resolution:.1e}");
    }
    text + "\n"
}

/// Returns the error of the program: an error of the input if f is unsuitable, a failure if no solution was found.
fn failed(name: &str, error: &SpectralError) -> Error {
    match error {
        SpectralError::NotPieces | SpectralError::Unsolvable(_) => {
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
