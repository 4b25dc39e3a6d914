//! Curves across which f jumps, cut at the boundary and continued beyond it.
//!
//! Inside, pieces of curves between the others carry the difference of f on their two sides, whose sum at each vertex is
//! zero. Outside, a piece is continued along its curve: to the next piece if that has the same jump; else to half the
//! way, and from there straight to infinity where a ray is free, or in a hole to its middle, where all that enter it
//! add to zero.

use super::domain::{PlaneDomain, SidePlace};
use super::psi::Psi;
use super::{PlaneError, PlaneSource, RegionBorder};
use crate::problem::complex::Complex;
use crate::problem::source::Source;
use crate::spectral::curve::{Arc, Curve, ROUNDING, SAME, borders};
use crate::spectral::potential::Potential;

/// Piece of a curve inside of the domain across which f jumps.
#[derive(Clone, Copy, Debug)]
pub(super) struct PlaneJump {
    pub arc: Arc,
    /// f on the left and on the right.
    pub values: [f64; 2],
}

/// f with psi, its jumps inside of the domain, and where these meet the boundary.
pub(super) struct PlaneJumps {
    pub psi: Psi,
    pub edges: Vec<PlaneJump>,
    /// Points of the boundary at which jumps end, by loop.
    pub crossings: Vec<(usize, SidePlace)>,
    /// Points at which psi, continued beyond the boundary, may be singular: vertices, and centres of circles.
    pub singular: Vec<Complex>,
}

/// Distance of points from the boundary below which they are on it.
const ON: f64 = 1e-12;

/// Piece of a curve: f on both sides, none outside of the domain.
struct Piece {
    span: [f64; 2],
    values: Option<[f64; 2]>,
}

impl PlaneJumps {
    pub(super) fn new(domain: &PlaneDomain, source: &PlaneSource) -> Result<Self, PlaneError> {
        let mut builder = Builder {
            domain,
            potential: Potential::default(),
            edges: Vec::new(),
            crossings: Vec::new(),
        };
        let inner = inner_points(domain);
        let psi = match source {
            PlaneSource::Polynomial(f) => Psi::Polynomial(f.clone()),
            PlaneSource::Pieces(f) if f.is_smooth() => {
                return Err(PlaneError::NotFound(
                    "f must consist of constant pieces, or be a polynomial".into(),
                ));
            }
            PlaneSource::Pieces(f) => {
                let curves = curves(f);
                for k in 0..curves.len() {
                    let pieces = builder.pieces(&curves, k, f);
                    builder.add(curves[k], &pieces)?;
                }
                Psi::of_jumps(builder.potential, &inner, |z| f.at(z.coordinates()))
            }
            PlaneSource::Regions(regions) => {
                for border in &regions.borders {
                    builder.add_border(border)?;
                }
                let (point, f) = regions.known;
                Psi::of_jumps(builder.potential, &[Complex::new(point[0], point[1])], |_| f)
            }
        };
        let mut singular = Vec::new();
        if let Psi::Jumps(potential) = &psi {
            singular.extend(&potential.vertices);
            singular.extend(potential.jumps.iter().filter_map(|jump| jump.arc.curve.centre()));
        }
        Ok(Self { psi, edges: builder.edges, crossings: builder.crossings, singular })
    }
}

/// Curves that bound the pieces, each once.
fn curves(f: &Source) -> Vec<Curve> {
    let mut curves: Vec<Curve> = Vec::new();
    if let Source::Pieces { pieces, .. } = f {
        for curve in pieces.iter().flat_map(|(shape, _)| borders(shape)) {
            if !curves.iter().any(|&other| other.same(curve)) {
                curves.push(curve);
            }
        }
    }
    curves
}

