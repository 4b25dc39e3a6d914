//! Names of the columns of a study.

/// Columns of the numbers, in their order.
pub(crate) const COLUMNS: [&str; 21] = [
    "energy",
    "energy_lower",
    "energy_upper",
    "error_relative",
    "error_l2",
    "error_h1",
    "error_max",
    "v_least",
    "v_greatest",
    "contact_length",
    "force",
    "nodes",
    "iterations",
    "iterations_per_grid",
    "stop",
    "kkt_relative",
    "solver",
    "reserve",
    "warnings",
    "remedy",
    "reason",
];
