//! `solve --solver spectral`: the true solution, without a grid.

use super::answer::law_json;
use super::bound::BoundaryWords;
use super::clock::Part;
use super::files::Format;
use super::request::Request;
use crate::cli::output::OutputFile;
use crate::pipeline::bar;
use crate::pipeline::error::{Error, Result};
use indicatif::ProgressBar;
use serde_json::{Value, json};
use signorini_mathematics::discrete::grid::Grid;
use signorini_mathematics::levels::{Integrals, Lattices, Levels};
use signorini_mathematics::problem::law::Law;
use signorini_mathematics::problem::text::plain;
use signorini_mathematics::saddle::Pair;
use signorini_mathematics::spectral::{
    Checks, Solution, SpectralError, TrueSolution, true_solution,
};
use std::time::Duration;

/// True solution on the square.
pub(super) struct TrueAnswer<'a> {
    lattices: &'a Lattices,
    solution: Solution,
    /// Number of Newton steps.
    steps: usize,
}

/// Solves.
pub(super) fn answer(request: &Request) -> Result<TrueAnswer<'_>> {
    let lattices = request.lattices("--solver spectral")?;
    let found = true_solution(request.problem.law(), lattices.source());
    let TrueSolution { solution, steps } = found.map_err(|e| failed(&request.name, &e))?;
    request.clock.ended(Part::Solver);
    Ok(TrueAnswer { lattices, solution, steps })
}

impl TrueAnswer<'_> {
    /// Writes a file with the solution at the nodes of the finest grid.
    pub(super) fn write(&self, request: &Request, file: &(OutputFile, Format)) -> Result<()> {
        request.write(file, self.lattices, &on_grid(&self.solution, self.lattices.finest()))
    }

    pub(super) fn json(&self, request: &Request) -> Value {
        let (Self { solution, .. }, law) = (self, request.problem.law());
        let [lower_right, upper_right, upper_left, lower_left] = solution.corners();
        let mut json = json!({
            "schema": 1,
            "scene": request.name,
            "f": self.lattices.f(),
            "dimension": 2,
            "solver": "spectral",
            "iterations": self.steps,
            "stop": "converged",
            "energy": solution.energy,
            "integral_f": self.lattices.integrals().of_f,
            "contact": solution.contact,
            "force": force(solution, law),
            "grids": null,
            "grids_reason": "the spectral solver uses no grid",
            "bound": null,
            "bound_reason": "the spectral solver checks its digits, see `checks`; --accuracy-energy gives guaranteed \
                bounds",
            "value": {
                "centre": solution.value(0.0, 0.0),
                "lower_left": lower_left,
                "lower_right": lower_right,
                "upper_right": upper_right,
                "upper_left": upper_left,
            },
            "checks": solution.checks,
            "warnings": request.warnings,
            "failure": null,
            "remedy": null,
            "seconds": request.clock.json(),
        });
        if !law.is_signorini() {
            json["law"] = law_json(law);
        }
        json
    }

    pub(super) fn text(&self, request: &Request) -> String {
        let (Self { lattices, solution, steps }, law) = (self, request.problem.law());
        let (name, f, integral) = (&request.name, lattices.f(), lattices.integrals().of_f);
        let mut text = format!("{name}: f = {f}, integral {}\n", plain(integral, 4));
        let words = BoundaryWords::of(law);
        if !law.is_signorini() {
            text += &format!("law {law}\n");
        }
        text += &table(solution, &words, lattices.integrals());
        let sums = [force(solution, law), 0.0 - integral];
        text += &words.force(sums, lattices.integrals(), 16);
        text += &checks(&solution.checks);
        text + &request.clock.text("setup", &format!(" ({steps} Newton steps)"))
    }
}

/// Returns v at the nodes of a grid, and the multiplier at its boundary nodes.
fn on_grid(solution: &Solution, grid: Grid) -> Pair {
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
