//! Polygons with contact on all sides, for tests.

use super::domain::{PlaneDomain, PlaneSide};
use crate::mesh::Condition;

/// Polygon with these corners, anticlockwise.
pub(in crate::spectral) fn polygon(points: &[[f64; 2]]) -> PlaneDomain {
    let side = |k: usize| {
        PlaneSide::segment([points[k], points[(k + 1) % points.len()]], Condition::Contact, 0)
    };
    PlaneDomain::new(vec![(0..points.len()).map(side).collect()]).unwrap()
}

/// Unit square round the origin.
pub(in crate::spectral) fn square() -> PlaneDomain {
    polygon(&[[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]])
}
