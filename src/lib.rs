//! The semicoercive scalar Signorini problem: Maksimova's study replicated, and what lies past it.

pub mod book;
pub mod cli;
pub mod draw;
pub mod error;
pub mod exact;
pub mod fast;
pub mod fields;
pub mod grid;
pub mod identify;
pub mod kkt;
pub mod load;
pub mod norms;
pub mod paper;
pub mod pipeline;
pub mod project;
pub mod saddle;
pub mod scene;
pub mod source;
pub mod stages;
pub mod stiffness;
pub mod table;
pub mod transfer;
