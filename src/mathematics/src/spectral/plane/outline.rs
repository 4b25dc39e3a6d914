//! Outline of a domain in the plane as straight sides and arcs of circles, from the edges of its first mesh.

use crate::mesh::{ClosedCurve, Condition, Round};
use crate::problem::complex::Complex;
use crate::spectral::complex::arg;
use crate::spectral::curve::{Arc, Curve};

/// Side of an outline.
#[derive(Clone, Debug)]
pub(crate) struct OutlineSide {
    /// Straight, or an arc of a circle, with the domain on the left.
    pub arc: Arc,
    /// Condition.
    pub condition: Condition,
    /// Position of its part among those of the mesh.
    pub part: Option<u16>,
}

/// Reason for which the boundary of a mesh is no outline.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum OutlineError {
    /// Too many sides.
    #[error(
        "the boundary has {sides} sides, more than {MOST_SIDES}; a curved part is one side if `curve` puts it on a \
         circle{hint}"
    )]
    Sides {
        /// Number of sides.
        sides: usize,
        /// Circle on which all nodes of a closed curve lie, in words.
        hint: String,
    },
    /// Two curves that do not meet in a node.
    #[error("two sides do not meet in the node ({}, {}), by {by:.1e}; write the mesh with 16 digits", at[0], at[1])]
    Apart {
        /// Node.
        at: [f64; 2],
        /// Distance.
        by: f64,
    },
    /// A side that bends by little.
    #[error("the boundary bends by {by:.1e} near ({}, {}): neither straight nor a corner; mesh it straight", at[0], at[1])]
    Bent {
        /// Node.
        at: [f64; 2],
        /// Distance from the straight side.
        by: f64,
    },
}

/// Most sides of a boundary, for which the time is still one of seconds.
const MOST_SIDES: usize = 60;
/// Least sides of a closed curve that is taken for a circle in a message.
const ROUND: usize = 12;
/// Sine of the angle between two edges below which both belong to one straight side.
const STRAIGHT: f64 = 1e-6;
/// Distance of nodes from their straight side, over the size of the curve, that is taken for rounding of the file.
const OFF: f64 = 1e-9;
/// Distance of a corner from its circles, over the size of the curve.
const APART: f64 = 1e-12;

/// Returns the sides of a closed curve of the boundary, whose parts lie on these circles.
///
/// # Errors
/// [`OutlineError`].
pub(crate) fn outline(
    curve: &ClosedCurve,
    circles: &[Option<Round<2>>],
) -> Result<Vec<OutlineSide>, OutlineError> {
    let edges = BoundaryEdges::new(curve, circles);
    let many = edges.points.len();
    let mut corners: Vec<usize> = (0..many).filter(|&k| edges.is_corner(k)).collect();
    if corners.is_empty() {
        // A circle, which begins somewhere.
        corners.push(0);
    }
    if corners.len() > MOST_SIDES {
        return Err(OutlineError::Sides { sides: corners.len(), hint: edges.circle_in_words(curve) });
    }
    let mut places = Vec::new();
    for &corner in &corners {
        places.push(edges.corner(corner)?);
    }
    let mut sides = Vec::new();
    for (j, &from) in corners.iter().enumerate() {
        let next = (j + 1) % corners.len();
        let to = if corners[next] > from { corners[next] } else { corners[next] + many };
        let arc = edges.side([from, to], [places[j], places[next]])?;
        let part = curve.parts.get(from).copied();
        sides.push(OutlineSide { arc, condition: curve.conditions[from], part });
    }
    Ok(sides)
}

/// Edges of a closed curve, from each node to the next.
struct BoundaryEdges {
    /// Nodes.
    points: Vec<Complex>,
    /// Circle, condition and part of the edge after each node.
    labels: Vec<(Option<Round<2>>, Condition, Option<u16>)>,
    /// Diameter, about.
    size: f64,
}

impl BoundaryEdges {
    fn new(curve: &ClosedCurve, circles: &[Option<Round<2>>]) -> Self {
        let points: Vec<_> = curve.points.iter().map(|&[x, y]| Complex::new(x, y)).collect();
        let mut labels = Vec::new();
        for (k, &condition) in curve.conditions.iter().enumerate() {
            let part = curve.parts.get(k).copied();
            let circle = part.and_then(|part| circles[usize::from(part)]);
            labels.push((circle, condition, part));
        }
        let size = points.iter().map(|&z| (z - points[0]).norm()).fold(0.0, f64::max);
        Self { points, labels, size }
    }

    fn point(&self, k: usize) -> Complex {
        self.points[k % self.points.len()]
    }

    /// True if a side begins at a node.
    fn is_corner(&self, k: usize) -> bool {
        let many = self.points.len();
        let (before, after) = (&self.labels[(k + many - 1) % many], &self.labels[k]);
        if before != after {
            return true;
        }
        if after.0.is_some() {
            return false;
        }
        let [u, v] = [many - 1, 0].map(|back| self.point(k + back + 1) - self.point(k + back));
        u.cross(v).abs() > STRAIGHT * u.norm() * v.norm() || u.dot(v) < 0.0
    }

