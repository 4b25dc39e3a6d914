//! Problems on the domains of meshes, solved from their finite element solutions.

use super::fit::Effort;
use crate::discrete::contact::ContactArc;
use crate::mesh::{BuiltIn, Condition, Names, PlaneMesh, boundary_curves, centroid};
use crate::problem::complex::Complex;
use crate::problem::exact::{Exact, Known};
use crate::problem::law::Law;
use crate::problem::source::Source;
use crate::problem::text::percent;
use crate::spectral::contact::ends::PlaneArc;
use crate::spectral::contact::start::DiscreteStart;
use crate::spectral::geometry::domain::{PlaneDomain, PlaneError, PlaneSide, SidePlace};
use crate::spectral::geometry::origin::Origin;
use crate::spectral::geometry::outline::outline;
use crate::spectral::problem::PlaneProblem;
use crate::spectral::proof::PlaneBracket;
use crate::spectral::solution::{PlaneSolution, solve};
use crate::spectral::source::polynomial::Polynomial;
use crate::spectral::source::{PlaneSource, regions};

/// Nodes, at most, of the meshes whose solutions are starts in turn, on a domain with at most so many sides.
const STARTS: [f64; 2] = [6e3, 6e4];
const SIDES: f64 = 20.0;
/// Cells per side of the grids whose solutions are starts in turn on the square.
const GRIDS: [usize; 2] = [64, 256];
/// Distance of the bounds, over the energy, from which on they are wide.
const WIDE: f64 = 1e-6;

/// Distances from corners, over the length of the side, at which v, and its derivatives, are taken for them.
const BESIDE: [f64; 2] = [1e-15, 1e-6];

/// True solution on the domain of a mesh.
pub(crate) struct PlaneTruth {
    /// Unit of f, of dv/dn and of v.
    height: f64,
    /// Place from which domain and f are seen.
    origin: Origin,
    /// Domain, f and law, seen from there in this unit.
    problem: PlaneProblem,
    /// Solution of that problem; its numbers are in the unit of the mesh.
    pub(crate) solution: PlaneSolution,
}

/// Solves the problem on the domain of a mesh, whose boundary is straight or lies on the circles of its parts.
///
/// # Errors
/// [`PlaneError`].
pub(crate) fn solve_on_mesh(
    mesh: &PlaneMesh,
    f: &[Source],
    law: Law,
) -> Result<PlaneTruth, PlaneError> {
    let unsolved = Unsolved::new(mesh, f, law)?;
    let domain = &unsolved.problem.domain;
    let sides = domain.sides().filter(|side| !side.is_after_bend).count() as f64;
    // Short sides want short edges.
    let most_nodes = STARTS.map(|nodes| nodes * (sides / SIDES).max(1.0).powi(2));
    let starts =
        most_nodes.into_iter().filter_map(|most| DiscreteStart::on_mesh(mesh, f, law, most));
    unsolved.solved(starts)
}

/// Solves the problem on the square; returns its coarsest mesh with the solution.
///
/// # Errors
/// [`PlaneError`].
pub(crate) fn solve_on_square(f: &Source, law: Law) -> Result<(PlaneMesh, PlaneTruth), PlaneError> {
    let mesh = BuiltIn::Square.plane().expect("the square lies in the plane");
    let unsolved = Unsolved::new(&mesh, std::slice::from_ref(f), law)?;
    let starts = GRIDS.into_iter().filter_map(|cells| DiscreteStart::on_square(cells, f, law));
    Ok((mesh, unsolved.solved(starts)?))
}

/// Checks that [`solve_on_mesh`] takes the domain of a mesh, and f.
///
/// # Errors
/// [`PlaneError`].
pub(crate) fn check_on_mesh(mesh: &PlaneMesh, f: &[Source], law: Law) -> Result<(), PlaneError> {
    Unsolved::new(mesh, f, law).map(|_| ())
}

/// Power of two next to the largest value of f in the middle of a cell, or on a piece: a unit that changes no digit.
fn height(mesh: &PlaneMesh, f: &[Source]) -> f64 {
    let mut largest = 0.0f64;
    for (cell, &region) in mesh.cells().iter().zip(mesh.regions()) {
        let f = &f[usize::from(region)];
        let here = f.largest().unwrap_or_else(|| f.at(centroid(mesh.vertices(cell))).abs());
        largest = largest.max(here);
    }
    if largest > 0.0 { libm::exp2(libm::log2(largest).round()) } else { 1.0 }
}

/// Problem on the domain of a mesh, before it is solved.
struct Unsolved {
    height: f64,
    origin: Origin,
    problem: PlaneProblem,
}

impl Unsolved {
    fn new(mesh: &PlaneMesh, f: &[Source], law: Law) -> Result<Self, PlaneError> {
        let (height, origin) = (height(mesh, f), Origin::of(mesh));
        Ok(Self { height, origin, problem: problem(mesh, f, law, (height, origin))? })
    }

