//! What the chapter on cost says about recorded times: fits and crossovers.

use crate::experiments::accuracy::Findings;
use crate::experiments::{Range, exponent};
use crate::timing::measure::TIMED;
use crate::timing::recorded::{self, Goal, Reached, Scaling, Timings, to_discretisation};
use crate::timing::solver::Solver;
use serde::Serialize;
use serde_json::{Value, json};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Display;

/// Error of the energy, relative, at which the spectral solver and multigrid are compared.
const FAR: f64 = 1e-10;
/// Cells per side of the finest grid that may fit into the caches.
const CACHED_AT: usize = 512;
/// Power laws are fitted to grids with at least so many unknowns.
const FIT_FROM: usize = 100_000;

/// Recorded times as the templates take them.
pub(super) fn times(timings: &Timings, accuracy: &Findings) -> Value {
    let mut problems: Vec<&str> = timings.solver.iter().map(|line| &*line.problem).collect();
    problems.dedup();
    let comparison = |problem| comparison(problem, &timings.solver);
    json!({
        "grids": grids(timings).into_iter().filter_map(|n| grid(timings, n)).collect::<Vec<_>>(),
        // The finest of those that fit into the caches.
        "cached": grids(timings).into_iter().rfind(|&n| n <= CACHED_AT).and_then(|n| grid(timings, n)),
        "fits": fits(timings),
        "comparisons": problems.into_iter().map(comparison).collect::<Vec<_>>(),
        "noise": noise(timings),
        "outdated": outdated(timings, accuracy),
        "spectral": spectral(timings),
    })
}

fn find(timings: &Timings, cells: usize, threads: usize, goal: Goal) -> Option<&Scaling> {
    let wanted =
        |line: &&Scaling| line.cells == cells && line.threads == threads && line.goal == goal;
    timings.multigrid.iter().find(wanted)
}

/// Multigrid on one grid to both goals.
fn to_goals(timings: &Timings, cells: usize, threads: usize) -> Option<[&Scaling; 2]> {
    let [near, floor] = Goal::ALL.map(|goal| find(timings, cells, threads, goal));
    Some([near?, floor?])
}

/// Cells per side of the grids on which one thread was timed to both goals.
fn grids(timings: &Timings) -> Vec<usize> {
    let mut grids: Vec<usize> = timings.multigrid.iter().map(|line| line.cells).collect();
    grids.dedup();
    grids.retain(|&cells| to_goals(timings, cells, 1).is_some());
    grids
}

/// Multigrid on one grid: to the discretisation error, then to the rounding floor.
fn grid(timings: &Timings, cells: usize) -> Option<Value> {
    let goals = to_goals(timings, cells, 1)?;
    let timed = |one: &Scaling| {
        let two = find(timings, cells, 2, one.goal);
        json!({
            // By threads: one, then two if there are.
            "ns": std::iter::once(one).chain(two).map(Scaling::ns).collect::<Vec<_>>(),
            "per_unit": one.ns() / one.work_units,
            "stream": stream(timings, one),
        })
    };
    Some(json!({
        "cells": cells,
        "unknowns": goals[0].unknowns(),
        "bytes": goals[1].bytes,
        "goals": goals.map(timed),
    }))
}

/// Nanoseconds per unknown in which the memory could have moved the bytes, one thread.
fn stream(timings: &Timings, line: &Scaling) -> f64 {
    line.traffic / timings.bandwidth.update
}

/// A power law of multigrid's time.
#[derive(Serialize)]
struct Fit {
    goal: &'static str,
    threads: usize,
    exponent: f64,
    /// Unknowns on the coarsest and the finest grid of the fit.
    from: usize,
    to: usize,
    ns: Range,
}

fn fits(timings: &Timings) -> Vec<Fit> {
    let fit = |goal: Goal, threads| {
        let wanted = |line: &&Scaling| {
            line.goal == goal && line.threads == threads && line.unknowns() >= FIT_FROM
        };
        let lines: Vec<_> = timings.multigrid.iter().filter(wanted).collect();
        let points: Vec<_> = lines.iter().map(|l| (l.unknowns() as f64, l.seconds)).collect();
        let (from, to) = (lines.first()?.unknowns(), lines.last()?.unknowns());
        let ns = Range::of(lines.iter().map(|line| line.ns()))?;
        Some(Fit { goal: goal.in_words(), threads, exponent: exponent(&points), from, to, ns })
    };
    let fits = Goal::ALL.into_iter().flat_map(|goal| [1, 2].map(|threads| fit(goal, threads)));
    fits.flatten().filter(|fit| fit.exponent.is_finite()).collect()
}

