//! Sides of a domain: segments and arcs of circles, and places on them.

use super::curve::{Arc, Curve};
use crate::mesh::Round;
use crate::problem::complex::Complex;
use crate::problem::law::Law;
use crate::spectral::complex::distance;

/// Side of a domain: a segment, or an arc of a circle, with one law.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlaneSide {
    pub(crate) arc: Arc,
    /// Law on it; its value is that of the formula, if there is one.
    pub law: Law,
    /// Position of the formula of its value among those of the domain.
    pub formula: Option<usize>,
    /// Bound of the error of its value, and of what that differs by from those of sides that it meets.
    pub off: f64,
    /// Number of the part of the boundary to which it belongs.
    pub part: usize,
    /// True if it goes on from the side before but for a bend that is too small for a corner.
    pub is_after_bend: bool,
}

impl PlaneSide {
    /// Segment between two points, in walking order.
    pub(crate) fn segment([from, to]: [[f64; 2]; 2], law: Law, part: usize) -> Self {
        let [from, to] = [from, to].map(|[x, y]| Complex::new(x, y));
        let way = to - from;
        let length = way.norm();
        let curve = Curve::line(from, way.scaled(1.0 / length));
        let arc = Arc { curve, span: [0.0, length], ends: [None; 2] };
        Self { arc, law, formula: None, off: 0.0, part, is_after_bend: false }
    }

    /// Arc of a circle between two angles, anticlockwise if they rise; a full circle is one side.
    pub(crate) fn arc(circle: Round<2>, [from, to]: [f64; 2], law: Law, part: usize) -> Self {
        let Round { centre: [x, y], radius, .. } = circle;
        let normal = Complex::unit(from);
        let origin = Complex::new(x, y) + normal.scaled(radius);
        let curve = Curve { origin, tangent: normal.turned(), curvature: 1.0 / radius };
        let span = [0.0, radius * (to - from)];
        let arc = Arc { curve, span, ends: [None; 2] };
        Self { arc, law, formula: None, off: 0.0, part, is_after_bend: false }
    }

    /// True if the law of another one is the same.
    pub(crate) fn has_law_of(&self, other: &Self) -> bool {
        (self.law, self.formula) == (other.law, other.formula)
    }

    /// Length.
    pub(crate) fn length(&self) -> f64 {
        (self.arc.span[1] - self.arc.span[0]).abs()
    }

    /// Point at a distance from the start along the side.
    pub(crate) fn at(&self, s: f64) -> [f64; 2] {
        self.point(s).coordinates()
    }

    /// Distance from the start along the side of its point that is nearest to `z`, about.
    pub(crate) fn nearest(&self, z: Complex) -> f64 {
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
    pub(crate) fn way(&self) -> f64 {
        1.0_f64.copysign(self.arc.span[1] - self.arc.span[0])
    }

    /// Curvature, positive to the left.
    pub(crate) fn curvature(&self) -> f64 {
        self.way() * self.arc.curve.curvature
    }

    /// Point at a distance from the start along the side.
    pub(crate) fn point(&self, s: f64) -> Complex {
        self.arc.curve.at(self.arc.span[0] + self.way() * s)
    }

    /// Direction of the walk at a distance from the start.
    pub(crate) fn tangent(&self, s: f64) -> Complex {
        self.arc.curve.direction(self.arc.span[0] + self.way() * s).scaled(self.way())
    }

    /// Distance from the start to the point of the side's curve next to `z`, if it lies on the side, by a tolerance.
    pub(crate) fn place(&self, z: Complex, tolerance: f64) -> Option<f64> {
        let along = self.way() * (self.arc.curve.place(z) - self.arc.span[0]);
        let period = self.arc.curve.period().unwrap_or(f64::INFINITY);
        let turned = [along, along + period, along - period];
        let length = self.length();
        let on_side = turned.into_iter().find(|s| (-tolerance..=length + tolerance).contains(s));
        on_side.map(|s| s.clamp(0.0, length))
    }

    /// Distance of a point.
    pub(crate) fn distance(&self, z: Complex) -> f64 {
        let [from, to] = [0.0, self.length()].map(|s| self.point(s));
        match self.arc.curve.centre() {
            None => distance([from, to], z),
            Some(_) if self.place(z, 0.0).is_some() => self.arc.curve.distance(z).abs(),
            Some(_) => (z - from).norm().min((z - to).norm()),
        }
    }
}

/// Point of the boundary.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SidePlace {
    /// Number of the side in its loop.
    pub side: usize,
    /// Distance from its start.
    pub s: f64,
}
