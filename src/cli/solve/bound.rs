//! What an answer is worth: guaranteed bounds of its error and of the true energy, and the contact found.

use super::problem::Solved;
use crate::bounds::{Bounds, NoBound, bounds, recovery};
use crate::cli::formats;
use crate::discrete::grid::Grid;
use crate::discrete::transfer::prolong_boundary;
use crate::pipeline::error::{Error, Result};
use crate::problem::source::Source;
use crate::saddle::Pair;
use serde_json::{Value, json};
use std::path::Path;

/// Bounds for a solution on the square, or why there are none.
pub(super) fn of(f: &Source, solved: &Solved) -> std::result::Result<Bounds, NoBound> {
    bounds(solved.grid, f, &solved.pair.y)
}

/// The bytes of a file of the recovered solution, on the grid of half the width.
pub(super) fn write_recovery(
    out: &Path,
    f: &Source,
    solved: &Solved,
    name: &str,
) -> Result<Vec<u8>> {
    let (y, _) = recovery(solved.grid, f, &solved.pair.y)
        .map_err(|reason| Error::input(format!("--recover: {reason}")))?;
    let grid = Grid::new(2 * solved.grid.cells()).map_err(|e| Error::input(e.to_string()))?;
    let pair = Pair { y, a: prolong_boundary(&solved.pair.a) };
    formats::write(out, grid, &pair, name)
}

/// Adds the bounds to an answer; those of a field that has none are null, with the reason.
pub(super) fn add_to(answer: &mut Value, bound: &std::result::Result<Bounds, impl ToString>) {
    (answer["bound"], answer["contact"]) = match bound {
        Ok(bound) => {
            let Bounds { energy, error, recovered, .. } = bound;
            (
                json!({ "energy": energy, "error": error, "recovered": recovered }),
                json!(bound.contact),
            )
        }
        Err(reason) => {
            answer["bound_reason"] = reason.to_string().into();
            (Value::Null, Value::Null)
        }
    };
}

/// The same as text, with a warning if the bounds expose the answer, which gives `energy`, as wrong.
pub(super) fn text(bound: &std::result::Result<Bounds, NoBound>, energy: f64) -> String {
    let bound = match bound {
        Ok(bound) => bound,
        Err(reason) => return format!("no bound of the error: {reason}\n"),
    };
    let [low, high] = bound.energy;
    let [least, most] = bound.error;
    let relative = 100.0 * bound.relative();
    let mut text = format!(
        "guaranteed: true energy in [{low:.12e}, {high:.12e}],\n  error in the energy norm {least:.3e} to {most:.3e}"
    );
    text += &if relative < 100.0 {
        format!(", at most {relative:.2} % of the solution\n")
    } else {
        "\n".into()
    };
    for arc in &bound.contact {
        let [from, to] = [arc.from, arc.to].map(|[x, y]| format!("({x:.4}, {y:.4})"));
        text += &format!("contact anticlockwise from {from} to {to}, force {:.6}\n", arc.force);
    }
    // The energy of v is above the true one by half the square of the error.
    let explained = most * most;
    if !(low - explained <= energy && energy <= high + explained) {
        text += "warning: the energy is further from the true one than the error explains: the load vector is not that of f; try --load exact\n";
    }
    if bound.relative() >= POOR {
        text += "warning: the error may be as large as the solution; refine the grid, or try --solver multigrid\n";
    }
    text
}

/// Part of the solution above which an error is warned of.
const POOR: f64 = 0.5;
