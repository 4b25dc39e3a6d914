//! Data of the chapter on cost, from recorded times: fits and crossovers.

use crate::timing::recorded::{
    Goal, Peer, Scaling, SolverTime, Spectral, Timings, to_discretisation,
};
use serde::Serialize;
use serde_json::{Value, json};
use signorini_mathematics::experiments::accuracy::AccuracyFindings;
use signorini_mathematics::experiments::timed::TimedPlan;
use signorini_mathematics::experiments::{Range, exponent};
use signorini_mathematics::solvers::Solver;
use std::collections::{BTreeMap, BTreeSet};

/// Error of the energy, relative, at which the spectral solver and multigrid are compared.
const FAR: f64 = 1e-10;
/// Cells per side of the finest grid that may fit into the caches.
const CACHED_AT: usize = 512;
/// Power laws are fitted to grids with at least so many unknowns.
const FIT_FROM: usize = 100_000;

/// Returns the recorded times in the form that the templates take.
pub(super) fn times(timings: &Timings, accuracy: &AccuracyFindings) -> Value {
    let problems = timings.problems();
    let comparisons: Vec<_> =
        problems.into_iter().map(|problem| comparison(problem, &timings.solver)).collect();
    let grids = grids(timings);
    json!({
        "grids": grids.iter().filter_map(|&n| grid(timings, n)).collect::<Vec<_>>(),
        // The finest of those that fit into the caches.
        "cached": grids.iter().rfind(|&&n| n <= CACHED_AT).and_then(|&n| grid(timings, n)),
        "fits": fits(timings),
        "comparisons": comparisons,
        "noise": noise(timings),
        "peers": peers(timings),
        "own_meshes": timings.own_mesh,
        "adapted": timings.adapted,
        "outdated": outdated(timings, accuracy),
        "spectral": spectral(timings),
    })
}

fn find(timings: &Timings, cells: usize, threads: usize, goal: Goal) -> Option<&Scaling> {
    let mut lines = timings.multigrid.iter().filter(|line| line.goal == goal);
    lines.find(|line| line.cells == cells && line.threads == threads)
}

/// Returns the times of multigrid on one grid to both goals.
fn to_goals(timings: &Timings, cells: usize, threads: usize) -> Option<[&Scaling; 2]> {
    let [near, floor] = Goal::ALL.map(|goal| find(timings, cells, threads, goal));
    Some([near?, floor?])
}

/// Returns the cells per side of the grids on which one thread was timed to both goals.
fn grids(timings: &Timings) -> Vec<usize> {
    let mut grids: Vec<usize> = timings.multigrid.iter().map(|line| line.cells).collect();
    grids.dedup();
    grids.retain(|&cells| to_goals(timings, cells, 1).is_some());
    grids
}

/// Returns the times of multigrid on one grid: to the discretisation error, then to the rounding floor.
fn grid(timings: &Timings, cells: usize) -> Option<Value> {
    let [near, floor] = to_goals(timings, cells, 1)?;
    Some(json!({
        "cells": cells,
        "unknowns": near.unknowns(),
        "discretisation": times_to_goal(timings, near),
        "floor": times_to_goal(timings, floor),
    }))
}

/// Returns the times per unknown to one goal on one grid: of one thread, and of two if they were timed.
fn times_to_goal(timings: &Timings, one_thread: &Scaling) -> Value {
    let two_threads = find(timings, one_thread.cells, 2, one_thread.goal);
    json!({
        "one_thread": one_thread.ns(),
        "two_threads": two_threads.map(Scaling::ns),
        // Nanoseconds per unknown in which the memory could have moved the bytes, one thread.
        "stream": one_thread.traffic / timings.bandwidth,
    })
}

/// Power law of multigrid's time.
#[derive(Serialize)]
struct Fit {
    goal: &'static str,
    threads: usize,
    exponent: f64,
    /// Unknowns on the coarsest and the finest grid of the fit.
    from: usize,
    to: usize,
}

fn fits(timings: &Timings) -> Vec<Fit> {
    let mut fits = Vec::new();
    for goal in Goal::ALL {
        for threads in [1, 2] {
            fits.extend(fit(timings, goal, threads));
        }
    }
    fits
}

/// Fits a power law; `None` with fewer than two grids of [`FIT_FROM`] unknowns.
fn fit(timings: &Timings, goal: Goal, threads: usize) -> Option<Fit> {
    let mut lines: Vec<&Scaling> = timings.multigrid.iter().collect();
    lines
        .retain(|line| line.goal == goal && line.threads == threads && line.unknowns() >= FIT_FROM);
    let points: Vec<_> = lines.iter().map(|l| (l.unknowns() as f64, l.seconds)).collect();
    let exponent = exponent(&points)?;
    let (from, to) = (lines.first()?.unknowns(), lines.last()?.unknowns());
    Some(Fit { goal: goal.in_words(), threads, exponent, from, to })
}

