//! Domains of the plane bounded by straight sides and circular arcs.

use super::PlaneError;
use crate::mesh::Condition;
use crate::problem::complex::Complex;
use crate::spectral::curve::{Arc, Curve};

/// Side of a domain: a segment, or an arc of a circle, with one condition.
#[derive(Clone, Copy, Debug)]
pub struct PlaneSide {
    pub(super) arc: Arc,
    /// Condition on it.
    pub condition: Condition,
    /// Number of the part of the boundary to which it belongs.
    pub part: usize,
}

impl PlaneSide {
    /// Segment between two points, in walking order.
    pub fn segment([from, to]: [[f64; 2]; 2], condition: Condition, part: usize) -> Self {
        let [from, to] = [from, to].map(|[x, y]| Complex::new(x, y));
        let way = to - from;
        let length = way.norm();
        let curve = Curve::line(from, way.scaled(1.0 / length));
        Self { arc: Arc { curve, span: [0.0, length], ends: [None; 2] }, condition, part }
    }

    /// Arc of a circle between two angles, anticlockwise if they rise; a full circle is one side.
    pub fn arc(circle: Circle, [from, to]: [f64; 2], condition: Condition, part: usize) -> Self {
        let Circle { centre: [x, y], radius } = circle;
        let normal = Complex::unit(from);
        let origin = Complex::new(x, y) + normal.scaled(radius);
        let curve = Curve { origin, tangent: normal.turned(), curvature: 1.0 / radius };
        let span = [0.0, radius * (to - from)];
        Self { arc: Arc { curve, span, ends: [None; 2] }, condition, part }
    }

    /// Length.
    pub fn length(&self) -> f64 {
        (self.arc.span[1] - self.arc.span[0]).abs()
    }

    /// Point at a distance from the start along the side.
    pub fn at(&self, s: f64) -> [f64; 2] {
        self.point(s).coordinates()
    }

    /// Distance from the start along the side of its point that is nearest to `z`, about.
    pub(super) fn nearest(&self, z: Complex) -> f64 {
        let Arc { curve, span, .. } = self.arc;
        let (along, length) = (self.way() * (curve.place(z) - span[0]), self.length());
        let Some(period) = curve.period() else { return along.clamp(0.0, length) };
        match along.rem_euclid(period) {
            s if s <= length => s,
            s if s - length < period - s => length,
            _ => 0.0,
        }
    }

    /// 1 if the side runs along its curve, -1 if against it.
    #[inline(always)]
    pub(super) fn way(&self) -> f64 {
        1.0_f64.copysign(self.arc.span[1] - self.arc.span[0])
    }

    /// Point at a distance from the start along the side.
    #[inline(always)]
    pub(super) fn point(&self, s: f64) -> Complex {
        self.arc.curve.at(self.arc.span[0] + self.way() * s)
    }

    /// Direction of the walk at a distance from the start.
    #[inline(always)]
    pub(super) fn tangent(&self, s: f64) -> Complex {
        self.arc.curve.direction(self.arc.span[0] + self.way() * s).scaled(self.way())
    }
}

/// Circle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Circle {
    /// Centre.
    pub centre: [f64; 2],
    /// Radius.
    pub radius: f64,
}

/// Domain of the plane: closed loops of sides with the domain on the left, the outer one first and anticlockwise, holes
/// clockwise.
#[derive(Clone, Debug)]
pub struct PlaneDomain {
    pub(super) loops: Vec<Vec<PlaneSide>>,
}

/// Point of the boundary.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SidePlace {
    /// Number of the side in its loop.
    pub side: usize,
    /// Distance from its start.
    pub s: f64,
}

impl PlaneDomain {
    /// Domain with these loops.
    ///
    /// # Errors
    /// [`PlaneError::Domain`] if a loop does not close, or the domain does not lie on its left.
    pub fn new(loops: Vec<Vec<PlaneSide>>) -> Result<Self, PlaneError> {
        todo!()
    }

    /// Loops of sides, the outer one first.
    pub fn loops(&self) -> &[Vec<PlaneSide>] {
        &self.loops
    }

    /// True if the domain holds a point, by more than rounding.
    pub fn contains(&self, point: [f64; 2]) -> bool {
        todo!()
    }
}
