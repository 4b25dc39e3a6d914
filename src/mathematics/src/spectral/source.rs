//! f and its particular solution psi, with -Lap psi = f, in closed form.
//!
//! Of constant pieces: [`curves`] finds the curves across which f jumps, [`jumps`] has f with psi, whose gradient is a
//! sum over the jumps ([`potential`]) and whose values are in [`psi`]; small closed shapes are seen from their own
//! middles ([`groups`]). Of formulas: [`expansion`] multiplies them out to a [`polynomial`].

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
