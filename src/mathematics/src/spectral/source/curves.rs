//! Curves inside a domain across which f jumps, cut where they meet, and continued beyond the boundary for psi.
//!
//! Inside, pieces of curves carry the difference of f on their two sides, whose sum at each vertex is zero. Outside, a
//! piece goes on along its curve: a line beyond the last side to infinity; else to the middle of its way outside, or
//! for a length of two, and from there away from the domain. Where the next piece has the same jump, so does all
//! between.

use super::Regions;
use super::changes::Changes;
use super::potential::Potential;
use crate::machine::extremes::two_sum;
use crate::problem::complex::Complex;
use crate::problem::shape::Shape;
use crate::problem::source::Source;
use crate::spectral::error::PlaneError;
use crate::spectral::geometry::curve::{
    Arc, Curve, CurvePart, ROUNDING, SAME, append, beside, borders, close,
};
use crate::spectral::geometry::domain::PlaneDomain;
use crate::spectral::geometry::way_out::WayOut;

/// Piece of a jump inside the domain, between vertices or points of the boundary.
#[derive(Clone, Debug)]
pub(crate) struct JumpEdge {
    pub arc: Arc,
    /// f on the left and on the right.
    pub values: [f64; 2],
}

impl JumpEdge {
    /// f on the left less f on the right.
    pub(crate) fn jump(&self) -> f64 {
        self.values[0] - self.values[1]
    }

    /// True if it is all of a circle.
    pub(crate) fn is_circle(&self) -> bool {
        let Arc { curve, span: [from, to], .. } = self.arc;
        curve.period().is_some_and(|turn| (to - from).abs() > turn - SAME)
    }
}

/// All jumps of f inside a domain.
#[derive(Clone, Default)]
pub(crate) struct Jumps {
    /// Curves on which f may jump: those of the borders of shapes, and then others of borders of regions.
    curves: Vec<Curve>,
    /// Parts of the curves that are such borders: of one of a shape, all of it.
    spans: Vec<Vec<[f64; 2]>>,
    pub edges: Vec<JumpEdge>,
    /// Bounds of the difference of f from that of the shapes.
    pub changes: Changes,
    /// Largest difference of f and a sum of two jumps more.
    most: f64,
    /// Lengths of the pieces between points that count as one, and of parts of the boundary between them.
    joined: Vec<f64>,
    /// Largest length of the boundary between two points beside a corner, over their distance.
    detour: f64,
    /// Vertices that stand for all others within [`NEAR`].
    hubs: Vec<usize>,
    /// Potential of the jumps, without the background. Its vertices are the points at which edges meet inside the
    /// domain, and ends and bends outside.
    pub psi: Potential,
}

/// Distance of vertices below which they count as one.
const NEAR: f64 = 10.0 * SAME;
/// Distance of a point from the boundary below which it is there.
pub(crate) const APART: f64 = 1e-13;
/// Longest way along a curve outside of the domain: psi would grow with the square of the radius.
const FARTHEST: f64 = 2.0;

/// Point at which a curve meets another one, or a side.
#[derive(Clone, Copy)]
struct CurveCut {
    /// Distance along the curve.
    s: f64,
    /// True if the curve meets a side.
    side: bool,
}

/// Piece of a curve with f on its left and right, none outside of the domain.
type CurvePiece = CurvePart<Option<[f64; 2]>>;

