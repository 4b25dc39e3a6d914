//! Problems on the domains of meshes, solved from their finite element solutions.

use super::outline::outline;
use super::regions::regions;
use super::start::{nearest_side, start};
use super::{
    PlaneArc, PlaneDomain, PlaneError, PlaneProblem, PlaneSolution, PlaneSource, Polynomial,
    SidePlace, solve,
};
use crate::discrete::contact::ContactArc;
use crate::mesh::{Condition, MeshSource, Names, PlaneMesh, boundary_curves};
use crate::problem::complex::Complex;
use crate::problem::law::Law;
use crate::problem::source::Source;

/// Nodes, at most, of the meshes whose solutions are starts in turn.
const STARTS: [f64; 2] = [6e3, 6e4];
/// Largest error of a polynomial in place of f, over the largest value of f.
const FITTED: f64 = 1e-10;
/// Error of a polynomial that is rounding alone, over the largest value of f.
const ROUNDING: f64 = 1e-13;

/// True solution on the domain of a mesh.
pub(crate) struct PlaneTruth {
    /// Domain with f and law.
    problem: PlaneProblem,
    /// Solution.
    pub solution: PlaneSolution,
    /// Remark on f, if a polynomial took its place.
    pub note: Option<String>,
}

/// Solves the problem on the domain of a mesh, whose boundary is straight or lies on the circles of its parts.
///
/// # Errors
/// [`PlaneError`].
pub(crate) fn solve_on_mesh(
    mesh: &PlaneMesh,
    f: &MeshSource<2>,
    law: Law,
) -> Result<PlaneTruth, PlaneError> {
    let problem = PlaneProblem::on_mesh(mesh, f, law)?;
    let mut error = PlaneError::NotFound("multigrid found no solution to begin with".into());
    for most_nodes in STARTS {
        let Some(start) = start(&problem, mesh, f, most_nodes) else { continue };
        match solve(&problem, &start) {
            Err(failed) => error = failed,
            Ok(solution) => {
                let note = problem.source.note();
                return Ok(PlaneTruth { problem, solution, note });
            }
        }
    }
    Err(error)
}

impl PlaneTruth {
    /// Arcs in contact, with the names of the parts of a mesh.
    pub(crate) fn contact(&self, mesh: &PlaneMesh) -> Vec<ContactArc> {
        let mut arcs = Vec::new();
        for PlaneArc { ring, ends: [from, to], points, closed, force } in &self.solution.arcs {
            let sides = &self.problem.domain.loops()[*ring];
            let count = match closed {
                true => sides.len(),
                // An arc that begins and ends on one side either stays on it or goes all the way round.
                false if from.side == to.side && from.s > to.s => sides.len() + 1,
                false => (to.side + sides.len() - from.side) % sides.len() + 1,
            };
            let along = (from.side..from.side + count).map(|side| &sides[side % sides.len()]);
            let under_law = along.filter(|side| side.condition == Condition::Contact);
            let part = Names::all(under_law.map(|side| &mesh.parts()[side.part].names));
            let arc = ContactArc::new(*points, *force);
            arcs.push(ContactArc { closed: *closed, part: Some(part), ..arc });
        }
        arcs
    }

    /// v and dv/dn at the point of the boundary nearest to this one.
    pub(crate) fn on_boundary(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let z = Complex::new(x, y);
        let loops = self.problem.domain.loops().iter().map(|sides| nearest_side(sides, z));
        let nearest = loops.enumerate().min_by(|(_, one), (_, other)| one.1.total_cmp(&other.1));
        let (ring, (side, _)) = nearest.expect("a domain has a boundary");
        let s = self.problem.domain.loops()[ring][side].nearest(z);
        self.solution.on_boundary(ring, SidePlace { side, s })
    }
}

impl PlaneSource {
    /// Remark that a polynomial took the place of f, unless f is one but for rounding.
    fn note(&self) -> Option<String> {
        match self {
            Self::Polynomial(fitted) if fitted.error > ROUNDING => Some(format!(
                "f is a polynomial that differs from the formula by {:.1e} of it at most, where looked at",
                fitted.error
            )),
            _ => None,
        }
    }
}

impl PlaneProblem {
    /// Problem on the domain of a mesh.
    ///
    /// # Errors
    /// [`PlaneError::Domain`] if its boundary is neither straight nor on circles, or f is of a kind that is not served.
    pub(crate) fn on_mesh(
        mesh: &PlaneMesh,
        f: &MeshSource<2>,
        law: Law,
    ) -> Result<Self, PlaneError> {
        let circles: Vec<_> = mesh.parts().iter().map(|part| part.curve).collect();
        let mut loops = Vec::new();
        for curve in boundary_curves(mesh) {
            loops.push(outline(&curve, &circles)?);
        }
        let domain = PlaneDomain::new(loops)?;
        let source = source(mesh, f, &domain)?;
        Ok(Self { domain, law, source })
    }
}

/// Returns f as the solver takes it.
fn source(
    mesh: &PlaneMesh,
    f: &MeshSource<2>,
    domain: &PlaneDomain,
) -> Result<PlaneSource, PlaneError> {
    let mut in_use = mesh.regions().to_vec();
    in_use.sort_unstable();
    in_use.dedup();
    let first = f.on(in_use[0]);
    if in_use.iter().all(|&region| f.on(region) == first) {
        if !first.is_smooth() {
            return Ok(PlaneSource::Pieces(first.clone()));
        }
        let fitted = Polynomial::fitted(|point| first.at(point), domain);
        return match fitted.error {
            error if error <= FITTED => Ok(PlaneSource::Polynomial(fitted)),
            error => Err(PlaneError::Source(format!(
                "f is no polynomial, and the nearest is off by {error:.1e} of it"
            ))),
        };
    }
    let mut values = vec![0.0; mesh.region_names().len()];
    for region in in_use {
        match f.on(region) {
            Source::Pieces { background, pieces } if pieces.is_empty() => {
                values[usize::from(region)] = *background;
            }
            _ => {
                let text = "f has shapes or a formula beside a region with another value".into();
                return Err(PlaneError::Source(text));
            }
        }
    }
    Ok(PlaneSource::Regions(regions(mesh, &values)?))
}
