//! Jumps of f that are closed: edges that meet no others, and loops of strong jumps that weak ones meet.

use crate::problem::complex::Complex;
use crate::spectral::geometry::curve::{Arc, Curve};
use crate::spectral::source::curves::JumpEdge;
use crate::spectral::source::potential::Potential;
use std::collections::BTreeSet;

/// Edges that are closed, with jumps of a function that is constant in each part of the plane between them.
pub(crate) struct ClosedEdges {
    pub edges: Vec<JumpEdge>,
    jumps: Vec<f64>,
    /// Jumps of f less those.
    left: Vec<f64>,
}

impl ClosedEdges {
    /// Edges that meet no others, and loops of strong jumps among the others.
    pub(crate) fn all(edges: &[JumpEdge]) -> Vec<Self> {
        let mut found = Vec::new();
        for own in connected(edges) {
            let is_closed = own.iter().all(|edge| match edge.arc.ends {
                [None, None] => edge.is_circle(),
                ends => ends.iter().all(Option::is_some),
            });
            if is_closed {
                let jumps: Vec<f64> = own.iter().map(JumpEdge::jump).collect();
                found.push(Self { left: vec![0.0; jumps.len()], edges: own, jumps });
                continue;
            }
            let mut rest = own;
            while let Some(most) = rest.iter().map(|edge| edge.jump().abs()).max_by(f64::total_cmp)
            {
                let (strong, weak): (Vec<_>, Vec<_>) =
                    rest.into_iter().partition(|edge| edge.jump().abs() > 0.5 * most);
                found.extend(connected(&strong).into_iter().filter_map(Self::of_loop));
                rest = weak;
            }
        }
        found
    }

    /// A loop along which a jump is constant but for weak ones: two edges meet at each vertex.
    fn of_loop(edges: Vec<JumpEdge>) -> Option<Self> {
        let ends: Vec<usize> = edges.iter().flat_map(|edge| edge.arc.ends).flatten().collect();
        let is_loop = ends.len() == 2 * edges.len()
            && ends.iter().all(|end| ends.iter().filter(|other| *other == end).count() == 2);
        if !is_loop {
            return None;
        }
        let [first, first_right] = edges[0].values;
        let (jump, mut jumps, mut left) = (edges[0].jump(), Vec::new(), Vec::new());
        for (edge, is_along) in edges.iter().zip(lead_along(&edges)) {
            let [l, r] = edge.values;
            let (from, to) = if is_along { (first, first_right) } else { (first_right, first) };
            jumps.push(if is_along { jump } else { -jump });
            left.push((l - from) - (r - to));
        }
        let is_weak = left.iter().all(|own| own.abs() < 0.25 * jump.abs());
        is_weak.then_some(Self { edges, jumps, left })
    }

    /// Takes its jumps out of a potential.
    pub(crate) fn take_from(&self, potential: &mut Potential) {
        for jump in &mut potential.jumps {
            let own = self.edges.iter().position(|edge| holds(jump.arc, edge));
            jump.size = own.map_or(jump.size, |k| self.left[k]);
        }
        potential.jumps.retain(|jump| jump.size != 0.0);
    }

    /// Numbers of its vertices in a potential, in order, and these seen from a point; they lie exactly on lines that
    /// are parallel to an axis.
    pub(crate) fn vertices(
        &self,
        potential: &Potential,
        origin: Complex,
    ) -> (Vec<usize>, Vec<Complex>) {
        let ends = self.edges.iter().flat_map(|edge| edge.arc.ends).flatten();
        let numbers: Vec<usize> = ends.collect::<BTreeSet<usize>>().into_iter().collect();
        let mut vertices = Vec::new();
        for &number in &numbers {
            let mut z = potential.vertices[number];
            let with = self.edges.iter().filter(|edge| edge.arc.ends.contains(&Some(number)));
            for curve in with.map(|edge| edge.arc.curve).filter(|&curve| is_parallel(curve)) {
                let is_flat = curve.tangent.im == 0.0;
                let Complex { re, im } = curve.origin;
                z = if is_flat { Complex::new(z.re, im) } else { Complex::new(re, z.im) };
            }
            vertices.push(z - origin);
        }
        (numbers, vertices)
    }

    /// Arcs with jumps: edges that follow each other along a curve with the same jump are one.
    pub(crate) fn arcs(&self) -> Vec<(Arc, f64)> {
        let mut sorted: Vec<(Arc, f64)> =
            self.edges.iter().map(|edge| edge.arc).zip(self.jumps.iter().copied()).collect();
        sorted.sort_by(|(one, _), (other, _)| one.span[0].total_cmp(&other.span[0]));
        let mut arcs: Vec<(Arc, f64)> = Vec::new();
        for (arc, jump) in sorted {
            let before = arcs.iter_mut().find(|(own, size)| {
                own.curve == arc.curve && own.ends[1] == arc.ends[0] && *size == jump
            });
            match before {
                Some((own, _)) => {
                    own.span[1] = arc.span[1];
                    own.ends[1] = arc.ends[1];
                }
                None => arcs.push((arc, jump)),
            }
        }
        // All of a circle has no ends.
        for (arc, _) in &mut arcs {
            if arc.ends[0] == arc.ends[1] {
                arc.ends = [None; 2];
            }
        }
        arcs
    }
}

/// True if an arc holds the middle of an edge.
pub(crate) fn holds(arc: Arc, edge: &JumpEdge) -> bool {
    let after = 0.5 * (edge.arc.span[0] + edge.arc.span[1]) - arc.span[0];
    let after = arc.curve.period().map_or(after, |turn| after.rem_euclid(turn));
    edge.arc.curve == arc.curve && 0.0 < after && after < arc.span[1] - arc.span[0]
}

/// True for the edges of a loop that lead round it as the first does.
fn lead_along(edges: &[JumpEdge]) -> Vec<bool> {
    let mut along = vec![None; edges.len()];
    let (mut next, mut vertex) = (Some(0), edges[0].arc.ends[0]);
    while let Some(k) = next {
        let [from, to] = edges[k].arc.ends;
        along[k] = Some(from == vertex);
        vertex = if from == vertex { to } else { from };
        next = (0..edges.len())
            .find(|&other| along[other].is_none() && edges[other].arc.ends.contains(&vertex));
    }
    along.into_iter().map(|own| own == Some(true)).collect()
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

/// True if a line is parallel to an axis.
pub(crate) fn is_parallel(Curve { tangent, curvature, .. }: Curve) -> bool {
    curvature == 0.0 && (tangent.re == 0.0 || tangent.im == 0.0)
}
