//! Domains of meshes: the edges of a boundary joined to straight sides and arcs of circles.

use crate::mesh::{ClosedCurve, Round};
use crate::problem::complex::Complex;
use crate::problem::law::Law;
use crate::spectral::complex::{arg, distance};
use crate::spectral::error::PlaneError;
use crate::spectral::geometry::curve::Curve;
use crate::spectral::geometry::frame::Frame;
use crate::spectral::geometry::side::PlaneSide;
use std::f64::consts::TAU;

/// Most sides of a closed curve, for which the time is still one of seconds.
const MOST_SIDES: usize = 60;
/// Sine of the angle between two edges below which both belong to one straight side.
const STRAIGHT: f64 = 1e-6;
/// Distance of a node from the line between two corners, over the size of the curve, from which on it is a corner;
/// nearer ones are bends, which are kept too, but have no functions of their own.
const OFF: f64 = 1e-9;
/// That distance up to which it is on the line: the rounding errors of coordinates.
const ON_LINE: f64 = 1e-15;
/// Distance of a corner from its curves, over the size of the curve: the rounding errors of points of circles.
const APART: f64 = 1e-14;

/// Returns the sides of a closed curve of a boundary, whose parts lie on these circles, all in the coordinates of a
/// frame.
///
/// # Errors
/// [`PlaneError::Domain`].
pub(crate) fn outline(
    curve: &ClosedCurve,
    circles: &[Option<Round<2>>],
    frame: Frame,
) -> Result<Vec<PlaneSide>, PlaneError> {
    let mut edges = Vec::new();
    for (k, &law) in curve.laws.iter().enumerate() {
        let part = curve.parts.get(k).map_or(0, |&part| usize::from(part));
        let circle = circles.get(part).copied().flatten();
        edges.push(OutlineEdge { circle, law: frame.law(law), part });
    }
    let points = curve.points.iter().chain(curve.points.first());
    let points = points.map(|&[x, y]| Complex::new(x, y)).collect();
    let outline = MeshOutline::new(points, edges, frame);
    let sides = outline.corners().len();
    if sides > MOST_SIDES {
        let part = curve.label().filter(|part| !part.contains(", "));
        let hint = part.and_then(|part| outline.circle_in_words(&part)).unwrap_or_default();
        return Err(PlaneError::Domain(format!(
            "the boundary has {sides} sides, more than {MOST_SIDES}; a curved part is one side if `curve` puts it on a \
             circle{hint}"
        )));
    }
    outline.sides()
}

/// Edge of a curve, but for its ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct OutlineEdge {
    /// Circle on which it lies; none if it is straight.
    pub circle: Option<Round<2>>,
    /// Law on the boundary, in the coordinates of the frame.
    pub law: Law,
    /// Position of its part among those of the mesh.
    pub part: usize,
}

/// Edges of a curve from node to node, closed or open.
pub(crate) struct MeshOutline {
    /// Nodes; of a closed curve the first is also the last.
    points: Vec<Complex>,
    /// Edge after each node but the last.
    edges: Vec<OutlineEdge>,
    is_closed: bool,
    /// Diameter, about.
    size: f64,
    /// Coordinates of the nodes.
    frame: Frame,
}

impl MeshOutline {
    /// Path of edges between nodes, one more.
    pub(crate) fn new(points: Vec<Complex>, edges: Vec<OutlineEdge>, frame: Frame) -> Self {
        let size = points.iter().map(|&z| (z - points[0]).norm()).fold(0.0, f64::max);
        let is_closed = points[0] == points[points.len() - 1];
        Self { points, edges, is_closed, size, frame }
    }

    /// PlaneNode before which an edge is the last of all, and after which the first: of a closed curve, the one before
    /// it.
    fn edges_at(&self, k: usize) -> [Option<usize>; 2] {
        let many = self.edges.len();
        match (k, self.is_closed) {
            (0, true) => [Some(many - 1), Some(0)],
            (0, false) => [None, Some(0)],
            _ => [Some(k - 1), Some(k).filter(|k| *k < many)],
        }
    }