    /// Solves it from the contact sets of discrete solutions in turn.
    fn solved(self, starts: impl Iterator<Item = DiscreteStart>) -> Result<PlaneTruth, PlaneError> {
        let Self { height, origin, problem } = self;
        let mut error = PlaneError::NotFound("multigrid found no solution to begin with".into());
        let mut effort = Effort::default();
        for start in starts {
            match solve(&problem, &start.seen(&problem, origin), &mut effort) {
                Err(failed) => error = failed,
                Ok(solution) => {
                    let solution = solution.in_unit(height);
                    return Ok(PlaneTruth { height, origin, problem, solution });
                }
            }
        }
        Err(error)
    }
}

impl PlaneTruth {
    /// Remark on bounds that are wide.
    pub(crate) fn notes(&self) -> Vec<String> {
        let mut notes = Vec::new();
        if let Ok(bracket) = self.solution.bracket {
            let relative = bracket.relative();
            if relative > WIDE && self.solution.energy != 0.0 {
                let PlaneBracket { cause, .. } = bracket;
                let share = percent(relative, 2);
                notes.push(format!(
                    "the bounds of the energy are {share} of it apart: mostly {cause}"
                ));
            }
        }
        notes
    }

    /// Distance of a point from the domain.
    pub(crate) fn distance(&self, point: [f64; 2]) -> f64 {
        let [x, y] = self.origin.seen(point);
        let (domain, z) = (&self.problem.domain, Complex::new(x, y));
        if domain.holds(z) { 0.0 } else { domain.distance(z) }
    }

    /// Arcs in contact, with the names of the parts of a mesh: those on sides where the law holds.
    pub(crate) fn contact(&self, mesh: &PlaneMesh) -> Vec<ContactArc> {
        let mut arcs = Vec::new();
        for PlaneArc { ring, ends, closed, force, errors, .. } in &self.solution.arcs {
            let sides = &self.problem.domain.loops()[*ring];
            let [from, to] = *ends;
            let count = match closed {
                true => sides.len(),
                // An arc that begins and ends on one side either stays on it or goes all the way round.
                false if from.side == to.side && from.s > to.s => sides.len() + 1,
                false => (to.side + sides.len() - from.side) % sides.len() + 1,
            };
            let along = (from.side..from.side + count).map(|side| side % sides.len());
            let lawful: Vec<usize> =
                along.filter(|&side| sides[side].condition == Condition::Contact).collect();
            let (Some(&first), Some(&last)) = (lawful.first(), lawful.last()) else { continue };
            // An arc that goes on over fixed and free sides ends at their corner.
            let [mut start, mut end] = [(0.0, 0.0), (sides[last].length(), 0.0)];
            if first == from.side {
                start = (from.s, errors[0]);
            }
            if last == to.side {
                end = (to.s, errors[1]);
            }
            let names = lawful.iter().map(|&side| &mesh.parts()[sides[side].part].names);
            let part = Some(Names::all(names));
            let points = [sides[first].at(start.0), sides[last].at(end.0)];
            let points = points.map(|point| self.origin.outside(point));
            let rounding = points.map(|[x, y]| f64::EPSILON * (x.abs() + y.abs()));
            let error = Some([start.1 + rounding[0], end.1 + rounding[1]]);
            let whole: f64 = lawful.iter().map(|&side| sides[side].length()).sum();
            let length = whole - start.0 - (sides[last].length() - end.0);
            let length = if *closed { whole } else { length };
            let arc = ContactArc::new(points, self.height * force, length);
            arcs.push(ContactArc { closed: *closed, part, error, ..arc });
        }
        arcs
    }

    /// v at points of the domain.
    pub(crate) fn values(&self, points: &[[f64; 2]]) -> Vec<f64> {
        let points: Vec<_> = points.iter().map(|point| self.origin.seen(*point)).collect();
        let values = self.solution.values(&points);
        values.into_iter().map(|v| self.height * v).collect()
    }

    /// v and its gradient at a point of the closed domain; in a corner, where the gradient may be infinite, that a
    /// little beside it; none outside of the domain.
    pub(crate) fn at(&self, point: &[f64]) -> Option<(f64, [f64; 2])> {
        let &[x, y] = point else { return None };
        let (domain, size) = (&self.problem.domain, libm::hypot(x, y));
        let [x, y] = self.origin.seen([x, y]);
        let z = Complex::new(x, y);
        // Coordinates of points of the boundary are rounded.
        let (value, seen) = match domain.distance(z) {
            away if away <= 8.0 * f64::EPSILON * (domain.diameter() + size) => {
                let (ring, place) = domain.nearest(z);
                let beside = self.beside_corners(ring, place, BESIDE[1]);
                (self.seen_on_boundary([x, y])[0], domain.loops()[ring][beside.side].at(beside.s))
            }
            _ if domain.holds(z) => (self.height * self.solution.value([x, y]), [x, y]),
            _ => return None,
        };
        Some((value, self.solution.gradient(seen).map(|slope| self.height * slope)))
    }

    /// Place no nearer to the ends of its side than this part of it.
    fn beside_corners(
        &self,
        ring: usize,
        SidePlace { side, s }: SidePlace,
        part: f64,
    ) -> SidePlace {
        let length = self.problem.domain.loops()[ring][side].length();
        SidePlace { side, s: s.clamp(part * length, (1.0 - part) * length) }
    }

