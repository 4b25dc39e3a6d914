//! Jumps of f in groups: those round small closed shapes, each seen from the middle of its box, and all others.
//!
//! A strong f on a small shape, V on a width e, has an integral of about V e^2, and so has psi outside; seen from far
//! away its terms are V, and their squares would be in the energy.

use super::PlaneDomain;
use super::far_field::FarField;
use super::psi::{Psi, PsiPart};
use super::quadratic::{Extent, Quadratic};
use crate::problem::complex::Complex;
use crate::spectral::curve::{Arc, Curve, ROUNDING};
use crate::spectral::jumps::JumpEdge;
use crate::spectral::potential::Potential;

/// Jumps of f, seen from a point.
pub(super) struct JumpGroup {
    pub middle: Complex,
    pub edges: Vec<GroupEdge>,
    /// psi, seen from there.
    pub psi: Psi,
    /// Box round a small closed shape.
    pub extent: Option<Extent>,
    /// Distance by which borders of a small shape may be off, seen from its middle, but for units of its width.
    pub off: f64,
}

impl JumpGroup {
    /// Bound of the distances of its jumps from where they are seen from, in a domain of about unit size round that.
    pub(super) fn reach(&self) -> f64 {
        self.extent.map_or(4.0, |extent| extent.half[0] + extent.half[1])
    }
}

/// Jump of f with what it bounds.
pub(super) struct GroupEdge {
    pub edge: JumpEdge,
    /// One entry for each side, or one for both if they share a quadratic function.
    pub sides: Vec<PieceSide>,
}

impl GroupEdge {
    /// f on the left less f on the right.
    pub(super) fn jump(&self) -> f64 {
        self.edge.values[0] - self.edge.values[1]
    }
}

/// A side of the border of a piece of f, or of two, in [`quadratic`](super::quadratic)'s integrals.
#[derive(Clone, Copy, Debug)]
pub(super) struct PieceSide {
    pub quadratic: Quadratic,
    /// f, positive if the normal leads out of the piece; the sum of both.
    pub f: f64,
    /// The same with the square of f.
    pub square: f64,
}

