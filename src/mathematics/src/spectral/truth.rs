//! True solution on all connected components of a domain.

use crate::discrete::contact::ContactArc;
use crate::mesh::PlaneMesh;
use crate::problem::law::Law;
use crate::problem::source::Source;
use crate::spectral::geometry::domain::PlaneError;
use crate::spectral::on_mesh::{PlaneTruth, check_on_mesh, solve_on_mesh, solve_on_square};
use crate::spectral::solution::PlaneChecks;
use crate::square::load::integral;

/// True solution.
pub struct TrueSolution {
    /// J(v).
    pub energy: f64,
    /// Guaranteed bounds of the energy, or the step of their proof that does not apply.
    pub bracket: Result<[f64; 2], &'static str>,
    /// Arcs in contact, each with the domain on the left.
    pub contact: Vec<ContactArc>,
    /// Integral of dv/dn over the boundary where the law holds.
    pub force: f64,
    /// Integral of f over the domain.
    pub integral: f64,
    /// Size of the integral of dv/dn over the whole boundary plus that of f, which is zero but for errors.
    pub unbalanced: f64,
    /// Number of real unknowns of the sum of functions.
    pub unknowns: usize,
    /// Number of Newton steps.
    pub steps: usize,
    /// Checks.
    pub checks: PlaneChecks,
    /// Remarks on f, and on bounds that are wide.
    pub notes: Vec<String>,
    /// Solution on each connected component.
    components: Vec<PlaneTruth>,
}

/// Solves the problem on the square.
///
/// # Errors
/// [`PlaneError`].
pub(crate) fn true_solution_on_square(f: &Source, law: Law) -> Result<TrueSolution, PlaneError> {
    let (mesh, truth) = solve_on_square(f, law)?;
    let mut found = TrueSolution::of(vec![truth], &mesh);
    found.integral = integral(f);
    // The boundary of the square has no parts.
    found.contact.iter_mut().for_each(|arc| arc.part = None);
    Ok(found)
}

/// Solves the problem on the domain of a mesh in the plane, whose boundary is straight or lies on the circles of its
/// parts.
///
/// # Errors
/// [`PlaneError`].
pub(crate) fn true_solution_on(
    mesh: &PlaneMesh,
    f: &[Source],
    law: Law,
) -> Result<TrueSolution, PlaneError> {
    let mut components = Vec::new();
    for component in mesh.split() {
        components.push(solve_on_mesh(&component, f, law)?);
    }
    Ok(TrueSolution::of(components, mesh))
}

/// Checks that [`true_solution_on`] takes the domain of a mesh, and f.
///
/// # Errors
/// [`PlaneError`].
pub(crate) fn check_plane(mesh: &PlaneMesh, f: &[Source], law: Law) -> Result<(), PlaneError> {
    mesh.split().iter().try_for_each(|component| check_on_mesh(component, f, law))
}

impl TrueSolution {
    /// Solution on a mesh from those on its connected components.
    fn of(components: Vec<PlaneTruth>, mesh: &PlaneMesh) -> Self {
        let solutions = || components.iter().map(|truth| &truth.solution);
        let bracket = solutions().try_fold([0.0; 2], |[low, high], own| {
            let [lower, upper] = own.bracket?.ends();
            Ok([low + lower, high + upper])
        });
        let mut notes: Vec<String> = components.iter().flat_map(PlaneTruth::notes).collect();
        notes.dedup();
        let checks = solutions().map(|own| own.checks).reduce(PlaneChecks::worst);
        Self {
            energy: solutions().map(|own| own.energy).sum(),
            bracket,
            contact: components.iter().flat_map(|truth| truth.contact(mesh)).collect(),
            force: solutions().map(|own| own.force).sum(),
            integral: solutions().map(|own| own.integral).sum(),
            unbalanced: solutions().map(|own| own.unbalanced).sum(),
            unknowns: solutions().map(|own| own.unknowns).sum(),
            steps: solutions().map(|own| own.steps).sum(),
            checks: checks.expect("a mesh has a component"),
            notes,
            components,
        }
    }

    /// Solution on the component that holds a point, or is nearest to it.
    fn nearest(&self, point: [f64; 2]) -> &PlaneTruth {
        let components = self.components.iter();
        let nearest = components.min_by(|a, b| a.distance(point).total_cmp(&b.distance(point)));
        nearest.expect("a mesh has a component")
    }

    /// v at points of the domain and its boundary.
    pub fn values(&self, points: &[[f64; 2]]) -> Vec<f64> {
        match &self.components[..] {
            [truth] => truth.values(points),
            _ => points.iter().map(|&z| self.nearest(z).values(&[z])[0]).collect(),
        }
    }

    /// v and its gradient at a point; none outside of the domain.
    pub fn at(&self, point: &[f64]) -> Option<(f64, [f64; 2])> {
        self.components.iter().find_map(|truth| truth.at(point))
    }

    /// v and dv/dn at the point of the boundary nearest to this one; dv/dn in a corner is that on one of its sides.
    pub fn on_boundary(&self, point: [f64; 2]) -> [f64; 2] {
        self.nearest(point).on_boundary(point)
    }
}
