//! Tests of the proof: solutions whose energy is known by other means, as they are and spoilt by known amounts, and
//! setups that must be refused.

pub(super) mod bench;
mod ends;
pub(super) mod known;
mod refused;
pub(super) mod spoilt;
