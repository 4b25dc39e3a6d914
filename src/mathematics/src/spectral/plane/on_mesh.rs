//! Problems on the domains of meshes, solved from their finite element solutions.

use super::outline::outline;
use super::regions::regions;
use super::start::start;
use super::{PlaneDomain, PlaneError, PlaneProblem, PlaneSolution, PlaneSource, Polynomial, solve};
use crate::mesh::{MeshSource, PlaneMesh, boundary_curves};
use crate::problem::law::Law;
use crate::problem::source::Source;

/// Nodes, at most, of the meshes whose solutions are starts in turn.
const STARTS: [f64; 2] = [6e3, 6e4];
/// Largest error of a polynomial in place of f, over the largest value of f.
const FITTED: f64 = 1e-10;

/// Solves the problem on the domain of a mesh, whose boundary is straight or lies on the circles of its parts.
///
/// # Errors
/// [`PlaneError`].
pub(crate) fn solve_on_mesh(
    mesh: &PlaneMesh,
    f: &MeshSource<2>,
    law: Law,
) -> Result<PlaneSolution, PlaneError> {
    let problem = PlaneProblem::on_mesh(mesh, f, law)?;
    let mut error = PlaneError::NotFound("multigrid found no solution to begin with".into());
    for most_nodes in STARTS {
        let Some(start) = start(&problem, mesh, f, most_nodes) else { continue };
        match solve(&problem, &start) {
            Err(failed) => error = failed,
            solved => return solved,
        }
    }
    Err(error)
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
