//! This paper's replication: its scenes, published tables and records, and the stages that tie them together.

pub mod comparison;
pub mod paper;
pub mod project;
pub mod scene;
pub(crate) mod stages;
