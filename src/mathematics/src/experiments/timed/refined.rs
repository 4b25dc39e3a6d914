//! Adaptive and uniform refinement to a guaranteed error, and the spectral solver beside them.

use super::{Prepared, TimedFacts, TimedRun};
use crate::experiments::adapted::{AdaptedProblem, BoundedRun, Way};
use crate::experiments::rows::row_of;
use crate::solvers::{Adaption, Solver};
use crate::spectral::TrueSolution;
use serde::Serialize;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Table `adapted`: meshes that are refined, from the coarsest mesh to the bounds.
#[derive(Serialize)]
struct RefinedRow {
    /// Name of the domain.
    problem: &'static str,
    /// Way of refinement, or the spectral solver.
    way: &'static str,
    /// Number of nodes of the finest mesh, or of unknowns of the spectral solver.
    nodes: usize,
    /// Guaranteed error over the norm of the solution.
    error: f64,
}

/// Guaranteed errors, over the norm of the solution, to which adaptive refinement goes.
const GOALS: [f64; 3] = [0.03, 0.01, 0.003];
/// Refinements of the coarsest uniform mesh.
const FIRST: usize = 5;

/// Runs on the L-shape, from the coarsest mesh to the bounds: adaptive refinement to each goal, uniform refinement as
/// long as it takes no longer than that, and the spectral solver; on meshes with at most the nodes of the grid with
/// this number of cells per side.
pub(super) fn runs(finest: usize) -> impl Iterator<Item = Prepared> {
    let most_nodes = (finest + 1) * (finest + 1);
    let missed = Arc::new(AtomicBool::new(false));
    let has_missed = Arc::clone(&missed);
    // The run after one that has missed its goal would be the same.
    let adaptive = GOALS.into_iter().take_while(move |_| !has_missed.load(Ordering::Relaxed));
    let adaptive = adaptive.map(move |goal| adaptive_run(goal, most_nodes, Arc::clone(&missed)));
    let uniform = (FIRST..).take_while(move |&times| uniform_nodes(times) <= most_nodes);
    let refined = adaptive.chain(uniform.map(uniform_run));
    refined.chain([spectral_run()]).map(|run| Ok(vec![run]))
}

/// Number of nodes of the L-shape, which is three squares, after so many uniform refinements.
fn uniform_nodes(refinements: usize) -> usize {
    let cells = 1 << refinements;
    3 * cells * cells + 4 * cells + 1
}

/// Run to a goal; remembers if it was `missed`.
fn adaptive_run(goal: f64, most_nodes: usize, missed: Arc<AtomicBool>) -> TimedRun {
    let run = TimedRun::new(
        format!("adaptive refinement, L-shape, error {goal}"),
        move || AdaptedProblem::LShape.adapted(goal, most_nodes, Adaption::BISECTIONS),
        move |run: Result<BoundedRun, String>| {
            let run = run?;
            missed.store(relative(&run)? > goal, Ordering::Relaxed);
            facts(Way::Adaptive, &run)
        },
    );
    TimedRun { series: Way::Adaptive.name().into(), ..run }
}

fn uniform_run(refinements: usize) -> TimedRun {
    let run = TimedRun::new(
        format!("uniform refinement, L-shape, {refinements} times"),
        move || AdaptedProblem::LShape.uniform_finest(refinements),
        |run: Result<BoundedRun, String>| facts(Way::Uniform, &run?),
    );
    let rival = Some(Way::Adaptive.name());
    TimedRun { series: Way::Uniform.name().into(), growth: 1.0, rival, ..run }
}

fn spectral_run() -> TimedRun {
    TimedRun::new(
        "spectral solver, L-shape".into(),
        || AdaptedProblem::LShape.truth(),
        |found: Result<TrueSolution, String>| {
            let found = found?;
            let Ok(bounds) = found.bounds() else { return Ok(None) };
            let problem = AdaptedProblem::LShape.name();
            let error = bounds.relative();
            let (way, nodes) = (Solver::Spectral.entry().name, found.unknowns);
            let row = RefinedRow { problem, way, nodes, error };
            Ok(error.is_finite().then(|| TimedFacts { table: "adapted", row: row_of(row) }))
        },
    )
}

/// Guaranteed error over the norm of the solution on the last mesh.
fn relative(run: &BoundedRun) -> Result<f64, String> {
    Ok(run.bounds.last().ok_or("no mesh")?.relative())
}

fn facts(way: Way, run: &BoundedRun) -> Result<Option<TimedFacts>, String> {
    let (nodes, error) = (run.y.len(), relative(run)?);
    let way = way.name();
    let row = RefinedRow { problem: AdaptedProblem::LShape.name(), way, nodes, error };
    Ok(Some(TimedFacts { table: "adapted", row: row_of(row) }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn uniform_meshes_have_so_many_nodes() {
        for refinements in 0..4 {
            let run = AdaptedProblem::LShape.uniform_finest(refinements).unwrap();
            assert_eq!(run.y.len(), uniform_nodes(refinements));
        }
    }
}
