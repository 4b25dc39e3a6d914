//! The curves inside the square across which f jumps.

use super::complex::Complex;
use super::curve::{Arc, Curve, SAME, SIDES, borders};
use super::place::Place;
use super::potential::Potential;
use crate::problem::source::Source;

/// A piece of a jump inside the square, between vertices or points of the border.
#[derive(Clone, Debug)]
pub(super) struct Edge {
    pub arc: Arc,
    /// f on the left and on the right.
    pub values: [f64; 2],
}

/// All jumps of f inside the square.
///
/// As psi sees them, f is continued beyond the border: a line goes on for ever, an arc to the middle of its way
/// outside, or for a length of two, and straight to infinity from there.
#[derive(Clone)]
pub(super) struct Jumps {
    f: Source,
    /// The borders of all regions, in full.
    pub curves: Vec<Curve>,
    pub edges: Vec<Edge>,
    /// Where edges meet the border.
    pub crossings: Vec<Place>,
    /// Its vertices are where edges meet inside the square, and the ends of arcs outside.
    pub psi: Potential,
}

/// A piece of a curve with f on its left and right, none outside of the square.
type Piece = ([f64; 2], Option<[f64; 2]>);

impl Jumps {
    pub(super) fn of(f: &Source) -> Self {
        let mut curves: Vec<Curve> = Vec::new();
        if let Source::Pieces { pieces, .. } = f {
            for curve in pieces.iter().flat_map(|(region, _)| borders(region)) {
                // Common borders of two regions are one curve.
                if !curves.iter().any(|&other| other.same(curve)) {
                    curves.push(curve);
                }
            }
        }
        let (edges, crossings, psi) = (Vec::new(), Vec::new(), Potential::default());
        let mut jumps = Self { f: f.clone(), curves, edges, crossings, psi };
        for curve in jumps.curves.clone() {
            jumps.add(curve);
        }
        jumps.psi.complete(|z| f.at([z.re, z.im]));
        jumps
    }

    /// f at a point.
    pub(super) fn value(&self, z: Complex) -> f64 {
        self.f.at([z.re, z.im])
    }

    /// How far beside the middle of a piece of a curve, given by its ends and its middle, f is still that beside the
    /// piece, up to `most`: curves that touch leave each other slowly.
    pub(super) fn room(&self, along: [Complex; 3], most: f64) -> f64 {
        let others = self.curves.iter().filter(|other| !other.holds(along));
        others.map(|other| 0.5 * other.distance(along[1]).abs()).fold(most, f64::min)
    }

    /// Where edges meet a side, as distances from its beginning.
    pub(super) fn crossings_on(&self, side: i32) -> impl Iterator<Item = f64> {
        let places = self.crossings.iter().map(|place| place.on_side());
        places.filter(move |&(of, _)| of == side).map(|(_, t)| t)
    }

    fn add(&mut self, curve: Curve) {
        let pieces = self.pieces(curve);
        let closed = pieces.len() == 1 && curve.period().is_some();
        for &(span, values) in &pieces {
            let Some(values @ [left, right]) = values else { continue };
            if left == right {
                continue;
            }
            let ends = if closed { [None; 2] } else { span.map(|s| self.meet(curve, s)) };
            let arc = Arc { curve, span, ends };
            self.edges.push(Edge { arc, values });
            if curve.period().is_none() {
                self.psi.add(arc, left - right);
            }
        }
        if let Some(period) = curve.period() {
            self.continue_circle(curve, period, &pieces);
        }
    }

