//! Data of the chapter on cost, from recorded times.

use crate::table::rows::{Rows, number};
use crate::timing::recorded::{GOALS, Timings};
use serde_json::{Value, json};
use signorini_mathematics::solvers::Solver;

/// Error of the energy, relative, at which the spectral solver and multigrid are compared.
const FAR: f64 = 1e-10;

/// Cells per side of the finest grid that fits into the caches.
const CACHED: f64 = 512.0;

/// Returns the recorded times, [`Timings::extended`], as the templates take them: with a table `far` that compares both
/// fast solvers, the fastest of the `rivals` on a grid, multigrid on a grid that is `cached` and on a `large` one, and
/// the greatest `spread` of all.
pub(super) fn times(timings: &Timings) -> Result<Value, String> {
    let extended = timings.extended();
    let own = extended.multigrid.wherever("threads", 1)?.wherever("goal", GOALS[0])?;
    let spreads = [&timings.multigrid, &timings.solver, &timings.spectral];
    let spreads =
        spreads.into_iter().flat_map(|table| table.iter().map(|row| number(row, "spread")));
    let mut times = json!(extended);
    times["far"] = json!(far(timings)?);
    times["rivals"] = json!(rivals(timings)?);
    times["cached"] = json!(own.within("cells", 0.0, CACHED).last());
    times["large"] = json!(own.last());
    times["spread"] = json!(spreads.fold(0.0, f64::max));
    Ok(times)
}

/// Returns the fastest of the solvers of others on each problem and grid, from f to the solution vector.
fn rivals(timings: &Timings) -> Result<Rows, String> {
    let whole = timings.peer.wherever("whole", true)?;
    let mut rivals = whole.clone();
    rivals.0.retain(|row| {
        let mut alike = whole.clone();
        alike.0.retain(|one| ["f", "cells"].iter().all(|name| one.get(*name) == row.get(*name)));
        alike.iter().all(|other| number(row, "theirs") <= number(other, "theirs"))
    });
    Ok(rivals)
}

/// Returns the milliseconds to an error of [`FAR`] in the energy, problem by problem: of the spectral solver, least
/// recorded, and of multigrid, extrapolated to a grid so fine that it would have this error.
///
/// Multigrid's error of the energy falls like the reciprocal of its unknowns, and its time grows with them, so that
/// the product of error and time is the same on all grids.
fn far(timings: &Timings) -> Result<Vec<Value>, String> {
    let mut rows = Vec::new();
    for problem in timings.spectral.texts("problem")? {
        let mut reached = timings.spectral.wherever("problem", problem)?;
        reached.0.retain(|row| number(row, "error") <= FAR);
        let multigrid = timings.solver.wherever("problem", problem)?;
        let multigrid = multigrid.wherever("solver", Solver::Multigrid.to_string())?;
        let products =
            multigrid.points("seconds", "error")?.into_iter().map(|(s, error)| s * error);
        let spectral = reached.numbers("seconds")?.into_iter().reduce(f64::min);
        if let (Some(spectral), Some(product)) = (spectral, products.reduce(f64::min)) {
            rows.push(json!({
                "problem": problem,
                "error": FAR,
                "milliseconds": 1e3 * spectral,
                "ratio": product / FAR / spectral,
            }));
        }
    }
    Ok(rows)
}
