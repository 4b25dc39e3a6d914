//! The semicoercive scalar Signorini problem: a replication of Maksimova's study, and results beyond it.
//!
//! The mathematics is a package of its own, `signorini-mathematics`; each module names it where it uses it. So is the
//! pipeline, `signorini-pipeline`, which has the place of a module here.

pub mod cli;
pub(crate) mod figures;
pub mod replication;
pub mod report;
pub(crate) mod table;
pub mod timing;

pub use signorini_pipeline as pipeline;
