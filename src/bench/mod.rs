//! Numerical experiments that go past the paper, as pure functions from a plan to plain data.
//!
//! What they count (errors, sweeps, work units, flipped counts) depends on no machine: it is hashed,
//! cached and pinned like everything else. Time is measured apart, by `signorini bench`.

pub mod claims;
pub mod lanes;
pub mod reference;
pub mod rounding;
pub mod stress;
pub mod trial;
