//! Reasons for which a problem has no solution.

use crate::mesh::{MeshError, MeshSourceError};
use crate::problem::error::SourceError;
use crate::problem::law::{Law, LawError};

/// Reason for which there is no problem with a unique solution.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Unsolvable {
    /// The mesh cannot be refined.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// The text is no f on the mesh.
    #[error(transparent)]
    Text(#[from] MeshSourceError),
    /// f is not finite at some point, or too large or too small to compute with.
    #[error(transparent)]
    Source(#[from] SourceError),
    /// f is not finite at some point.
    #[error("f is not finite at some point; give a formula with finite values on the whole domain")]
    NotFinite,
    /// No solution, or no unique one, under the paper's law: the condition (2) is violated.
    #[error(
        "the integral of f{} is {}, but (2) asks for a negative one; lower f somewhere{}",
        over(*component),
        shown_integral(*integral),
        if *has_parts { ", or fix a part of the boundary" } else { "" }
    )]
    NotCoercive {
        /// Integral of f.
        integral: f64,
        /// Number of the connected component, from 1 on; none if the domain is connected.
        component: Option<usize>,
        /// True if the boundary has parts that can be fixed.
        has_parts: bool,
    },
    /// No solution, or no unique one, under another law.
    #[error("{error}{}", over(*component))]
    Law {
        /// Number of the connected component, from 1 on; none if the domain is connected.
        component: Option<usize>,
        /// Integral of f, and those that the flux can balance.
        error: LawError,
    },
    /// A connected component whose whole boundary is free.
    #[error(
        "the boundary of {} is free everywhere; let some of it be in contact or fixed",
        component.map_or("the domain".into(), |number| format!("component {number} of the domain"))
    )]
    Insulated {
        /// Number of the connected component, from 1 on; none if the domain is connected.
        component: Option<usize>,
    },
}

/// Words for the component of the domain.
fn over(component: Option<usize>) -> String {
    component.map_or_else(String::new, |number| format!(" over component {number} of the domain"))
}

/// Connected component of a domain with f.
pub(super) struct Component {
    /// Number, from 1 on; none if the domain is connected.
    pub number: Option<usize>,
    /// True if v = 0 on a part of its boundary.
    pub has_fixed: bool,
    /// True if the boundary has parts that can be fixed.
    pub has_parts: bool,
    /// Length or area of its boundary in contact.
    pub measure: f64,
    /// Integral of f.
    pub integral: f64,
}

/// Bound of the rounding error of the integral of f, over the integral of |f|.
const ROUNDING: f64 = 1e-12;

impl Component {
    /// Checks the condition (2): the flux that a law allows can balance f, by more than rounding errors of integrals of
    /// this `size`.
    pub(super) fn check(self, law: Law, size: f64) -> Result<(), Unsolvable> {
        let Self { number: component, has_fixed, has_parts, measure, integral } = self;
        if has_fixed {
            return Ok(());
        }
        if measure == 0.0 {
            return Err(Unsolvable::Insulated { component });
        }
        match law.check_solvable_by(ROUNDING * size.abs(), integral, measure) {
            Err(LawError::Unbalanced { integral, .. }) if law.is_signorini() => {
                Err(Unsolvable::NotCoercive { integral, component, has_parts })
            }
            Err(error) => Err(Unsolvable::Law { component, error }),
            Ok(()) => Ok(()),
        }
    }
}

/// Integral of f with the digits that messages and answers show.
pub fn shown_integral(integral: f64) -> String {
    match integral.abs() {
        0.0 => "0".into(),
        1e-2..1e6 => format!("{integral:.4}"),
        _ => format!("{integral:.3e}"),
    }
}
