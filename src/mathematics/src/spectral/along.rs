//! psi inside the square, by integrals of its gradient along curves from the boundary.

use super::complex::distance;
use super::curve::{Arc, Curve, SAME};
use super::place::{BoundaryPlace, tangent};
use super::potential::Potential;
use super::problem::SpectralProblem;
use super::rule::{GaussNode, Rules, halved};
use crate::problem::complex::Complex;

/// Node of a quadrature on a curve.
pub(super) struct Node {
    pub point: Complex,
    /// Normal to the right of the curve.
    pub normal: Complex,
    /// Weight with respect to the length of the curve.
    pub weight: f64,
    /// Gradient of psi.
    pub gradient: Complex,
}

impl SpectralProblem {
    /// psi at a point, along a straight line from the nearest side.
    pub(super) fn psi(&self, z: Complex, rules: &Rules) -> f64 {
        let place = BoundaryPlace::nearest(z);
        let inwards = tangent(place.corner, place.t).turned();
        let line = Curve::line(place.point(), inwards);
        let to = line.local(z).re;
        let mut cuts = Vec::new();
        for &curve in &self.jumps.curves {
            cuts.extend(line.meets(curve).into_iter().filter(|s| (SAME..to - SAME).contains(s)));
        }
        cuts.sort_by(f64::total_cmp);
        cuts.insert(0, 0.0);
        cuts.push(to);
        let mut psi = self.boundary_psi.value(place);
        for span in cuts.windows(2) {
            let span = [span[0], span[1]];
            let ends = span.map(|s| self.jumps.psi.vertex_at(line.at(s)));
            psi = self.along(Arc { curve: line, span, ends }, psi, rules, |_, _| ());
        }
        psi
    }

    /// Passes the nodes on an arc to `take`, with psi there. Jumps of f meet the arc at its ends only. Returns psi at
    /// the end of the arc, from psi at its start.
    pub(super) fn along(
        &self,
        arc: Arc,
        start: f64,
        rules: &Rules,
        mut take: impl FnMut(&Node, f64),
    ) -> f64 {
        let pieces = pieces(&self.jumps.psi, arc);
        let mut nodes = Vec::with_capacity(pieces.len() * rules.targets.len());
        for &piece in &pieces {
            nodes.extend(nodes_on(piece, rules));
        }
        let points: Vec<Complex> = nodes.iter().map(|node| node.point).collect();
        for (node, gradient) in nodes.iter_mut().zip(self.jumps.psi.gradients(&points)) {
            node.gradient = gradient;
        }
        let (mut before, way) = (start, (arc.span[1] - arc.span[0]).signum());
        for (piece, nodes) in pieces.iter().zip(nodes.chunks_exact(rules.targets.len())) {
            let changes = nodes.iter().map(|n| way * n.weight * n.gradient.dot(n.normal.turned()));
            let (values, end) = rules.integrate(before, piece.ends[1].is_some(), changes);
            before = end;
            for (node, psi) in nodes.iter().zip(values) {
                take(node, psi);
            }
        }
        before
    }
}

/// Nodes on a piece, counted from the vertex at one of its ends, without gradients.
fn nodes_on(Arc { curve, span: [a, b], ends }: Arc, rules: &Rules) -> impl Iterator<Item = Node> {
    let [first, last] = ends.map(|end| end.is_some());
    rules.targets.iter().map(move |&GaussNode { x, weight }| {
        let (part, slope) = if first || last { (x * x * x, 3.0 * x * x) } else { (x, 1.0) };
        let s = if last { b - (b - a) * part } else { a + (b - a) * part };
        Node {
            point: curve.at(s),
            normal: -curve.direction(s).turned(),
            weight: (b - a).abs() * slope * weight,
            gradient: Complex::default(),
        }
    })
}

/// Pieces of an arc in order, short where psi is singular, each with one vertex at most.
fn pieces(psi: &Potential, arc: Arc) -> Vec<Arc> {
    let spans = halved(arc.span, |span| is_too_long(psi, arc, arc.part(span)));
    spans.into_iter().map(|span| arc.part(span)).collect()
}

/// True if a piece of an arc must be halved: it has two vertices, or is longer than its distance from a singular point
/// of psi other than the ends of the arc (than half of that if it has a vertex), or wider than [`WIDEST`].
fn is_too_long(psi: &Potential, arc: Arc, piece: Arc) -> bool {
    let Arc { curve, span: [a, b], .. } = piece;
    let own = arc.ends.map(|end| end.map(|v| psi.vertices[v]));
    let length = (b - a).abs();
    let along = [a, 0.5 * (a + b), b].map(|s| curve.at(s));
    let mut nearest = f64::INFINITY;
    for v in psi.singular(along).filter(|&v| !own.contains(&Some(v))) {
        nearest = nearest.min(distance([along[0], along[2]], v));
    }
    let wide = length * curve.curvature > WIDEST;
    let vertices = piece.ends.iter().flatten().count();
    let graded = if vertices > 0 { 2.0 } else { 1.0 };
    let near = length > SHORTEST && graded * length > nearest;
    length > SAME && (near || wide || vertices == 2)
}

/// Pieces shorter than this are not cut where psi is singular.
const SHORTEST: f64 = 1e-9;
/// Longest piece of an arc, as an angle.
const WIDEST: f64 = 1.6;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spectral::SpectralParams;

    #[test]
    fn psi_is_the_same_along_all_ways() {
        let f = "rect(-0.7,0.3,-0.2,0.1)=-5; disc(0.3,0.35,0.1)=4; disc(0,-0.1,0.2)=1; else=-2";
        let (problem, rules) =
            (SpectralProblem::new(&f.parse().unwrap()), Rules::new(SpectralParams::FINER));
        // On either side of the diagonals the nearest sides are different ones.
        for k in 1..50 {
            let z = Complex::new(0.01 * f64::from(k), 0.01 * f64::from(k));
            for z in [z, -z, z.turned(), -z.turned()] {
                let [a, b] = [1.0 - 1e-15, 1.0 + 1e-15]
                    .map(|factor| problem.psi(Complex::new(factor * z.re, z.im), &rules));
                assert!((a - b).abs() < 2e-15, "{z:?}: {a} {b}");
            }
        }
    }
}
