//! Accuracy that a scene or an option asks for: the grids and meshes that are tried to reach it.

use crate::pipeline::InputFiles;
use crate::pipeline::error::{Error, Result};
use crate::replication::fields::table::Voice;
use crate::replication::mesh_files;
use crate::timing::machine;
use signorini_mathematics::bounds::{Accuracy, Bounds, NoBound};
use signorini_mathematics::levels::{
    AdaptedEnd, AdaptedMesh, AdaptedRun, Adaption, Problem, ProblemError, Watch,
};
use signorini_mathematics::mesh::AnyMesh;
use signorini_mathematics::statement::{MOST_CELLS, Statement};
use std::ops::ControlFlow;

/// Cells per side of the first grid.
pub(crate) const FIRST: usize = 16;
/// Cells per side from which on errors fall like a power of the width of the grid.
const SETTLED: usize = 128;
/// Largest ratio of the widths of a grid and the next one.
const STRIDE: usize = 8;
/// Memory per node of the finest of adapted meshes, with all coarser ones: measured, rounded up.
const BYTES_PER_NODE: u64 = 900;

/// Choice of the solver without grids.
fn spectral(voice: Voice) -> &'static str {
    match voice {
        Voice::Options | Voice::OverScene => "--solver spectral",
        Voice::Keys => "solver = \"spectral\"",
    }
}

/// Solves on one grid of the square after the other until the guaranteed bounds are small enough. `solve` gets the
/// cells per side, and returns the bounds, or none if it failed and no finer grid is to be tried. All coarser
/// grids together cost less than the last one.
///
/// # Errors
/// [`Error::Input`] if no grid reaches the accuracy, and those of `solve`.
pub(crate) fn reach(
    accuracy: Accuracy,
    voice: Voice,
    mut solve: impl FnMut(usize) -> Result<Option<Bounds>>,
) -> Result<()> {
    let (mut finest, mut tried) = (FIRST, Vec::new());
    while let Some(bounds) = solve(finest)? {
        let reached = accuracy.reached(&bounds);
        if reached <= accuracy.wanted() {
            break;
        }
        tried.push(TriedGrid { cells: finest, reached });
        finest = next(accuracy, voice, &tried)?;
    }
    Ok(())
}

/// Returns what a grid of the square tells: its bounds, or that a finer one is needed, whose points miss less of f.
///
/// # Errors
/// [`Error::Input`] if no grid has bounds.
pub(crate) fn of_grid(
    accuracy: Accuracy,
    voice: Voice,
    bounds: std::result::Result<Bounds, NoBound>,
) -> Result<Bounds> {
    match bounds {
        Err(NoBound::Missed { .. }) => Ok(Bounds::NONE),
        Err(reason) => {
            let asked = voice.accuracy(accuracy);
            Err(Error::input(format!("{asked}: no bound of the error: {reason}; scale f")))
        }
        Ok(bounds) => Ok(bounds),
    }
}

/// Returns the cells per side of the grid after the last of those `tried`, whose bounds are too large.
fn next(accuracy: Accuracy, voice: Voice, tried: &[TriedGrid]) -> Result<usize> {
    let (asked, spectral) = (voice.accuracy(accuracy), spectral(voice));
    let TriedGrid { cells: finest, reached } = tried[tried.len() - 1];
    // Of two grids of nearly the same width the coarser may be better, if the borders of f are among its lines.
    let before = tried.iter().filter(|grid| 2 * grid.cells <= finest);
    let before = before.map(|grid| grid.reached).fold(f64::INFINITY, f64::min);
    // The relative error is infinite if the error may be as large as the solution.
    let settled = finest >= SETTLED && reached.is_finite();
    if settled && finest > SETTLED && reached >= before {
        return Err(Error::input(format!(
            "{asked}: rounding errors leave {before:.1e}; ask for less, or use {spectral}"
        )));
    }
    let order = order(accuracy);
    let needed = finest as f64 * libm::pow(reached / accuracy.wanted(), 1.0 / order);
    let last = MOST_CELLS as f64;
    if finest == MOST_CELLS || (settled && needed > 1.02 * last) {
        let best = match reached * libm::pow(finest as f64 / last, order) {
            f64::INFINITY => "does not reach half".into(),
            best => format!("reaches about {best:.1e}"),
        };
        let grid = match needed < 1e6 {
            true => format!("of about 1/{needed:.0}"),
            false => "finer than 1/1000000".into(),
        };
        return Err(Error::input(format!(
            "{asked} takes a grid {grid}, too fine for memory; 1/{MOST_CELLS} {best}, and {spectral} needs no grid"
        )));
    }
    Ok(size(needed.min(finest as f64 * STRIDE as f64)).clamp(finest + 1, MOST_CELLS))
}