/// Points of the domain away from its boundary.
fn inner_points(domain: &PlaneDomain) -> Vec<Complex> {
    let [[left, right], [low, high]] = domain.extent();
    let mut points = Vec::new();
    for k in 0..2000 {
        let [x, y] = [0.618_034 * f64::from(k) + 0.31, 0.754_878 * f64::from(k) + 0.17];
        let z = Complex::new(
            left + (right - left) * (x - x.floor()),
            low + (high - low) * (y - y.floor()),
        );
        if domain.holds(z) {
            points.push(z);
        }
        if points.len() == 25 {
            break;
        }
    }
    points
}

struct Builder<'a> {
    domain: &'a PlaneDomain,
    potential: Potential,
    edges: Vec<PlaneJump>,
    crossings: Vec<(usize, SidePlace)>,
}

impl Builder<'_> {
    /// Pieces of the `k`-th curve between the others and the sides, once around a circle.
    fn pieces(&self, curves: &[Curve], k: usize, f: &Source) -> Vec<Piece> {
        let curve = curves[k];
        let mut cuts = Vec::new();
        for (j, other) in curves.iter().enumerate() {
            // Both of two curves are cut at the same points.
            cuts.extend(match j < k {
                true => other.meets(curve).into_iter().map(|s| curve.place(other.at(s))).collect(),
                false => curve.meets(*other),
            });
        }
        for side in self.domain.sides() {
            let met = curve.meets(side.arc.curve).into_iter();
            cuts.extend(met.filter(|&s| side.place(curve.at(s), 10.0 * SAME).is_some()));
            // Where a curve runs along a side it is cut at the ends of the side.
            let ends = [0.0, side.length()].map(|s| side.point(s));
            cuts.extend(
                ends.into_iter()
                    .filter(|&z| curve.distance(z).abs() < SAME)
                    .map(|z| curve.place(z)),
            );
        }
        cuts.sort_by(f64::total_cmp);
        cuts.dedup_by(|b, a| *b - *a < SAME);
        if let Some(period) = curve.period() {
            if cuts.len() > 1 && cuts[0] + period - cuts[cuts.len() - 1] < SAME {
                cuts.pop();
            }
            let first = cuts.first().copied().unwrap_or(0.0);
            cuts.resize(cuts.len().max(1), first);
            cuts.push(first + period);
        }
        let mut pieces: Vec<Piece> = Vec::new();
        for cut in cuts.windows(2) {
            let span = [cut[0], cut[1]];
            let middle = 0.5 * (span[0] + span[1]);
            let (z, normal) = (curve.at(middle), curve.direction(middle).turned());
            let inside = self.domain.distance(z) > ON && self.domain.holds(z);
            let along = [span[0], middle, span[1]].map(|s| curve.at(s));
            let values = inside.then(|| {
                let known = curves[..k].iter().any(|other| other.holds(along, ROUNDING));
                let apart = curves.iter().filter(|other| !other.holds(along, ROUNDING));
                let room = apart.map(|other| 0.5 * other.distance(z).abs()).fold(1e-9, f64::min);
                let step = normal.scaled(room.max(curve.rounding()));
                if known { [0.0; 2] } else { [z + step, z - step].map(|z| f.at(z.coordinates())) }
            });
            match pieces.last_mut() {
                Some(last) if last.values == values => last.span[1] = span[1],
                _ => pieces.push(Piece { span, values }),
            }
        }
        if let Some(period) = curve.period()
            && let [first, .., last] = &mut pieces[..]
            && first.values == last.values
        {
            first.span[0] = last.span[0] - period;
            pieces.pop();
        }
        pieces
    }

    /// Adds the jumps along a curve, cut into pieces, with their continuation beyond the boundary.
    fn add(&mut self, curve: Curve, pieces: &[Piece]) -> Result<(), PlaneError> {
        let jumps: Vec<Option<f64>> = pieces.iter().map(|p| p.values.map(|[l, r]| l - r)).collect();
        for piece in pieces {
            if let Some(values) = piece.values.filter(|[left, right]| left != right) {
                let whole = curve.period().is_some() && pieces.len() == 1;
                let ends =
                    if whole { [None; 2] } else { piece.span.map(|s| self.meet(curve.at(s))) };
                self.edges.push(PlaneJump { arc: Arc { curve, span: piece.span, ends }, values });
            }
        }
        // Parts of the curve that carry a jump, those outside included.
        let mut parts: Vec<([f64; 2], f64)> = Vec::new();
        let many = pieces.len();
        let reach = self.domain.diameter();
        for (k, piece) in pieces.iter().enumerate() {
            if let Some(jump) = jumps[k] {
                parts.push((piece.span, jump));
                continue;
            }
            let [before, after] = match curve.period() {
                Some(_) => [jumps[(k + many - 1) % many], jumps[(k + 1) % many]],
                None => {
                    [k.checked_sub(1).and_then(|k| jumps[k]), jumps.get(k + 1).copied().flatten()]
                }
            };
            let [from, to] = piece.span;
            let half = (0.5 * (to - from)).min(reach);
            match [before, after] {
                [Some(a), Some(b)] if a == b => parts.push((piece.span, a)),
                // A line goes on beyond the last side.
                [a, None] | [None, a] if curve.period().is_none() => {
                    parts.extend(a.map(|jump| (piece.span, jump)));
                }
                [a, b] => {
                    parts.extend(a.map(|jump| ([from, from + half], jump)));
                    parts.extend(b.map(|jump| ([to - half, to], jump)));
                }
            }
        }
        parts.retain(|(_, jump)| *jump != 0.0);
        let mut joined: Vec<([f64; 2], f64)> = Vec::new();
        for (span, jump) in parts {
            match joined.last_mut() {
                Some((last, same)) if *same == jump && (span[0] - last[1]).abs() < SAME => {
                    last[1] = span[1]
                }
                _ => joined.push((span, jump)),
            }
        }
        if let Some(period) = curve.period()
            && let [(first, jump), .., (last, same)] = &mut joined[..]
            && jump == same
            && (first[0] + period - last[1]).abs() < SAME
        {
            first[0] = last[0] - period;
            joined.pop();
        }
        let (first, last) = (pieces.first(), pieces.last());
        let ends = first.zip(last).map(|(a, b)| [a.span[0], b.span[1]]);
        for (span, jump) in joined {
            if curve.period().is_some_and(|period| span[1] - span[0] > period - SAME) {
                self.potential.add(Arc { curve, span, ends: [None; 2] }, jump);
                continue;
            }
            // A line goes on to infinity beyond the last side.
            let open = [0, 1]
                .map(|k| curve.period().is_none() && ends.is_some_and(|ends| ends[k] == span[k]));
            let mut vertices = [None; 2];
            for k in 0..2 {
                if open[k] {
                    continue;
                }
                let z = curve.at(span[k]);
                let v = self.vertex(z);
                vertices[k] = Some(v);
                if self.domain.distance(z) <= ON || !self.domain.holds(z) {
                    let outwards = curve.direction(span[k]).scaled([-1.0, 1.0][k]);
                    self.lead_away(v, outwards, [-jump, jump][k])?;
                }
            }
            self.potential.add(Arc { curve, span, ends: vertices }, jump);
        }
        Ok(())
    }

    /// Adds a border of regions, which meets others or the boundary at its ends only.
    fn add_border(&mut self, border: &RegionBorder) -> Result<(), PlaneError> {
        let RegionBorder { side, mut values } = *border;
        let mut arc = side.arc;
        if arc.span[0] > arc.span[1] {
            arc = arc.reversed();
            values.reverse();
        }
        let jump = values[0] - values[1];
        if jump == 0.0 {
            return Ok(());
        }
        let Arc { curve, span, .. } = arc;
        if curve.period().is_some_and(|period| span[1] - span[0] > period - SAME) {
            self.edges.push(PlaneJump { arc, values });
            self.potential.add(arc, jump);
            return Ok(());
        }
        let ends = span.map(|s| self.meet(curve.at(s)));
        self.edges.push(PlaneJump { arc: Arc { ends, ..arc }, values });
        let (mut longer, mut vertices) = (span, ends);
        for k in 0..2 {
            if ends[k].is_some() {
                continue;
            }
            // Straight on beyond the boundary, along the tangent.
            let (z, outwards) =
                (curve.at(span[k]), curve.direction(span[k]).scaled([-1.0, 1.0][k]));
            let length = (0.5 * self.domain.exit(z, outwards)).min(0.1 * self.domain.diameter());
            let v = match curve.curvature {
                0.0 => {
                    longer[k] += [-length, length][k];
                    self.vertex(curve.at(longer[k]))
                }
                _ => {
                    let limited = length.min(0.5 / curve.curvature);
                    longer[k] += [-limited, limited][k];
                    self.vertex(curve.at(longer[k]))
                }
            };
            vertices[k] = Some(v);
            self.lead_away(v, outwards, [-jump, jump][k])?;
        }
        self.potential.add(Arc { curve, span: longer, ends: vertices }, jump);
        Ok(())
    }

    /// Leads a jump from a vertex outside of the domain to infinity, or to the middle of a hole.
    fn lead_away(&mut self, v: usize, direction: Complex, jump: f64) -> Result<(), PlaneError> {
        let z = self.potential.vertices[v];
        let turned = (0..32).map(|k| {
            direction * Complex::unit(f64::from(k % 2 * 2 - 1) * 0.1 * f64::from((k + 1) / 2))
        });
        if let Some(way) = turned.into_iter().find(|&way| self.domain.exit(z, way).is_infinite()) {
            self.potential.add(
                Arc { curve: Curve::line(z, way), span: [0.0, 1.0], ends: [Some(v), None] },
                jump,
            );
            return Ok(());
        }
        for hole in self.domain.loops.iter().skip(1) {
            let middle = middle(hole);
            let way = middle - z;
            let length = way.norm();
            if length == 0.0 || self.domain.exit(z, way.scaled(1.0 / length)) > length {
                if length > 0.0 {
                    let curve = Curve::line(z, way.scaled(1.0 / length));
                    let to = self.vertex(middle);
                    self.potential
                        .add(Arc { curve, span: [0.0, length], ends: [Some(v), Some(to)] }, jump);
                }
                return Ok(());
            }
        }
        Err(PlaneError::NotFound(
            "f jumps into a bay from which no straight line leads away".into(),
        ))
    }

    /// Vertex at the end of an edge, or none if it lies on the boundary.
    fn meet(&mut self, z: Complex) -> Option<usize> {
        for (ring, sides) in self.domain.loops.iter().enumerate() {
            for (side, line) in sides.iter().enumerate() {
                if line.distance(z) <= ON
                    && let Some(s) = line.place(z, 10.0 * SAME)
                {
                    self.crossings.push((ring, SidePlace { side, s }));
                    return None;
                }
            }
        }
        Some(self.vertex(z))
    }

    /// Number of the vertex at a point, a new one if there is none.
    fn vertex(&mut self, z: Complex) -> usize {
        let vertices = &mut self.potential.vertices;
        match vertices.iter().position(|&v| (v - z).norm() < 4.0 * ROUNDING) {
            Some(known) => known,
            None => {
                vertices.push(z);
                vertices.len() - 1
            }
        }
    }
}

/// Middle of a hole: the mean of points of its boundary.
pub(super) fn middle(sides: &[super::PlaneSide]) -> Complex {
    let mut sum = Complex::default();
    let many = 16.0 * sides.len() as f64;
    for side in sides {
        for k in 0..16 {
            sum = sum + side.point(side.length() * (f64::from(k) + 0.5) / 16.0).scaled(1.0 / many);
        }
    }
    sum
}