    /// Adds the jumps of a circle to psi, each with half of the way outside the square to the next, but no more than
    /// `FARTHEST`: psi would grow with the square of the radius.
    fn continue_circle(&mut self, circle: Curve, period: f64, pieces: &[Piece]) {
        const FARTHEST: f64 = 2.0;
        let many = pieces.len();
        let beyond = |k: usize| match pieces[k % many] {
            ([from, to], None) => FARTHEST.min(0.5 * (to - from)),
            _ => 0.0,
        };
        let mut arcs: Vec<([f64; 2], f64)> = Vec::new();
        for (k, &([from, to], values)) in pieces.iter().enumerate() {
            let Some([left, right]) = values else { continue };
            let span = [from - beyond(k + many - 1), to + beyond(k + 1)];
            append(&mut arcs, (span, left - right));
        }
        close(&mut arcs, period);
        for (span, jump) in arcs.into_iter().filter(|&(_, jump)| jump != 0.0) {
            if span[1] - span[0] > period - SAME {
                self.psi.add(Arc { curve: circle, span, ends: [None; 2] }, jump);
                continue;
            }
            let ends = span.map(|s| self.psi.vertex(circle.at(s)));
            self.psi.add(Arc { curve: circle, span, ends: ends.map(Some) }, jump);
            for (tip, jump) in ends.into_iter().zip([-jump, jump]) {
                let z = self.psi.vertices[tip];
                if depth(z) < SAME {
                    let curve = Curve::line(z, z.scaled(1.0 / z.norm()));
                    self.psi.add(Arc { curve, span: [0.0, 1.0], ends: [Some(tip), None] }, jump);
                }
            }
        }
    }

    /// The pieces of a curve between the others and the sides, once around a circle; neighbours with the same values
    /// on both sides are one.
    fn pieces(&self, curve: Curve) -> Vec<Piece> {
        let others = self.curves.iter().copied().chain(SIDES);
        let mut cuts: Vec<f64> = others.flat_map(|other| curve.meets(other)).collect();
        cuts.sort_by(f64::total_cmp);
        if let Some(period) = curve.period() {
            let first = cuts.first().copied().unwrap_or(0.0);
            cuts.resize(cuts.len().max(1), first);
            cuts.push(first + period);
        }
        cuts.dedup_by(|b, a| *b - *a < SAME);
        let (mut pieces, rounding): (Vec<Piece>, _) = (Vec::new(), curve.rounding());
        for cut in cuts.windows(2) {
            let s = 0.5 * (cut[0] + cut[1]);
            let along = [cut[0], s, cut[1]].map(|s| curve.at(s));
            let (z, normal) = (along[1], curve.direction(s).turned());
            let step = normal.scaled(self.room(along, rounding));
            let inside = along.into_iter().any(|z| depth(z) > rounding);
            // Where two curves touch, the jump is that of the first.
            let mut before = self.curves.iter().take_while(|&&other| other != curve);
            let known = before.any(|other| other.holds(along));
            let sides = if known { [z; 2] } else { [z + step, z - step] };
            let values = inside.then(|| sides.map(|z| self.value(z)));
            append(&mut pieces, ([cut[0], cut[1]], values));
        }
        curve.period().into_iter().for_each(|period| close(&mut pieces, period));
        pieces
    }

    /// Notes where an edge ends: the vertex there, or none on the border.
    fn meet(&mut self, curve: Curve, s: f64) -> Option<usize> {
        let z = curve.at(s);
        if depth(z) > curve.rounding() {
            return Some(self.psi.vertex(z));
        }
        if !self.crossings.iter().any(|place| (place.point() - z).norm() < 10.0 * SAME) {
            self.crossings.push(Place::of(z));
        }
        None
    }
}

/// Distance of a point from the nearest side, negative beyond it.
fn depth(z: Complex) -> f64 {
    0.5 - z.re.abs().max(z.im.abs())
}

/// Adds a part of a curve, to the last one if they touch and are alike.
fn append<T: PartialEq>(parts: &mut Vec<([f64; 2], T)>, part: ([f64; 2], T)) {
    match parts.last_mut() {
        Some((span, value)) if *value == part.1 && part.0[0] - span[1] < SAME => {
            span[1] = part.0[1];
        }
        _ => parts.push(part),
    }
}

/// The same with the first and the last, once around a circle.
fn close<T: PartialEq>(parts: &mut Vec<([f64; 2], T)>, period: f64) {
    if let [(first, value), .., (last, other)] = &mut parts[..]
        && value == other
        && first[0] + period - last[1] < SAME
    {
        first[0] = last[0] - period;
        parts.pop();
    }
}