    /// Point of a corner, on the circles of the sides that meet there.
    fn corner(&self, k: usize) -> Result<Complex, OutlineError> {
        /// Projections onto two curves in turn, enough for angles down to a tenth.
        const PROJECTIONS: usize = 4000;
        let many = self.points.len();
        let node = self.point(k);
        let mut lines = Vec::new();
        for edge in [(k + many - 1) % many, k] {
            let (from, to) = (self.point(edge), self.point(edge + 1));
            lines.push(match self.labels[edge].0 {
                Some(circle) => OnCurve::Circle(circle),
                None => OnCurve::Line(from, (to - from).scaled(1.0 / (to - from).norm())),
            });
        }
        let off = |z: Complex| lines.iter().map(|line| line.distance(z)).fold(0.0, f64::max);
        let mut z = node;
        for _ in 0..PROJECTIONS {
            if off(z) <= 0.1 * APART * self.size {
                break;
            }
            z = lines.iter().fold(z, |z, line| line.nearest(z));
        }
        match off(z) {
            by if by <= APART * self.size => Ok(z),
            by => Err(OutlineError::Apart { at: node.coordinates(), by }),
        }
    }

    /// Side from one node to another, whose places are given.
    fn side(&self, [from, to]: [usize; 2], [a, b]: [Complex; 2]) -> Result<Arc, OutlineError> {
        let Some(circle) = self.labels[from].0 else {
            let (way, length) = (b - a, (b - a).norm());
            let curve = Curve::line(a, way.scaled(1.0 / length));
            for k in from + 1..to {
                let by = curve.distance(self.point(k)).abs();
                if by > OFF * self.size {
                    return Err(OutlineError::Bent { at: self.point(k).coordinates(), by });
                }
            }
            return Ok(Arc { curve, span: [0.0, length], ends: [None; 2] });
        };
        let centre = Complex::new(circle.centre[0], circle.centre[1]);
        let mut turn = 0.0;
        for k in from..to {
            let [u, v] = [k, k + 1].map(|k| self.point(k) - centre);
            turn += arg(u.conj() * v);
        }
        if to - from < self.points.len() {
            // To the places of its ends themselves, which are as near as rounding of the file.
            turn += arg((self.point(from) - centre).conj() * (a - centre)) * -1.0;
            turn += arg((self.point(to) - centre).conj() * (b - centre));
        } else {
            turn = std::f64::consts::TAU.copysign(turn);
        }
        let normal = (a - centre).scaled(1.0 / (a - centre).norm());
        let curve = Curve { origin: a, tangent: normal.turned(), curvature: 1.0 / circle.radius };
        Ok(Arc { curve, span: [0.0, circle.radius * turn], ends: [None; 2] })
    }

    /// Circle on which all nodes of the curve lie, as `curve` wants it, in words; nothing if there is none.
    fn circle_in_words(&self, curve: &ClosedCurve) -> String {
        let many = self.points.len();
        let [a, b, c] = [0, many / 3, 2 * many / 3].map(|k| self.point(k));
        let Some(circle) = circle_through([a, b, c]).filter(|_| many >= ROUND) else {
            return String::new();
        };
        let off = self.points.iter().map(|z| circle.distance(z.coordinates()));
        let part = curve.label().filter(|label| !label.contains(", "));
        match part {
            Some(part) if off.fold(0.0, f64::max) < 1e-4 * circle.radius => {
                let ([x, y], radius) = (circle.centre.map(short), short(circle.radius));
                format!(", as {part}={x},{y},{radius}")
            }
            _ => String::new(),
        }
    }
}

/// A number without the digits that rounding of a file may have made.
fn short(value: f64) -> f64 {
    let rounded = (value * 1e6).round() / 1e6;
    if (rounded - value).abs() < 1e-9 { rounded + 0.0 } else { value }
}

/// Circle through three points; none through points of a line.
pub(crate) fn circle_through([a, b, c]: [Complex; 3]) -> Option<Round<2>> {
    let (u, v) = (b - a, c - a);
    let twice = 2.0 * u.cross(v);
    if twice.abs() < 1e-12 * u.norm() * v.norm() {
        return None;
    }
    let centre = (v.scaled(u.norm2()) - u.scaled(v.norm2())).turned().scaled(-1.0 / twice);
    Some(Round::sphere((a + centre).coordinates(), centre.norm()))
}

/// Line or circle near a corner.
enum OnCurve {
    /// Point and unit tangent.
    Line(Complex, Complex),
    Circle(Round<2>),
}

impl OnCurve {
    fn distance(&self, z: Complex) -> f64 {
        match self {
            Self::Line(origin, tangent) => tangent.cross(z - *origin).abs(),
            Self::Circle(circle) => circle.distance(z.coordinates()),
        }
    }

    fn nearest(&self, z: Complex) -> Complex {
        match self {
            Self::Line(origin, tangent) => *origin + tangent.scaled(tangent.dot(z - *origin)),
            Self::Circle(circle) => {
                let [x, y] = circle.nearest(z.coordinates());
                Complex::new(x, y)
            }
        }
    }
}
