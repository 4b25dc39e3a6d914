//! Approximations that guaranteed bounds leave out.

use serde::Serialize;

/// Approximation that bounds leave out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum Reserve {
    /// Of integrals of f, by formulas.
    Quadrature,
    /// Of a curved domain, by the polygon or polyhedron of the finest mesh.
    Polygon,
}

impl Reserve {
    /// List of the approximations that are made.
    pub(super) fn list(quadrature: bool, polygon: bool) -> Vec<Self> {
        let made = [(quadrature, Self::Quadrature), (polygon, Self::Polygon)];
        made.into_iter().filter(|(is_made, _)| *is_made).map(|(_, reserve)| reserve).collect()
    }
}