    /// v and dv/dn at the point of the boundary nearest to this one; dv/dn, which may be infinite in a corner, a little
    /// beside it.
    pub(crate) fn on_boundary(&self, point: [f64; 2]) -> [f64; 2] {
        self.seen_on_boundary(self.origin.seen(point))
    }

    /// That at a point in the coordinates of the problem.
    fn seen_on_boundary(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let (z, loops) = (Complex::new(x, y), self.problem.domain.loops());
        let (ring, place) = self.problem.domain.nearest(z);
        let SidePlace { side, s } = place;
        let [of_value, of_flux] = BESIDE
            .map(|part| self.solution.on_boundary(ring, self.beside_corners(ring, place, part)));
        let ([value, _], [_, flux]) = (of_value, of_flux);
        // On one of both sides of each condition the number is known without error.
        let law = self.problem.law;
        let [value, flux] = match loops[ring][side].condition {
            Condition::Fixed => [0.0, flux],
            Condition::Free => [value, 0.0],
            Condition::Contact if self.sticks(ring, side, s) => [0.0, law.project(flux)],
            Condition::Contact if value < 0.0 && law.hi().is_finite() => [value, law.hi()],
            Condition::Contact if law.lo().is_finite() => [value, law.lo()],
            Condition::Contact => [value, law.hi()],
        };
        [self.height * value, self.height * flux]
    }

    /// True if an arc that sticks holds the point at a distance from the start of a side.
    fn sticks(&self, ring: usize, side: usize, s: f64) -> bool {
        let sides = &self.problem.domain.loops()[ring];
        let start_of = |side: usize| sides[..side].iter().map(PlaneSide::length).sum::<f64>();
        let (turn, t) = (start_of(sides.len()), start_of(side) + s);
        let mut arcs = self.solution.arcs.iter().filter(|arc| arc.ring == ring);
        arcs.any(|arc| {
            let [from, to] = arc.ends.map(|end| start_of(end.side) + end.s);
            arc.closed || (t - from).rem_euclid(turn) <= (to - from).rem_euclid(turn)
        })
    }
}

/// Returns the problem on the domain of a mesh, in a unit of f and seen from a place.
///
/// # Errors
/// [`PlaneError`] if the boundary is neither straight nor on circles, or f is of a kind that is not served.
fn problem(
    mesh: &PlaneMesh,
    f: &[Source],
    law: Law,
    (height, origin): (f64, Origin),
) -> Result<PlaneProblem, PlaneError> {
    let seen = origin.mesh(mesh);
    let circles: Vec<_> = seen.parts().iter().map(|part| part.curve).collect();
    let mut loops = Vec::new();
    for curve in boundary_curves(&seen) {
        loops.push(outline(&curve, &circles)?);
    }
    let domain = PlaneDomain::new(loops)?;
    f.iter().try_for_each(|f| origin.check(f, domain.diameter()))?;
    let source = source(&seen, f, &domain, (height, origin))?;
    let [lo, hi] = [law.lo(), law.hi()].map(|flux| flux / height);
    Ok(PlaneProblem { domain, law: Law::new(lo, hi).unwrap_or(law), source })
}

/// Returns constant pieces in a unit of f, seen from a place.
fn in_unit(f: &Source, (height, origin): (f64, Origin)) -> Source {
    let Source::Pieces { background, pieces } = origin.pieces(f) else { return f.clone() };
    let pieces = pieces.into_iter().map(|(shape, value)| (shape, value / height));
    Source::Pieces { background: background / height, pieces: pieces.collect() }
}

/// Returns f, on a mesh that is seen from a place, as the solver takes it.
fn source(
    mesh: &PlaneMesh,
    f: &[Source],
    domain: &PlaneDomain,
    unit: (f64, Origin),
) -> Result<PlaneSource, PlaneError> {
    let (height, _) = unit;
    let mut in_use = mesh.regions().to_vec();
    in_use.sort_unstable();
    in_use.dedup();
    let first = &f[usize::from(in_use[0])];
    if in_use.iter().all(|&region| f[usize::from(region)] == *first) {
        if !first.is_smooth() {
            return Ok(PlaneSource::Pieces(in_unit(first, unit)));
        }
        return match first {
            Source::Formula(formula) => {
                let f = Polynomial::of_formula(formula, unit, domain)?;
                Ok(PlaneSource::Polynomial(f))
            }
            Source::Exact(Known::Square(Exact::Torsion)) => {
                Ok(PlaneSource::Pieces(Source::constant(first.at([0.0; 2]) / height)))
            }
            _ => Err(PlaneError::Source("f is no polynomial in x and y".into())),
        };
    }
    if in_use.iter().any(|&region| f[usize::from(region)].is_smooth()) {
        let text = "f has a formula on one region beside another f on the next".into();
        return Err(PlaneError::Source(text));
    }
    let pieces: Vec<Source> = f.iter().map(|f| in_unit(f, unit)).collect();
    Ok(PlaneSource::Regions(regions(mesh, pieces)?))
}

#[cfg(test)]
mod bends;
