//! Law on the boundary and load vector: all of a discrete problem but its grid or mesh.
//!
//! A solver takes both at once. Neither is a setting of the solver, and neither has a default, so that no caller can
//! forget the law.

use crate::problem::law::Law;

/// Law on the boundary, and load vector.
#[derive(Clone, Copy, Debug)]
pub struct LawAndLoad<'a> {
    /// Law on the boundary.
    pub law: Law,
    /// Load vector F (6), one number per node.
    pub load: &'a [f64],
}

impl Law {
    /// Returns this law with a load vector.
    pub fn with_load(self, load: &[f64]) -> LawAndLoad<'_> {
        LawAndLoad { law: self, load }
    }
}
