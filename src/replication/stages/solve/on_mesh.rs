//! The `solve` stage on a domain other than the square: one r and one rule on the nested meshes.

use super::{Cell, Outcomes, id, pair_of};
use crate::pipeline::error::Failure;
use crate::pipeline::{Artifacts, Inputs, Task, parameters};
use crate::replication::domain::{RefinedProblem, SceneDomain};
use crate::replication::scene::Scene;
use serde::Serialize;
use signorini_mathematics::saddle::{Pair, Params, StopRule, solve_nested};

/// Parameters that determine the artifacts of a solve.
#[derive(Clone, Debug, Serialize)]
struct MeshCell {
    domain: SceneDomain,
    r: f64,
    stop: StopRule,
    max_iterations: usize,
    /// True if the pair on the finest mesh is drawn.
    keep_pair: bool,
}

/// The task that solves one cell of a scene on this domain.
pub(super) fn task(id: String, domain: &SceneDomain, cell: &Cell) -> Task {
    let &Cell { r, stop, max_iterations, keep_pair, .. } = cell;
    let cell = MeshCell { domain: domain.clone(), r, stop, max_iterations, keep_pair };
    let task = Task::new(id, parameters(&cell), Vec::new(), move |inputs| solve(&cell, inputs));
    Task { files: domain.files.clone(), ..task }
}

fn solve(cell: &MeshCell, inputs: &Inputs) -> Result<Artifacts, Failure> {
    let RefinedProblem { problem, .. } = cell.domain.problem(inputs.files)?;
    let params = Params {
        r: cell.r,
        rule: cell.stop,
        max_iterations: cell.max_iterations,
        ..Params::default()
    };
    let loads = problem.loads().map_err(|e| e.to_string())?;
    let (levels, pair) =
        solve_nested(&problem.levels[..], problem.law.with_loads(&loads), &params, &mut ());
    let outcomes = Outcomes { schema: 1, r: cell.r, levels, errors: Vec::new() };
    outcomes.artifacts(cell.keep_pair.then_some(&pair))
}

/// Returns the pair of a scene on the finest mesh of `problem` where a rule stops, with the r that is drawn.
pub(in crate::replication::stages) fn pair(
    inputs: &Inputs,
    scene: &Scene,
    stop: StopRule,
    RefinedProblem { problem, .. }: &RefinedProblem,
) -> Result<Pair, String> {
    let network = problem.network();
    let lengths = [network.nodes(), network.contact().len()];
    pair_of(inputs, &id(scene, stop, scene.drawn_r()), lengths)
}
