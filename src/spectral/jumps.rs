//! The curves inside the square across which f jumps.

use super::complex::Complex;
use crate::problem::region::Region;
use crate::problem::shape::Shape;
use crate::problem::source::Source;
use std::f64::consts::TAU;

/// Points closer than this count as one.
const SAME: f64 = 1e-12;
/// Half chords shorter than the root of this are tangencies: with decimal input they are frequent.
const TANGENT: f64 = 1e-15;
/// Distance from a jump at which f is read on either side of it.
pub(super) const PROBE: f64 = 1e-9;

/// A line or circle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Curve {
    /// The points z with Re(conj(normal) z) = offset, by distance along the normal turned left.
    Line { normal: Complex, offset: f64 },
    /// By angle, anticlockwise.
    Circle { centre: Complex, radius: f64 },
}

impl Curve {
    pub fn at(self, s: f64) -> Complex {
        match self {
            Self::Line { normal, offset } => normal.scaled(offset) + normal.turned().scaled(s),
            Self::Circle { centre, radius } => centre + Complex::unit(s).scaled(radius),
        }
    }

    /// The unit normal to the right of the curve.
    pub fn normal(self, s: f64) -> Complex {
        match self {
            Self::Line { normal, .. } => normal,
            Self::Circle { .. } => Complex::unit(s),
        }
    }

    /// Length per parameter.
    pub fn speed(self) -> f64 {
        match self {
            Self::Line { .. } => 1.0,
            Self::Circle { radius, .. } => radius,
        }
    }

    /// Whether the branch of psi that holds at `z` is singular in the centre.
    pub fn singular_centre(self, z: Complex) -> Option<Complex> {
        match self {
            Self::Circle { centre, radius } if (z - centre).norm() > radius + SAME => Some(centre),
            _ => None,
        }
    }

    /// Parameters at which it meets another curve.
    fn meets(self, other: Self) -> Vec<f64> {
        match (self, other) {
            (Self::Line { normal, offset }, Self::Line { normal: n, offset: o }) => {
                let slope = n.dot(normal.turned());
                if slope.abs() < 1e-9 {
                    Vec::new()
                } else {
                    vec![(o - offset * n.dot(normal)) / slope]
                }
            }
            (Self::Line { normal, offset }, Self::Circle { centre, radius }) => {
                let (foot, off) = (normal.turned().dot(centre), offset - normal.dot(centre));
                chord(radius * radius - off * off).map_or(Vec::new(), |h| vec![foot - h, foot + h])
            }
            (Self::Circle { centre, radius }, Self::Line { normal, offset }) => {
                self.cut(normal, offset - normal.dot(centre), radius)
            }
            (Self::Circle { centre, radius }, Self::Circle { centre: c, radius: r }) => {
                let to = c - centre;
                let distance = to.norm();
                if distance < SAME {
                    return Vec::new();
                }
                let along = 0.5 * (distance + (radius - r) * (radius + r) / distance);
                self.cut(to.scaled(1.0 / distance), along, radius)
            }
        }
    }

    /// Angles at which a circle meets the line at `along` from its centre in a direction.
    fn cut(self, direction: Complex, along: f64, radius: f64) -> Vec<f64> {
        let Some(half) = chord(radius * radius - along * along) else { return Vec::new() };
        let (middle, spread) = (direction.arg(), libm::atan2(half, along));
        [middle - spread, middle + spread].map(|s| s - TAU * (s / TAU).floor()).to_vec()
    }

    fn same(self, other: Self) -> bool {
        match (self, other) {
            (Self::Line { normal, offset }, Self::Line { normal: n, offset: o }) => {
                (normal - n).norm() < SAME && (offset - o).abs() < SAME
            }
            (Self::Circle { centre, radius }, Self::Circle { centre: c, radius: r }) => {
                (centre - c).norm() < SAME && (radius - r).abs() < SAME
            }
            _ => false,
        }
    }
}

/// The root of a squared half chord, zero at a tangency; none without points in common.
fn chord(square: f64) -> Option<f64> {
    (square > -TANGENT).then(|| if square < TANGENT { 0.0 } else { square.sqrt() })
}

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
    pub fn jump(&self) -> f64 {
        self.values[0] - self.values[1]
    }
}