impl Jumps {
    /// Jumps of f at the borders of the shapes of constant pieces, and of regions.
    ///
    /// All pieces of all borders between their cuts are looked at, so that every jump of f inside the domain is among
    /// these but for what [`Changes`] bounds.
    ///
    /// # Errors
    /// [`PlaneError::NotFound`] if there is no way out of a bay, [`PlaneError::Source`] if jumps do not add up to zero
    /// where they meet.
    pub(crate) fn new(domain: &PlaneDomain, regions: &Regions) -> Result<Self, PlaneError> {
        let sources = &regions.pieces;
        let largest = sources.iter().filter_map(Source::largest).fold(0.0, f64::max);
        let mut jumps =
            Self { most: 4.0 * largest, detour: domain.longest_detour(), ..Self::default() };
        for source in sources {
            let Source::Pieces { pieces, .. } = source else { continue };
            pieces.iter().for_each(|&(shape, _)| jumps.add_shape(domain, shape));
        }
        let inner = regions.borders.iter().filter(|border| border.is_inside());
        inner.for_each(|border| jumps.add_region(border.side.arc));
        for (k, curve) in jumps.curves.clone().into_iter().enumerate() {
            let cuts = jumps.cuts(domain, k);
            let pieces = jumps.pieces(domain, k, cuts, regions);
            jumps.add(domain, curve, &pieces)?;
        }
        jumps.changes.add_joined(jumps.most, &jumps.joined);
        jumps.check_vertices(domain)?;
        Ok(jumps)
    }

    /// Adds the borders of a shape; common borders of two shapes are one curve.
    fn add_shape(&mut self, domain: &PlaneDomain, shape: Shape<2>) {
        let curves = borders(&shape);
        if let Shape::Ball { centre: [x, y], radius } = shape
            && curves.is_empty()
            && domain.depth(Complex::new(x, y)) >= -radius
        {
            self.changes.add_disc(self.most, radius.max(0.0));
        }
        for curve in curves {
            if let Some(&known) = self.curves.iter().find(|other| other.same(curve)) {
                self.changes.add_moved(self.most, curve, known);
                continue;
            }
            self.curves.push(curve);
            let whole = [f64::NEG_INFINITY, f64::INFINITY];
            self.spans.push(vec![curve.period().map_or(whole, |turn| [0.0, turn])]);
        }
    }

    /// Adds the border of a region to its curve.
    fn add_region(&mut self, arc: Arc) {
        let Arc { curve, span: [from, to], .. } =
            if arc.span[0] > arc.span[1] { arc.reversed() } else { arc };
        let Some(k) = self.curves.iter().position(|&other| other.same(curve)) else {
            self.curves.push(curve);
            self.spans.push(vec![[from, to]]);
            return;
        };
        let known = self.curves[k];
        let off = [from, 0.5 * (from + to), to].map(|s| known.distance(curve.at(s)).abs());
        self.changes.add_between(self.most, off.into_iter().fold(0.0, f64::max), to - from);
        // Circles run one way.
        let turns = known.curvature == 0.0 && known.tangent.dot(curve.tangent) < 0.0;
        let start = known.place(curve.at(if turns { to } else { from }));
        self.spans[k].push([start, start + to - from]);
    }

    /// True if a curve is a border at a distance along it.
    fn is_border(&self, k: usize, s: f64) -> bool {
        let period = self.curves[k].period();
        self.spans[k].iter().any(|[from, to]| {
            let after = period.map_or(s - from, |turn| (s - from + SAME).rem_euclid(turn) - SAME);
            (-SAME..=to - from + SAME).contains(&after)
        })
    }

    /// Points on both sides of the middle of a piece of the `k`-th curve at which f is the value beside the piece:
    /// curves that touch leave each other slowly. The same one if that is no border there, or a curve before has its
    /// jump.
    fn beside(&mut self, k: usize, [from, to]: [f64; 2]) -> [Complex; 2] {
        let (curve, s) = (self.curves[k], 0.5 * (from + to));
        let along = [from, s, to].map(|s| curve.at(s));
        let z = along[1];
        let borders = self.curves.iter().enumerate();
        let (on, off): (Vec<_>, Vec<_>) = borders
            .filter(|(j, other)| self.is_border(*j, other.place(z)))
            .partition(|(_, other)| other.holds(along, ROUNDING));
        // Where two curves touch, the jump is that of the first.
        if let Some(&(_, first)) = on.first().filter(|(j, _)| *j < k) {
            let off = along.map(|z| first.distance(z).abs()).into_iter().fold(0.0, f64::max);
            self.changes.add_between(self.most, off, to - from);
            return [z; 2];
        }
        if !self.is_border(k, s) {
            return [z; 2];
        }
        let apart = off.iter().map(|(_, other)| other.distance(z).abs());
        beside([z, curve.direction(s).turned()], curve.rounding().max(SAME), apart)
    }

