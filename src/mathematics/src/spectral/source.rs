//! source

pub(super) mod closed_edges;
pub(super) mod complex;
pub(super) mod curves;
pub(super) mod elementary;
pub(super) mod expansion;
pub(super) mod far_field;
pub(super) mod groups;
pub(super) mod jumps;
pub(super) mod polynomial;
pub(super) mod potential;
pub(super) mod psi;
pub(super) mod quadratic;
pub(super) mod real_polynomial;