/// Order of the bound on the square: the power of the width of the grid that is proportional to it.
fn order(accuracy: Accuracy) -> f64 {
    match accuracy {
        Accuracy::Error(_) => 1.0,
        Accuracy::Energy(_) => 3.0,
    }
}

/// Refines a mesh where the error is large until it is as small as asked; `watch` is shown each mesh, and `ended` told
/// each step.
///
/// # Errors
/// [`Error::Input`] in space, and if there is no problem or no bound; [`Error::Interrupted`] if `watch` does not let it
/// go on.
pub(crate) fn adapted(
    statement: &Statement,
    coarsest: &AnyMesh,
    (accuracy, voice): (Accuracy, Voice),
    watch: &mut dyn FnMut(&AdaptedMesh) -> ControlFlow<()>,
    ended: Watch<'_>,
) -> Result<AdaptedRun> {
    let asked = voice.accuracy(accuracy);
    let AnyMesh::Plane(coarsest) = coarsest else {
        return Err(Error::input(format!(
            "{asked}: meshes are adapted in the plane alone; in space, choose how fine by the number of refinements"
        )));
    };
    let memory = machine::available_memory().unwrap_or(u64::MAX);
    let most_nodes = usize::try_from(memory / BYTES_PER_NODE).unwrap_or(usize::MAX);
    let law = statement.law().map_err(|e| Error::input(format!("law: {e}")))?;
    let (f, goal, bisections) = (&*statement.f, accuracy, Adaption::BISECTIONS);
    let adaption = Adaption { coarsest, f, law, goal, most_nodes, bisections };
    let run = adaption.run_while(watch, ended).map_err(|e| match e {
        ProblemError::Mesh(e) => Error::input(format!("{}: {e}", statement.domain.name)),
        e => Error::input(format!("{asked}: {e}")),
    })?;
    run.ok_or(Error::Interrupted)
}

/// As [`adapted`], for a scene, whose mesh is read from these files. The end is that of the goal.
///
/// # Errors
/// [`Error::Input`] also if the accuracy is not reached; [`Error::Interrupted`] if `watch` does not let it go on.
pub(crate) fn adapted_scene(
    statement: &Statement,
    files: &InputFiles,
    accuracy: Accuracy,
    watch: &mut dyn FnMut(&AdaptedMesh) -> ControlFlow<()>,
) -> Result<AdaptedRun> {
    let Some(coarsest) = mesh_files::mesh(statement, files)? else {
        return Err(Error::input("the square has grids in place of meshes"));
    };
    let (asked, voice) = (Voice::Keys.accuracy(accuracy), Voice::Keys);
    let run = adapted(statement, &coarsest, (accuracy, voice), watch, &|_| ())?;
    match run.end {
        AdaptedEnd::Goal => Ok(run),
        _ if !accuracy.reached(&run.bounds).is_finite() => Err(Error::input(format!(
            "{asked}: the error is bounded on no mesh by less than the solution, as where v = 0; leave it out"
        ))),
        AdaptedEnd::Nodes | AdaptedEnd::NoLongerFalls => Err(Error::input(format!(
            "{asked}: {:.1e} is reached with {} nodes, and no more; ask for less",
            accuracy.reached(&run.bounds),
            run.y.len()
        ))),
    }
}

/// Returns the problem on the meshes of [`adapted_scene`], from the cells that were marked there.
pub(crate) fn on_bisected(
    statement: &Statement,
    files: &InputFiles,
    marks: &[Vec<u32>],
) -> Result<Problem> {
    let Some(AnyMesh::Plane(coarsest)) = mesh_files::mesh(statement, files)? else {
        return Err(Error::input("meshes are adapted in the plane alone"));
    };
    let law = statement.law().map_err(|e| Error::input(format!("law: {e}")))?;
    let problem = Problem::on_bisected(&coarsest, marks, &statement.f, law);
    problem.map_err(|e| Error::input(e.to_string()))
}

/// Grid that was tried, with the bound that it gave.
#[derive(Clone, Copy, Debug)]
struct TriedGrid {
    cells: usize,
    reached: f64,
}

/// Returns the least number of cells per side from 1.003 times `needed` on that multigrid takes: four to seven times a
/// power of two.
fn size(needed: f64) -> usize {
    let needed = (1.003 * needed).ceil() as usize;
    let mut unit = 2;
    while 8 * unit < needed {
        unit *= 2;
    }
    unit * needed.div_ceil(unit).max(4)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_suit_multigrid_and_are_hardly_finer_than_needed() {
        for needed in 9..5000 {
            let n = size(f64::from(needed));
            let odd = n >> n.trailing_zeros();
            assert!(odd <= 7 && n as f64 >= f64::from(needed), "{needed} {n}");
            assert!((n as f64) < 1.3 * f64::from(needed) + 2.0, "{needed} {n}");
        }
    }
}
