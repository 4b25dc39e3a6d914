//! Loops of sides and domains for tests.

use super::domain::PlaneDomain;
use super::frame::Frame;
use super::side::PlaneSide;
use crate::mesh::Round;
use crate::problem::law::Law;
use crate::spectral::error::PlaneError;
use std::f64::consts::PI;

impl PlaneDomain {
    /// Domain with these loops in coordinates of the plane.
    pub(crate) fn new(loops: Vec<Vec<PlaneSide>>) -> Result<Self, PlaneError> {
        Self::seen(Frame::default(), loops)
    }

    /// The domain with another law on sides that have the paper's.
    pub(crate) fn with_law(mut self, law: Law) -> Self {
        let sides = self.rings.iter_mut().flat_map(|ring| &mut ring.sides);
        sides.filter(|side| side.law == Law::SIGNORINI).for_each(|side| side.law = law);
        self
    }
}

/// Full circle round the origin.
pub(crate) fn circle(radius: f64, law: Law, is_outer: bool) -> Vec<PlaneSide> {
    let angles = if is_outer { [0.0, 2.0 * PI] } else { [2.0 * PI, 0.0] };
    let own = Round::sphere([0.0; 2], radius);
    vec![PlaneSide::arc(own, angles, law, usize::from(!is_outer))]
}

/// Sides between these corners, with a condition each.
pub(crate) fn loop_of(points: &[[f64; 2]], laws: &[Law]) -> Vec<PlaneSide> {
    let ends = |k: usize| [points[k], points[(k + 1) % points.len()]];
    let sides = laws.iter().enumerate();
    sides.map(|(k, &law)| PlaneSide::segment(ends(k), law, k)).collect()
}

/// Polygon with these corners, anticlockwise, in contact on all sides.
pub(crate) fn polygon(points: &[[f64; 2]]) -> PlaneDomain {
    PlaneDomain::new(vec![loop_of(points, &vec![Law::SIGNORINI; points.len()])]).unwrap()
}

/// Unit square round the origin.
pub(crate) fn square() -> PlaneDomain {
    polygon(&[[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]])
}
