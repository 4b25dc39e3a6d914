//! Counts of iterations of the paper's method on nested meshes.

use super::{DomainPlan, DomainsPlan, problem};
use crate::discrete::end::End;
use crate::levels::Problem;
use crate::saddle::jobs::{NestedJob, run_all_nested};
use crate::saddle::{NestedLevels, StopRule};
use serde::Serialize;
use std::borrow::Cow;

/// Iterations of the paper's method on a mesh of a domain; those of a limit are counted as such.
#[derive(Clone, Serialize)]
pub(super) struct MeshCount {
    /// Name of the domain.
    name: String,
    /// f, as text.
    f: String,
    /// Number of dimensions.
    dimension: u8,
    /// Duality parameter.
    r: f64,
    /// Number of the mesh among the nested ones, the coarsest the first.
    mesh: usize,
    /// Number of nodes.
    nodes: usize,
    /// Iterations under the signed rule, as in Tables 1 and 2.
    signed: usize,
    /// Iterations under the rule as printed.
    printed: usize,
    /// True if the former are fewer.
    is_earlier: bool,
    /// Last change of the multiplier under the signed rule, Delta a.
    delta_a: f64,
}

/// Counts iterations on one domain.
pub(super) fn counted(domain: &DomainPlan, plan: &DomainsPlan) -> Result<Vec<MeshCount>, String> {
    let made = problem(domain, domain.first + plan.levels - 1)?;
    let loads = made.loads().map_err(|e| e.to_string())?;
    let loads: Vec<_> = loads.into_iter().map(Cow::into_owned).collect();
    let networks = made.networks().ok_or("the experiment is for meshes")?;
    let (levels, loads) = (&networks[domain.first..], &loads[domain.first..]);
    let rules = [StopRule::Signed, StopRule::Printed];
    let runs = plan.r.iter().flat_map(|&r| rules.map(|rule| (r, rule)));
    let ends = ends(levels, &made, loads, runs, plan.max_iterations);
    let mut counts = Vec::new();
    for (&r, ends) in plan.r.iter().zip(ends.chunks(rules.len())) {
        for (k, (signed, printed)) in ends[0].iter().zip(&ends[1]).enumerate() {
            counts.push(MeshCount {
                name: domain.name.clone(),
                f: made.levels().facts().f.clone(),
                dimension: made.levels().facts().dimension,
                r,
                mesh: k + 1,
                nodes: levels[k].network.nodes(),
                signed: signed.iterations,
                printed: printed.iterations,
                is_earlier: signed.iterations < printed.iterations,
                delta_a: signed.change(),
            });
        }
    }
    Ok(counts)
}

/// Ends of the paper's method on all levels, side by side for each r and rule.
fn ends<L: NestedLevels + ?Sized>(
    levels: &L,
    problem: &Problem,
    loads: &[Vec<f64>],
    runs: impl Iterator<Item = (f64, StopRule)>,
    limit: usize,
) -> Vec<Vec<End>> {
    let law = problem.law();
    let runs: Vec<_> = runs.map(|(r, rule)| NestedJob { law, loads, r, rule }).collect();
    let ended = run_all_nested(levels, &runs, |_, _| limit);
    ended.iter().map(|levels| levels.iter().map(|(end, _)| *end).collect()).collect()
}
