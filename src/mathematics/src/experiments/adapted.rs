//! Meshes that are refined where the guaranteed error is large, beside uniform ones: the error against the number of
//! nodes, and what the paper's method costs on them.
//!
//! The nodal derivatives (8) of M shrink with the patches of the nodes. Criterion (13) with a fixed number is therefore
//! met the earlier the smaller the patches are, whatever the error is. Over the measures of their own patches the
//! derivatives are residuals of the differential equation, whose greatest value is governed by the smallest patches.
//! In the slow modes of Gauss-Seidel sweeps the derivatives are about of one size at all nodes, and the square of the
//! distance from the solution is N times the sum of their squares, up to a factor, where N is the number of nodes:
//! divided by the mean measure of a patch, they measure the distance on all meshes alike.

use super::domains::{Nested, nested};
use super::{Findings, Rows, exponent};
use crate::bounds::{Accuracy, Bounds};
use crate::discrete::end::End;
use crate::discrete::nested::NestedNetwork;
use crate::discrete::network::Network;
use crate::discrete::stop::Stop;
use crate::levels::Problem;
use crate::machine::threads::map;
use crate::mesh::{
    AnyMesh, BuiltIn, Condition, Facet, MeshData, Names, Part, PlaneMesh, lattice_mesh,
};
use crate::multigrid::MultigridParams;
use crate::multilevel::solve_nested_networks;
use crate::problem::law::Law;
use crate::saddle::batch::{LANES, LaneEngine};
use crate::saddle::{
    Goals, Method, Pair, Plain, RunStart, RunState, SaddleDomain, run, run_nested,
};
use crate::solvers::{Adaption, Settings, Solver, solve};
use serde::{Deserialize, Serialize};
use std::convert::Infallible;

/// Input of the experiment.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct AdaptedPlan {
    /// Problems; the paper's method runs on the first.
    problems: Vec<AdaptedProblem>,
    /// Guaranteed error, over the norm of the solution, at which adaptive refinement ends.
    accuracy: f64,
    /// Number of uniform refinements.
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
            accuracy: 0.01,
            refinements: 7,
            finest: 100_000,
            fitted: 1000,
            most_nodes: 6000,
            r: 10.0,
            printed: 1e-4,
            divided: 0.1,
            limit: 4000,
        }
    }
}

/// Problem of the experiment.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum AdaptedProblem {
    /// The L-shape with a load in its inner corner's square, all of its boundary in contact.
    LShape,
    /// The unit square, whose lower side is fixed on its left half, free on its right half; the other sides are in
    /// contact.
    FixedFree,
}

impl AdaptedProblem {
    const ALL: [Self; 2] = [Self::LShape, Self::FixedFree];

    /// Name in pictures and tables.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::LShape => "L-shape",
            Self::FixedFree => "square, fixed and free",
        }
    }

    /// f, as text.
    fn f(self) -> &'static str {
        match self {
            Self::LShape => "rect(-9,0,-9,0)=3; else=-2",
            Self::FixedFree => "rect(-9,0,-9,0)=-4; else=2",
        }
    }

    /// First mesh.
    ///
    /// # Errors
    /// A sentence if it fails the checks of meshes.
    fn mesh(self) -> Result<PlaneMesh, String> {
        match self {
            Self::LShape => {
                BuiltIn::LShape.plane().ok_or_else(|| "the L-shape lies in the plane".into())
            }
            Self::FixedFree => {
                let square = lattice_mesh(&[-0.5, 0.0, 0.5]);
                let part =
                    |name, condition| Part { names: Names::from(name), condition, curve: None };
                MeshData {
                    points: square.points,
                    cells: square.cells,
                    facets: vec![
                        Facet { nodes: [0, 1], part: 0 },
                        Facet { nodes: [1, 2], part: 1 },
                    ],
                    parts: vec![part("fixed", Condition::Fixed), part("free", Condition::Free)],
                    ..MeshData::default()
                }
                .mesh()
                .map_err(|e| e.to_string())
            }
        }
    }

    /// Solves on adapted meshes until the guaranteed error, over the norm of the solution, is at most `accuracy`, or a
    /// mesh would have more than `most_nodes`; returns with the run the bounds on each mesh.
    ///
    /// # Errors
    /// A sentence if there is no solution, or no bound on a mesh.
    pub(super) fn adapted(
        self,
        accuracy: f64,
        most_nodes: usize,
        bisections: usize,
    ) -> Result<BoundedRun, String> {
        let mesh = self.mesh()?;
        let goal = Accuracy::Error(accuracy);
        let adaption = Adaption {
            coarsest: &mesh,
            f: self.f(),
            law: Law::SIGNORINI,
            goal,
            most_nodes,
            bisections,
        };
        let solved = adaption.run(&mut (), &|_| ()).map_err(|e| e.to_string())?;
        let bounds: Result<Vec<_>, _> = solved.bounds().iter().cloned().collect();
        let bounds = bounds.map_err(|e| e.to_string())?;
        let y = solved.pair().y;
        Ok(BoundedRun { problem: solved.problem, y, bounds })
    }

    /// Solves on the mesh after so many uniform refinements, with bounds on this mesh alone.
    ///
    /// # Errors
    /// A sentence if there is no solution, or no bound.
    pub(super) fn uniform_finest(self, refinements: usize) -> Result<BoundedRun, String> {
        let mesh = AnyMesh::from(self.mesh()?);
        let problem = Problem::on_mesh(&mesh, refinements, self.f(), Law::SIGNORINI)
            .map_err(|e| e.to_string())?;
        let run = solve(&problem, &Settings::of(Solver::Multigrid)).map_err(|e| e.to_string())?;
        let bounds = problem.bounds(&run.y).map_err(|e| e.to_string())?;
        Ok(BoundedRun { problem, y: run.y, bounds: vec![bounds] })
    }

    /// Solves on the first mesh and on its uniform refinements, with bounds on each.
    ///
    /// # Errors
    /// A sentence if there is no solution, or no bound on a mesh.
    fn uniform(self, refinements: usize) -> Result<BoundedRun, String> {
        let mut bounds = Vec::new();
        for times in 0..refinements {
            bounds.extend(self.uniform_finest(times)?.bounds);
        }
        let mut run = self.uniform_finest(refinements)?;
        bounds.append(&mut run.bounds);
        Ok(BoundedRun { bounds, ..run })
    }
}

