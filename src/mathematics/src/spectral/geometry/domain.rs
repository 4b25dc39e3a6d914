//! Domains of the plane bounded by straight sides and circular arcs.

use super::curve::{Arc, Curve, SAME};
use super::frame::Frame;
use super::ring::PlaneRing;
use crate::mesh::{Names, Round};
use crate::problem::complex::Complex;
use crate::problem::law::Law;
use crate::spectral::complex::distance;

/// Side of a domain: a segment, or an arc of a circle, with one condition.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlaneSide {
    pub(in crate::spectral) arc: Arc,
    /// Condition on it.
    pub law: Law,
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
        Self { arc, law, part, is_after_bend: false }
    }

    /// Arc of a circle between two angles, anticlockwise if they rise; a full circle is one side.
    pub(crate) fn arc(circle: Round<2>, [from, to]: [f64; 2], law: Law, part: usize) -> Self {
        let Round { centre: [x, y], radius, .. } = circle;
        let normal = Complex::unit(from);
        let origin = Complex::new(x, y) + normal.scaled(radius);
        let curve = Curve { origin, tangent: normal.turned(), curvature: 1.0 / radius };
        let span = [0.0, radius * (to - from)];
        let arc = Arc { curve, span, ends: [None; 2] };
        Self { arc, law, part, is_after_bend: false }
    }

    /// Length.
    pub(crate) fn length(&self) -> f64 {
        (self.arc.span[1] - self.arc.span[0]).abs()
    }

    /// Point at a distance from the start along the side.
    pub(in crate::spectral) fn at(&self, s: f64) -> [f64; 2] {
        self.point(s).coordinates()
    }

    /// Distance from the start along the side of its point that is nearest to `z`, about.
    pub(in crate::spectral) fn nearest(&self, z: Complex) -> f64 {
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
    pub(in crate::spectral) fn way(&self) -> f64 {
        1.0_f64.copysign(self.arc.span[1] - self.arc.span[0])
    }

    /// Curvature, positive to the left.
    pub(in crate::spectral) fn curvature(&self) -> f64 {
        self.way() * self.arc.curve.curvature
    }

    /// Point at a distance from the start along the side.
    pub(in crate::spectral) fn point(&self, s: f64) -> Complex {
        self.arc.curve.at(self.arc.span[0] + self.way() * s)
    }

    /// Direction of the walk at a distance from the start.
    pub(in crate::spectral) fn tangent(&self, s: f64) -> Complex {
        self.arc.curve.direction(self.arc.span[0] + self.way() * s).scaled(self.way())
    }

    /// Distance from the start to the point of the side's curve next to `z`, if it lies on the side, by a tolerance.
    pub(in crate::spectral) fn place(&self, z: Complex, tolerance: f64) -> Option<f64> {
        let along = self.way() * (self.arc.curve.place(z) - self.arc.span[0]);
        let period = self.arc.curve.period().unwrap_or(f64::INFINITY);
        let turned = [along, along + period, along - period];
        let length = self.length();
        let on_side = turned.into_iter().find(|s| (-tolerance..=length + tolerance).contains(s));
        on_side.map(|s| s.clamp(0.0, length))
    }

    /// Distance of a point.
    pub(in crate::spectral) fn distance(&self, z: Complex) -> f64 {
        let [from, to] = [0.0, self.length()].map(|s| self.point(s));
        match self.arc.curve.centre() {
            None => distance([from, to], z),
            Some(_) if self.place(z, 0.0).is_some() => self.arc.curve.distance(z).abs(),
            Some(_) => (z - from).norm().min((z - to).norm()),
        }
    }
}

/// Domain of the plane: closed loops of sides with the domain on the left, the outer one first and anticlockwise, holes
/// clockwise.
#[derive(Clone, Debug, Default)]
pub(crate) struct PlaneDomain {
    /// Coordinates of all its points.
    pub(in crate::spectral) frame: Frame,
    /// Names of the parts of the boundary; none of the square.
    pub(in crate::spectral) parts: Vec<Names>,
    pub(in crate::spectral) rings: Vec<PlaneRing>,
}

/// Point of the boundary.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SidePlace {
    /// Number of the side in its loop.
    pub side: usize,
    /// Distance from its start.
    pub s: f64,
}

