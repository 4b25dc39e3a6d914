//! Jumps of f in groups: those round small closed shapes, each seen from the middle of its box, and all others.
//!
//! A strong f on a small shape, V on a width e, has an integral of about V e^2, and so has psi outside; seen from far
//! away its terms are V, and their squares would be in the energy.

use super::changes::UNITS;
use super::closed_edges::{ClosedEdges, holds, is_parallel};
use super::far_field::FarField;
use super::psi::{Psi, PsiPart};
use super::quadratic::{Extent, Quadratic};
use crate::problem::complex::Complex;
use crate::spectral::geometry::curve::{Arc, Curve, ROUNDING, beside};
use crate::spectral::geometry::domain::PlaneDomain;
use crate::spectral::source::curves::JumpEdge;
use crate::spectral::source::potential::Potential;

/// Jumps of f, seen from a point.
pub(crate) struct JumpGroup {
    pub middle: Complex,
    pub edges: Vec<GroupEdge>,
    /// psi, seen from there.
    pub psi: Psi,
    /// Box round a small closed shape.
    pub extent: Option<Extent>,
    /// Distance by which borders may be off, of a small shape seen from its middle, but for units of its width.
    pub off: f64,
}

impl JumpGroup {
    /// Bound of the distances of its jumps from where they are seen from, in a domain of about unit size round that.
    pub(crate) fn reach(&self) -> f64 {
        self.extent.map_or(4.0, |extent| extent.half[0] + extent.half[1])
    }
}

/// Jump of f with what it bounds.
pub(crate) struct GroupEdge {
    pub edge: JumpEdge,
    /// One entry for each side, or one for both if they share a quadratic function.
    pub sides: Vec<PieceSide>,
}

/// A side of the border of a piece of f, or of two, in [`quadratic`](super::quadratic)'s integrals.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PieceSide {
    pub quadratic: Quadratic,
    /// f, positive if the normal leads out of the piece; the sum of both.
    pub f: f64,
    /// The same with the square of f.
    pub square: f64,
}

impl PieceSide {
    /// Sum of the pieces on the left and right of a jump, with normals to the right.
    pub(crate) fn of_jump(quadratic: Quadratic, [left, right]: [f64; 2]) -> Self {
        Self { quadratic, f: left - right, square: (left - right) * (left + right) }
    }
}

/// A closed shape that is small, seen from the middle of its box.
struct SmallShape {
    middle: Complex,
    part: PsiPart,
    edges: Vec<JumpEdge>,
    extent: Extent,
    off: f64,
}

/// Groups of jumps, first of all that bound no small closed shape, with psi by f at some points of the domain.
pub(crate) fn groups(
    domain: &PlaneDomain,
    mut potential: Potential,
    mut edges: Vec<JumpEdge>,
    f: impl Fn(Complex) -> f64,
) -> Vec<JumpGroup> {
    let mut shapes = Vec::new();
    for closed in ClosedEdges::all(&edges) {
        if let Some(shape) = SmallShape::of(domain, &potential, &closed) {
            closed.take_from(&mut potential);
            edges.retain(|edge| !closed.edges.iter().any(|own| holds(edge.arc, own)));
            shapes.push(shape);
        }
    }
    let parts = shapes.iter().map(|own| PsiPart { middle: own.middle, ..own.part.clone() });
    let psi = Psi::of_jumps(potential, parts.collect(), &domain.inner_points(25), f);
    let all = Quadratic::round(domain.centre());
    let origin = Complex::default();
    let mut groups = vec![JumpGroup {
        middle: origin,
        edges: edges.iter().map(|own| with_sides(own, (&edges, origin), &shapes, all)).collect(),
        psi,
        extent: None,
        off: UNITS,
    }];
    for SmallShape { middle, edges, extent, off, .. } in &shapes {
        let sides = edges.iter().map(|own| with_sides(own, (edges, *middle), &shapes, all));
        groups.push(JumpGroup {
            middle: *middle,
            edges: sides.collect(),
            psi: groups[0].psi.seen_from(*middle),
            extent: Some(*extent),
            off: *off,
        });
    }
    groups
}

/// An edge with its sides, each by the quadratic function of the innermost shape that it lies in; all are seen from a
/// point, among edges.
fn with_sides(
    edge: &JumpEdge,
    (edges, middle): (&[JumpEdge], Complex),
    shapes: &[SmallShape],
    all: Quadratic,
) -> GroupEdge {
    let around = beside_edge(edge, edges.iter()).map(|z| SmallShape::around(z, middle, shapes));
    let sides = match around {
        [None, None] => vec![PieceSide::of_jump(all.seen_from(middle), edge.values)],
        _ => (0..2)
            .map(|k| {
                let (f, sign) = (edge.values[k], [1.0, -1.0][k]);
                let quadratic = around[k]
                    .map_or(all, |shape| Quadratic::of(shape.extent).seen_from(-shape.middle));
                let quadratic = quadratic.seen_from(middle);
                PieceSide { quadratic, f: sign * f, square: sign * f * f }
            })
            .collect(),
    };
    GroupEdge { edge: edge.clone(), sides }
}

