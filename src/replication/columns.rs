//! Names of the columns of a study, and the digits that a number in one of them has.

use signorini_mathematics::problem::text::known;

/// Columns of the numbers, in their order.
pub(crate) const COLUMNS: [&str; 25] = [
    "energy",
    "energy_lower",
    "energy_upper",
    "error_relative",
    "error_l2",
    "error_h1",
    "error_max",
    "error_true",
    "v_least",
    "v_greatest",
    "contact_length",
    "contact_length_error",
    "force",
    "nodes",
    "iterations",
    "work_units",
    "iterations_per_grid",
    STOP,
    "kkt_relative",
    "delta_a",
    "solver",
    "reserve",
    "warnings",
    "remedy",
    "reason",
];

/// Column of the end of the solver, and its name in studies of the stopping rule.
pub(crate) const STOP: &str = "stop";
pub(crate) const END: &str = "end";

/// Returns the name of a column in words, as tables for a paper and charts have it.
pub(crate) fn in_words(column: &str) -> String {
    match column {
        "error_relative" => "relative error".into(),
        "kkt_relative" => "relative KKT residual".into(),
        other => other.replace('_', " "),
    }
}

/// Columns that stand beside one with digits that may not be known: what bounds its number.
pub(crate) fn beside(column: &str) -> &'static [&'static str] {
    match column {
        "energy" => &["energy_lower", "energy_upper"],
        "contact_length" => &["contact_length_error"],
        _ => &[],
    }
}

/// Returns the number in a column with so many digits; one of a true solution with those of them that are known by the
/// numbers `of` the columns [`beside`] it.
pub(crate) fn shown(
    (column, digits): (&str, usize),
    is_true: bool,
    of: impl Fn(&str) -> Option<f64>,
) -> Option<String> {
    let number = of(column)?;
    let bounds = beside(column).iter().map(|name| of(name).filter(|_| is_true));
    let ends = match bounds.collect::<Option<Vec<f64>>>().as_deref() {
        Some(&[lower, upper]) => Some([lower, upper]),
        Some(&[error]) => Some([number - error, number + error]),
        _ => None,
    };
    Some(known(number, ends, digits))
}
