//! Right-hand sides on the cube, and problems with known solutions there.

mod body;
mod exact;

pub use body::Body;
pub use exact::{Exact, Sample};

/// A right-hand side f on the cube (-1/2, 1/2)^3.
pub type Source = super::source::Source<Body>;
