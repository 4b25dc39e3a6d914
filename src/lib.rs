//! The semicoercive scalar Signorini problem: a replication of Maksimova's study, and results beyond it.
//!
//! The mathematics is a package of its own, `signorini-mathematics`; each module names it where it uses it, and so the
//! builder of the book, `signorini-book`. The pipeline, `signorini-pipeline`, and the pictures, `signorini-figures`,
//! have the place of modules here.

pub mod cli;
pub mod replication;
pub(crate) mod table;
pub mod timing;

pub(crate) use signorini_figures as figures;
pub use signorini_pipeline as pipeline;