impl PlaneDomain {
    /// Domain with these loops in the coordinates of a frame.
    ///
    /// # Errors
    /// [`PlaneError::Domain`] if a loop does not close, two of its sides lie on each other, or the domain does not lie
    /// on its left.
    pub(in crate::spectral) fn seen(
        frame: Frame,
        loops: Vec<Vec<PlaneSide>>,
    ) -> Result<Self, PlaneError> {
        /// Distance, over the diameter, up to which sides that meet may be apart: rounding of points of circles.
        const MEET: f64 = 2e-14;
        /// That from which on sides beside each other leave room between them.
        const CLOSE: f64 = 1e-9;
        /// Least length of a side, over the diameter, and over the perimeter: shorter ones are one point of a walk.
        const SHORTEST: [f64; 2] = [1e-9, 2e-10];
        let rings = loops.into_iter().map(PlaneRing::new).collect();
        let domain = Self { frame, rings, ..Self::default() };
        let size = domain.diameter();
        let shortest = (SHORTEST[0] * size).max(SHORTEST[1] * domain.perimeter());
        for (number, ring) in domain.rings.iter().enumerate() {
            let sides = &ring.sides;
            let closes = (0..sides.len()).all(|k| {
                let before = ring.before(k);
                (before.point(before.length()) - sides[k].point(0.0)).norm() <= MEET * size
            });
            if sides.is_empty() || !closes {
                return Err(PlaneError::Domain(format!(
                    "loop {number} of the boundary does not close"
                )));
            }
            if let Some(short) = sides.iter().find(|side| side.length() < shortest) {
                let [x, y] = frame.outside(short.point(0.0));
                return Err(PlaneError::Domain(format!(
                    "the boundary has a side of length {:.1e} at ({x}, {y}), too short for this solver; join both ends",
                    frame.unit * short.length()
                )));
            }
            if has_slit(sides, CLOSE * size) {
                let text = "the domain has a slit, and this solver wants room between the sides of its boundary";
                return Err(PlaneError::Domain(text.into()));
            }
            let middle = 0.5 * sides[0].length();
            let inwards = sides[0].tangent(middle).turned().scaled(1e-6 * size);
            if !domain.holds(sides[0].point(middle) + inwards) {
                return Err(PlaneError::Domain(format!(
                    "the domain lies on the right of loop {number}"
                )));
            }
        }
        Ok(domain)
    }

    /// All sides.
    pub(in crate::spectral) fn sides(&self) -> impl Iterator<Item = &PlaneSide> {
        self.rings.iter().flat_map(|ring| &ring.sides)
    }

    /// Length of the diagonal of the box round the domain.
    pub(in crate::spectral) fn diameter(&self) -> f64 {
        let [[left, right], [low, high]] = self.extent();
        libm::hypot(right - left, high - low)
    }

    /// Least and greatest coordinates, to a hundredth of a turn of arcs.
    pub(in crate::spectral) fn extent(&self) -> [[f64; 2]; 2] {
        let mut extent = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
        for side in self.sides() {
            for k in 0..=100 {
                let point = side.at(side.length() * f64::from(k) / 100.0);
                for (range, t) in extent.iter_mut().zip(point) {
                    *range = [range[0].min(t), range[1].max(t)];
                }
            }
        }
        extent
    }

    /// Middle of the box round the domain.
    pub(in crate::spectral) fn centre(&self) -> Complex {
        let [[left, right], [low, high]] = self.extent();
        Complex::new(0.5 * (left + right), 0.5 * (low + high))
    }

    /// Length of the boundary.
    pub(in crate::spectral) fn perimeter(&self) -> f64 {
        self.sides().map(PlaneSide::length).sum()
    }

    /// Distance of a point from the boundary.
    pub(in crate::spectral) fn distance(&self, z: Complex) -> f64 {
        self.sides().map(|side| side.distance(z)).fold(f64::INFINITY, f64::min)
    }

    /// Distance of a point from the boundary, negative outside of the domain.
    pub(in crate::spectral) fn depth(&self, z: Complex) -> f64 {
        let distance = self.distance(z);
        if self.holds(z) { distance } else { -distance }
    }

    /// Loop, side and place of the boundary next to a point.
    pub(in crate::spectral) fn nearest(&self, z: Complex) -> (usize, SidePlace) {
        let nearest = self.rings.iter().map(|ring| ring.nearest(z)).enumerate();
        let nearest = nearest.min_by(|(_, one), (_, other)| one.1.total_cmp(&other.1));
        let (ring, (side, _)) = nearest.expect("a domain has a boundary");
        (ring, SidePlace { side, s: self.rings[ring].sides[side].nearest(z) })
    }