/// A jump as psi sees it: beyond the border f is continued, so that a line goes on for ever (no vertex at
/// that end) and an arc runs on to the middle of its way outside.
#[derive(Clone, Debug)]
pub(super) enum Continued {
    Line { origin: Complex, tangent: Complex, jump: f64, ends: [Option<usize>; 2] },
    Arc { centre: Complex, radius: f64, span: [f64; 2], jump: f64, ends: [usize; 2] },
    Circle { centre: Complex, radius: f64, jump: f64 },
}

/// All jumps of f inside the square.
#[derive(Clone, Debug, Default)]
pub(super) struct Jumps {
    /// f, as regions with their values, in painting order.
    painted: Vec<(Region, f64)>,
    background: f64,
    /// The borders of all regions, in full.
    pub curves: Vec<Curve>,
    pub edges: Vec<Edge>,
    pub continued: Vec<Continued>,
    /// Where edges meet, inside the square, and ends of continued arcs outside.
    pub vertices: Vec<Complex>,
    /// Where edges meet the border.
    pub crossings: Vec<Complex>,
}

impl Jumps {
    pub fn of(f: &Source) -> Self {
        let Source::Pieces { pieces, background } = f else { return Self::default() };
        let mut jumps = Self { background: *background, ..Self::default() };
        for (region, value) in pieces {
            for curve in borders(region) {
                // Common borders of two regions are one curve.
                if !jumps.curves.iter().any(|&other| other.same(curve)) {
                    jumps.curves.push(curve);
                }
            }
            jumps.painted.push((*region, *value));
        }
        for curve in jumps.curves.clone() {
            match curve {
                Curve::Line { .. } => jumps.add_line(curve),
                Curve::Circle { .. } => jumps.add_circle(curve),
            }
        }
        jumps
    }