/// Compares the times of all solvers to the discretisation error of one problem, grid by grid.
fn comparison(problem: &str, lines: &[SolverTime]) -> Value {
    let (solvers, mut times) = (Solver::on_grids(), Vec::new());
    for &solver in &solvers {
        let mine = lines.iter().filter(|line| line.solver == solver && line.problem == problem);
        times.push(to_discretisation(mine));
    }
    let grids: BTreeSet<_> = times.iter().flat_map(BTreeMap::keys).collect();
    let mut rows = Vec::new();
    for cells in grids {
        let seconds = times.iter().map(|by_grid| by_grid.get(cells).map(|run| run.seconds));
        rows.push(json!({ "cells": cells, "seconds": seconds.collect::<Vec<_>>() }));
    }
    json!({ "problem": problem, "solvers": solvers, "rows": rows })
}

/// Returns the largest distance of the quartiles of a recorded time, over its median.
fn noise(timings: &Timings) -> f64 {
    let multigrid = timings.multigrid.iter().map(|line| line.spread);
    let solvers = timings.solver.iter().map(|line| line.spread);
    let spectral = timings.spectral.iter().map(|line| line.spread);
    multigrid.chain(solvers).chain(spectral).fold(0.0, f64::max)
}

/// Returns, for each f and grid on which other solvers were timed from f to the solution, the fastest of them.
fn peers(timings: &Timings) -> Vec<&Peer> {
    let mut fastest: Vec<&Peer> = Vec::new();
    for peer in timings.peer.iter().filter(|peer| peer.whole) {
        match fastest.iter_mut().find(|other| other.f == peer.f && other.cells == peer.cells) {
            Some(other) if other.theirs <= peer.theirs => (),
            Some(other) => *other = peer,
            None => fastest.push(peer),
        }
    }
    fastest
}

/// Returns the work units to the rounding floor, recorded and today's, on the finest grid for which both exist, if
/// they differ: then multigrid has changed since it was timed.
fn outdated(timings: &Timings, accuracy: &AccuracyFindings) -> Option<Value> {
    let problem =
        accuracy.problems.iter().find(|problem| problem.name == TimedPlan::SCALED.name())?;
    for level in problem.levels.iter().rev() {
        let (cells, [.., floor]) = (level.cost.cells, &level.cost.goals);
        if let Some(timed) = find(timings, cells, 1, Goal::Floor) {
            let (then, now) = (timed.work_units, floor.work_units);
            let changed = (then - now).abs() > 1e-6 * now;
            return changed.then(|| json!({ "cells": cells, "then": then, "now": now }));
        }
    }
    None
}

/// Returns the time to an error of [`FAR`] in the energy: ranges over the problems.
fn spectral(timings: &Timings) -> Option<Value> {
    let problems = timings.spectral.chunk_by(|a, b| a.problem == b.problem);
    let times: Vec<_> = problems.filter_map(|lines| far(timings, lines)).collect();
    Some(json!({
        "error": FAR,
        "milliseconds": Range::of(times.iter().map(|times| 1e3 * times.spectral))?,
        "ratio": Range::of(times.iter().map(|times| times.multigrid / times.spectral))?,
    }))
}

/// Seconds to an error of [`FAR`] in the energy of one problem.
struct Far {
    /// Least recorded time of the spectral solver.
    spectral: f64,
    /// Extrapolated time of multigrid, on a grid so fine that it would have this error.
    multigrid: f64,
}

/// Returns the times for the problem of these `lines` of the spectral solver.
///
/// Multigrid's error of the energy falls like the reciprocal of its unknowns, and its time grows with them, so that
/// the product of error and time is the same on all grids.
fn far(timings: &Timings, lines: &[Spectral]) -> Option<Far> {
    let reached = lines.iter().filter(|line| line.error <= FAR);
    let spectral = reached.map(|line| line.seconds).reduce(f64::min)?;
    let multigrid = timings.solver.iter().filter(|line| line.solver == Solver::Multigrid);
    let multigrid = multigrid.filter(|line| line.problem == lines[0].problem);
    let product = multigrid.map(|line| line.seconds * line.error).reduce(f64::min)?;
    Some(Far { spectral, multigrid: product / FAR })
}
