//! Adaptive and uniform refinement to a guaranteed error, and the spectral solver beside them.

use super::{Prepared, TimedFacts, TimedRun};
use crate::bounds::Accuracy;
use crate::experiments::rows::row_of;
use crate::mesh::BuiltIn;
use crate::problem::law::Law;
use crate::solvers::{Adaption, Solved, Solver};
use crate::statement::{Domain, Fineness, Statement};
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
const FIRST: u8 = 5;

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
fn uniform_nodes(refinements: u8) -> usize {
    let cells: usize = 1 << refinements;
    3 * cells * cells + 4 * cells + 1
}

/// Run to a goal; remembers if it was `missed`.
/// Names of both ways of refinement.
const ADAPTIVE: &str = "adaptive";
const UNIFORM: &str = "uniform";

/// f on the L-shape, and the name of the L-shape in tables and pictures.
const F: &str = "rect(-9,0,-9,0)=3; else=-2";
const NAME: &str = "L-shape";

/// Solves on adapted meshes, with bounds on each.
fn adaptive(goal: f64, most_nodes: usize) -> Result<Solved, String> {
    let (law, goal, bisections) = (Law::SIGNORINI, Accuracy::Error(goal), Adaption::BISECTIONS);
    let coarsest = &BuiltIn::LShape.plane().ok_or("the L-shape lies in the plane")?;
    let adaption = Adaption { coarsest, f: F, law, goal, most_nodes, bisections };
    adaption.run(&mut (), &|_| ()).map_err(|e| e.to_string())
}

/// Solves on the mesh after so many uniform refinements, or by the spectral solver, with bounds.
fn solved(fineness: Fineness, solver: Solver) -> Result<Solved, String> {
    let statement = Statement { fineness, solver, ..Statement::usual(Domain::named("lshape"), F) };
    statement.solved(None).map_err(|e| e.to_string())
}

fn adaptive_run(goal: f64, most_nodes: usize, missed: Arc<AtomicBool>) -> TimedRun {
    let run = TimedRun::new(
        format!("adaptive refinement, L-shape, error {goal}"),
        move || adaptive(goal, most_nodes),
        move |solved: Result<Solved, String>| {
            let solved = solved?;
            missed.store(relative(&solved)? > goal, Ordering::Relaxed);
            facts(ADAPTIVE, &solved)
        },
    );
    TimedRun { series: ADAPTIVE.into(), ..run }
}

fn uniform_run(refinements: u8) -> TimedRun {
    let run = TimedRun::new(
        format!("uniform refinement, L-shape, {refinements} times"),
        move || solved(Fineness::Refined(refinements), Solver::Multigrid),
        |solved: Result<Solved, String>| facts(UNIFORM, &solved?),
    );
    TimedRun { series: UNIFORM.into(), growth: 1.0, rival: Some(ADAPTIVE), ..run }
}

fn spectral_run() -> TimedRun {
    TimedRun::new(
        "spectral solver, L-shape".into(),
        || solved(Fineness::Refined(0), Solver::Spectral),
        |solved: Result<Solved, String>| facts(Solver::Spectral.entry().name, &solved?),
    )
}

/// Guaranteed error over the norm of the solution.
fn relative(solved: &Solved) -> Result<f64, String> {
    match solved.bounds().last() {
        Some(Ok(bounds)) => Ok(bounds.relative()),
        _ => Err("no bounds".into()),
    }
}

/// What a run has reached; none without an error below the solution.
fn facts(way: &'static str, solved: &Solved) -> Result<Option<TimedFacts>, String> {
    let error = relative(solved)?;
    let nodes = solved
        .truth()
        .map_or_else(|| solved.run().map_or(0, |run| run.y.len()), |found| found.unknowns);
    let row = RefinedRow { problem: NAME, way, nodes, error };
    Ok(error.is_finite().then(|| TimedFacts { table: "adapted", row: row_of(row) }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn uniform_meshes_have_so_many_nodes() {
        for refinements in 0..4 {
            let run = solved(Fineness::Refined(refinements), Solver::Multigrid).unwrap();
            assert_eq!(run.run().unwrap().y.len(), uniform_nodes(refinements));
        }
    }
}
