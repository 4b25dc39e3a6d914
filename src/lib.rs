//! The semicoercive scalar Signorini problem: Maksimova's study replicated, and what lies past it.

pub mod exact;
pub mod grid;
pub mod kkt;
pub mod load;
pub mod saddle;
pub mod source;
pub mod stiffness;
pub mod transfer;
