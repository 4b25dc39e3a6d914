//! Reasons for which the plane solver has no solution.

/// Reason for which there is no solution.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PlaneError {
    /// The domain is not as said.
    #[error("{0}")]
    Domain(String),
    /// The equation is another.
    #[error("the true solution is that for k = 1 without a reaction")]
    Operator,
    /// f is not one that is served.
    #[error("{0}")]
    Source(String),
    /// The contact set was not found, or a check failed.
    #[error("{0}")]
    NotFound(String),
}

impl PlaneError {
    /// Change of the input that this solver needs; none if no solution was found.
    pub fn remedy(&self) -> Option<&'static str> {
        match self {
            Self::Domain(_) => Some("change the domain"),
            Self::Operator => Some("leave out k and the reaction"),
            Self::Source(_) => Some("change f"),
            Self::NotFound(_) => None,
        }
    }
}
