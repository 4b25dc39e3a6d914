//! Data of the chapter on cost, from recorded times.

use crate::timing::recorded::{Timings, number};
use serde_json::{Value, json};
use signorini_mathematics::solvers::Solver;

/// Error of the energy, relative, at which the spectral solver and multigrid are compared.
const FAR: f64 = 1e-10;

/// Returns the recorded times, [`Timings::extended`], as the templates take them: with the names of the `solvers` on
/// grids, and a table `far` that compares both fast solvers.
pub(super) fn times(timings: &Timings) -> Result<Value, String> {
    let mut times = json!(timings.extended());
    times["solvers"] = json!(Solver::on_grids());
    times["far"] = json!(far(timings)?);
    Ok(times)
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
