//! Numbers of a true solution on the square, as a reference for other programs.

use crate::discrete::contact::ContactArc;
use crate::spectral::TrueSolution;
use serde::Serialize;

/// Table `values`: a number of a true solution.
#[derive(Serialize)]
pub(super) struct ValueRow {
    /// Name of the problem.
    problem: String,
    /// `energy`; v at the `centre` and in the corners, `lower left` and so on; of an arc of contact the coordinates
    /// `from x`, `from y`, `to x`, `to y` of its ends, equal if all of the boundary is in contact, and the `force`, the
    /// integral of the multiplier.
    quantity: &'static str,
    /// Number of the arc, anticlockwise, from the one that ends first after the lower right corner.
    arc: Option<usize>,
    /// The number.
    value: f64,
}

/// Numbers of the solution of a problem, in the order of `pipeline/truth.toml`.
pub(super) fn values(problem: &str, solution: &TrueSolution) -> Vec<ValueRow> {
    let mut numbers =
        vec![("energy", None, solution.energy), ("centre", None, solution.values(&[[0.0; 2]])[0])];
    for (quantity, corner) in [
        ("lower left", [-0.5, -0.5]),
        ("lower right", [0.5, -0.5]),
        ("upper right", [0.5, 0.5]),
        ("upper left", [-0.5, 0.5]),
    ] {
        numbers.push((quantity, None, solution.on_boundary(corner)[0]));
    }
    let mut arcs: Vec<&ContactArc> = solution.contact.iter().collect();
    arcs.sort_by(|one, other| place(one.to).total_cmp(&place(other.to)));
    for (k, arc) in arcs.into_iter().enumerate() {
        let ([from_x, from_y], [to_x, to_y]) = (arc.from, arc.to);
        numbers.extend([
            ("from x", Some(k), from_x),
            ("from y", Some(k), from_y),
            ("to x", Some(k), to_x),
            ("to y", Some(k), to_y),
            ("force", Some(k), arc.force),
        ]);
    }
    let rows = numbers.into_iter();
    rows.map(|(quantity, arc, value)| ValueRow { problem: problem.into(), quantity, arc, value })
        .collect()
}

/// Length of the boundary from the lower right corner to a point of it, anticlockwise.
fn place([x, y]: [f64; 2]) -> f64 {
    if x == 0.5 {
        y + 0.5
    } else if y == 0.5 {
        1.5 - x
    } else if x == -0.5 {
        2.5 - y
    } else {
        3.5 + x
    }
}
