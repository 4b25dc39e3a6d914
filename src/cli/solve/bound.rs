//! What an answer is worth: guaranteed bounds of its error and of the true energy, and the contact found.

use crate::bounds::Bounds;
use crate::discrete::contact::ContactArc;
use crate::timing::solver::Solver;

/// The bounds as text. A `smooth` f enters them by quadrature, pieces exactly.
pub(super) fn text(bound: &Result<Bounds, String>, smooth: bool) -> String {
    let bound = match bound {
        Ok(bound) => bound,
        Err(reason) => return format!("no bound of the error: {reason}\n"),
    };
    let [low, high] = bound.energy;
    let [least, most] = bound.error;
    let relative = 100.0 * bound.relative();
    let guaranteed = if smooth { "guaranteed, but for the quadrature of f" } else { "guaranteed" };
    let mut text = format!(
        "{guaranteed}: true energy in [{low:.12e}, {high:.12e}],\n  error in the energy norm {least:.3e} to {most:.3e}"
    );
    text += &if relative < 100.0 {
        format!(", at most {relative:.2} % of the solution\n")
    } else {
        "\n".into()
    };
    text
}

/// What the bounds say against an answer, which gives `energy`.
pub(super) fn warnings(bound: &Bounds, energy: f64, solver: Solver) -> Vec<String> {
    let mut warnings = Vec::new();
    let ([low, high], [_, most]) = (bound.energy, bound.error);
    // The energy of v is above the true one by half the square of the error.
    let explained = most * most;
    if !(low - explained <= energy && energy <= high + explained) {
        warnings.push("the energy is further from the true one than the error explains: the load vector is not that of f; try --load exact".into());
    }
    let relative = bound.relative();
    if relative >= POOR {
        let error = match relative < 1.0 {
            true => format!("{:.0} % of the solution", 100.0 * relative),
            false => "as large as the solution".into(),
        };
        let remedy = match solver {
            Solver::Multigrid => "refine the grid",
            _ => "refine the grid, or try --solver multigrid",
        };
        warnings.push(format!("the error may be {error}; {remedy}"));
    }
    warnings
}

/// The total contact force beside minus the integral of f, which it equals at the solution, as text.
pub(super) fn force(force: f64, minus_integral: f64, digits: usize) -> String {
    let digits = digits - 1;
    format!("contact force {force:.digits$e}, minus the integral of f {minus_integral:.digits$e}\n")
}

/// Where a part of the boundary is in contact, and with which force.
pub(super) fn contact(arc: &ContactArc, digits: usize) -> String {
    let [from, to] = [arc.from, arc.to].map(|[x, y]| format!("({x:.digits$}, {y:.digits$})"));
    let place = match arc.from == arc.to {
        true => "everywhere".to_owned(),
        false => format!("anticlockwise from {from} to {to}"),
    };
    format!("contact {place}, force {:.*e}\n", digits - 1, arc.force)
}

/// Part of the solution above which an error is warned of.
const POOR: f64 = 0.5;
