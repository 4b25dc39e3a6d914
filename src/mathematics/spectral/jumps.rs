//! The curves inside the square across which f jumps.

use super::complex::Complex;
use super::curve::{Arc, Curve, ROUNDING, SAME, SIDES, borders};
use super::place::Place;
use super::potential::Potential;
use crate::problem::source::{Region, Source};
use std::fmt;

/// A piece of a jump inside the square, between vertices or points of the border.
#[derive(Clone, Debug)]
pub(super) struct Edge {
    pub arc: Arc,
    /// f on the left and on the right.
    pub values: [f64; 2],
}

/// Two borders that nearly touch, by the regions they bound.
#[derive(Clone, Debug, PartialEq)]
pub struct Touch(pub [String; 2]);

impl fmt::Display for Touch {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "; the borders of {} and {} nearly touch", self.0[0], self.0[1])
    }
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
    /// The first region that each bounds.
    regions: Vec<Region>,
    pub edges: Vec<Edge>,
    /// Where edges meet the border.
    pub crossings: Vec<Place>,
    /// The vertices that stand for all that are hardly apart from them.
    hubs: Vec<usize>,
    /// Its vertices are where edges meet inside the square, and the ends of arcs outside.
    pub psi: Potential,
}

/// Vertices so near to one another are one.
const NEAR: f64 = 10.0 * SAME;
/// Crossings so near to one another are one, and what is so near to a side is on it.
pub(super) const APART: f64 = 1e-13;

/// Where a curve meets another one, or a side.
#[derive(Clone, Copy)]
struct Cut {
    /// Its place along the curve.
    s: f64,
    side: bool,
}

/// A piece of a curve with f on its left and right, none outside of the square.
type Piece = ([f64; 2], Option<[f64; 2]>);

impl Jumps {
    pub(super) fn of(f: &Source) -> Self {
        let (mut curves, mut regions): (Vec<Curve>, Vec<Region>) = (Vec::new(), Vec::new());
        if let Source::Pieces { pieces, .. } = f {
            for &(region, _) in pieces {
                for curve in borders(&region) {
                    // Common borders of two regions are one curve.
                    if !curves.iter().any(|&other| other.same(curve)) {
                        curves.push(curve);
                        regions.push(region);
                    }
                }
            }
        }
        let (edges, crossings, hubs) = (Vec::new(), Vec::new(), Vec::new());
        let psi = Potential::default();
        let mut jumps = Self { f: f.clone(), curves, regions, edges, crossings, hubs, psi };
        for k in 0..jumps.curves.len() {
            jumps.add(k);
        }
        jumps.psi.complete(|z| f.at([z.re, z.im]));
        jumps
    }

    /// f at a point.
    pub(super) fn value(&self, z: Complex) -> f64 {
        self.f.at([z.re, z.im])
    }

    /// The two borders that come nearest to touching or coinciding without doing so, if any nearly do.
    pub(super) fn nearly_touching(&self) -> Option<Touch> {
        /// Angle, or distance, below which borders nearly touch.
        const NEARLY: f64 = 0.03;
        let many = self.curves.len();
        let curves: Vec<Curve> = self.curves.iter().copied().chain(SIDES).collect();
        let pairs = (0..many).flat_map(|k| (k + 1..many + SIDES.len()).map(move |j| (k, j)));
        let measured = pairs.map(|(k, j)| (k, j, curves[k].apartness(curves[j])));
        let near = measured.filter(|&(_, _, apart)| apart < NEARLY);
        let (k, j, _) = near.min_by(|a, b| a.2.total_cmp(&b.2))?;
        let name = |k: usize| match self.regions.get(k) {
            Some(region) => region.to_string(),
            None => format!("the {} side", ["left", "right", "lower", "upper"][k - many]),
        };
        Some(Touch([k, j].map(name)))
    }

    /// How far beside the middle of a piece of a curve, given by its ends and its middle, f is still that beside the
    /// piece, up to `most`: curves that touch leave each other slowly.
    /// Curves that pass within `on` of the piece are on it.
    pub(super) fn room(&self, along: [Complex; 3], most: f64, on: f64) -> f64 {
        let others = self.curves.iter().filter(|other| !other.holds(along, on));
        others.map(|other| 0.5 * other.distance(along[1]).abs()).fold(most, f64::min)
    }

    /// Where edges meet a side, as distances from its beginning.
    pub(super) fn crossings_on(&self, side: i32) -> impl Iterator<Item = f64> {
        let places = self.crossings.iter().map(|place| place.on_side());
        places.filter(move |&(of, _)| of == side).map(|(_, t)| t)
    }

