//! The semicoercive scalar Signorini problem: Maksimova's study replicated, and what lies past it.
//!
//! The mathematics is a package of its own, whose rooms are named here as if they were this one's.

pub use signorini_mathematics::{
    bounds, discrete, experiments, identify, multigrid, problem, saddle, spectral,
};

pub mod cli;
pub(crate) mod figures;
pub mod pipeline;
pub mod replication;
pub mod report;
#[cfg(test)]
mod sources;
pub mod timing;

/// The README's example of the library, compiled and run with the documentation.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
