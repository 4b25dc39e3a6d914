//! Right-hand sides on the cube, and problems with known solutions there.

mod exact;
mod source;

pub use exact::{Exact, Sample};
pub use source::{Body, Source, SourceError};