impl PieceSide {
    /// Sum of the pieces on the left and right of a jump, with normals to the right.
    pub(super) fn of_jump(quadratic: Quadratic, [left, right]: [f64; 2]) -> Self {
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
pub(super) fn groups(
    domain: &PlaneDomain,
    mut potential: Potential,
    mut edges: Vec<JumpEdge>,
    f: impl Fn(Complex) -> f64,
) -> Vec<JumpGroup> {
    let mut shapes = Vec::new();
    for own in connected(&edges) {
        if let Some(shape) = SmallShape::of(domain, &potential, &own) {
            potential.jumps.retain(|jump| !holds_one(jump.arc, &own));
            edges.retain(|edge| !holds_one(edge.arc, &own));
            shapes.push(shape);
        }
    }
    let parts = shapes.iter().map(|own| PsiPart { middle: own.middle, ..own.part.clone() });
    let psi = Psi::of_jumps(potential, parts.collect(), &domain.inner_points(25), f);
    let all = Quadratic::round(domain.centre());
    let rest = edges
        .into_iter()
        .map(|edge| GroupEdge { sides: vec![PieceSide::of_jump(all, edge.values)], edge });
    let rest = JumpGroup {
        middle: Complex::default(),
        edges: rest.collect(),
        psi,
        extent: None,
        off: 0.0,
    };
    let mut groups = vec![rest];
    for shape in &shapes {
        let around = shape.around(&shapes).map(|own| own.quadratic().seen_from(-own.middle));
        let outer = around.unwrap_or(all).seen_from(shape.middle);
        groups.push(JumpGroup {
            middle: shape.middle,
            edges: shape.edges.iter().map(|edge| shape.with_sides(edge, outer)).collect(),
            psi: groups[0].psi.seen_from(shape.middle),
            extent: Some(shape.extent),
            off: shape.off,
        });
    }
    groups
}

/// True if an arc holds the middle of one of some edges.
fn holds_one(arc: Arc, edges: &[JumpEdge]) -> bool {
    edges.iter().filter(|edge| edge.arc.curve == arc.curve).any(|edge| {
        let after = 0.5 * (edge.arc.span[0] + edge.arc.span[1]) - arc.span[0];
        let after = arc.curve.period().map_or(after, |turn| after.rem_euclid(turn));
        0.0 < after && after < arc.span[1] - arc.span[0]
    })
}

/// Edges that are connected by vertices.
fn connected(edges: &[JumpEdge]) -> Vec<Vec<JumpEdge>> {
    let mut groups: Vec<Vec<JumpEdge>> = Vec::new();
    for edge in edges {
        let ends = edge.arc.ends;
        let (with, without): (Vec<_>, Vec<_>) = groups.into_iter().partition(|own| {
            let mut others = own.iter().flat_map(|other| other.arc.ends).flatten();
            others.any(|other| ends.contains(&Some(other)))
        });
        groups = without;
        groups.push(with.into_iter().flatten().chain([edge.clone()]).collect());
    }
    groups
}

impl SmallShape {
    /// The shape with these edges, if they are closed, small, and round no hole.
    fn of(domain: &PlaneDomain, potential: &Potential, edges: &[JumpEdge]) -> Option<Self> {
        /// Width over the diameter of the domain.
        const WIDEST: f64 = 1.0 / 16.0;
        let mut closed = edges.iter().map(|edge| match edge.arc.ends {
            [None, None] => edge.is_circle(),
            ends => ends.iter().all(Option::is_some),
        });
        if !closed.all(|is_closed| is_closed) {
            return None;
        }
        let arcs: Vec<Arc> = edges.iter().map(|edge| edge.arc).collect();
        let extent = Extent::of(&arcs);
        let middle = extent.centre;
        if 2.0 * extent.half[1] > WIDEST * domain.diameter() {
            return None;
        }
        let mut vertices: Vec<usize> = arcs.iter().flat_map(|arc| arc.ends).flatten().collect();
        vertices.sort_unstable();
        vertices.dedup();
        let mut local = Potential {
            vertices: vertices.iter().map(|&v| potential.vertices[v] - middle).collect(),
            ..Potential::default()
        };
        let mut seen = Vec::new();
        for edge in edges {
            let ends = edge.arc.ends;
            let ends = ends.map(|end| end.map(|v| vertices.binary_search(&v).expect("a vertex")));
            let arc = seen_from(middle, Arc { ends, ..edge.arc }, &local.vertices);
            local.add(arc, edge.values[0] - edge.values[1]);
            seen.push(JumpEdge { arc, ..edge.clone() });
        }
        let arcs: Vec<Arc> = seen.iter().map(|edge| edge.arc).collect();
        let extent = Extent::of(&arcs);
        let far = FarField::new(&local, extent);
        let part = PsiPart::new(Complex::default(), local, Some(far));
        // Radii, and coordinates of lines that are parallel to an axis, are those of f.
        let is_exact = edges.iter().all(|edge| edge.is_circle() || is_exact(edge, potential));
        let off = if is_exact { 4.0 * f64::EPSILON * extent.half[1] } else { ROUNDING };
        let shape = Self { middle, part, edges: seen, extent, off };
        let mut holes = domain.loops.iter().map(|sides| sides[0].point(0.0));
        holes.all(|z| shape.is_outside(z - middle)).then_some(shape)
    }

    /// True if f of the shape alone is zero at a point, seen from its middle.
    fn is_outside(&self, z: Complex) -> bool {
        let sizes = self.part.potential.jumps.iter().map(|jump| jump.size.abs());
        self.part.source(z).abs() < 1e-9 * sizes.sum::<f64>()
    }

    /// True if it lies in another shape.
    fn lies_in(&self, other: &Self) -> bool {
        let Arc { curve, span: [from, to], .. } = self.edges[0].arc;
        let z = curve.at(0.5 * (from + to)) + (self.middle - other.middle);
        !std::ptr::eq(self, other) && !other.is_outside(z)
    }

    /// Innermost shape in which it lies.
    fn around<'a>(&self, shapes: &'a [Self]) -> Option<&'a Self> {
        let around: Vec<&Self> = shapes.iter().filter(|other| self.lies_in(other)).collect();
        let mut inwards = around.iter();
        inwards.find(|own| around.iter().all(|other| !other.lies_in(own))).copied()
    }

    fn quadratic(&self) -> Quadratic {
        Quadratic::of(self.extent)
    }

    /// An edge with its sides: outside of the shape by the function of what is around.
    fn with_sides(&self, edge: &JumpEdge, outer: Quadratic) -> GroupEdge {
        let mut sides = Vec::new();
        let beside = beside(edge, self.edges.iter());
        for ((z, f), sign) in beside.into_iter().zip(edge.values).zip([1.0, -1.0]) {
            let quadratic = if self.is_outside(z) { outer } else { self.quadratic() };
            sides.push(PieceSide { quadratic, f: sign * f, square: sign * f * f });
        }
        GroupEdge { edge: edge.clone(), sides }
    }
}

/// True if the ends of a segment that is parallel to an axis lie exactly on its line.
fn is_exact(edge: &JumpEdge, potential: &Potential) -> bool {
    let Arc { curve, ends, .. } = edge.arc;
    let is_on = |v: usize| curve.local(potential.vertices[v]).im == 0.0;
    let is_parallel = curve.tangent.re == 0.0 || curve.tangent.im == 0.0;
    curve.curvature == 0.0 && is_parallel && ends.into_iter().flatten().all(is_on)
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
pub(super) fn beside<'a>(
    edge: &JumpEdge,
    others: impl Iterator<Item = &'a JumpEdge>,
) -> [Complex; 2] {
    let (curve, [from, to]) = (edge.arc.curve, edge.arc.span);
    let s = 0.5 * (from + to);
    let z = curve.at(s);
    let apart = others.map(|other| other.arc.curve.distance(z).abs());
    let apart = apart.filter(|&apart| apart > ROUNDING).fold(f64::INFINITY, f64::min);
    let step = (1e-6 * (to - from).abs().min(1.0)).min(0.5 * apart);
    let normal = curve.direction(s).turned();
    [step, -step].map(|step| z + normal.scaled(step))
}