/// All solvers to the discretisation error of one problem, grid by grid.
fn comparison(problem: &str, lines: &[Reached]) -> Value {
    let times = Solver::ON_GRIDS.map(|solver| {
        let mine = lines.iter().filter(|l| l.solver == solver && l.problem == problem);
        to_discretisation(&mine.collect::<Vec<_>>())
    });
    let grids: BTreeSet<_> = times.iter().flat_map(BTreeMap::keys).collect();
    let row = |cells: &usize| {
        let seconds = times.each_ref().map(|of| of.get(cells).copied());
        let there =
            Solver::ON_GRIDS.iter().zip(seconds).filter_map(|(solver, s)| Some((solver, s?)));
        let best = there.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(solver, _)| solver);
        json!({ "cells": cells, "seconds": seconds, "best": best })
    };
    let rows: Vec<_> = grids.into_iter().map(row).collect();
    json!({ "problem": problem, "solvers": Solver::ON_GRIDS, "rows": rows })
}

/// The two noisiest medians, worst first.
fn noise(timings: &Timings) -> Vec<Value> {
    let on = |of: &dyn Display, cells: usize, spread: f64| (format!("{of} at 1/{cells}"), spread);
    let sweep = timings.sweep.iter().map(|l| on(&"a sweep", l.cells, l.spread));
    let multigrid = timings.multigrid.iter().map(|l| on(&"multigrid", l.cells, l.spread));
    let solvers = timings.solver.iter().map(|l| on(&l.solver.in_words(), l.cells, l.spread));
    let spectral = timings.spectral.iter();
    let spectral = spectral.map(|l| (format!("spectral with {} nodes", l.nodes), l.spread));
    let mut all: Vec<_> = sweep.chain(multigrid).chain(solvers).chain(spectral).collect();
    all.sort_by(|a, b| b.1.total_cmp(&a.1));
    all.truncate(2);
    all.into_iter().map(|(of, spread)| json!({ "of": of, "spread": spread })).collect()
}

/// Work units to the rounding floor, as timed and as they are, on the finest grid that both know, where
/// multigrid has changed since it was timed.
fn outdated(timings: &Timings, accuracy: &Findings) -> Option<Value> {
    let timed = accuracy.problems.iter().find(|problem| problem.name == TIMED.name())?;
    let mut both = timed.levels.iter().rev().filter_map(|level| {
        let (cells, [.., floor]) = (level.cost.cells, &level.cost.goals);
        Some((cells, find(timings, cells, 1, Goal::Floor)?.work_units, floor.work_units))
    });
    let (cells, then, now) =
        both.next().filter(|(_, then, now)| (then - now).abs() > 1e-6 * now)?;
    Some(json!({ "cells": cells, "then": then, "now": now }))
}

/// What an error of [`FAR`] in the energy takes, over problems.
///
/// Multigrid's error of the energy falls like the reciprocal of its unknowns, and its time grows with them.
fn spectral(timings: &Timings) -> Option<Value> {
    let times = |lines: &[recorded::Spectral]| {
        let reached = lines.iter().filter(|line| line.error <= FAR);
        let spectral = reached.map(|line| line.seconds).reduce(f64::min)?;
        let solver = timings.solver.iter().filter(|line| line.solver == Solver::Multigrid);
        let multigrid = solver.filter(|line| line.problem == lines[0].problem);
        let best = multigrid.map(|line| line.seconds * line.error).reduce(f64::min)?;
        Some([spectral, best / FAR])
    };
    let problems = timings.spectral.chunk_by(|a, b| a.problem == b.problem);
    let times: Vec<_> = problems.filter_map(times).collect();
    Some(json!({
        "error": FAR,
        "milliseconds": Range::of(times.iter().map(|[spectral, _]| 1e3 * spectral))?,
        // Multigrid's time over it, on a grid so fine that it would have this error.
        "ratio": Range::of(times.iter().map(|[spectral, multigrid]| multigrid / spectral))?,
    }))
}
