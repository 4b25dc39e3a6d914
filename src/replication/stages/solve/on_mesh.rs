//! The `solve` stage on a domain other than the square: one r and one rule on the nested meshes.

use super::{Cell, OUTCOMES, Outcomes, PAIR, id, pair_bytes, pair_of};
use crate::pipeline::error::Failure;
use crate::pipeline::{Artifacts, Inputs, Task, parameters};
use crate::replication::domain::{RefinedProblem, SceneDomain};
use crate::replication::scene::Scene;
use crate::replication::stages::to_json;
use serde::Serialize;
use signorini_mathematics::discrete::stop::Stop;
use signorini_mathematics::saddle::{Pair, Params, Plain, StopRule, solve_networks};

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
    let law = problem.law;
    let (networks, loads) = (&problem.levels, problem.loads().map_err(|e| e.to_string())?);
    let params = Params {
        r: cell.r,
        rule: cell.stop,
        max_iterations: cell.max_iterations,
        ..Params::default()
    };
    let mut levels = Vec::new();
    let pair = solve_networks(networks, law.with_loads(&loads), &params, &mut |k, run, pair| {
        let network = &networks[k].network;
        let plain = Plain { network, law, load: &loads[k], r: cell.r };
        levels.push(run.outcome(&plain, pair));
    });
    if let Some(last) = levels.last().filter(|last| last.stop == Stop::Diverged) {
        return Err(format!(
            "diverged on the mesh of {} nodes after {} iterations at r = {}; choose a smaller r or scale f down",
            last.cells, last.iterations, cell.r
        )
        .into());
    }
    let outcomes = Outcomes { schema: 1, r: cell.r, levels, errors: Vec::new() };
    let mut artifacts = Artifacts::from([(OUTCOMES.to_owned(), to_json(&outcomes))]);
    if cell.keep_pair {
        artifacts.insert(PAIR.into(), pair_bytes(&pair));
    }
    Ok(artifacts)
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
