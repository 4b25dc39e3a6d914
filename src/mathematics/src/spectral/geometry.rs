//! The domain: its curves and sides, in the frame of the solver, a walk along the boundary with its corners, and what
//! lies outside of it.
//!
//! In the coordinates of a [`frame`] [`outline`] makes the sides of a [`domain`] of a mesh, loops of which are a
//! [`ring`] each; [`boundary`] splits them at corners, ends of contact and crossings into intervals, on which
//! [`panels`] have the points of the rows and of quadratures.

pub(super) mod boundary;
pub(super) mod curve;
pub(super) mod domain;
pub(super) mod frame;
pub(super) mod images;
pub(super) mod outline;
pub(super) mod panels;
#[cfg(test)]
pub(super) mod polygons;
pub(super) mod ring;
pub(super) mod side;
pub(super) mod way_out;
