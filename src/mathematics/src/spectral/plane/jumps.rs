//! Curves across which f jumps, cut at the boundary and continued beyond it.
//!
//! Inside, pieces of curves between the others carry the difference of f on their two sides, whose sum at each vertex is
//! zero. Outside, a piece is continued along its curve: to the next piece if that has the same jump; else to half the
//! way, and from there straight to infinity where a ray is free, or in a hole to its middle, where all that enter it
//! add to zero.

use super::continuation::Builder;
use super::domain::{PlaneDomain, SidePlace};
use super::psi::Psi;
use super::{PlaneError, PlaneSource};
use crate::problem::complex::Complex;
use crate::problem::source::Source;
use crate::spectral::curve::{Arc, Curve, ROUNDING, SAME, borders};
use crate::spectral::parts::{CurvePart, append, close};
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
pub(super) const ON: f64 = 1e-12;

/// Piece of a curve with f on its left and right, none outside of the domain.
pub(super) type Piece = CurvePart<Option<[f64; 2]>>;

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
            append(&mut pieces, Piece { span, value: values });
        }
        if let Some(period) = curve.period() {
            close(&mut pieces, period);
        }
        pieces
    }
}
