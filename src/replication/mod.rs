//! Replication of this paper: its scenes, published tables and records, and the stages of a run.
//!
//! Central are `stages::plan`, which turns scenes into tasks, and `Paper::compare`, which compares the tables.

pub(crate) mod columns;
pub mod comparison;
pub(crate) mod fields;
pub(crate) mod identified;
pub(crate) mod limits;
pub(crate) mod mesh_files;
pub(crate) mod numbers;
pub mod output;
pub mod paper;
pub mod project;
pub(crate) mod record;
pub mod scene;
pub(crate) mod scenes;
pub(crate) mod stages;
pub(crate) mod study;
#[cfg(test)]
mod tests;
pub(crate) mod written;
