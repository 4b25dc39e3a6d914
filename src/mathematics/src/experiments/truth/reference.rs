//! Values of a true solution, to as many digits as two resolutions agree on and rounding leaves.

use crate::spectral::Solution;
use serde::Serialize;

/// Table `values`: a number of a true solution, as a reference for other programs.
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
    /// Number as a double, at the finer of two resolutions.
    value: f64,
    /// Decimals on which both resolutions agree, at most 14, rounded.
    digits: String,
}

/// Number of decimals that rounding errors do not reach: beyond, both resolutions may have the same error.
const DECIMALS: usize = 14;

/// Decimals on which two numbers agree.
fn digits([rough, fine]: [f64; 2]) -> String {
    // Zero on contact, and halves on the sides of the square, hold by construction.
    if fine == rough && (2.0 * fine).fract() == 0.0 {
        return format!("{}", fine + 0.0);
    }
    for places in (0..=DECIMALS).rev() {
        let written = decimals(fine, places);
        if written == decimals(rough, places) {
            return written;
        }
    }
    String::new()
}

/// Writes `x` with this number of decimals; zero has no sign.
fn decimals(x: f64, places: usize) -> String {
    let text = format!("{x:.places$}");
    if text.trim_start_matches(['-', '0', '.']).is_empty() {
        text.trim_start_matches('-').to_owned()
    } else {
        text
    }
}

/// A number of a solution, and its name.
struct Named {
    quantity: &'static str,
    arc: Option<usize>,
    value: f64,
}

/// The numbers of a solution with this many arcs at least, in the order of `pipeline/truth.toml`.
fn numbers(solution: &Solution, arcs: usize) -> Vec<Named> {
    // The solver counts from the lower right corner.
    let [lower_right, upper_right, upper_left, lower_left] = solution.corners();
    let mut numbers = Vec::new();
    for (quantity, value) in [
        ("energy", solution.energy),
        ("centre", solution.value(0.0, 0.0)),
        ("lower left", lower_left),
        ("lower right", lower_right),
        ("upper right", upper_right),
        ("upper left", upper_left),
    ] {
        numbers.push(Named { quantity, arc: None, value });
    }
    for (k, arc) in solution.contact[..arcs].iter().enumerate() {
        for (quantity, value) in [
            ("from x", arc.from[0]),
            ("from y", arc.from[1]),
            ("to x", arc.to[0]),
            ("to y", arc.to[1]),
            ("force", arc.force),
        ] {
            numbers.push(Named { quantity, arc: Some(k), value });
        }
    }
    numbers
}

/// Returns the numbers of the solution of a problem at two resolutions, the finer one last.
pub(super) fn values(problem: &str, [rough, fine]: [&Solution; 2]) -> Vec<ValueRow> {
    let arcs = rough.contact.len().min(fine.contact.len());
    let mut rows = Vec::new();
    for (rough, Named { quantity, arc, value }) in
        numbers(rough, arcs).into_iter().zip(numbers(fine, arcs))
    {
        let digits = digits([rough.value, value]);
        rows.push(ValueRow { problem: problem.into(), quantity, arc, value, digits });
    }
    rows
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_are_those_of_both_resolutions() {
        // 0.12345679 and 0.12345678 with a decimal more.
        assert_eq!(digits([0.123456789, 0.123456781]), "0.1234568");
        assert_eq!(digits([-0.5, -0.5]), "-0.5");
        assert_eq!(digits([0.25, 0.25]), "0.25000000000000");
        assert_eq!(digits([0.0, 0.0]), "0");
        assert_eq!(digits([-1e-18, 1e-18]), "0.00000000000000");
    }
}
