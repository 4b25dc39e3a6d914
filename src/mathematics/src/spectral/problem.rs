//! A problem on a domain in the plane, made of one on a mesh.

use crate::mesh::{PlaneMesh, boundary_curves};
use crate::problem::exact::{Exact, Known};
use crate::problem::source::Source;
use crate::problem::text::Written;
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
    /// f.
    pub source: PlaneSource,
}

impl PlaneProblem {
    /// The problem on the domain of a mesh.
    ///
    /// # Errors
    /// [`PlaneError`] if the boundary is neither straight nor on the circles of its parts, two of these meet with
    /// different values, one has values by a formula, or f is of a kind that is not served.
    pub(crate) fn on_mesh(mesh: &PlaneMesh, f: &[Source]) -> Result<Self, PlaneError> {
        if let Some(facet) = mesh.facets().iter().find(|facet| mesh.value(facet.part).is_some()) {
            let part = &mesh.parts()[usize::from(facet.part)].names;
            return Err(PlaneError::Domain(format!(
                "the law on {part} has a formula, and the true solution takes numbers"
            )));
        }
        let frame = Frame::of(mesh, f);
        let seen = frame.mesh(mesh);
        let circles: Vec<_> = seen.parts().iter().map(|part| part.curve).collect();
        let mut loops = Vec::new();
        for curve in boundary_curves(&seen) {
            loops.push(outline(&curve, &circles, frame)?);
        }
        let parts = mesh.parts().iter().map(|part| part.names.clone()).collect();
        let domain = PlaneDomain { parts, ..PlaneDomain::seen(frame, loops)? };
        check_values(&domain)?;
        f.iter().try_for_each(|f| frame.check(f, domain.diameter()))?;
        let source = source(&seen, f, &domain)?;
        Ok(Self { domain, source })
    }
}

/// Checks that v has one value wherever two parts meet, or one of them is free there.
///
/// # Errors
/// [`PlaneError::Domain`].
fn check_values(domain: &PlaneDomain) -> Result<(), PlaneError> {
    for ring in &domain.rings {
        for (k, side) in ring.sides.iter().enumerate() {
            let both = [ring.before(k), side];
            let values = both.map(|own| own.law.at());
            if values[0] == values[1] || both.iter().any(|own| own.law.is_free()) {
                continue;
            }
            let [x, y] = domain.frame.outside(side.point(0.0));
            let [one, other] = both.map(|own| &domain.parts[own.part]);
            let [a, b] = values.map(|at| Written(domain.frame.of_value() * at));
            return Err(PlaneError::Domain(format!(
                "{one} and {other} meet at ({x}, {y}) with the values {a} and {b} of v; the true solution takes one, \
                 or a free part between them"
            )));
        }
    }
    Ok(())
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
