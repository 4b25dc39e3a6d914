//! Curves inside the square across which f jumps.

use super::curve::{Arc, Curve, ROUNDING, SAME, SIDES, borders};
use super::parts::{CurvePart, append, close};
use super::place::BoundaryPlace;
use super::potential::Potential;
use crate::problem::complex::Complex;
use crate::problem::shape::Shape;
use crate::problem::source::Source;
use std::fmt;

/// Piece of a jump inside the square, between vertices or points of the boundary.
#[derive(Clone, Debug)]
pub(super) struct JumpEdge {
    pub arc: Arc,
    /// f on the left and on the right.
    pub values: [f64; 2],
}

/// Two borders that nearly touch, by the shapes that they bound.
#[derive(Clone, Debug, PartialEq)]
pub struct Touch(pub [String; 2]);

impl fmt::Display for Touch {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "; the borders of {} and {} nearly touch", self.0[0], self.0[1])
    }
}

/// All jumps of f inside the square.
///
/// For psi, f is continued beyond the boundary: a line to infinity, an arc to the middle of its way outside, or for a
/// length of two, and straight to infinity from there.
#[derive(Clone)]
pub(super) struct Jumps {
    f: Source,
    /// Borders of all shapes, in full.
    pub curves: Vec<Curve>,
    /// First shape that each of the curves bounds.
    shapes: Vec<Shape<2>>,
    pub edges: Vec<JumpEdge>,
    /// Points at which edges meet the boundary.
    pub crossings: Vec<BoundaryPlace>,
    /// Vertices that stand for all others within [`NEAR`].
    hubs: Vec<usize>,
    /// Potential of the jumps. Its vertices are the points at which edges meet inside the square, and the ends of arcs
    /// outside.
    pub psi: Potential,
}

/// Distance of vertices below which they count as one.
const NEAR: f64 = 10.0 * SAME;
/// Distance of crossings below which they are one, and of a point from a side below which it is on the side.
pub(super) const APART: f64 = 1e-13;

/// Point at which a curve meets another one, or a side.
#[derive(Clone, Copy)]
struct CurveCut {
    /// Distance along the curve.
    s: f64,
    /// True if the curve meets a side.
    side: bool,
}

/// Piece of a curve with f on its left and right, none outside of the square.
type CurvePiece = CurvePart<Option<[f64; 2]>>;

impl Jumps {
    pub(super) fn new(f: &Source) -> Self {
        let (mut curves, mut shapes): (Vec<Curve>, Vec<Shape<2>>) = (Vec::new(), Vec::new());
        if let Source::Pieces { pieces, .. } = f {
            for &(shape, _) in pieces {
                for curve in borders(&shape) {
                    // Common borders of two shapes are one curve.
                    if !curves.iter().any(|&other| other.same(curve)) {
                        curves.push(curve);
                        shapes.push(shape);
                    }
                }
            }
        }
        let (edges, crossings, hubs) = (Vec::new(), Vec::new(), Vec::new());
        let psi = Potential::default();
        let mut jumps = Self { f: f.clone(), curves, shapes, edges, crossings, hubs, psi };
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
        let curves = [&self.curves[..], &SIDES[..]].concat();
        let (mut nearest, mut touch) = (NEARLY, None);
        for k in 0..many {
            for j in k + 1..curves.len() {
                let apart = curves[k].apartness(curves[j]);
                if apart < nearest && !curves[k].touches(curves[j]) {
                    nearest = apart;
                    touch = Some(Touch([k, j].map(|k| self.border_name(k))));
                }
            }
        }
        touch
    }

    /// Name of a shape by the number of a curve that bounds it; curves after the last are the sides.
    fn border_name(&self, curve: usize) -> String {
        match self.shapes.get(curve) {
            Some(shape) => shape.to_string(),
            None => {
                let side = ["left", "right", "lower", "upper"][curve - self.curves.len()];
                format!("the {side} side")
            }
        }
    }

    /// Distance from the middle of a piece of a curve, up to `most`, at which f is still the value beside the piece:
    /// curves that touch leave each other slowly. The piece is given by its start, middle and end; curves that pass
    /// within `on` of the piece coincide with it.
    pub(super) fn room(&self, along: [Complex; 3], most: f64, on: f64) -> f64 {
        let mut room = most;
        for other in self.curves.iter().filter(|other| !other.holds(along, on)) {
            room = room.min(0.5 * other.distance(along[1]).abs());
        }
        room
    }

    /// Points at which edges meet a side, as distances from the corner at which it begins.
    pub(super) fn crossings_on(&self, side: i32) -> impl Iterator<Item = f64> {
        let places = self.crossings.iter().map(|place| place.on_side());
        places.filter(move |&(met, _)| met == side).map(|(_, t)| t)
    }