    /// Points at which a border ends or meets others inside the domain, and at which its curve meets the sides; and
    /// those at which it does the former so near to a side that it counts as there.
    fn cuts(&mut self, domain: &PlaneDomain, k: usize) -> (Vec<CurveCut>, Vec<f64>) {
        /// Distance of an end from the boundary below which it is there.
        const ON: f64 = 1e-9;
        let (curve, most) = (self.curves[k], self.most);
        let (mut cuts, mut beside) = (on_sides(domain, curve), Vec::new());
        let sides = domain.sides().map(|side| side.arc.curve);
        for other in self.curves[..k].iter().copied().chain(sides) {
            if let Some(overlap) = curve.overlap(other) {
                self.changes.add_overlap(most, overlap);
            }
        }
        for j in 0..self.curves.len() {
            let other = self.curves[j];
            // Where curves meet at a small angle their common points are known to few digits: both are cut at the same.
            let places = match j < k {
                true => other.meets(curve).into_iter().map(|s| curve.place(other.at(s))).collect(),
                false => curve.meets(other),
            };
            for s in places {
                let z = curve.at(s);
                let depth = domain.depth(z);
                if !(self.is_border(k, s) && self.is_border(j, other.place(z))) {
                    continue;
                }
                if depth > APART {
                    cuts.push(CurveCut { s, side: false });
                } else if depth > -ROUNDING {
                    beside.push(s);
                }
            }
        }
        let turn = curve.period().unwrap_or(f64::INFINITY);
        let parts = self.spans[k].iter().filter(|[from, to]| to - from < turn - SAME);
        for s in parts.flatten() {
            let z = curve.at(*s);
            match domain.distance(z) > ON {
                true => cuts.push(CurveCut { s: curve.place(z), side: false }),
                false => beside.push(curve.place(z)),
            }
        }
        (cuts, beside)
    }

    /// Pieces of a curve between cuts, once around a circle, with f beside those inside the domain, from their start
    /// and end; neighbours with the same values on both sides are one. Beside other points f is taken from the middle
    /// of the piece on its shorter part, too. With that of the other border and the boundary between both it encloses
    /// where f changes.
    fn pieces(
        &mut self,
        domain: &PlaneDomain,
        k: usize,
        (mut cuts, beside): (Vec<CurveCut>, Vec<f64>),
        f: &Regions,
    ) -> Vec<CurvePiece> {
        let curve = self.curves[k];
        cuts.sort_by(|a, b| a.s.total_cmp(&b.s));
        if let Some(period) = curve.period() {
            let first = cuts.first().copied().unwrap_or(CurveCut { s: 0.0, side: true });
            cuts.resize(cuts.len().max(1), first);
            cuts.push(CurveCut { s: first.s + period, ..first });
        }
        cuts.dedup_by(|b, a| {
            let apart = b.s - a.s;
            let is_same = apart < if a.side == b.side { SAME } else { ROUNDING };
            if is_same && apart > 0.0 {
                let is_corner = a.side && b.side;
                self.joined.push(apart * if is_corner { 1.0 + self.detour } else { 1.0 });
                // The curve meets one side there, and the other one beyond its end.
                let [off, other] = [a.s, b.s].map(|s| domain.distance(curve.at(s)));
                a.s = if is_corner && other < off { b.s } else { a.s };
            }
            is_same
        });
        let mut pieces = Vec::new();
        for cut in cuts.windows(2) {
            let span = [cut[0].s, cut[1].s];
            let depth = domain.depth(curve.at(0.5 * (span[0] + span[1])));
            // Curves meet one another inside only.
            let inside = cut.iter().any(|cut| !cut.side) || depth > curve.rounding().max(APART);
            if !inside && depth > 0.0 {
                let off = off_side(domain, curve, span);
                self.changes.add_between(self.most, off, span[1] - span[0]);
            }
            if inside {
                let shorter = beside.iter().filter_map(|&s| shorter_part(curve, span, s));
                self.joined.extend(shorter.map(|length| (1.0 + self.detour) * length));
            }
            let value = inside.then(|| self.beside(k, span).map(|z| f.at(z)));
            append(&mut pieces, CurvePart { span, value });
        }
        if let Some(period) = curve.period() {
            close(&mut pieces, period);
        }
        pieces
    }

