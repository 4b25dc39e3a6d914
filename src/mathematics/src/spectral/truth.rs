//! Answer of the spectral solver, whatever the domain.

use super::plane::{PlaneChecks, PlaneTruth, check_on_mesh, solve_on_mesh};
use super::{Checks, QUICK, STARTS, Solution, SpectralError, SpectralParams, solved_from};
use crate::discrete::contact::ContactArc;
use crate::mesh::PlaneMesh;
use crate::problem::law::Law;
use crate::problem::source::Source;
use serde::Serialize;
use std::fmt;

/// True solution.
pub struct TrueSolution {
    /// J(v).
    pub energy: f64,
    /// Guaranteed bounds of the energy, or the step of their proof that does not apply; none of the closed form of the
    /// square, where two resolutions and identities stand for them.
    pub bracket: Option<Result<[f64; 2], &'static str>>,
    /// Arcs in contact, each with the domain on the left.
    pub contact: Vec<ContactArc>,
    /// Integral of dv/dn over the boundary where the law holds.
    pub force: f64,
    /// Integral of f over the domain.
    pub integral: f64,
    /// Number of real unknowns of the sum of functions; none of the closed form of the square.
    pub unknowns: Option<usize>,
    /// Number of Newton steps; on the square of those at the usual resolution.
    pub steps: usize,
    /// Checks.
    pub checks: TrueChecks,
    /// Remarks on f, on bounds that are wide, and on the method, if another one found nothing.
    pub notes: Vec<String>,
    form: TrueForm,
}

/// Solution in the form of its method.
enum TrueForm {
    /// Conformal map and Riemann-Hilbert problem, at the finer of two resolutions.
    Square(Box<Solution>),
    /// Powers at corners and ends, on each connected component.
    Plane(Vec<PlaneTruth>),
}

/// Checks of a true solution.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum TrueChecks {
    /// Of the closed form of the square.
    Square(Checks),
    /// Of a sum of functions.
    Plane(PlaneChecks),
}

impl fmt::Display for TrueChecks {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Square(checks) => checks.fmt(out),
            Self::Plane(checks) => checks.fmt(out),
        }
    }
}

/// Solves the problem on the square under a law at the usual resolution, and from there at the finer one, with twelve
/// digits of the energy or more.
///
/// # Errors
/// As [`spectral_under`](super::spectral_under), or if the finer solution fails a check.
pub fn true_solution(law: Law, f: &Source) -> Result<TrueSolution, SpectralError> {
    let starts = if law.is_bounded() { QUICK } else { &STARTS };
    let usual = solved_from(starts, law, f, SpectralParams::default())?;
    let solution = usual.at_resolution(SpectralParams::FINER)?;
    Ok(TrueSolution {
        energy: solution.energy,
        bracket: None,
        contact: solution.contact.clone(),
        force: solution.force(),
        integral: solution.integral,
        unknowns: None,
        steps: usual.steps,
        checks: TrueChecks::Square(solution.checks),
        notes: Vec::new(),
        form: TrueForm::Square(solution.into()),
    })
}

/// Solves the problem on the domain of a mesh in the plane, whose boundary is straight or lies on the circles of its
/// parts.
///
/// # Errors
/// [`SpectralError::Plane`].
pub(crate) fn true_solution_on(
    mesh: &PlaneMesh,
    f: &[Source],
    law: Law,
) -> Result<TrueSolution, SpectralError> {
    let mut truths = Vec::new();
    for component in mesh.split() {
        truths.push(solve_on_mesh(&component, f, law)?);
    }
    let bracket = truths.iter().try_fold([0.0; 2], |[low, high], truth| {
        truth.bracket().map(|[lower, upper]| [low + lower, high + upper])
    });
    let mut notes: Vec<String> = truths.iter().flat_map(PlaneTruth::notes).collect();
    notes.dedup();
    let checks = truths.iter().map(PlaneTruth::checks).reduce(PlaneChecks::worst);
    Ok(TrueSolution {
        energy: truths.iter().map(PlaneTruth::energy).sum(),
        bracket: Some(bracket),
        contact: truths.iter().flat_map(|truth| truth.contact(mesh)).collect(),
        force: truths.iter().map(PlaneTruth::force).sum(),
        integral: truths.iter().map(PlaneTruth::integral).sum(),
        unknowns: Some(truths.iter().map(PlaneTruth::unknowns).sum()),
        steps: truths.iter().map(PlaneTruth::steps).sum(),
        checks: TrueChecks::Plane(checks.expect("a mesh has a component")),
        notes,
        form: TrueForm::Plane(truths),
    })
}

/// Checks that [`true_solution_on`] takes the domain of a mesh, and f.
///
/// # Errors
/// [`SpectralError::Plane`].
pub(crate) fn check_plane(mesh: &PlaneMesh, f: &[Source], law: Law) -> Result<(), SpectralError> {
    mesh.split().iter().try_for_each(|component| Ok(check_on_mesh(component, f, law)?))
}

/// Solution on the component that holds a point, or is nearest to it.
fn nearest(truths: &[PlaneTruth], point: [f64; 2]) -> &PlaneTruth {
    let one = truths.iter().min_by(|a, b| a.distance(point).total_cmp(&b.distance(point)));
    one.expect("a mesh has a component")
}

impl TrueSolution {
    /// Solution on the square in its closed form; none on another domain.
    pub fn on_square(&self) -> Option<&Solution> {
        match &self.form {
            TrueForm::Square(solution) => Some(solution),
            TrueForm::Plane(_) => None,
        }
    }

    /// Cuts of the functions whose sum the solution is, outward from points of the boundary and behind it, the longest
    /// first of each point; none on the square in its closed form.
    pub(crate) fn cuts(&self) -> Vec<[[f64; 2]; 2]> {
        match &self.form {
            TrueForm::Square(_) => Vec::new(),
            TrueForm::Plane(truths) => truths.iter().flat_map(PlaneTruth::cuts).collect(),
        }
    }

    /// Numbers of unknowns, and energies, of levels from coarse to fine; none on the square in its closed form, and on
    /// several components.
    pub(crate) fn by_level(&self) -> Vec<(usize, f64)> {
        match &self.form {
            TrueForm::Square(_) => Vec::new(),
            TrueForm::Plane(truths) => match &truths[..] {
                [truth] => truth.by_level(),
                _ => Vec::new(),
            },
        }
    }

    /// v at points of the domain and its boundary.
    pub fn values(&self, points: &[[f64; 2]]) -> Vec<f64> {
        match &self.form {
            TrueForm::Square(solution) => {
                points.iter().map(|&[x, y]| solution.value(x, y)).collect()
            }
            TrueForm::Plane(truths) => match &truths[..] {
                [truth] => truth.values(points),
                _ => points.iter().map(|&z| nearest(truths, z).values(&[z])[0]).collect(),
            },
        }
    }

    /// v and its gradient at a point; none outside of the domain.
    pub fn at(&self, point: &[f64]) -> Option<(f64, [f64; 2])> {
        match &self.form {
            TrueForm::Square(solution) => solution.at(point),
            TrueForm::Plane(truths) => truths.iter().find_map(|truth| truth.at(point)),
        }
    }

    /// v and dv/dn at the point of the boundary nearest to this one; dv/dn in a corner is that on one of its sides.
    pub fn on_boundary(&self, point: [f64; 2]) -> [f64; 2] {
        match &self.form {
            TrueForm::Square(solution) => solution.on_boundary(point),
            TrueForm::Plane(truths) => nearest(truths, point).on_boundary(point),
        }
    }
}