    /// Adds the jumps along the `k`-th curve.
    fn add(&mut self, k: usize) {
        let (curve, pieces) = (self.curves[k], self.pieces(k));
        let closed = pieces.len() == 1 && curve.period().is_some();
        for &(span, values) in &pieces {
            let Some(values @ [left, right]) = values else { continue };
            if left == right {
                continue;
            }
            let ends = if closed { [None; 2] } else { span.map(|s| self.meet(curve, s)) };
            let arc = Arc { curve, span, ends };
            let stitches = self.stitches(arc);
            if curve.period().is_none() {
                for arc in stitches.iter().copied().chain([arc]) {
                    self.psi.add(arc, left - right);
                }
            }
            self.edges.push(Edge { arc, values });
            self.edges.extend(stitches.into_iter().map(|arc| Edge { arc, values }));
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
            let ends = span.map(|s| self.vertex(circle.at(s)));
            let arc = Arc { curve: circle, span, ends: ends.map(Some) };
            for arc in self.stitches(arc).into_iter().chain([arc]) {
                self.psi.add(arc, jump);
            }
            for (tip, jump) in ends.into_iter().zip([-jump, jump]) {
                let z = self.psi.vertices[tip];
                if depth(z) <= APART {
                    let curve = Curve::line(z, z.scaled(1.0 / z.norm()));
                    self.psi.add(Arc { curve, span: [0.0, 1.0], ends: [Some(tip), None] }, jump);
                }
            }
        }
    }

    /// The pieces of a curve between the others and the sides, once around a circle; neighbours with the same values
    /// on both sides are one.
    fn pieces(&self, k: usize) -> Vec<Piece> {
        let (curve, others) = (self.curves[k], self.curves.iter().copied().chain(SIDES));
        let many = self.curves.len();
        let mut cuts: Vec<Cut> = Vec::new();
        for (j, other) in others.enumerate() {
            // Where curves meet at a small angle their common points are known to few digits: both are cut at the same.
            let places = match j < k {
                true => other.meets(curve).into_iter().map(|s| curve.place(other.at(s))).collect(),
                false => curve.meets(other),
            };
            let cut = places.into_iter().map(|s| Cut { s, side: j >= many });
            // What happens so near to a side happens on it.
            cuts.extend(cut.filter(|cut| cut.side || depth(curve.at(cut.s)) > APART));
        }
        cuts.sort_by(|a, b| a.s.total_cmp(&b.s));
        if let Some(period) = curve.period() {
            let first = cuts.first().copied().unwrap_or(Cut { s: 0.0, side: true });
            cuts.resize(cuts.len().max(1), first);
            cuts.push(Cut { s: first.s + period, ..first });
        }
        cuts.dedup_by(|b, a| b.s - a.s < if a.side == b.side { SAME } else { ROUNDING });
        let (mut pieces, rounding): (Vec<Piece>, _) = (Vec::new(), curve.rounding());
        for cut in cuts.windows(2) {
            let [from, to] = [cut[0].s, cut[1].s];
            let s = 0.5 * (from + to);
            let along = [from, s, to].map(|s| curve.at(s));
            let (z, normal) = (along[1], curve.direction(s).turned());
            let step = normal.scaled(self.room(along, rounding.max(SAME), ROUNDING));
            // Curves meet one another inside only.
            let inside = depth(z) > rounding.max(APART) || cut.iter().any(|cut| !cut.side);
            // Where two curves touch, the jump is that of the first.
            let known = self.curves[..k].iter().any(|other| other.holds(along, ROUNDING));
            let sides = if known { [z; 2] } else { [z + step, z - step] };
            let values = inside.then(|| sides.map(|z| self.value(z)));
            append(&mut pieces, ([from, to], values));
        }
        curve.period().into_iter().for_each(|period| close(&mut pieces, period));
        pieces
    }

    /// Notes where an edge ends: the vertex there, or none on the border.
    fn meet(&mut self, curve: Curve, s: f64) -> Option<usize> {
        let z = curve.at(s);
        if depth(z) > APART {
            return Some(self.vertex(z));
        }
        if !self.crossings.iter().any(|place| (place.point() - z).norm() < APART) {
            self.crossings.push(Place::of(z));
        }
        None
    }

    /// The number of the vertex at a point, a new one if there is none.
    fn vertex(&mut self, z: Complex) -> usize {
        let apart = |v: usize| (self.psi.vertices[v] - z).norm();
        let new = self.psi.vertices.len();
        if let Some(known) = (0..new).find(|&v| apart(v) < ROUNDING / 4.0) {
            return known;
        }
        if !self.hubs.iter().any(|&hub| apart(hub) < NEAR) {
            self.hubs.push(new);
        }
        self.psi.vertices.push(z);
        new
    }

    /// Straight pieces that continue an arc from and to the vertices that stand for those at its ends: where three
    /// curves meet but for rounding, or nearly, their jumps would not sum to zero in any point.
    fn stitches(&self, arc: Arc) -> Vec<Arc> {
        let vertices = &self.psi.vertices;
        let mut stitches = Vec::new();
        for (k, end) in arc.ends.into_iter().enumerate() {
            let Some(v) = end else { continue };
            let near = |&hub: &usize| (vertices[hub] - vertices[v]).norm() <= NEAR;
            let Some(hub) = self.hubs.iter().copied().find(near).filter(|&hub| hub != v) else {
                continue;
            };
            let [from, to] = if k == 0 { [hub, v] } else { [v, hub] };
            let way = vertices[to] - vertices[from];
            let length = way.norm();
            let curve = Curve::line(vertices[from], way.scaled(1.0 / length));
            stitches.push(Arc { curve, span: [0.0, length], ends: [Some(from), Some(to)] });
        }
        stitches
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