    /// Adds the jumps along a curve, cut into pieces, with their continuation beyond the boundary.
    fn add(
        &mut self,
        domain: &PlaneDomain,
        curve: Curve,
        pieces: &[CurvePiece],
    ) -> Result<(), PlaneError> {
        let whole = pieces.len() == 1 && curve.period().is_some();
        for &CurvePart { span, value } in pieces {
            let Some(values) = value.filter(|[left, right]| left != right) else { continue };
            let ends = if whole { [None; 2] } else { span.map(|s| self.meet(domain, curve.at(s))) };
            let arc = Arc { curve, span, ends };
            self.edges.push(JumpEdge { arc, values });
            let stitches = self.stitches(arc);
            self.joined.extend(stitches.iter().map(|arc| arc.span[1]));
            self.edges.extend(stitches.into_iter().map(|arc| JumpEdge { arc, values }));
        }
        let open = tails(curve, pieces);
        for CurvePart { span, value: jump } in continued(curve, pieces) {
            if jump == 0.0 {
                continue;
            }
            if curve.period().is_some_and(|period| span[1] - span[0] > period - SAME) {
                self.psi.add(Arc { curve, span, ends: [None; 2] }, jump);
                continue;
            }
            let is_open = [0, 1].map(|k| open.is_some_and(|open| open[k] == span[k]));
            let ends = [0, 1].map(|k| (!is_open[k]).then(|| self.vertex(curve.at(span[k]))));
            let arc = Arc { curve, span, ends };
            for arc in self.stitches(arc).into_iter().chain([arc]) {
                self.psi.add(arc, jump);
            }
            for (end, jump) in ends.into_iter().zip([-jump, jump]) {
                if let Some(tip) = end
                    && domain.depth(self.psi.vertices[tip]) <= APART
                {
                    self.lead_away(domain, tip, jump)?;
                }
            }
        }
        Ok(())
    }

    /// Leads a jump from a vertex outside of the domain to infinity, or to the middle of a hole.
    fn lead_away(&mut self, domain: &PlaneDomain, tip: usize, jump: f64) -> Result<(), PlaneError> {
        let text = "f jumps into a bay from which no way out was found";
        let WayOut { bends, ray } = domain
            .way_out(self.psi.vertices[tip])
            .ok_or_else(|| PlaneError::NotFound(text.into()))?;
        let mut last = tip;
        for bend in bends {
            let next = self.vertex(bend);
            // A border may end in the middle of a hole.
            if next != last {
                self.psi.add(self.straight(last, next), jump);
            }
            last = next;
        }
        if let Some(direction) = ray {
            let curve = Curve::line(self.psi.vertices[last], direction);
            self.psi.add(Arc { curve, span: [0.0, 1.0], ends: [Some(last), None] }, jump);
        }
        Ok(())
    }

