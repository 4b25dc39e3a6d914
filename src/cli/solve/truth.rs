//! Parts of an answer that only a true solution has: its numbers, and the checks that they stand.

use super::bound::BoundaryWords;
use crate::pipeline::bar;
use indicatif::ProgressBar;
use serde_json::{Value, json};
use signorini_mathematics::problem::text::plain;
use signorini_mathematics::solvers::Solved;
use std::time::Duration;

/// Returns what only a true solution has.
pub(super) fn json(solved: &Solved) -> Option<Value> {
    let found = solved.truth()?;
    let solution = &found.solution;
    let [lower_right, upper_right, upper_left, lower_left] = solution.corners();
    Some(json!({
        "iterations": found.steps,
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
    }))
}

/// Returns a true solution in words; nothing of another.
pub(super) fn text(solved: &Solved) -> String {
    let Some(found) = solved.truth() else { return String::new() };
    let (solution, law) = (&found.solution, solved.problem.law());
    let facts = solved.problem.levels().facts();
    let (words, rounding) = (BoundaryWords::of(law), facts.rounding());
    let mut text = String::new();
    if !law.is_signorini() {
        text += &format!("law {law}\n");
    }
    text += &format!("energy {}\n", plain(solution.energy, 16));
    for arc in &solution.contact {
        text += &words.arc(arc, rounding, 16);
    }
    text += &format!("v(0,0) {}\n", plain(solution.value(0.0, 0.0), 16));
    text += &words.force([solution.force(), 0.0 - facts.integral], rounding, 16);
    // The signs that hold, and the numbers that vanish.
    let checks = &solution.checks;
    let [least_multiplier, least_value] =
        [checks.least_multiplier, checks.least_value].map(|least| plain(least, 2));
    text += &format!(
        "checks: least multiplier {least_multiplier}, least value {least_value}\n  \
        zero up to rounding: Green {:.1e}, Rellich {:.1e}, moments {:.1e}",
        checks.green, checks.rellich, checks.moments
    );
    if let Some(resolution) = checks.resolution {
        text += &format!(",\n  two resolutions {resolution:.1e}");
    }
    text + "\n"
}

/// A bar without a length, with what is done at the moment and the time that it takes.
pub(super) fn turning(doing: &str) -> Option<ProgressBar> {
    bar("{spinner} {msg}, {elapsed}").inspect(|bar| {
        bar.set_message(doing.to_owned());
        bar.enable_steady_tick(Duration::from_millis(200));
    })
}

/// Evaluates a solution at so many nodes, under a bar.
pub(super) fn shown<T>([nodes, _]: [usize; 2], evaluate: impl FnOnce() -> T) -> T {
    let bar = turning(&format!("v at {nodes} nodes"));
    let values = evaluate();
    bar.inspect(ProgressBar::finish_and_clear);
    values
}
