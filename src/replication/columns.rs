//! Names of the columns of a study.

/// Columns of the numbers, in their order.
pub(crate) const COLUMNS: [&str; 23] = [
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