    /// Adds the jumps along the `k`-th curve.
    fn add(&mut self, k: usize) {
        let (curve, pieces) = (self.curves[k], self.pieces(k));
        let closed = pieces.len() == 1 && curve.period().is_some();
        for &CurvePart { span, value } in &pieces {
            let Some(values @ [left, right]) = value else { continue };
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
            self.edges.push(JumpEdge { arc, values });
            self.edges.extend(stitches.into_iter().map(|arc| JumpEdge { arc, values }));
        }
        if let Some(period) = curve.period() {
            self.continue_circle(curve, period, &pieces);
        }
    }

    /// Adds the jumps of a circle to psi, each with half of the way outside the square to the next, but no more than
    /// `FARTHEST`: psi would grow with the square of the radius.
    fn continue_circle(&mut self, circle: Curve, period: f64, pieces: &[CurvePiece]) {
        const FARTHEST: f64 = 2.0;
        let many = pieces.len();
        // Lengths by which the neighbours of a piece go on along it.
        let mut beyond = vec![0.0; many];
        for (length, piece) in beyond.iter_mut().zip(pieces) {
            if piece.value.is_none() {
                *length = FARTHEST.min(0.5 * (piece.span[1] - piece.span[0]));
            }
        }
        let mut arcs: Vec<CurvePart<f64>> = Vec::new();
        for (k, &CurvePart { span: [from, to], value }) in pieces.iter().enumerate() {
            let Some([left, right]) = value else { continue };
            let span = [from - beyond[(k + many - 1) % many], to + beyond[(k + 1) % many]];
            append(&mut arcs, CurvePart { span, value: left - right });
        }
        close(&mut arcs, period);
        for CurvePart { span, value: jump } in arcs {
            if jump == 0.0 {
                continue;
            }
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

    /// Pieces of a curve between the others and the sides, once around a circle; neighbours with the same values
    /// on both sides are one.
    fn pieces(&self, k: usize) -> Vec<CurvePiece> {
        let curve = self.curves[k];
        let mut cuts = self.cuts(k);
        if let Some(period) = curve.period() {
            let first = cuts.first().copied().unwrap_or(CurveCut { s: 0.0, side: true });
            cuts.resize(cuts.len().max(1), first);
            cuts.push(CurveCut { s: first.s + period, ..first });
        }
        cuts.dedup_by(|b, a| b.s - a.s < if a.side == b.side { SAME } else { ROUNDING });
        let (mut pieces, rounding) = (Vec::new(), curve.rounding());
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
            let value = inside.then(|| sides.map(|z| self.value(z)));
            append(&mut pieces, CurvePart { span: [from, to], value });
        }
        if let Some(period) = curve.period() {
            close(&mut pieces, period);
        }
        pieces
    }

    /// Points at which a curve meets the others and the sides, in order.
    fn cuts(&self, k: usize) -> Vec<CurveCut> {
        let (curve, many) = (self.curves[k], self.curves.len());
        let mut cuts = Vec::new();
        for (j, other) in self.curves.iter().copied().chain(SIDES).enumerate() {
            // Where curves meet at a small angle their common points are known to few digits: both are cut at the same.
            let places = match j < k {
                true => other.meets(curve).into_iter().map(|s| curve.place(other.at(s))).collect(),
                false => curve.meets(other),
            };
            for s in places {
                // A meeting so near to a side happens on the side.
                if j >= many || depth(curve.at(s)) > APART {
                    cuts.push(CurveCut { s, side: j >= many });
                }
            }
        }
        cuts.sort_by(|a, b| a.s.total_cmp(&b.s));
        cuts
    }

    /// Records the point at which an edge ends. Returns the vertex there, or none on the boundary.
    fn meet(&mut self, curve: Curve, s: f64) -> Option<usize> {
        let z = curve.at(s);
        if depth(z) > APART {
            return Some(self.vertex(z));
        }
        if !self.crossings.iter().any(|place| (place.point() - z).norm() < APART) {
            self.crossings.push(BoundaryPlace::nearest(z));
        }
        None
    }

    /// Number of the vertex at a point, a new one if there is none.
    fn vertex(&mut self, z: Complex) -> usize {
        let vertices = &self.psi.vertices;
        let new = vertices.len();
        if let Some(known) = vertices.iter().position(|&v| (v - z).norm() < ROUNDING / 4.0) {
            return known;
        }
        if !self.hubs.iter().any(|&hub| (vertices[hub] - z).norm() < NEAR) {
            self.hubs.push(new);
        }
        self.psi.vertices.push(z);
        new
    }

    /// Straight pieces that continue an arc from and to the hubs of the vertices at its ends: if three curves meet but
    /// for rounding, or nearly, their jumps would not sum to zero in any point.
    fn stitches(&self, arc: Arc) -> Vec<Arc> {
        let vertices = &self.psi.vertices;
        let mut stitches = Vec::new();
        for (k, end) in arc.ends.into_iter().enumerate() {
            let Some(v) = end else { continue };
            let mut hubs = self.hubs.iter().copied();
            let hub = hubs.find(|&hub| (vertices[hub] - vertices[v]).norm() <= NEAR);
            let Some(hub) = hub.filter(|&hub| hub != v) else { continue };
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