    /// Distance at which a ray from a point, which may lie on the boundary, first meets the boundary.
    pub(in crate::spectral) fn exit(&self, z: Complex, direction: Complex) -> f64 {
        let hits = ray_hits(self.sides(), z, direction).into_iter().map(|hit| hit.distance);
        hits.filter(|&s| s > SAME).fold(f64::INFINITY, f64::min)
    }

    /// True if the domain holds a point.
    pub(in crate::spectral) fn holds(&self, z: Complex) -> bool {
        let mut inside = false;
        for direction in directions() {
            let hits = ray_hits(self.sides(), z, direction);
            inside = hits.iter().filter(|hit| hit.distance > 0.0).count() % 2 == 1;
            if !hits.iter().any(|hit| hit.is_unsure) {
                break;
            }
        }
        inside
    }

    /// Largest length of the boundary between two points on both sides of a corner, over their distance: one over the
    /// sine of half of its angle, or more.
    pub(in crate::spectral) fn longest_detour(&self) -> f64 {
        let mut least = 1.0f64;
        for ring in &self.rings {
            for k in 0..ring.sides.len() {
                let [before, after] = ring.tangents(k);
                least = least.min(before.dot(after));
            }
        }
        (0.5 * (1.0 + least)).max(f64::MIN_POSITIVE).sqrt().recip()
    }

    /// Points of the domain, so many if it is not tiny in the box round it.
    pub(in crate::spectral) fn inner_points(&self, many: usize) -> Vec<Complex> {
        let [[left, right], [low, high]] = self.extent();
        let scattered = (0..2000).map(|k| {
            let [x, y] = [0.618_034 * f64::from(k) + 0.31, 0.754_878 * f64::from(k) + 0.17];
            let (x, y) = (x - x.floor(), y - y.floor());
            Complex::new(left + (right - left) * x, low + (high - low) * y)
        });
        scattered.filter(|&z| self.holds(z)).take(many).collect()
    }
}

/// Directions of rays that are tried in turn.
pub(in crate::spectral) fn directions() -> impl Iterator<Item = Complex> {
    (0..50).map(|k| Complex::unit(0.7 + 2.4 * f64::from(k)))
}

/// Point at which a ray meets a side.
pub(in crate::spectral) struct RayHit {
    pub distance: f64,
    /// Position of the side among all.
    pub side: usize,
    /// True if the ray comes from the left of the side.
    pub is_left: bool,
    /// True if it meets the side near to one of its ends, or nearly along it.
    pub is_unsure: bool,
}

/// Points at which a ray from `z` meets sides, not in order.
pub(in crate::spectral) fn ray_hits<'a>(
    sides: impl Iterator<Item = &'a PlaneSide>,
    z: Complex,
    direction: Complex,
) -> Vec<RayHit> {
    let (ray, mut hits) = (Curve::line(z, direction), Vec::new());
    for (number, side) in sides.enumerate() {
        for distance in ray.meets(side.arc.curve) {
            let Some(t) = side.place(ray.at(distance), SAME) else { continue };
            let across = direction.cross(side.tangent(t));
            let is_at_end = t < 1e-9 || t > side.length() - 1e-9;
            hits.push(RayHit {
                distance,
                side: number,
                is_left: across > 0.0,
                is_unsure: is_at_end || across.abs() < 1e-6,
            });
        }
    }
    hits
}

/// True if the middle of a side of a loop lies on another one that runs the other way, by a tolerance.
fn has_slit(sides: &[PlaneSide], tolerance: f64) -> bool {
    sides.iter().enumerate().any(|(k, side)| {
        let middle = 0.5 * side.length();
        let (point, along) = (side.point(middle), side.tangent(middle));
        sides.iter().enumerate().any(|(j, other)| {
            j != k
                && other.distance(point) < tolerance
                && other.tangent(other.nearest(point)).dot(along) < 0.0
        })
    })
}

/// Reason for which there is no solution.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PlaneError {
    /// The domain is not as said.
    #[error("{0}")]
    Domain(String),
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
            Self::Source(_) => Some("change f"),
            Self::NotFound(_) => None,
        }
    }
}
