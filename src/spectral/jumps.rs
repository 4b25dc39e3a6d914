//! The curves inside the square across which f jumps.

use super::complex::Complex;
use super::curve::{Curve, SAME, SIDES, borders, in_square};
use super::potential::{Arc, Circle, Line, Potential};
use crate::problem::source::Source;
use std::f64::consts::TAU;

/// A piece of a jump inside the square, between vertices or points of the border.
#[derive(Clone, Debug)]
pub(super) struct Edge {
    pub curve: Curve,
    /// Parameters of its ends.
    pub span: [f64; 2],
    /// f on the left and on the right.
    pub values: [f64; 2],
    /// Vertices at its ends, none on the border.
    pub ends: [Option<usize>; 2],
}

impl Edge {
    /// f on the left less f on the right.
    pub(super) fn jump(&self) -> f64 {
        self.values[0] - self.values[1]
    }
}

/// All jumps of f inside the square.
///
/// As psi sees them, f is continued beyond the border: a line goes on for ever (no vertex at that end), an arc to
/// the middle of its way outside, or for a length of two.
#[derive(Clone, Debug)]
pub(super) struct Jumps {
    f: Source,
    /// The borders of all regions, in full.
    pub curves: Vec<Curve>,
    pub edges: Vec<Edge>,
    pub lines: Vec<Line>,
    pub arcs: Vec<Arc>,
    pub circles: Vec<Circle>,
    /// Centres and radii of the circles of edges.
    round: Vec<(Complex, f64)>,
    /// Where edges meet, inside the square, and ends of continued arcs outside.
    pub vertices: Vec<Complex>,
    /// Where edges meet the border.
    pub crossings: Vec<Complex>,
}

impl Jumps {
    pub(super) fn of(f: &Source) -> Self {
        let mut jumps = Self {
            f: f.clone(),
            curves: Vec::new(),
            edges: Vec::new(),
            lines: Vec::new(),
            arcs: Vec::new(),
            circles: Vec::new(),
            round: Vec::new(),
            vertices: Vec::new(),
            crossings: Vec::new(),
        };
        if let Source::Pieces { pieces, .. } = f {
            for curve in pieces.iter().flat_map(|(region, _)| borders(region)) {
                // Common borders of two regions are one curve.
                if !jumps.curves.iter().any(|&other| other.same(curve)) {
                    jumps.curves.push(curve);
                }
            }
        }
        for curve in jumps.curves.clone() {
            match curve {
                Curve::Line { .. } => jumps.add_line(curve),
                Curve::Circle { .. } => jumps.add_circle(curve),
            }
        }
        jumps
    }

    pub(super) fn potential(&self) -> Potential {
        let Self { vertices, lines, arcs, circles, .. } = self;
        let (vertices, circles) = (vertices.clone(), circles.clone());
        Potential::new(vertices, lines.clone(), arcs.clone(), circles, |z| self.value(z))
    }

    /// f at a point.
    pub(super) fn value(&self, z: Complex) -> f64 {
        self.f.at([z.re, z.im])
    }

    fn add_line(&mut self, line: Curve) {
        let Some([low, high]) = in_square(line) else { return };
        let mut cuts = vec![low, high];
        cuts.extend(
            self.curves
                .iter()
                .flat_map(|&other| line.meets(other))
                .filter(|s| (low + SAME..high - SAME).contains(s)),
        );
        for (span, values) in self.pieces(line, cuts) {
            let Some(values) = values.filter(|[left, right]| left != right) else { continue };
            let ends = span.map(|s| self.meet(line, s));
            let tangent = line.normal(0.0).turned();
            let (origin, jump) = (line.at(span[0]), values[0] - values[1]);
            self.lines.push(Line::new(origin, tangent, jump, ends));
            self.edges.push(Edge { curve: line, span, values, ends });
        }
    }

    fn add_circle(&mut self, circle: Curve) {
        let Curve::Circle { centre, radius } = circle else { return };
        let around = self.around(circle);
        let jumps = |[left, right]: [f64; 2]| left != right;
        if !around.iter().filter_map(|(_, values)| *values).any(jumps) {
            return;
        }
        self.round.push((centre, radius));
        if let [(_, Some(values))] = around[..] {
            let (span, jump) = ([0.0, TAU], values[0] - values[1]);
            self.edges.push(Edge { curve: circle, span, values, ends: [None; 2] });
            self.circles.push(Circle { centre, radius, jump });
            return;
        }
        for &(span, values) in &around {
            if let Some(values) = values.filter(|[left, right]| left != right) {
                let ends = span.map(|s| self.meet(circle, s));
                self.edges.push(Edge { curve: circle, span, values, ends });
            }
        }
        let joined = continued(&around, 2.0 / radius);
        if let [(_, jump)] = joined[..] {
            if jump != 0.0 {
                self.circles.push(Circle { centre, radius, jump });
            }
            return;
        }
        for (k, &(span, jump)) in joined.iter().enumerate() {
            let ends = span.map(|s| self.vertex(circle.at(s)));
            let tip = self.vertices[ends[1]];
            let next = joined[(k + 1) % joined.len()].1;
            if depth(tip) < SAME && jump != next {
                // What the arcs before and after do not share goes to infinity.
                let outwards = tip.scaled(1.0 / tip.norm());
                self.lines.push(Line::new(tip, outwards, jump - next, [Some(ends[1]), None]));
            }
            if jump != 0.0 {
                let circle = Circle { centre, radius, jump };
                self.arcs.push(Arc::new(circle, span, ends, ends.map(|v| self.vertices[v])));
            }
        }
    }