    /// Nodes at corners.
    fn corners(&self) -> Vec<usize> {
        let mut corners: Vec<_> = (0..self.edges.len()).filter(|&k| self.is_corner(k)).collect();
        if corners.is_empty() {
            // A circle, which begins somewhere.
            corners.push(0);
        }
        for span in self.spans(&corners) {
            corners.extend(self.off_line(span, OFF).into_iter().map(|k| k % self.edges.len()));
        }
        corners.sort_unstable();
        corners
    }

    /// First and last nodes between corners, the last perhaps a turn farther.
    fn spans(&self, corners: &[usize]) -> Vec<[usize; 2]> {
        let many = self.edges.len();
        let end = if self.is_closed { corners[0] + many } else { many };
        let next = corners[1..].iter().copied().chain([end]);
        corners.iter().zip(next).map(|(&from, to)| [from, to]).collect()
    }

    /// Nodes between two others without which the path is farther than this from them, over its size, as long as it is
    /// straight: the farthest node, and so on on both sides of it.
    fn off_line(&self, [from, to]: [usize; 2], tolerance: f64) -> Vec<usize> {
        let (many, node) = (self.edges.len(), |k: usize| self.points[k % self.edges.len()]);
        if self.edges[from % many].circle.is_some() || to <= from + 1 {
            return Vec::new();
        }
        let off = |k: usize| distance([node(from), self.end_node(to)], node(k));
        let farthest = (from + 1..to).max_by(|&j, &k| off(j).total_cmp(&off(k)));
        let Some(k) = farthest.filter(|&k| off(k) > tolerance * self.size) else {
            return Vec::new();
        };
        let [before, after] = [[from, k], [k, to]].map(|span| self.off_line(span, tolerance));
        [before, vec![k], after].concat()
    }

    /// Node at the end of a path, perhaps a turn farther.
    fn end_node(&self, k: usize) -> Complex {
        if k < self.points.len() { self.points[k] } else { self.points[k % self.edges.len()] }
    }

    fn is_corner(&self, k: usize) -> bool {
        let [Some(before), Some(after)] = self.edges_at(k) else { return true };
        if self.edges[before] != self.edges[after] {
            return true;
        }
        let [u, v] = [before, after].map(|edge| self.points[edge + 1] - self.points[edge]);
        let turns = u.cross(v).abs() > STRAIGHT * u.norm() * v.norm() || u.dot(v) < 0.0;
        turns && self.edges[after].circle.is_none()
    }

    /// Sides between corners and bends.
    ///
    /// # Errors
    /// [`PlaneError::Domain`].
    pub(crate) fn sides(&self) -> Result<Vec<PlaneSide>, PlaneError> {
        let (corners, many) = (self.corners(), self.edges.len());
        let mut places = Vec::new();
        for &corner in &corners {
            places.push(self.corner(corner)?);
        }
        places.push(if self.is_closed { places[0] } else { self.corner(many)? });
        let mut sides = Vec::new();
        for (span, ends) in self.spans(&corners).into_iter().zip(places.windows(2)) {
            let OutlineEdge { circle, law, part } = self.edges[span[0]];
            if let Some(circle) = circle {
                sides.push(self.arc(circle, span, [ends[0], ends[1]]));
                continue;
            }
            let bends = self.off_line(span, ON_LINE).into_iter().map(|k| self.points[k % many]);
            let nodes: Vec<Complex> = [ends[0]].into_iter().chain(bends).chain([ends[1]]).collect();
            for (k, pair) in nodes.windows(2).enumerate() {
                let ends = [pair[0], pair[1]].map(Complex::coordinates);
                let side = PlaneSide::segment(ends, law, part);
                sides.push(PlaneSide { is_after_bend: k > 0, ..side });
            }
        }
        Ok(sides)
    }

