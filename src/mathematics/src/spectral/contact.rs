//! The contact set: where it [`start`]s, how Newton's method moves its [`ends`] ([`newton`]), which signs are wrong
//! ([`signs`]), and the way from a start to a checked solution ([`search`]).

pub(super) mod ends;
pub(super) mod newton;
pub(super) mod search;
pub(super) mod signs;
pub(super) mod start;
