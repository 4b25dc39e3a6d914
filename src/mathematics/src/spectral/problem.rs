//! A problem on a domain in the plane, made of one on a mesh.

use crate::mesh::{PlaneMesh, boundary_curves};
use crate::problem::exact::{Exact, Known};
use crate::problem::law::Law;
use crate::problem::source::Source;
use crate::spectral::error::PlaneError;
use crate::spectral::geometry::domain::PlaneDomain;
use crate::spectral::geometry::frame::Frame;
use crate::spectral::geometry::outline::outline;
use crate::spectral::source::polynomial::Polynomial;
use crate::spectral::source::{PlaneSource, Regions, regions};
use std::collections::BTreeSet;

/// Problem on a domain of the plane, all in the coordinates of its frame.
#[derive(Clone, Debug)]
pub(crate) struct PlaneProblem {
    /// The domain.
    pub domain: PlaneDomain,
    /// The law on sides in contact.
    pub law: Law,
    /// f.
    pub source: PlaneSource,
}

impl PlaneProblem {
    /// The problem on the domain of a mesh.
    ///
    /// # Errors
    /// [`PlaneError`] if the boundary is neither straight nor on the circles of its parts, these have several laws, or
    /// f is of a kind that is not served.
    pub(in crate::spectral) fn on_mesh(mesh: &PlaneMesh, f: &[Source]) -> Result<Self, PlaneError> {
        let law = Law::only(&mesh.laws()).ok_or_else(|| {
            PlaneError::Domain("the true solution takes one law for all of a component".into())
        })?;
        let frame = Frame::of(mesh, f);
        let seen = frame.mesh(mesh);
        let circles: Vec<_> = seen.parts().iter().map(|part| part.curve).collect();
        let mut loops = Vec::new();
        for curve in boundary_curves(&seen) {
            loops.push(outline(&curve, &circles, frame)?);
        }
        let parts = mesh.parts().iter().map(|part| part.names.clone()).collect();
        let domain = PlaneDomain { parts, ..PlaneDomain::seen(frame, loops)? };
        f.iter().try_for_each(|f| frame.check(f, domain.diameter()))?;
        let source = source(&seen, f, &domain)?;
        Ok(Self { domain, law: frame.law(law), source })
    }
}

/// Returns f as the solver takes it, on a mesh in the coordinates of a domain.
fn source(mesh: &PlaneMesh, f: &[Source], domain: &PlaneDomain) -> Result<PlaneSource, PlaneError> {
    let frame = domain.frame;
    let in_use: BTreeSet<usize> = mesh.regions().iter().map(|&region| region.into()).collect();
    let used: Vec<&Source> = in_use.into_iter().map(|region| &f[region]).collect();
    if !used.iter().any(|f| f.is_smooth()) {
        let pieces = f.iter().map(|f| frame.pieces(f)).collect();
        return Ok(PlaneSource::Pieces(regions(mesh, pieces, frame)?));
    }
    let text = match used[0] {
        first if used.iter().any(|f| *f != first) => {
            "f has a formula on one region beside another f on the next"
        }
        Source::Formula(formula) => {
            return Ok(PlaneSource::Polynomial(Polynomial::of_formula(formula, domain)?));
        }
        first @ Source::Exact(Known::Square(Exact::Torsion)) => {
            let constant = frame.pieces(&Source::constant(first.at([0.0; 2])));
            return Ok(PlaneSource::Pieces(Regions::all(constant)));
        }
        _ => "f is no polynomial in x and y",
    };
    Err(PlaneError::Source(text.into()))
}
