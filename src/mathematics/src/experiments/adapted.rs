//! Meshes that are refined where the guaranteed error is large, beside uniform ones: the error against the number of
//! nodes.

mod problem;

pub use problem::coarse_meshes;
pub(super) use problem::{AdaptedProblem, BoundedRun};

use super::{Findings, Rows, exponent};
use crate::machine::threads::try_map;
use serde::{Deserialize, Serialize};

/// Input of the experiment.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct AdaptedPlan {
    /// Problems.
    problems: Vec<AdaptedProblem>,
    /// Guaranteed error, over the norm of the solution, at which adaptive refinement ends.
    accuracy: f64,
    /// Number of uniform refinements of a first mesh whose sides are halved once; a finer one is refined less often.
    refinements: usize,
    /// Most nodes of an adapted mesh.
    finest: usize,
    /// Number of nodes from which on orders are fitted.
    fitted: usize,
}

impl Default for AdaptedPlan {
    fn default() -> Self {
        Self {
            problems: AdaptedProblem::ALL.into(),
            accuracy: 0.015,
            refinements: 6,
            finest: 100_000,
            fitted: 800,
        }
    }
}

/// Way of refining meshes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Way {
    /// Bisection where the guaranteed error is large.
    Adaptive,
    /// Halving of all edges.
    Uniform,
}

impl Way {
    const ALL: [Self; 2] = [Self::Adaptive, Self::Uniform];

    /// Name in pictures.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Adaptive => "adaptive",
            Self::Uniform => "uniform",
        }
    }
}

/// Error on a mesh.
#[derive(Clone, Serialize)]
struct ErrorOnMesh {
    /// Name of the problem.
    problem: &'static str,
    /// f, as text.
    f: &'static str,
    way: Way,
    /// Number of nodes.
    nodes: usize,
    /// Guaranteed error over the norm of the solution.
    error: f64,
}

/// Error on the finest mesh of one way of refinement.
#[derive(Serialize)]
struct FinestError {
    #[serde(flatten)]
    on_mesh: ErrorOnMesh,
    /// Exponent p of the error `N^-p` that fits fine meshes best.
    order: f64,
    /// Nodes that uniform refinement needs to the last error of the adaptive one, by its order.
    uniform_nodes: f64,
}

/// Measures errors: the central function of this module. Tables `errors` on all meshes, and `finest` of the last ones.
///
/// # Errors
/// A sentence if a problem cannot be solved.
pub(super) fn adapted(plan: &AdaptedPlan) -> Result<Findings, String> {
    let mut refined = Vec::new();
    for &problem in &plan.problems {
        refined.extend(Way::ALL.map(|way| RefinementWay { problem, way }));
    }
    let errors = try_map(&refined, |refined| refined.errors(plan))?;
    let mut finest = Vec::new();
    for ways in errors.chunks(Way::ALL.len()) {
        finest.extend(finest_errors(ways, plan).ok_or("too few meshes for an order")?);
    }
    Ok(Findings::from([
        ("errors".into(), Rows::of(errors.concat())),
        ("finest".into(), Rows::of(finest)),
    ]))
}

/// Errors on the finest meshes of a problem, adaptive and uniform; none with fewer than two fine meshes.
fn finest_errors(ways: &[Vec<ErrorOnMesh>], plan: &AdaptedPlan) -> Option<[FinestError; 2]> {
    let [adaptive, uniform] = ways else { return None };
    let [adaptive, uniform] = [adaptive, uniform].map(|way| {
        let fine = way.iter().filter(|mesh| mesh.nodes >= plan.fitted);
        let points: Vec<_> = fine.map(|mesh| (mesh.nodes as f64, mesh.error)).collect();
        way.last().cloned().zip(exponent(&points).map(|p| -p))
    });
    let (goal, last) = (adaptive?, uniform?);
    let uniform_nodes = last.0.nodes as f64 * libm::pow(last.0.error / goal.0.error, 1.0 / last.1);
    Some([goal, last].map(|(on_mesh, order)| FinestError { on_mesh, order, uniform_nodes }))
}

/// A problem on meshes of one way of refinement.
struct RefinementWay {
    problem: AdaptedProblem,
    way: Way,
}

impl RefinementWay {
    /// Errors on its meshes.
    fn errors(&self, plan: &AdaptedPlan) -> Result<Vec<ErrorOnMesh>, String> {
        let run = match self.way {
            Way::Adaptive => self.problem.adapted(plan.accuracy, plan.finest, 1),
            Way::Uniform => self.problem.uniform(plan.refinements + 1 - self.problem.halvings()),
        }?;
        let mut errors = Vec::new();
        for (level, bounds) in run.bounds.iter().enumerate() {
            // Coarse meshes may have no bound below infinity.
            let error = bounds.relative();
            if error.is_finite() {
                let (problem, f, way) = (self.problem.name(), self.problem.f(), self.way);
                let nodes = run.problem.domain(level).nodes();
                errors.push(ErrorOnMesh { problem, f, way, nodes, error });
            }
        }
        Ok(errors)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn adaptive_errors_fall_faster_and_brackets_hold_the_true_energies() {
        let plan =
            AdaptedPlan { accuracy: 0.03, refinements: 4, fitted: 100, ..Default::default() };
        let found = adapted(&plan).unwrap();
        for (way, orders) in [("adaptive", 0.45..1.0), ("uniform", 0.0..0.42)] {
            let finest = found["finest"].wherever("way", way).unwrap().numbers("order").unwrap();
            assert!(finest.iter().all(|order| orders.contains(order)), "{way} {finest:?}");
        }
        // Extrapolated energies, whose last digits may be off by two.
        for (problem, energy) in
            AdaptedProblem::ALL.into_iter().zip([-3.019_878, -0.452_388, -0.452_388])
        {
            let run = problem.uniform(3).unwrap();
            assert_eq!(run.bounds.len(), 4);
            let mut brackets = run.bounds.iter().map(|bounds| bounds.energy);
            assert!(brackets.all(|[low, high]| low < energy && energy < high));
        }
    }
}