impl SmallShape {
    /// The shape with closed edges, if it is small and round no hole.
    fn of(domain: &PlaneDomain, potential: &Potential, closed: &ClosedEdges) -> Option<Self> {
        /// Width over the diameter of the domain.
        const WIDEST: f64 = 1.0 / 16.0;
        let arcs: Vec<Arc> = closed.edges.iter().map(|edge| edge.arc).collect();
        let extent = Extent::of(&arcs);
        if 2.0 * extent.half[1] > WIDEST * domain.diameter() {
            return None;
        }
        let (middle, sides) = (extent.centre, closed.arcs());
        let (numbers, vertices) = closed.vertices(potential, middle);
        let seen_from = |arc: Arc| {
            let ends = arc.ends.map(|end| end.and_then(|v| numbers.binary_search(&v).ok()));
            seen_from(middle, Arc { ends, ..arc }, &vertices)
        };
        let mut local = Potential { vertices: vertices.clone(), ..Potential::default() };
        sides.iter().for_each(|&(arc, jump)| local.add(seen_from(arc), jump));
        let edges = closed.edges.iter();
        let edges = edges.map(|edge| JumpEdge { arc: seen_from(edge.arc), ..edge.clone() });
        let edges: Vec<JumpEdge> = edges.collect();
        let arcs: Vec<Arc> = local.jumps.iter().map(|jump| jump.arc).collect();
        let extent = Extent::of(&arcs);
        let far = FarField::new(&local, extent);
        let part = PsiPart::new(Complex::default(), local, Some(far));
        // Radii, and coordinates of lines that are parallel to an axis, are those of f.
        let is_exact = sides.iter().all(|(arc, _)| arc.ends == [None; 2] || is_parallel(arc.curve));
        let off = if is_exact { 4.0 * f64::EPSILON * extent.half[1] } else { ROUNDING };
        let shape = Self { middle, part, edges, extent, off };
        let mut holes = domain.rings.iter().map(|ring| ring.sides[0].point(0.0));
        holes.all(|z| shape.is_outside(z - middle)).then_some(shape)
    }

    /// True if f of the shape alone is zero at a point, seen from its middle.
    fn is_outside(&self, z: Complex) -> bool {
        let sizes = self.part.potential.jumps.iter().map(|jump| jump.size.abs());
        self.part.source(z).abs() < 1e-9 * sizes.sum::<f64>()
    }

    /// Innermost shape in which a point lies that is seen from another point.
    fn around(z: Complex, origin: Complex, shapes: &[Self]) -> Option<&Self> {
        let around = shapes.iter().filter(|own| !own.is_outside(z + (origin - own.middle)));
        let around: Vec<&Self> = around.collect();
        let mut inwards = around.iter();
        inwards.find(|own| around.iter().all(|other| !other.lies_in(own))).copied()
    }

    /// True if it lies in another shape.
    fn lies_in(&self, other: &Self) -> bool {
        let Arc { curve, span: [from, to], .. } = self.edges[0].arc;
        let z = curve.at(0.5 * (from + to)) + (self.middle - other.middle);
        !std::ptr::eq(self, other) && !other.is_outside(z)
    }
}

/// An arc with vertices at its ends, seen from a point; a segment is that between the vertices.
fn seen_from(origin: Complex, arc: Arc, vertices: &[Complex]) -> Arc {
    if let [Some(from), Some(to)] = arc.ends
        && arc.curve.curvature == 0.0
    {
        let way = vertices[to] - vertices[from];
        let length = way.norm();
        let curve = Curve::line(vertices[from], Complex::new(way.re / length, way.im / length));
        return Arc { curve, span: [0.0, length], ..arc };
    }
    Arc { curve: Curve { origin: arc.curve.origin - origin, ..arc.curve }, ..arc }
}

/// Points on the left and on the right of the middle of a jump, nearer to it than the curves of all others.
pub(crate) fn beside_edge<'a>(
    edge: &JumpEdge,
    others: impl Iterator<Item = &'a JumpEdge>,
) -> [Complex; 2] {
    let (curve, [from, to]) = (edge.arc.curve, edge.arc.span);
    let s = 0.5 * (from + to);
    let z = curve.at(s);
    let apart = others.map(|other| other.arc.curve.distance(z).abs());
    let apart = apart.filter(|&apart| apart > ROUNDING);
    beside([z, curve.direction(s).turned()], 1e-6 * (to - from).abs().min(1.0), apart)
}
