//! geometry

pub(super) mod boundary;
pub(super) mod curve;
pub(super) mod domain;
pub(super) mod frame;
pub(super) mod medial;
pub(super) mod origin;
pub(super) mod outline;
pub(super) mod panels;
pub(super) mod parts;
pub(super) mod regions;
pub(super) mod rule;
pub(super) mod way_out;
