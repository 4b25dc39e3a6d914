//! Right-hand sides on the cube, and problems with known solutions there.

mod body;
mod exact;
mod source;

pub use body::Body;
pub use exact::{Exact, Sample};
pub use source::{Source, SourceError};
