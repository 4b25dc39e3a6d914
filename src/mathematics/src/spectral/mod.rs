//! True solution on any domain in the plane with straight and circular sides: ten digits of the energy and more, with
//! two bounds of it that are proved.
//!
//! [`plane`] has the method. Here are the domain ([`domain`]) and what f is made of: its curves ([`curve`]), the arcs
//! across which it jumps ([`jumps`]), and its particular solution ([`potential`]).
//!
//! *Borders that nearly touch.* Two curves are cut at the same points, however small the angle at which they meet
//! there; curves that overlap by, or lack, less than half of 2^-40 touch in one point, which moves the energy by the
//! power 3/2 of that. Where vertices are hardly apart short straight pieces join them, so that at each the jumps sum
//! to zero.

mod complex;
mod curve;
mod domain;
mod elementary;
mod jumps;
mod parts;
mod plane;
mod potential;
mod rule;
mod truth;
mod way_out;

pub use plane::{PlaneChecks, PlaneError};
pub use truth::TrueSolution;
pub(crate) use truth::{check_plane, true_solution_on, true_solution_on_square};
