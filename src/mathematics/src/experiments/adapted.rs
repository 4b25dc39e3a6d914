//! Meshes that are refined where the guaranteed error is large, beside uniform ones: the error against the number of
//! nodes, and what the paper's method costs on them.

mod method;
mod problem;

pub use problem::coarse_meshes;
pub(super) use problem::{AdaptedProblem, BoundedRun};

use super::{Findings, Rows, exponent};
use crate::machine::threads::try_map;
use method::{CountsOnMesh, method};
use serde::{Deserialize, Serialize};

/// Input of the experiment.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct AdaptedPlan {
    /// Problems; the paper's method runs on the first.
    problems: Vec<AdaptedProblem>,
    /// Guaranteed error, over the norm of the solution, at which adaptive refinement ends.
    accuracy: f64,
    /// Number of uniform refinements of a first mesh whose sides are halved once; a finer one is refined less often.
    refinements: usize,
    /// Most nodes of an adapted mesh.
    finest: usize,
    /// Number of nodes from which on orders are fitted.
    fitted: usize,
    /// Most nodes of a mesh on which the paper's method runs.
    most_nodes: usize,
    /// Duality parameter of the paper's method.
    r: f64,
    /// Bound in criterion (13) as printed.
    printed: f64,
    /// Derivatives over the measures of patches, their own or the mean, are compared with so many times the product of
    /// the largest |f| and the guaranteed error of the mesh over the norm of the solution.
    divided: f64,
    /// Limit on iterations of the paper's method on a mesh.
    limit: usize,
}

impl Default for AdaptedPlan {
    fn default() -> Self {
        Self {
            problems: AdaptedProblem::ALL.into(),
            accuracy: 0.015,
            refinements: 6,
            finest: 100_000,
            fitted: 800,
            most_nodes: 6000,
            r: 10.0,
            printed: 1e-4,
            divided: 0.1,
            limit: 4000,
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

/// Measures errors and counts: the central function of this module. Tables `errors` on all meshes, `finest` of the last
/// ones, and `counts` of the paper's method.
///
/// # Errors
/// A sentence if a problem cannot be solved.
pub(super) fn adapted(plan: &AdaptedPlan) -> Result<Findings, String> {
    let mut refined = Vec::new();
    for (number, &problem) in plan.problems.iter().enumerate() {
        refined.extend(Way::ALL.map(|way| RefinementWay { problem, way, has_method: number == 0 }));
    }
    let measured = try_map(&refined, |refined| refined.measured(plan))?;
    let (mut errors, mut counts, mut finest) = (Vec::new(), Vec::new(), Vec::new());
    for ways in measured.chunks(Way::ALL.len()) {
        finest.extend(finest_errors(ways, plan).ok_or("too few meshes for an order")?);
    }
    for way in measured {
        errors.extend(way.errors);
        counts.extend(way.counts);
    }
    Ok(Findings::from([
        ("errors".into(), Rows::of(errors)),
        ("finest".into(), Rows::of(finest)),
        ("counts".into(), Rows::of(counts)),
    ]))
}

/// Errors on the finest meshes of a problem, adaptive and uniform; none with fewer than two fine meshes.
fn finest_errors(ways: &[MeasuredWay], plan: &AdaptedPlan) -> Option<[FinestError; 2]> {
    let [adaptive, uniform] = ways else { return None };
    let [adaptive, uniform] = [adaptive, uniform].map(|way| {
        let fine = way.errors.iter().filter(|mesh| mesh.nodes >= plan.fitted);
        let points: Vec<_> = fine.map(|mesh| (mesh.nodes as f64, mesh.error)).collect();
        way.errors.last().cloned().zip(exponent(&points).map(|p| -p))
    });
    let (goal, last) = (adaptive?, uniform?);
    let uniform_nodes = last.0.nodes as f64 * libm::pow(last.0.error / goal.0.error, 1.0 / last.1);
    Some([goal, last].map(|(on_mesh, order)| FinestError { on_mesh, order, uniform_nodes }))
}

/// A problem on meshes of one way of refinement.
struct RefinementWay {
    problem: AdaptedProblem,
    way: Way,
    /// True if the paper's method runs on the meshes.
    has_method: bool,
}

/// Measurements on meshes of one way of refinement, which are not kept.
struct MeasuredWay {
    errors: Vec<ErrorOnMesh>,
    counts: Vec<CountsOnMesh>,
}

impl RefinementWay {
    fn measured(&self, plan: &AdaptedPlan) -> Result<MeasuredWay, String> {
        let run = match self.way {
            Way::Adaptive => self.problem.adapted(plan.accuracy, plan.finest, 1),
            Way::Uniform => self.problem.uniform(plan.refinements + 1 - self.problem.halvings()),
        }?;
        let counts = if self.has_method { method(self.way, &run, plan)? } else { Vec::new() };
        Ok(MeasuredWay { errors: self.errors(&run), counts })
    }

    /// Errors on the meshes of a run.
    fn errors(&self, run: &BoundedRun) -> Vec<ErrorOnMesh> {
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
        errors
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A plan that takes little time.
    fn small() -> AdaptedPlan {
        AdaptedPlan {
            accuracy: 0.03,
            refinements: 4,
            fitted: 100,
            most_nodes: 900,
            ..AdaptedPlan::default()
        }
    }

    #[test]
    fn adaptive_errors_fall_faster_and_brackets_hold_the_true_energies() {
        let found = adapted(&small()).unwrap();
        for (way, orders) in [("adaptive", 0.45..1.0), ("uniform", 0.0..0.42)] {
            let finest = found["finest"].wherever("way", way).unwrap().numbers("order").unwrap();
            assert!(finest.iter().all(|order| orders.contains(order)), "{way} {finest:?}");
            let counts = found["counts"].wherever("way", way).unwrap();
            let mut fine = counts.points("nodes", "tenth").unwrap();
            fine.retain(|point| point.0 > 100.0);
            assert!(exponent(&fine).unwrap() > 0.7, "{way} {fine:?}");
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

    #[test]
    fn a_fixed_number_stops_the_paper_s_method_early_on_fine_meshes_and_a_rule_that_scales_does_not()
     {
        let counts = &adapted(&small()).unwrap()["counts"];
        for way in ["adaptive", "uniform"] {
            let of_way = counts.wherever("way", way).unwrap();
            let [tenth, printed, distance] = ["tenth", "printed", "printed_distance"]
                .map(|name| *of_way.numbers(name).unwrap().last().unwrap());
            assert!(printed < tenth && distance > 0.03, "{way} {printed} {tenth} {distance}");
        }
        for mesh in counts.iter().filter(|mesh| mesh["nodes"].as_u64() > Some(100)) {
            let distance = mesh["mean_distance"].as_f64().unwrap();
            assert!(mesh["mean_is_met"] == true && (0.03..0.12).contains(&distance), "{mesh:?}");
        }
    }
}
