//! Warnings of integrals of f that formulas have not found.

use super::domain::Domain;
use signorini_mathematics::discrete::load::missed_on;

/// Error over the integral of |f| from which on a warning is given.
const MISSED: f64 = 1e-3;
/// Cells per side of the grid on which f is looked at, since on finer ones less is missed.
const LOOKED_AT: usize = 256;
/// Cells per side of the finest grid on which f is looked at, if [`LOOKED_AT`] is too coarse.
const FINEST: usize = 512;

impl Domain {
    /// True if f is known by its values only, at least somewhere.
    pub(super) fn is_smooth(&self) -> bool {
        match self {
            Self::Square { f, .. } => f.is_smooth(),
            Self::Mesh(mesh) => mesh.problem.f.unsettled.is_some(),
        }
    }

    /// Returns a warning if the quadrature of f on a grid, or on the mesh, misses more than a small part of f.
    pub(super) fn quadrature_warning(&self, n: usize) -> Option<String> {
        match self {
            Self::Square { f, .. } if f.is_smooth() && f.exact().is_none() => {
                let mut missed = missed_on(f, n.min(LOOKED_AT))?;
                if missed > MISSED && n > LOOKED_AT {
                    missed = missed_on(f, n.min(FINEST))?;
                }
                (missed > MISSED).then(|| {
                    format!(
                        "the quadrature of f on grid 1/{n} misses {missed:.1e} of the integral of |f|; choose a smaller --h"
                    )
                })
            }
            // The bounds take f as it is sampled on a mesh, the load vector its values at the nodes.
            Self::Square { .. } => None,
            Self::Mesh(mesh) => {
                let f = &mesh.problem.f;
                let missed = f.unsettled? / f.size;
                (missed > MISSED).then(|| {
                    format!(
                        "the quadrature of f did not settle and may miss {missed:.1e} of the integral of |f|; write jumps of f as shapes, or refine the mesh"
                    )
                })
            }
        }
    }
}