    /// f; the last region that covers a point wins.
    pub fn value(&self, x: f64, y: f64) -> f64 {
        let covering = self.painted.iter().rev().find(|(region, _)| region.contains([x, y]));
        covering.map_or(self.background, |&(_, value)| value)
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
            let ends = span.map(|s| self.meet(line.at(s)));
            let tangent = line.normal(0.0).turned();
            let (origin, jump) = (line.at(span[0]), values[0] - values[1]);
            self.continued.push(Continued::Line { origin, tangent, jump, ends });
            self.edges.push(Edge { curve: line, span, values, ends });
        }
    }

    fn add_circle(&mut self, circle: Curve) {
        let Curve::Circle { centre, radius } = circle else { return };
        let around = self.around(circle);
        if around.iter().all(|(_, values)| values.is_none()) {
            return;
        }
        if let [(_, Some(values))] = around[..] {
            let (span, jump) = ([0.0, TAU], values[0] - values[1]);
            if jump != 0.0 {
                self.edges.push(Edge { curve: circle, span, values, ends: [None; 2] });
                self.continued.push(Continued::Circle { centre, radius, jump });
            }
            return;
        }
        for &(span, values) in &around {
            if let Some(values) = values.filter(|[left, right]| left != right) {
                let ends = span.map(|s| self.meet(circle.at(s)));
                self.edges.push(Edge { curve: circle, span, values, ends });
            }
        }
        let joined = continued(&around);
        if let [(_, jump)] = joined[..] {
            if jump != 0.0 {
                self.continued.push(Continued::Circle { centre, radius, jump });
            }
            return;
        }
        for (k, &(span, jump)) in joined.iter().enumerate() {
            let ends = span.map(|s| self.vertex(circle.at(s)));
            let tip = self.vertices[ends[1]];
            let next = joined[(k + 1) % joined.len()].1;
            if tip.re.abs().max(tip.im.abs()) > 0.5 - SAME && jump != next {
                // What the arcs before and after do not share goes to infinity.
                self.continued.push(Continued::Line {
                    origin: tip,
                    tangent: tip.scaled(1.0 / tip.norm()),
                    jump: jump - next,
                    ends: [Some(ends[1]), None],
                });
            }
            if jump != 0.0 {
                self.continued.push(Continued::Arc { centre, radius, span, jump, ends });
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
        let mut pieces: Vec<Piece> = Vec::new();
        for cut in cuts.windows(2) {
            let s = 0.5 * (cut[0] + cut[1]);
            let (z, step) = (curve.at(s), curve.normal(s).scaled(PROBE));
            let inside = z.re.abs().max(z.im.abs()) < 0.5 - SAME;
            let values = inside.then(|| [z - step, z + step].map(|z| self.value(z.re, z.im)));
            match pieces.last_mut() {
                Some((span, last)) if *last == values => span[1] = cut[1],
                _ => pieces.push(([cut[0], cut[1]], values)),
            }
        }
        pieces
    }

    /// The singular points of psi as it is near `z`: vertices, and centres of circles seen from outside.
    pub fn singular(&self, z: Complex) -> impl Iterator<Item = Complex> {
        let centres = self.edges.iter().filter_map(move |e| e.curve.singular_centre(z));
        self.vertices.iter().copied().chain(centres)
    }

    /// Notes where an edge ends: the vertex there, or none on the border.
    fn meet(&mut self, z: Complex) -> Option<usize> {
        if z.re.abs().max(z.im.abs()) < 0.5 - SAME {
            return Some(self.vertex(z));
        }
        index(&mut self.crossings, z);
        None
    }

    fn vertex(&mut self, z: Complex) -> usize {
        index(&mut self.vertices, z)
    }
}

/// The position of a point in a list, to which it is added if new.
fn index(known: &mut Vec<Complex>, z: Complex) -> usize {
    known.iter().position(|&v| (v - z).norm() < 10.0 * SAME).unwrap_or_else(|| {
        known.push(z);
        known.len() - 1
    })
}

/// The lines of the sides.
const SIDES: [Curve; 4] = [
    Curve::Line { normal: Complex::new(1.0, 0.0), offset: -0.5 },
    Curve::Line { normal: Complex::new(1.0, 0.0), offset: 0.5 },
    Curve::Line { normal: Complex::new(0.0, 1.0), offset: -0.5 },
    Curve::Line { normal: Complex::new(0.0, 1.0), offset: 0.5 },
];

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
/// neighbours, half from each.
fn continued(around: &[Piece]) -> Vec<([f64; 2], f64)> {
    let many = around.len();
    let jump = |k: usize| around[k % many].1.map(|values| values[0] - values[1]);
    let mut arcs: Vec<([f64; 2], f64)> = Vec::new();
    for (k, &(span @ [from, to], _)) in around.iter().enumerate() {
        let middle = 0.5 * (from + to);
        let halves = match jump(k) {
            Some(jump) => vec![(span, jump)],
            None => vec![
                ([from, middle], jump(k + many - 1).unwrap_or(0.0)),
                ([middle, to], jump(k + 1).unwrap_or(0.0)),
            ],
        };
        for (span, jump) in halves {
            match arcs.last_mut() {
                Some((last, same)) if *same == jump => last[1] = span[1],
                _ => arcs.push((span, jump)),
            }
        }
    }
    closed(arcs)
}

/// The parameters of the points of a line in the closed square, if it meets the inside.
fn in_square(line: Curve) -> Option<[f64; 2]> {
    let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
    let (origin, tangent) = (line.at(0.0), line.normal(0.0).turned());
    for (o, t) in [(origin.re, tangent.re), (origin.im, tangent.im)] {
        if t.abs() < 1e-15 {
            if o.abs() >= 0.5 - SAME {
                return None;
            }
            continue;
        }
        let (a, b) = ((-0.5 - o) / t, (0.5 - o) / t);
        (low, high) = (low.max(a.min(b)), high.min(a.max(b)));
    }
    (high - low > SAME).then_some([low, high])
}

/// The curves that bound a region.
fn borders(region: &Region) -> Vec<Curve> {
    if let Region::Disc { centre: [x, y], radius } = *region {
        return vec![Curve::Circle { centre: Complex::new(x, y), radius }];
    }
    let line = |[a, b, c]: [f64; 3]| {
        // One orientation for each line, so that common borders are found to be one.
        let flip = if a < 0.0 || (a == 0.0 && b < 0.0) { -1.0 } else { 1.0 };
        let scale = flip / (a * a + b * b).sqrt();
        Curve::Line { normal: Complex::new(a, b).scaled(scale), offset: c * scale }
    };
    region.half_planes().into_iter().map(line).collect()
}
