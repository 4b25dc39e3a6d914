//! Outputs of a scene.

use serde::{Deserialize, Serialize};
use std::fmt;

/// Output for which a scene may ask; no other output is computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Output {
    /// Table of iteration counts and Delta a; of a study, of the numbers of its members.
    Table,
    /// Map of f.
    Source,
    /// Surface of the solution on the finest grid.
    Surface,
    /// Map of the solution on the finest grid, with the boundary in contact.
    Map,
    /// Residuals against iterations.
    History,
    /// Trace and multiplier along the unrolled boundary.
    Contact,
    /// Values of f near the scene's with which the published counts still come out.
    Identify,
    /// Two columns of the table of a study against each other.
    Chart,
}

/// Writes the name used in scenes and file names.
impl fmt::Display for Output {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.serialize(out)
    }
}
