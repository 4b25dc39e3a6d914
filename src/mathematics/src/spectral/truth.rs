//! True solution on all connected components of a domain.

use super::contact::start::DiscreteStart;
use super::fit::Effort;
use super::problem::PlaneProblem;
use super::solution::{PlaneChecks, PlaneSolution, solve};
use crate::discrete::contact::ContactArc;
use crate::mesh::{BuiltIn, PlaneMesh};
use crate::problem::law::Law;
use crate::problem::source::Source;
use crate::spectral::error::PlaneError;
use crate::spectral::geometry::domain::PlaneDomain;
use crate::square::load::integral;

/// Nodes, at most, of the meshes whose solutions are starts in turn, on a domain with at most so many sides.
const STARTS: [f64; 2] = [6e3, 6e4];
const SIDES: f64 = 20.0;
/// Cells per side of the grids whose solutions are starts in turn on the square.
const GRIDS: [usize; 2] = [64, 256];

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
    pub(super) components: Vec<PlaneSolution>,
}

/// Solves the problem on the square, whose boundary has no parts.
///
/// # Errors
/// [`PlaneError`].
pub(crate) fn true_solution_on_square(f: &Source, law: Law) -> Result<TrueSolution, PlaneError> {
    let mesh = BuiltIn::Square.plane().expect("the square lies in the plane").with_law(law);
    let problem = PlaneProblem::on_mesh(&mesh, std::slice::from_ref(f))?;
    let domain = PlaneDomain { parts: Vec::new(), ..problem.domain };
    let starts = GRIDS.into_iter().filter_map(|cells| DiscreteStart::on_square(cells, f, law));
    let found = solved(&PlaneProblem { domain, ..problem }, starts)?;
    Ok(TrueSolution { integral: integral(f), ..found })
}

/// Solves the problem on the domain of a mesh in the plane, whose boundary is straight or lies on the circles of its
/// parts.
///
/// # Errors
/// [`PlaneError`].
pub(crate) fn true_solution_on(mesh: &PlaneMesh, f: &[Source]) -> Result<TrueSolution, PlaneError> {
    let mut all: Option<TrueSolution> = None;
    for component in mesh.split() {
        let problem = PlaneProblem::on_mesh(&component, f)?;
        let sides = problem.domain.sides().filter(|side| !side.is_after_bend).count() as f64;
        // Short sides want short edges.
        let most_nodes = STARTS.map(|nodes| nodes * (sides / SIDES).max(1.0).powi(2));
        let starts =
            most_nodes.into_iter().filter_map(|most| DiscreteStart::on_mesh(&component, f, most));
        let own = solved(&problem, starts)?;
        all = Some(if let Some(before) = all { before.with(own) } else { own });
    }
    Ok(all.expect("a mesh has a component"))
}

/// Checks that [`true_solution_on`] takes the domain of a mesh, and f.
///
/// # Errors
/// [`PlaneError`].
pub(crate) fn check_plane(mesh: &PlaneMesh, f: &[Source]) -> Result<(), PlaneError> {
    mesh.split().iter().try_for_each(|component| PlaneProblem::on_mesh(component, f).map(|_| ()))
}

/// Solves a problem from the contact sets of discrete solutions in turn.
fn solved(
    problem: &PlaneProblem,
    starts: impl Iterator<Item = DiscreteStart>,
) -> Result<TrueSolution, PlaneError> {
    let mut error = PlaneError::NotFound("multigrid found no solution to begin with".into());
    let mut effort = Effort::default();
    for start in starts {
        match solve(problem, &start.seen(problem), &mut effort) {
            Err(failed) => error = failed,
            found => return found,
        }
    }
    Err(error)
}

impl TrueSolution {
    /// Solution on the components of this one and those of another.
    fn with(self, other: Self) -> Self {
        let both = self.bracket.and_then(|own| Ok((own, other.bracket?)));
        let mut notes = [self.notes, other.notes].concat();
        notes.dedup();
        Self {
            energy: self.energy + other.energy,
            bracket: both.map(|([low, high], [lower, upper])| [low + lower, high + upper]),
            contact: [self.contact, other.contact].concat(),
            force: self.force + other.force,
            integral: self.integral + other.integral,
            unbalanced: self.unbalanced + other.unbalanced,
            unknowns: self.unknowns + other.unknowns,
            steps: self.steps + other.steps,
            checks: self.checks.worst(other.checks),
            notes,
            components: self.components.into_iter().chain(other.components).collect(),
        }
    }

    /// Solution on the component that holds a point, or is nearest to it.
    fn nearest(&self, point: [f64; 2]) -> &PlaneSolution {
        let components = self.components.iter();
        let nearest = components.min_by(|a, b| a.distance(point).total_cmp(&b.distance(point)));
        nearest.expect("a mesh has a component")
    }

    /// v at points of the domain and its boundary.
    pub fn values(&self, points: &[[f64; 2]]) -> Vec<f64> {
        match &self.components[..] {
            [own] => own.values(points),
            _ => points.iter().map(|&z| self.nearest(z).values(&[z])[0]).collect(),
        }
    }

    /// v and its gradient at a point; none outside of the domain. In a corner, where the gradient may be infinite, that
    /// a little beside it.
    pub fn at(&self, point: &[f64]) -> Option<(f64, [f64; 2])> {
        let &[x, y] = point else { return None };
        self.components.iter().find_map(|own| own.at([x, y]))
    }

    /// v and dv/dn at the point of the boundary nearest to this one; dv/dn in a corner is that on one of its sides.
    pub fn on_boundary(&self, point: [f64; 2]) -> [f64; 2] {
        self.nearest(point).on_boundary(point)
    }
}