/// Problem on nested meshes, with guaranteed bounds.
pub(super) struct BoundedRun {
    /// Problem.
    problem: Problem,
    /// Nodal vector on the finest mesh.
    pub(super) y: Vec<f64>,
    /// Bounds on each mesh, coarsest first, or on the finest alone.
    pub(super) bounds: Vec<Bounds>,
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

/// Iterations of the paper's method on a mesh, from the interpolated pair of the mesh before under the same rule; and
/// at the stop the distance from the discrete solution in the energy norm over the guaranteed error.
#[derive(Serialize)]
struct CountsOnMesh {
    way: Way,
    /// Number of nodes.
    nodes: usize,
    /// Guaranteed error over the norm of the solution.
    error: f64,
    /// Iterations until the distance is at most a tenth.
    tenth: usize,
    /// Iterations under criterion (13) as printed.
    printed: usize,
    /// Distance under this rule.
    printed_distance: f64,
    /// Iterations with derivatives over the measures of their own patches; none on the meshes after one on which the
    /// limit is reached.
    own: Option<usize>,
    /// True if this rule is met.
    own_is_met: Option<bool>,
    /// Distance under this rule.
    own_distance: Option<f64>,
    /// Iterations with derivatives over the mean measure of a patch.
    mean: usize,
    /// True if this rule is met.
    mean_is_met: bool,
    /// Distance under this rule.
    mean_distance: f64,
}

/// End of the paper's method on a mesh under a rule.
#[derive(Clone, Copy)]
struct CountAndDistance {
    /// Iterations, at most the limit.
    iterations: usize,
    /// True if the rule is met.
    is_met: bool,
    /// Distance from the discrete solution in the energy norm over the guaranteed error.
    distance: f64,
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
    let measured = map(&refined, 1, |refined| refined.measured(plan));
    let measured = measured.into_iter().collect::<Result<Vec<_>, _>>()?;
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

/// The last adapted mesh with at most so many nodes of each problem, with its name and number of nodes as a title.
///
/// # Errors
/// A sentence if a problem cannot be solved.
pub fn coarse_meshes(most_nodes: usize) -> Result<Vec<(String, AnyMesh)>, String> {
    let mut meshes = Vec::new();
    for problem in AdaptedProblem::ALL {
        // No mesh so coarse is so accurate: the number of nodes is what ends the run.
        let run = problem.adapted(f64::EPSILON, most_nodes, 1)?;
        let title = format!("{}, {} nodes", problem.name(), run.y.len());
        meshes.push((title, run.problem.levels().mesh()));
    }
    Ok(meshes)
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
            Way::Uniform => self.problem.uniform(plan.refinements),
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
                let nodes = run.problem.levels().nodes(level);
                errors.push(ErrorOnMesh { problem, f, way, nodes, error });
            }
        }
        errors
    }
}