    /// Vertex at which an edge ends; none on the boundary.
    fn meet(&mut self, domain: &PlaneDomain, z: Complex) -> Option<usize> {
        (domain.depth(z) > APART).then(|| self.vertex(z))
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
            stitches.push(self.straight(from, to));
        }
        stitches
    }

    /// Checks that the jumps that end in each vertex add up to zero, but for the rounding of each: psi would belong to
    /// an f that is not constant on pieces.
    ///
    /// # Errors
    /// [`PlaneError::Source`].
    fn check_vertices(&self, domain: &PlaneDomain) -> Result<(), PlaneError> {
        let vertices = &self.psi.vertices;
        let mut sums = vec![[0.0; 3]; vertices.len()];
        for jump in &self.psi.jumps {
            for (end, sign) in jump.arc.ends.into_iter().zip([-1.0, 1.0]) {
                let Some(v) = end else { continue };
                let [sum, rest, sizes] = sums[v];
                let [sum, remainder] = two_sum(sum, sign * jump.size);
                sums[v] = [sum, rest + remainder, sizes + jump.size.abs()];
            }
        }
        // Half a unit for each difference of two values, and as much for the sum of the remainders.
        let is_open = |[sum, rest, sizes]: &[f64; 3]| (sum + rest).abs() > f64::EPSILON * sizes;
        let Some(v) = sums.iter().position(is_open) else { return Ok(()) };
        let [x, y] = domain.frame.outside(vertices[v]);
        Err(PlaneError::Source(format!(
            "borders of f end or meet near ({x:.3}, {y:.3}) closer than this solver tells apart; move one of them"
        )))
    }

    /// Segment between two vertices.
    fn straight(&self, from: usize, to: usize) -> Arc {
        let [start, end] = [from, to].map(|v| self.psi.vertices[v]);
        let way = end - start;
        let length = way.norm();
        let curve = Curve::line(start, way.scaled(1.0 / length));
        Arc { curve, span: [0.0, length], ends: [Some(from), Some(to)] }
    }
}

/// Points at which a curve meets those of the sides.
fn on_sides(domain: &PlaneDomain, curve: Curve) -> Vec<CurveCut> {
    let met = domain.sides().flat_map(|side| curve.meets(side.arc.curve));
    met.map(|s| CurveCut { s, side: true }).collect()
}

/// Length of the shorter part of a piece of a curve between its ends and a point of the curve that lies on it.
fn shorter_part(curve: Curve, [from, to]: [f64; 2], s: f64) -> Option<f64> {
    let after = curve.period().map_or(s - from, |turn| (s - from).rem_euclid(turn));
    (0.0..=to - from).contains(&after).then(|| after.min(to - from - after))
}

/// Distance of a piece of a curve from the curve of the side that is nearest to all of it, at the worst of the points
/// that cut it into eight.
fn off_side(domain: &PlaneDomain, curve: Curve, [from, to]: [f64; 2]) -> f64 {
    let points = (1..8).map(|k| curve.at(from + 0.125 * f64::from(k) * (to - from)));
    let points: Vec<Complex> = points.collect();
    let off = domain
        .sides()
        .map(|side| points.iter().map(|&z| side.arc.curve.distance(z).abs()).fold(0.0, f64::max));
    off.fold(f64::INFINITY, f64::min)
}

/// Ends from which a line goes on to infinity, beyond the last sides; none of a circle.
fn tails(curve: Curve, pieces: &[CurvePiece]) -> Option<[f64; 2]> {
    let mut inside = pieces.iter().filter(|piece| piece.value.is_some());
    let first = inside.next()?;
    let last = inside.next_back().unwrap_or(first);
    curve.period().is_none().then_some([first.span[0], last.span[1]])
}

/// Parts of a curve with their jumps, continued outside of the domain.
fn continued(curve: Curve, pieces: &[CurvePiece]) -> Vec<CurvePart<f64>> {
    let many = pieces.len();
    // Lengths by which the neighbours of a piece go on along it; lines that end there do so to infinity.
    let mut beyond = vec![0.0; many];
    for (k, (length, CurvePart { span, value })) in beyond.iter_mut().zip(pieces).enumerate() {
        let is_between = curve.period().is_some() || k > 0 && k + 1 < many;
        if value.is_none() && is_between {
            *length = FARTHEST.min(0.5 * (span[1] - span[0]));
        }
    }
    let mut parts = Vec::new();
    for (k, &CurvePart { span: [from, to], value }) in pieces.iter().enumerate() {
        let Some([left, right]) = value else { continue };
        // Of a line, the pieces at both ends have no neighbours inside that go on.
        let [before, after] = [(k + many - 1) % many, (k + 1) % many].map(|beside| beyond[beside]);
        let span = [from - before, to + after];
        append(&mut parts, CurvePart { span, value: left - right });
    }
    if let Some(period) = curve.period() {
        close(&mut parts, period);
    }
    parts
}
