//! Domains of the plane bounded by straight sides and circular arcs.

use super::boundary::PlaneInterval;
use super::curve::{Curve, SAME};
use super::frame::Frame;
use super::ring::PlaneRing;
use super::side::{PlaneSide, SidePlace};
use crate::mesh::Names;
use crate::problem::complex::Complex;
use crate::spectral::error::PlaneError;
use crate::spectral::smooth::Smooth;

/// Domain of the plane: closed loops of sides with the domain on the left, the outer one first and anticlockwise, holes
/// clockwise.
#[derive(Clone, Debug, Default)]
pub(crate) struct PlaneDomain {
    /// Coordinates of all its points.
    pub(crate) frame: Frame,
    /// Names of the parts of the boundary; none of the square.
    pub(crate) parts: Vec<Names>,
    pub(crate) rings: Vec<PlaneRing>,
    /// Values of laws that are no numbers.
    pub(crate) values: Vec<Smooth>,
}

impl PlaneDomain {
    /// Domain with these loops in the coordinates of a frame.
    ///
    /// # Errors
    /// [`PlaneError::Domain`] if a loop does not close, two of its sides lie on each other, or the domain does not lie
    /// on its left.
    pub(crate) fn seen(frame: Frame, loops: Vec<Vec<PlaneSide>>) -> Result<Self, PlaneError> {
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
    pub(crate) fn sides(&self) -> impl Iterator<Item = &PlaneSide> {
        self.rings.iter().flat_map(|ring| &ring.sides)
    }

    /// True if v = 0 is not what all laws have; without it the energy of v = 0 is zero.
    pub(crate) fn has_values(&self) -> bool {
        self.sides().any(|side| side.formula.is_some() || side.law.at() != 0.0)
    }

    /// Side of an interval.
    pub(crate) fn side(&self, interval: &PlaneInterval) -> &PlaneSide {
        &self.rings[interval.ring].sides[interval.side]
    }

    /// Value of the law of a side at a point, with its gradient.
    pub(crate) fn value(&self, side: &PlaneSide, z: Complex) -> (f64, Complex) {
        let own = side.formula.map(|k| (self.values[k].value(z), self.values[k].gradient(z)));
        own.unwrap_or((side.law.at(), Complex::default()))
    }

    /// Length of the diagonal of the box round the domain.
    pub(crate) fn diameter(&self) -> f64 {
        let [[left, right], [low, high]] = self.extent();
        libm::hypot(right - left, high - low)
    }

    /// Least and greatest coordinates, to a hundredth of a turn of arcs.
    pub(crate) fn extent(&self) -> [[f64; 2]; 2] {
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
    pub(crate) fn centre(&self) -> Complex {
        let [[left, right], [low, high]] = self.extent();
        Complex::new(0.5 * (left + right), 0.5 * (low + high))
    }

    /// Length of the boundary.
    pub(crate) fn perimeter(&self) -> f64 {
        self.sides().map(PlaneSide::length).sum()
    }

    /// Distance of a point from the boundary.
    pub(crate) fn distance(&self, z: Complex) -> f64 {
        self.sides().map(|side| side.distance(z)).fold(f64::INFINITY, f64::min)
    }

    /// Distance of a point from the boundary, negative outside of the domain.
    pub(crate) fn depth(&self, z: Complex) -> f64 {
        let distance = self.distance(z);
        if self.holds(z) { distance } else { -distance }
    }

    /// Loop, side and place of the boundary next to a point.
    pub(crate) fn nearest(&self, z: Complex) -> (usize, SidePlace) {
        let nearest = self.rings.iter().map(|ring| ring.nearest(z)).enumerate();
        let nearest = nearest.min_by(|(_, one), (_, other)| one.1.total_cmp(&other.1));
        let (ring, (side, _)) = nearest.expect("a domain has a boundary");
        (ring, SidePlace { side, s: self.rings[ring].sides[side].nearest(z) })
    }

    /// Distance at which a ray from a point, which may lie on the boundary, first meets the boundary.
    pub(crate) fn exit(&self, z: Complex, direction: Complex) -> f64 {
        let hits = ray_hits(self.sides(), z, direction).into_iter().map(|hit| hit.distance);
        hits.filter(|&s| s > SAME).fold(f64::INFINITY, f64::min)
    }

    /// True if the domain holds a point.
    pub(crate) fn holds(&self, z: Complex) -> bool {
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
    pub(crate) fn longest_detour(&self) -> f64 {
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
    pub(crate) fn inner_points(&self, many: usize) -> Vec<Complex> {
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
pub(crate) fn directions() -> impl Iterator<Item = Complex> {
    (0..50).map(|k| Complex::unit(0.7 + 2.4 * f64::from(k)))
}

/// Point at which a ray meets a side.
pub(crate) struct RayHit {
    pub distance: f64,
    /// Position of the side among all.
    pub side: usize,
    /// True if the ray comes from the left of the side.
    pub is_left: bool,
    /// True if it meets the side near to one of its ends, or nearly along it.
    pub is_unsure: bool,
}

/// Points at which a ray from `z` meets sides, not in order.
pub(crate) fn ray_hits<'a>(
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