/// Rule that ends the paper's method on a mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
enum MeshRule {
    /// Distance from the discrete solution.
    Tenth,
    /// Criterion (13) as printed.
    Printed,
    /// Derivatives over the measures of their own patches.
    Own,
    /// Derivatives over the mean measure of a patch.
    Mean,
}

impl MeshRule {
    const ALL: [Self; 4] = [Self::Tenth, Self::Printed, Self::Own, Self::Mean];
}

/// The paper's method on the nested meshes of a run, under each rule.
fn method(way: Way, run: &BoundedRun, plan: &AdaptedPlan) -> Result<Vec<CountsOnMesh>, String> {
    let Nested { networks, loads } = nested(&run.problem)?;
    let count = networks.iter().take_while(|level| level.network.nodes() <= plan.most_nodes);
    let networks = &networks[..count.count()];
    let mut solutions = Vec::new();
    for (k, load) in loads.iter().enumerate().take(networks.len()) {
        let law = Law::SIGNORINI.with_load(load);
        let (y, _) = solve_nested_networks(&networks[..=k], law, &MultigridParams::default())
            .map_err(|e| e.to_string())?;
        solutions.push(y);
    }
    let steps = Steps { run, networks, loads: &loads, solutions: &solutions, plan };
    let ends = steps.ends();
    let mut meshes = Vec::new();
    for (k, level) in networks.iter().enumerate() {
        let error = run.bounds[k].relative();
        if error.is_finite() {
            let end = ends.iter().map(|ends| ends.get(k).copied()).collect::<Vec<_>>();
            let [Some(tenth), Some(printed), own, Some(mean)] = end[..] else { break };
            meshes.push(CountsOnMesh {
                way,
                nodes: level.network.nodes(),
                error,
                tenth: tenth.iterations,
                printed: printed.iterations,
                printed_distance: printed.distance,
                own: own.map(|own| own.iterations),
                own_is_met: own.map(|own| own.is_met),
                own_distance: own.map(|own| own.distance),
                mean: mean.iterations,
                mean_is_met: mean.is_met,
                mean_distance: mean.distance,
            });
        }
    }
    Ok(meshes)
}

/// Largest mean of |f| over the patch of a node.
fn largest_f(network: &Network, load: &[f64]) -> f64 {
    load.iter().zip(network.masses()).map(|(f, mass)| (f / mass).abs()).fold(0.0, f64::max)
}

/// The paper's method on nested meshes.
struct Steps<'a> {
    run: &'a BoundedRun,
    networks: &'a [NestedNetwork],
    loads: &'a [Vec<f64>],
    /// Discrete solutions.
    solutions: &'a [Vec<f64>],
    plan: &'a AdaptedPlan,
}

impl Steps<'_> {
    /// Ends on each mesh under each of [`MeshRule::ALL`], as far as the limit on iterations is not reached.
    fn ends(&self) -> [Vec<CountAndDistance>; 4] {
        let networks = self.networks;
        let mut ends = [const { Vec::new() }; 4];
        let mut pairs = vec![Pair::zero(&networks[0].network); ends.len()];
        let on_mesh = |k: usize, pairs: &mut Vec<Pair>| {
            let (network, load) = (&networks[k].network, &self.loads[k][..]);
            let problem = Plain { network, law: Law::SIGNORINI, load, r: self.plan.r };
            let (solution, bounds) = (&self.solutions[k][..], &self.run.bounds[k]);
            // After the limit the pair says nothing of the rule: the run ends.
            let goes_on = ends
                .each_ref()
                .map(|ends: &Vec<CountAndDistance>| ends.last().is_none_or(|end| end.is_met));
            let on_mesh = OnMesh { problem, solution, bounds, plan: self.plan };
            let ended = on_mesh.iterate(goes_on, pairs);
            ends.iter_mut().zip(ended).for_each(|(ends, end)| ends.extend(end));
            Ok::<(), Infallible>(())
        };
        let Ok(()) = run_nested(networks, &mut pairs, on_mesh);
        ends
    }
}

/// The paper's method on a mesh.
struct OnMesh<'a> {
    problem: Plain<'a>,
    /// Discrete solution.
    solution: &'a [f64],
    /// Bounds of the discrete solution.
    bounds: &'a Bounds,
    plan: &'a AdaptedPlan,
}

