//! The paper's method on adapted meshes.
//!
//! The nodal derivatives (8) of M shrink with the patches of the nodes. Criterion (13) with a fixed number is therefore
//! met the earlier the smaller the patches are, whatever the error is. Over the measures of their own patches the
//! derivatives are residuals of the differential equation, whose greatest value is governed by the smallest patches.
//! In the slow modes of Gauss-Seidel sweeps the derivatives are about of one size at all nodes, and the square of the
//! distance from the solution is N times the sum of their squares, up to a factor, where N is the number of nodes:
//! divided by the mean measure of a patch, they measure the distance on all meshes alike.

use super::{AdaptedPlan, BoundedRun, Way};
use crate::bounds::Bounds;
use crate::discrete::end::End;
use crate::discrete::nested::NestedNetwork;
use crate::discrete::network::Network;
use crate::discrete::stop::Stop;
use crate::experiments::domains::{Nested, nested};
use crate::multigrid::MultigridParams;
use crate::multilevel::solve_nested_networks;
use crate::problem::law::Law;
use crate::saddle::batch::{LANES, LaneEngine};
use crate::saddle::{Goals, Method, Pair, Plain, RunStart, RunState, lanes, run, run_nested};
use serde::Serialize;
use std::convert::Infallible;

/// Iterations of the paper's method on a mesh, from the interpolated pair of the mesh before under the same rule; and
/// at the stop the distance from the discrete solution in the energy norm over the guaranteed error.
#[derive(Serialize)]
pub(super) struct CountsOnMesh {
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
pub(super) fn method(
    way: Way,
    run: &BoundedRun,
    plan: &AdaptedPlan,
) -> Result<Vec<CountsOnMesh>, String> {
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
        let mut engine = lanes(network);
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
