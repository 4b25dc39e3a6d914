//! contact

pub(super) mod arcs;
pub(super) mod ends;
pub(super) mod newton;
pub(super) mod search;
pub(super) mod signs;
pub(super) mod start;