impl OnMesh<'_> {
    /// Distance from the discrete solution in the energy norm over the guaranteed error.
    fn distance(&self, pair: &Pair) -> f64 {
        let difference: Vec<_> = pair.y.iter().zip(self.solution).map(|(y, v)| y - v).collect();
        let energy = self.problem.network.energy(&difference, &vec![0.0; difference.len()]);
        (2.0 * energy.max(0.0)).sqrt() / self.bounds.error[1]
    }

    /// Iterates from these pairs, side by side under those of [`MeshRule::ALL`] that go on, until the rule is met or to
    /// the limit.
    fn iterate(&self, goes_on: [bool; 4], pairs: &mut [Pair]) -> [Option<CountAndDistance>; 4] {
        let Plain { network, law, load, r } = self.problem;
        let mut engine = network.lanes();
        let mut runs = [None; LANES];
        for (lane, pair) in pairs.iter().enumerate().filter(|(lane, _)| goes_on[*lane]) {
            let start = RunStart { load, method: Method::ArrowHurwicz, r, pair };
            engine.enter(lane, law, &start);
            runs[lane] = Some(RunState::new(&start, self.plan.limit));
        }
        let (ends, asked_at) = ([None; 4], [1; 4]);
        let mut goals = GoalsOnMesh { on_mesh: self, asked_at, pairs, ends };
        run(&mut *engine, runs, &mut goals);
        goals.ends
    }

    /// True if a rule is met.
    fn is_met(&self, rule: MeshRule, pair: &Pair) -> bool {
        let Plain { network, load, .. } = self.problem;
        let masses = network.masses();
        let residual =
            self.plan.divided * largest_f(network, load) * self.bounds.relative().min(1.0);
        let mean = masses.iter().sum::<f64>() / masses.len() as f64;
        let mut nodes = 0..pair.y.len();
        let derivative = |node| self.problem.gradient(node, pair).abs();
        match rule {
            MeshRule::Tenth => self.distance(pair) <= 0.1,
            MeshRule::Printed => nodes.all(|node| derivative(node) <= self.plan.printed),
            MeshRule::Own => nodes.all(|node| derivative(node) <= residual * masses[node]),
            MeshRule::Mean => nodes.all(|node| derivative(node) <= residual * mean),
        }
    }
}

/// The rules on a mesh, one per lane.
struct GoalsOnMesh<'a> {
    on_mesh: &'a OnMesh<'a>,
    /// Iteration at which each rule is asked next.
    asked_at: [usize; 4],
    /// Last pairs.
    pairs: &'a mut [Pair],
    ends: [Option<CountAndDistance>; 4],
}

impl<'e> Goals<dyn LaneEngine + 'e, LANES> for GoalsOnMesh<'_> {
    fn reached(
        &mut self,
        engine: &mut (dyn LaneEngine + 'e),
        runs: [Option<&RunState>; LANES],
    ) -> [bool; LANES] {
        let mut reached = [false; LANES];
        for (lane, (&rule, asked_at)) in MeshRule::ALL.iter().zip(&mut self.asked_at).enumerate() {
            let Some(run) = runs[lane].filter(|run| run.iterations >= *asked_at) else { continue };
            // Two per cent more save time.
            *asked_at = run.iterations + 1 + run.iterations / 50;
            reached[lane] = self.on_mesh.is_met(rule, &engine.pair(lane));
        }
        reached
    }

    fn ended(
        &mut self,
        engine: &mut (dyn LaneEngine + 'e),
        lane: usize,
        end: End,
    ) -> Option<RunState> {
        let pair = engine.pair(lane).into_owned();
        let (iterations, is_met) = (end.iterations, end.stop == Stop::Converged);
        let distance = self.on_mesh.distance(&pair);
        self.ends[lane] = Some(CountAndDistance { iterations, is_met, distance });
        self.pairs[lane] = pair;
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A plan that takes little time.
    fn small() -> AdaptedPlan {
        AdaptedPlan {
            accuracy: 0.05,
            refinements: 4,
            fitted: 50,
            most_nodes: 900,
            ..AdaptedPlan::default()
        }
    }

    #[test]
    fn adaptive_errors_fall_faster_and_brackets_hold_the_true_energies() {
        let found = adapted(&small()).unwrap();
        let orders = |way| found["finest"].wherever("way", way).unwrap().numbers("order").unwrap();
        assert!(orders("adaptive").iter().all(|&order| order > 0.45), "{found:?}");
        assert!(orders("uniform").iter().all(|&order| order < 0.42), "{found:?}");
        for way in ["adaptive", "uniform"] {
            let counts = found["counts"].wherever("way", way).unwrap();
            let mut fine = counts.points("nodes", "tenth").unwrap();
            fine.retain(|point| point.0 > 100.0);
            assert!(exponent(&fine).unwrap() > 0.7, "{way} {fine:?}");
        }
        // Extrapolated energies, whose last digits may be off by two.
        for (problem, energy) in AdaptedProblem::ALL.into_iter().zip([-3.019_878, -0.452_388]) {
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
