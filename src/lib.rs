//! The semicoercive scalar Signorini problem: a replication of Maksimova's study, and results beyond it.
//!
//! The mathematics is a package of its own, `signorini-mathematics`; each module names it where it uses it, and so the
//! builder of the book, `signorini-book`. The pipeline, `signorini-pipeline`, has the place of a module here.

pub mod cli;
pub(crate) mod figures;
pub mod replication;
pub(crate) mod table;
pub mod timing;

pub use signorini_pipeline as pipeline;
