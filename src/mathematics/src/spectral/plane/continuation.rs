//! Jumps beyond the boundary.

use super::PlaneError;
use super::RegionBorder;
use super::domain::{PlaneDomain, PlaneSide, SidePlace};
use super::jumps::{ON, Piece, PlaneJump};
use crate::problem::complex::Complex;
use crate::spectral::curve::{Arc, Curve, ROUNDING, SAME};
use crate::spectral::parts::{CurvePart, append, close};
use crate::spectral::potential::Potential;

/// Jumps of f as they are added, curve by curve.
pub(super) struct Builder<'a> {
    pub domain: &'a PlaneDomain,
    pub potential: Potential,
    pub edges: Vec<PlaneJump>,
    pub crossings: Vec<(usize, SidePlace)>,
}

impl Builder<'_> {
    /// Adds the jumps along a curve, cut into pieces, with their continuation beyond the boundary.
    pub(super) fn add(&mut self, curve: Curve, pieces: &[Piece]) -> Result<(), PlaneError> {
        for piece in pieces {
            if let Some(values) = piece.value.filter(|[left, right]| left != right) {
                let whole = curve.period().is_some() && pieces.len() == 1;
                let ends =
                    if whole { [None; 2] } else { piece.span.map(|s| self.meet(curve.at(s))) };
                self.edges.push(PlaneJump { arc: Arc { curve, span: piece.span, ends }, values });
            }
        }
        let parts = self.continued(curve, pieces);
        let (first, last) = (pieces.first(), pieces.last());
        let ends = first.zip(last).map(|(a, b)| [a.span[0], b.span[1]]);
        for CurvePart { span, value: jump } in parts {
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

    /// Parts of a curve that carry a jump, those outside of the domain included.
    fn continued(&self, curve: Curve, pieces: &[Piece]) -> Vec<CurvePart<f64>> {
        let jumps: Vec<Option<f64>> = pieces.iter().map(|p| p.value.map(|[l, r]| l - r)).collect();
        let (many, reach) = (pieces.len(), self.domain.diameter());
        let mut parts: Vec<CurvePart<f64>> = Vec::new();
        let mut add = |span, jump: Option<f64>| {
            if let Some(value) = jump.filter(|jump| *jump != 0.0) {
                append(&mut parts, CurvePart { span, value });
            }
        };
        for (k, piece) in pieces.iter().enumerate() {
            if jumps[k].is_some() {
                add(piece.span, jumps[k]);
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
                [Some(a), Some(b)] if a == b => add(piece.span, before),
                // A line goes on beyond the last side.
                [a, None] | [None, a] if curve.period().is_none() => add(piece.span, a),
                _ => {
                    add([from, from + half], before);
                    add([to - half, to], after);
                }
            }
        }
        if let Some(period) = curve.period() {
            close(&mut parts, period);
        }
        parts
    }

    /// Adds a border of regions, which meets others or the boundary at its ends only.
    pub(super) fn add_border(&mut self, border: &RegionBorder) -> Result<(), PlaneError> {
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
pub(super) fn middle(sides: &[PlaneSide]) -> Complex {
    let mut sum = Complex::default();
    let many = 16.0 * sides.len() as f64;
    for side in sides {
        for k in 0..16 {
            sum = sum + side.point(side.length() * (f64::from(k) + 0.5) / 16.0).scaled(1.0 / many);
        }
    }
    sum
}
