//! Problems on the domains of meshes, solved from their finite element solutions.

use super::fit::Effort;
use super::frame::Origin;
use super::outline::outline;
use super::regions::regions;
use super::start::MeshSolution;
use super::{
    PlaneArc, PlaneBracket, PlaneChecks, PlaneDomain, PlaneError, PlaneProblem, PlaneSide,
    PlaneSolution, PlaneSource, Polynomial, SidePlace, solve,
};
use crate::discrete::contact::ContactArc;
use crate::mesh::{Condition, Names, PlaneMesh, boundary_curves, centroid};
use crate::problem::complex::Complex;
use crate::problem::law::Law;
use crate::problem::source::Source;

/// Nodes, at most, of the meshes whose solutions are starts in turn, on a domain with at most so many sides.
const STARTS: [f64; 2] = [6e3, 6e4];
const SIDES: f64 = 20.0;
/// Largest error of a polynomial in place of f, over the largest value of f.
const FITTED: f64 = 1e-10;
/// Error of a polynomial that is rounding alone, over the largest value of f.
const ROUNDING: f64 = 1e-13;

/// True solution on the domain of a mesh.
pub(crate) struct PlaneTruth {
    /// Unit of f, of dv/dn and of v.
    height: f64,
    /// Place from which domain and f are seen.
    origin: Origin,
    /// Domain, f and law, seen from there in this unit.
    problem: PlaneProblem,
    /// Its solution.
    solution: PlaneSolution,
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
    let height = height(mesh, f);
    let origin = Origin::of(mesh);
    let problem = problem(mesh, f, law, (height, origin))?;
    let mut error = PlaneError::NotFound("multigrid found no solution to begin with".into());
    let sides = problem.domain.sides().filter(|side| !side.is_after_bend).count() as f64;
    let mut effort = Effort::default();
    for nodes in STARTS {
        // Short sides want short edges.
        let most_nodes = nodes * (sides / SIDES).max(1.0).powi(2);
        let Some(solution) = MeshSolution::new(mesh, f, law, most_nodes) else { continue };
        match solve(&problem, &solution.start(&problem, origin), &mut effort) {
            Err(failed) => error = failed,
            Ok(solution) => return Ok(PlaneTruth { height, origin, problem, solution }),
        }
    }
    Err(error)
}

