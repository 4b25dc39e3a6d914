//! What only the true solution has in an answer: its numbers, and the checks that they stand.

use super::bound::BoundaryWords;
use crate::pipeline::bar;
use crate::pipeline::error::Error;
use indicatif::ProgressBar;
use serde_json::{Value, json};
use signorini_mathematics::levels::{Integrals, Problem};
use signorini_mathematics::problem::law::Law;
use signorini_mathematics::problem::text::plain;
use signorini_mathematics::spectral::{SpectralError, TrueSolution};
use std::time::Duration;

/// Returns what only a true solution has.
pub(super) fn json(TrueSolution { solution, steps }: &TrueSolution) -> Value {
    let [lower_right, upper_right, upper_left, lower_left] = solution.corners();
    json!({
        "iterations": steps,
        "stop": "converged",
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
    })
}

/// Returns a true solution with this total force in words.
pub(super) fn text(found: &TrueSolution, problem: &Problem, force: f64) -> String {
    let (law, integrals) = (problem.law(), problem.levels().integrals());
    let words = BoundaryWords::of(law);
    let mut text = String::new();
    if !law.is_signorini() {
        text += &format!("law {law}\n");
    }
    text += &table(found, &words, integrals);
    text += &words.force([force, 0.0 - integrals.of_f], integrals, 16);
    text + &checks(found)
}

/// Evaluates a solution at so many nodes, under a bar.
pub(super) fn shown<T>([nodes, _]: [usize; 2], evaluate: impl FnOnce() -> T) -> T {
    let bar = bar("{spinner} v at {msg} nodes, {elapsed}");
    if let Some(bar) = &bar {
        bar.set_message(nodes.to_string());
        bar.enable_steady_tick(Duration::from_millis(200));
    }
    let values = evaluate();
    bar.inspect(ProgressBar::finish_and_clear);
    values
}

/// Returns the total contact force; under another law than the paper's the flux through all of the boundary.
pub(super) fn force(TrueSolution { solution, .. }: &TrueSolution, law: Law) -> f64 {
    if law.is_signorini() {
        return solution.contact.iter().map(|arc| arc.force).sum();
    }
    solution.boundary_points().map(|point| point.weight * point.multiplier).sum()
}

fn table(
    TrueSolution { solution, .. }: &TrueSolution,
    words: &BoundaryWords,
    integrals: &Integrals,
) -> String {
    let mut text = format!("energy {}\n", plain(solution.energy, 16));
    for arc in &solution.contact {
        text += &words.arc(arc, integrals, 16);
    }
    text + &format!("v(0,0) {}\n", plain(solution.value(0.0, 0.0), 16))
}

/// Returns the checks in two lines: the signs that hold, and the numbers that vanish.
fn checks(TrueSolution { solution, .. }: &TrueSolution) -> String {
    let of = &solution.checks;
    let [least_multiplier, least_value] =
        [of.least_multiplier, of.least_value].map(|least| plain(least, 2));
    let (green, rellich, moments) = (of.green, of.rellich, of.moments);
    let mut text = format!(
        "checks: least multiplier {least_multiplier}, least value {least_value}\n  \
        zero up to rounding: Green {green:.1e}, Rellich {rellich:.1e}, moments {moments:.1e}"
    );
    if let Some(resolution) = of.resolution {
        text += &format!(",\n  two resolutions {resolution:.1e}");
    }
    text + "\n"
}

/// Returns the error of the program: an error of the input if f is unsuitable, a failure if no solution was found.
pub(super) fn failed(name: &str, error: &SpectralError) -> Error {
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
