//! A problem on a domain in the plane, made of one on a mesh.

use crate::mesh::{PlaneMesh, boundary_curves};
use crate::problem::exact::{Exact, Known};
use crate::problem::formula::Formula;
use crate::problem::law::SAME;
use crate::problem::source::Source;
use crate::spectral::error::PlaneError;
use crate::spectral::geometry::domain::PlaneDomain;
use crate::spectral::geometry::frame::Frame;
use crate::spectral::geometry::outline::outline;
use crate::spectral::source::expansion::{Expansion, in_frame};
use crate::spectral::source::smooth::SmoothSource;
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
    /// different values, one has values by a formula whose kind is not served, or f is of a kind that is not served.
    pub(crate) fn on_mesh(mesh: &PlaneMesh, f: &[Source]) -> Result<Self, PlaneError> {
        if !mesh.is_laplacian() {
            return Err(PlaneError::Operator);
        }
        let frame = Frame::of(mesh, f);
        let seen = frame.mesh(mesh);
        let circles: Vec<_> = seen.parts().iter().map(|part| part.curve).collect();
        let mut loops = Vec::new();
        for curve in boundary_curves(&seen) {
            loops.push(outline(&curve, &circles, frame)?);
        }
        let parts = mesh.parts().iter().map(|part| part.names.clone()).collect();
        let mut domain = PlaneDomain { parts, ..PlaneDomain::seen(frame, loops)? };
        for part in 0..mesh.parts().len() {
            if let Some(formula) = mesh.value(part as u16) {
                if mesh.parts()[part].law.is_free() {
                    let part = &domain.parts[part];
                    return Err(PlaneError::Domain(format!(
                        "the flux through {part} has a formula, and the true solution takes numbers"
                    )));
                }
                set_value(&mut domain, part, formula)?;
            }
        }
        join_values(&mut domain);
        f.iter().try_for_each(|f| frame.check(f, domain.diameter()))?;
        let source = source(&seen, f, &domain)?;
        Ok(Self { domain, source })
    }
}

/// Makes a formula the value of the laws on a part.
///
/// # Errors
/// [`PlaneError::Domain`] if it is of a kind that is not served.
pub(crate) fn set_value(
    domain: &mut PlaneDomain,
    part: usize,
    formula: &Formula,
) -> Result<(), PlaneError> {
    let unit = domain.frame.of_value();
    let (value, error) = in_frame(formula, domain, unit).map_err(|what| {
        PlaneError::Domain(format!("the value of v on {} {what}", domain.parts[part]))
    })?;
    let radius = Expansion::on(domain).radius;
    let off = error + f64::EPSILON * value.units(radius) * value.size(radius);
    let number = domain.values.len();
    let sides = domain.rings.iter_mut().flat_map(|ring| &mut ring.sides);
    for side in sides.filter(|side| side.part == part) {
        side.law = side.law.scaled_at(0.0);
        (side.formula, side.off) = (Some(number), off);
    }
    domain.values.push(value);
    Ok(())
}

/// Takes values of sides that meet for one if they differ by rounding: by that they are off.
fn join_values(domain: &mut PlaneDomain) {
    for number in 0..domain.rings.len() {
        let many = domain.rings[number].sides.len();
        for k in 0..many {
            let ring = &domain.rings[number];
            let both = [ring.before(k), &ring.sides[k]];
            let values = both.map(|own| domain.value(own, ring.sides[k].point(0.0)).0);
            let (apart, largest) =
                ((values[0] - values[1]).abs(), values[0].abs().max(values[1].abs()));
            if apart > 0.0 && apart <= SAME * largest && !both.iter().any(|own| own.law.is_free()) {
                for k in [(k + many - 1) % many, k] {
                    domain.rings[number].sides[k].off += apart;
                }
            }
        }
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
            return Ok(PlaneSource::Smooth(SmoothSource::of_formula(formula, domain)?));
        }
        first @ Source::Exact(Known::Square(Exact::Torsion)) => {
            let constant = frame.pieces(&Source::constant(first.at([0.0; 2])));
            return Ok(PlaneSource::Pieces(Regions::all(constant)));
        }
        _ => "f is no sum of polynomials and waves",
    };
    Err(PlaneError::Source(text.into()))
}