/// Checks that [`solve_on_mesh`] takes the domain of a mesh, and f.
///
/// # Errors
/// [`PlaneError`].
pub(crate) fn check_on_mesh(mesh: &PlaneMesh, f: &[Source], law: Law) -> Result<(), PlaneError> {
    problem(mesh, f, law, (height(mesh, f), Origin::of(mesh))).map(|_| ())
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

impl PlaneTruth {
    /// J(v).
    pub(crate) fn energy(&self) -> f64 {
        self.height * self.height * self.solution.energy
    }

    /// Bounds of the energy.
    pub(crate) fn bracket(&self) -> [f64; 2] {
        let PlaneBracket { lower, upper, .. } = self.solution.bracket;
        [lower, upper].map(|end| self.height * self.height * end)
    }

    /// True if the bounds rest on samples.
    pub(crate) fn is_sampled(&self) -> bool {
        !self.solution.bracket.reserve.is_empty()
    }

    /// Integral of dv/dn over the boundary where the law holds.
    pub(crate) fn force(&self) -> f64 {
        self.height * self.solution.force
    }

    /// Integral of f over the domain.
    pub(crate) fn integral(&self) -> f64 {
        self.height * self.solution.integral
    }

    /// Number of real unknowns.
    pub(crate) fn unknowns(&self) -> usize {
        self.solution.unknowns
    }

    /// Number of Newton steps.
    pub(crate) fn steps(&self) -> usize {
        self.solution.steps
    }

    /// Checks, all relative.
    pub(crate) fn checks(&self) -> PlaneChecks {
        self.solution.checks
    }

    /// Remark on f, if what took its place is not f but for rounding.
    pub(crate) fn note(&self) -> Option<String> {
        match &self.problem.source {
            PlaneSource::Polynomial(fitted) if fitted.error > ROUNDING => Some(format!(
                "f is a polynomial that differs from the formula by {:.1e} of it at most, where looked at",
                fitted.error
            )),
            _ => None,
        }
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
        for PlaneArc { ring, ends, closed, force, .. } in &self.solution.arcs {
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
            let start = if first == from.side { from.s } else { 0.0 };
            let end = if last == to.side { to.s } else { sides[last].length() };
            let names = lawful.iter().map(|&side| &mesh.parts()[sides[side].part].names);
            let part = Some(Names::all(names));
            let points = [sides[first].at(start), sides[last].at(end)];
            let points = points.map(|point| self.origin.outside(point));
            let arc = ContactArc::new(points, self.height * force);
            arcs.push(ContactArc { closed: *closed, part, ..arc });
        }
        arcs
    }

    /// Numbers of unknowns, and energies, of levels from coarse to fine.
    pub(crate) fn by_level(&self) -> Vec<(usize, f64)> {
        let square = self.height * self.height;
        let levels = self.solution.by_level().into_iter();
        levels.map(|(unknowns, energy)| (unknowns, square * energy)).collect()
    }

    /// Cuts of the functions, from and to.
    pub(crate) fn cuts(&self) -> Vec<[[f64; 2]; 2]> {
        let cuts = self.solution.cuts().into_iter();
        cuts.map(|cut| cut.map(|point| self.origin.outside(point))).collect()
    }

    /// v at points of the domain.
    pub(crate) fn values(&self, points: &[[f64; 2]]) -> Vec<f64> {
        let points: Vec<_> = points.iter().map(|point| self.origin.seen(*point)).collect();
        let values = self.solution.values(&points);
        values.into_iter().map(|v| self.height * v).collect()
    }

    /// v and its gradient at a point; none outside of the domain, or as near to its boundary as rounding errors.
    pub(crate) fn at(&self, point: &[f64]) -> Option<(f64, [f64; 2])> {
        let &[x, y] = point else { return None };
        let [x, y] = self.origin.seen([x, y]);
        let is_inside = self.problem.domain.contains([x, y]);
        is_inside.then(|| {
            let gradient = self.solution.gradient([x, y]).map(|slope| self.height * slope);
            (self.height * self.solution.value([x, y]), gradient)
        })
    }

    /// v and dv/dn at the point of the boundary nearest to this one; dv/dn, which may be infinite in a corner, a little
    /// beside it.
    pub(crate) fn on_boundary(&self, point: [f64; 2]) -> [f64; 2] {
        /// Distances from corners, over the length of the side, at which v and dv/dn are taken.
        const BESIDE: [f64; 2] = [1e-15, 1e-6];
        let [x, y] = self.origin.seen(point);
        let (z, loops) = (Complex::new(x, y), self.problem.domain.loops());
        let (ring, SidePlace { side, s }) = self.problem.domain.nearest(z);
        let length = loops[ring][side].length();
        let [of_value, of_flux] = BESIDE.map(|part| {
            let place = SidePlace { side, s: s.clamp(part * length, (1.0 - part) * length) };
            self.solution.on_boundary(ring, place)
        });
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
    let (height, origin) = unit;
    let mut in_use = mesh.regions().to_vec();
    in_use.sort_unstable();
    in_use.dedup();
    let first = &f[usize::from(in_use[0])];
    if in_use.iter().all(|&region| f[usize::from(region)] == *first) {
        if !first.is_smooth() {
            return Ok(PlaneSource::Pieces(in_unit(first, unit)));
        }
        let fitted = Polynomial::fitted(|point| first.at(origin.outside(point)) / height, domain);
        return match fitted.error {
            error if error <= FITTED => Ok(PlaneSource::Polynomial(fitted)),
            error => Err(PlaneError::Source(format!(
                "f is no polynomial, and the nearest is off by {error:.1e} of it"
            ))),
        };
    }
    if in_use.iter().any(|&region| f[usize::from(region)].is_smooth()) {
        let text = "f has a formula on one region beside another f on the next".into();
        return Err(PlaneError::Source(text));
    }
    let pieces: Vec<Source> = f.iter().map(|f| in_unit(f, unit)).collect();
    Ok(PlaneSource::Regions(regions(mesh, pieces)?))
}