    /// Place of a corner, on the lines and circles of the sides that meet there.
    fn corner(&self, k: usize) -> Result<Complex, PlaneError> {
        /// Projections onto two curves in turn, enough for angles down to a tenth.
        const PROJECTIONS: usize = 4000;
        let node = self.points[k];
        let mut curves = Vec::new();
        for edge in self.edges_at(k).into_iter().flatten() {
            curves.push(match self.edges[edge].circle {
                Some(circle) => OnCurve::Round(circle),
                None => {
                    let way = self.points[edge + 1] - self.points[edge];
                    OnCurve::Line(Curve::line(node, way.scaled(1.0 / way.norm())))
                }
            });
        }
        let mut z = node;
        for _ in 0..PROJECTIONS {
            if greatest_distance(&curves, z) <= 0.1 * APART * self.size {
                break;
            }
            z = curves.iter().fold(z, |z, curve| curve.nearest(z));
        }
        match greatest_distance(&curves, z) {
            by if by <= APART * self.size => Ok(z),
            by => {
                let [x, y] = self.frame.outside(node);
                let by = self.frame.unit * by;
                Err(PlaneError::Domain(format!(
                    "two sides do not meet in the node ({x}, {y}), by {by:.1e}; write the mesh with 16 digits"
                )))
            }
        }
    }

    /// Arc from one node to another, whose places are given.
    fn arc(&self, circle: Round<2>, [from, to]: [usize; 2], ends: [Complex; 2]) -> PlaneSide {
        let (OutlineEdge { law, part, .. }, many) = (self.edges[from], self.edges.len());
        let between = (from + 1..to).map(|k| self.points[k % many]);
        let [x, y] = circle.centre;
        let middle = Complex::new(x, y);
        let (mut turn, mut before) = (0.0, ends[0] - middle);
        for node in between.chain([ends[1]]) {
            turn += arg(before.conj() * (node - middle));
            before = node - middle;
        }
        if to - from == many && self.is_closed {
            turn = TAU.copysign(turn);
        }
        let start = arg(ends[0] - middle);
        PlaneSide::arc(circle, [start, start + turn], law, part)
    }

    /// Circle on which all nodes lie, as `curve` wants it for a part; none if there is none.
    fn circle_in_words(&self, part: &str) -> Option<String> {
        /// Distance of nodes from the circle, in radii.
        const ON_CIRCLE: f64 = 1e-4;
        let many = self.edges.len();
        let circle = circle_through([0, 1, 2].map(|k| self.points[k * many / 3]))?;
        let off = self.points.iter().map(|z| circle.distance(z.coordinates()));
        let is_round = off.fold(0.0, f64::max) < ON_CIRCLE * circle.radius;
        let Frame { unit, .. } = self.frame;
        let [x, y] = circle.centre;
        let [x, y] = self.frame.outside(Complex::new(x, y)).map(short);
        let radius = short(unit * circle.radius);
        is_round.then(|| format!(", as {part}={x},{y},{radius}"))
    }
}

/// A number without the digits that rounding of a file may have made.
fn short(value: f64) -> f64 {
    let rounded = (value * 1e6).round() / 1e6;
    if (rounded - value).abs() < 1e-9 { rounded + 0.0 } else { value }
}

/// Circle through three points; none through points of a line.
fn circle_through([a, b, c]: [Complex; 3]) -> Option<Round<2>> {
    let (u, v) = (b - a, c - a);
    let twice = 2.0 * u.cross(v);
    if twice.abs() < 1e-12 * u.norm() * v.norm() {
        return None;
    }
    let to_centre = (u.scaled(v.norm2()) - v.scaled(u.norm2())).turned().scaled(1.0 / twice);
    Some(Round::sphere((a + to_centre).coordinates(), to_centre.norm()))
}

/// Line or circle of a side at a corner.
enum OnCurve {
    Line(Curve),
    Round(Round<2>),
}

fn greatest_distance(curves: &[OnCurve], z: Complex) -> f64 {
    curves.iter().map(|curve| (curve.nearest(z) - z).norm()).fold(0.0, f64::max)
}

impl OnCurve {
    fn nearest(&self, z: Complex) -> Complex {
        match self {
            Self::Line(line) => line.at(line.place(z)),
            Self::Round(circle) => {
                let [x, y] = circle.nearest(z.coordinates());
                Complex::new(x, y)
            }
        }
    }
}

#[cfg(test)]
mod tests;