    /// The pieces of a circle between the other curves and the sides, once around.
    fn around(&self, circle: Curve) -> Vec<Piece> {
        let others = self.curves.iter().copied().chain(SIDES);
        let mut cuts: Vec<f64> = others.flat_map(|other| circle.meets(other)).collect();
        cuts.sort_by(f64::total_cmp);
        // Once around, from the first cut.
        let first = cuts.first().copied().unwrap_or(0.0);
        cuts.push(first + TAU);
        if cuts.len() == 1 {
            cuts.insert(0, 0.0);
        }
        closed(self.pieces(circle, cuts))
    }

    /// The pieces of a curve between parameters; neighbours with the same values on both sides are one.
    fn pieces(&self, curve: Curve, mut cuts: Vec<f64>) -> Vec<Piece> {
        cuts.sort_by(f64::total_cmp);
        cuts.dedup_by(|b, a| *b - *a < SAME);
        let (mut pieces, rounding): (Vec<Piece>, _) = (Vec::new(), curve.rounding());
        for cut in cuts.windows(2) {
            let s = 0.5 * (cut[0] + cut[1]);
            let (z, step) = (curve.at(s), curve.normal(s).scaled(rounding));
            let along = [cut[0], s, cut[1]].map(|s| curve.at(s));
            let inside = along.into_iter().any(|z| depth(z) > rounding);
            // Where two curves touch, the jump is that of the first.
            let mut before = self.curves.iter().take_while(|&&other| other != curve);
            let known = before.any(|other| along.into_iter().all(|z| other.holds(z)));
            let sides = if known { [z; 2] } else { [z - step, z + step] };
            let values = inside.then(|| sides.map(|z| self.value(z)));
            match pieces.last_mut() {
                Some((span, last)) if *last == values => span[1] = cut[1],
                _ => pieces.push(([cut[0], cut[1]], values)),
            }
        }
        pieces
    }

    /// The singular points of psi as it is along a piece of a curve, given by its ends and its middle: vertices,
    /// and centres of circles seen from outside, which the piece may touch in one of the three.
    pub(super) fn singular(&self, along: [Complex; 3]) -> impl Iterator<Item = Complex> {
        let outside = move |&&(centre, radius): &&(Complex, f64)| {
            along.iter().any(|&z| (z - centre).norm() > radius + SAME)
        };
        let centres = self.round.iter().filter(outside).map(|&(centre, _)| centre);
        self.vertices.iter().copied().chain(centres)
    }

    /// Notes where an edge ends: the vertex there, or none on the border.
    fn meet(&mut self, curve: Curve, s: f64) -> Option<usize> {
        let z = curve.at(s);
        if depth(z) > curve.rounding() {
            return Some(self.vertex(z));
        }
        index(&mut self.crossings, z);
        None
    }

    /// The vertex at a point, if there is one.
    pub(super) fn vertex_at(&self, z: Complex) -> Option<usize> {
        position(&self.vertices, z)
    }

    fn vertex(&mut self, z: Complex) -> usize {
        index(&mut self.vertices, z)
    }
}

/// Distance of a point from the nearest side, negative beyond it.
fn depth(z: Complex) -> f64 {
    0.5 - z.re.abs().max(z.im.abs())
}

fn position(known: &[Complex], z: Complex) -> Option<usize> {
    known.iter().position(|&v| (v - z).norm() < 10.0 * SAME)
}

/// The position of a point in a list, to which it is added if new.
fn index(known: &mut Vec<Complex>, z: Complex) -> usize {
    position(known, z).unwrap_or_else(|| {
        known.push(z);
        known.len() - 1
    })
}

/// A piece of a curve and f on its left and right, none outside of the square.
type Piece = ([f64; 2], Option<[f64; 2]>);

/// Pieces once around a circle with the first and the last in one where they are alike.
fn closed<T: Copy + PartialEq>(mut around: Vec<([f64; 2], T)>) -> Vec<([f64; 2], T)> {
    let [before, after] = [around[around.len() - 1], around[0]];
    if around.len() > 1 && before.1 == after.1 {
        around[0].0[0] = before.0[0] - TAU;
        around.pop();
    }
    around
}

/// The jumps around a circle with those outside the square: a piece there takes its jumps from its
/// neighbours, half from each, but no farther than `reach`: psi would grow with the square of the radius.
fn continued(around: &[Piece], reach: f64) -> Vec<([f64; 2], f64)> {
    let many = around.len();
    let jump = |k: usize| around[k % many].1.map(|values| values[0] - values[1]);
    let mut arcs: Vec<([f64; 2], f64)> = Vec::new();
    for (k, &(span @ [from, to], _)) in around.iter().enumerate() {
        let middle = 0.5 * (from + to);
        let (out, back) = (middle.min(from + reach), middle.max(to - reach));
        let parts = match jump(k) {
            Some(jump) => vec![(span, jump)],
            None => vec![
                ([from, out], jump(k + many - 1).unwrap_or(0.0)),
                ([out, back], 0.0),
                ([back, to], jump(k + 1).unwrap_or(0.0)),
            ],
        };
        for (span, jump) in parts.into_iter().filter(|([from, to], _)| from < to) {
            match arcs.last_mut() {
                Some((last, same)) if *same == jump => last[1] = span[1],
                _ => arcs.push((span, jump)),
            }
        }
    }
    closed(arcs)
}
