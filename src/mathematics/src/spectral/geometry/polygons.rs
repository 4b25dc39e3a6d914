//! Polygons with contact on all sides, for tests.

use super::domain::{PlaneDomain, PlaneError, PlaneSide};
use super::frame::Frame;
use crate::mesh::Condition;

impl PlaneDomain {
    /// Domain with these loops in coordinates of the plane.
    pub(in crate::spectral) fn new(loops: Vec<Vec<PlaneSide>>) -> Result<Self, PlaneError> {
        Self::seen(Frame::default(), loops)
    }
}

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
